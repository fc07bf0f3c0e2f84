//! A range of two numbers, written with a colon between them.

use std::fmt;
use std::str::FromStr;

/// From `low` to `high`, `low` being smaller; written `LOW:HIGH`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::commands) struct Range {
    pub low: f64,
    pub high: f64,
}

/// The error for text that is not a range.
pub(in crate::commands) const RANGE_FORM: &str =
    "two numbers with a colon between them are needed, the smaller one first, such as -20:20";

impl Range {
    /// Whether a number lies in it, its ends included.
    pub(super) fn contains(&self, number: f64) -> bool {
        (self.low..=self.high).contains(&number)
    }
}

impl FromStr for Range {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|n| n.is_finite());
        let ends = text.split_once(':');
        ends.and_then(|(low, high)| Some((number(low)?, number(high)?)))
            .filter(|(low, high)| low < high)
            .map(|(low, high)| Self { low, high })
            .ok_or_else(|| RANGE_FORM.to_owned())
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.low, self.high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_the_smaller_end_first() {
        assert_eq!(
            "-20:30".parse(),
            Ok(Range {
                low: -20.0,
                high: 30.0
            })
        );
        assert!("30:-20".parse::<Range>().is_err());
    }
}
