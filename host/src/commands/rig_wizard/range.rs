//! A range of two numbers, written with a colon between them.

use std::fmt;
use std::str::FromStr;

/// From `low` to `high`, `low` being smaller; written `LOW:HIGH`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The smaller end.
    pub low: f64,
    /// The greater one.
    pub high: f64,
}

impl Range {
    /// Whether a number lies in it, its ends included.
    #[must_use]
    pub fn contains(&self, number: f64) -> bool {
        (self.low..=self.high).contains(&number)
    }
}

impl FromStr for Range {
    type Err = String;

    /// ```
    /// use servoid::rig_wizard::Range;
    /// assert_eq!("-20:30".parse(), Ok(Range { low: -20.0, high: 30.0 }));
    /// assert!("30:-20".parse::<Range>().is_err());
    /// ```
    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|n| n.is_finite());
        text.split_once(':')
            .and_then(|(low, high)| Some((number(low)?, number(high)?)))
            .filter(|(low, high)| low < high)
            .map(|(low, high)| Self { low, high })
            .ok_or_else(|| "two numbers with a colon between them are needed, the smaller one first, such as -20:20".to_owned())
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.low, self.high)
    }
}
