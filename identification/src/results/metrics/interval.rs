//! A value between two bounds.

use serde::{Deserialize, Serialize};

/// A value with its bounds; `None` where the responses do not determine it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Interval {
    /// Best estimate.
    pub value: Option<f64>,
    /// Lower bound.
    pub lower: Option<f64>,
    /// Upper bound.
    pub upper: Option<f64>,
}

impl Interval {
    /// An interval; numbers that are not finite become `None`.
    #[must_use]
    pub fn new(value: f64, lower: f64, upper: f64) -> Self {
        let finite = |x: f64| x.is_finite().then_some(x);
        Self {
            value: finite(value),
            lower: finite(lower),
            upper: finite(upper),
        }
    }

    /// The value alone.
    #[must_use]
    pub fn without_bounds(self) -> Self {
        Self {
            value: self.value,
            ..Self::default()
        }
    }

    /// Both bounds; `None` where it is open to a side.
    #[must_use]
    pub fn ends(&self) -> Option<[f64; 2]> {
        Some([self.lower?, self.upper?])
    }

    /// From the lower bound to the upper one; `None` where it is open to a side.
    ///
    /// ```
    /// use servoid_identification::results::Interval;
    /// assert_eq!(Interval::new(2.0, 1.0, 4.0).width(), Some(3.0));
    /// assert_eq!(Interval::new(2.0, 1.0, f64::INFINITY).width(), None);
    /// ```
    #[must_use]
    pub fn width(&self) -> Option<f64> {
        let [lower, upper] = self.ends()?;
        Some(upper - lower)
    }

    /// A value with bounds `half` to each side; none where that is not known.
    #[must_use]
    pub(crate) fn around(value: f64, half: Option<f64>) -> Self {
        half.map_or(Self::new(value, f64::NAN, f64::NAN), |half| {
            Self::new(value, value - half, value + half)
        })
    }

    /// The interval, `half` to each side of its value where it is narrower; without bounds where that is not known.
    pub(crate) fn at_least_as_wide(self, half: Option<f64>) -> Self {
        let least = self.value.zip(half);
        let wider = |bound: Option<f64>, of: fn(f64, f64, f64) -> f64| {
            let (bound, (value, half)) = bound.zip(least)?;
            Some(of(bound, value, half))
        };
        Self {
            lower: wider(self.lower, |lower, value, half| lower.min(value - half)),
            upper: wider(self.upper, |upper, value, half| upper.max(value + half)),
            ..self
        }
    }

    /// The interval with its lower bound `below` further out, and its upper bound `above`: none where that is endless.
    #[must_use]
    pub(crate) fn reaching(self, below: f64, above: f64) -> Self {
        let upper = self.upper.map(|upper| upper + above);
        Self {
            lower: self.lower.map(|lower| lower - below),
            upper: upper.filter(|upper| upper.is_finite()),
            ..self
        }
    }

    /// The interval with its bounds `by` further out; one that is not negative stays so.
    #[must_use]
    pub(crate) fn widened(self, by: f64) -> Self {
        let below = |lower: f64| match lower < 0.0 {
            true => lower - by,
            false => (lower - by).max(0.0),
        };
        Self {
            lower: self.lower.map(below),
            upper: self.upper.map(|upper| upper + by),
            ..self
        }
    }

    /// The same interval in another unit: a rising function of value and bounds. What has no finite number there becomes
    /// `None`.
    pub(crate) fn map(self, of: impl Fn(f64) -> f64) -> Self {
        let finite = |x: Option<f64>| x.map(&of).filter(|x| x.is_finite());
        Self {
            value: finite(self.value),
            lower: finite(self.lower),
            upper: finite(self.upper),
        }
    }

    /// Whether `x` is not excluded: a missing bound excludes nothing.
    ///
    /// ```
    /// use servoid_identification::results::Interval;
    /// assert!(Interval::new(1.0, 0.9, f64::INFINITY).contains(7.0));
    /// assert!(!Interval::new(1.0, 0.9, 1.1).contains(0.8));
    /// ```
    #[must_use]
    pub fn contains(&self, x: f64) -> bool {
        self.lower.is_none_or(|lower| lower <= x) && self.upper.is_none_or(|upper| x <= upper)
    }
}
