//! The commands that a servo is simulated under.

use std::borrow::Cow;

/// Commands that are held from sample to sample, each in force from its sample on or from a moment within the period behind it.
#[derive(Clone, Copy, Debug)]
pub struct Commands<'a> {
    /// The command of each sample period.
    pub levels: &'a [f64],
    /// How long after its sample each comes into force, less than a sample period \[s\]; `None` where all do at once. Only those of changes count.
    pub late_s: Option<&'a [f64]>,
}

impl<'a> Commands<'a> {
    /// The first `count` of them.
    #[must_use]
    pub fn first(self, count: usize) -> Self {
        Self {
            levels: &self.levels[..count],
            late_s: self.late_s.map(|late_s| &late_s[..count]),
        }
    }
}

impl<'a> From<&'a [f64]> for Commands<'a> {
    fn from(levels: &'a [f64]) -> Self {
        Self {
            levels,
            late_s: None,
        }
    }
}

impl<'a, const N: usize> From<&'a [f64; N]> for Commands<'a> {
    fn from(levels: &'a [f64; N]) -> Self {
        levels.as_slice().into()
    }
}

impl<'a> From<&'a Vec<f64>> for Commands<'a> {
    fn from(levels: &'a Vec<f64>) -> Self {
        levels.as_slice().into()
    }
}

impl<'a> From<&'a Cow<'a, [f64]>> for Commands<'a> {
    fn from(levels: &'a Cow<'a, [f64]>) -> Self {
        levels.as_ref().into()
    }
}
