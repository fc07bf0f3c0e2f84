//! What a caller may fix, and what is left to the measured procedures.

use std::fmt;
use std::str::FromStr;

use crate::error::Error;

/// Largest order of the noise model that can be asked for.
pub(crate) const MAX_NOISE_ORDER: usize = 24;

/// Longest settling time that can be asked for \[samples\]: its matrices have the square of it as
/// entries, 200 MB each.
pub(crate) const LONGEST_SETTLING_BY_HAND: usize = 5000;

/// Largest order that the automatic choice of the noise model considers.
pub(crate) const MAX_AUTO_ORDER: usize = 8;

/// Confidence levels that bounds can be had for.
pub const LEVELS: std::ops::RangeInclusive<f64> = 0.5..=0.99999;

/// Settling time N: the number of samples after which the response to an input is over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Settling {
    /// Chosen from the data (see `selection::settling_choice`).
    #[default]
    Auto,
    /// Fixed \[samples\].
    Samples(usize),
}

/// Number n of frequencies in the filter bank, odd and at most N.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Frequencies {
    /// All of them (n = N, made odd), or, when the input has no power at high frequencies, as many
    /// as make the honest band narrowest.
    #[default]
    Auto,
    /// About twice what predicts best, a narrow part of the spectrum as in the paper. The bounds contain what is left out, hold only if the
    /// response falls at 40 dB/decade above the highest frequency, and are no narrower than those of `Auto`.
    Narrow,
    /// Fixed, odd.
    Count(usize),
}

/// Order d of the noise model `1/D(z)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NoiseOrder {
    /// By Bayes' information criterion over 0 to 8.
    #[default]
    Auto,
    /// Fixed; 0 is plain least squares.
    Order(usize),
}

impl NoiseOrder {
    /// The highest order that may be fitted.
    pub(crate) fn highest(self) -> usize {
        match self {
            Self::Auto => MAX_AUTO_ORDER,
            Self::Order(order) => order,
        }
    }
}

/// What is taken out of the output of each run, within the regression.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Detrend {
    /// Offsets where runs differ, and straight lines where the output drifts, each beyond chance.
    #[default]
    Auto,
    /// Nothing but an offset of all runs together.
    None,
    /// An offset of each run.
    Offset,
    /// An offset and a straight line of each run.
    Linear,
}

/// What is known of the response before the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Prior {
    /// Nothing but that it is over after N: the paper's way.
    #[default]
    None,
    /// It dies out and is smooth, as much as the data say. Bounds are narrower by a factor of 1.5 to 4 in white noise, and no narrower in slow
    /// noise; they rest on the response being of that kind.
    Stable,
}

/// Options of [`crate::identify()`]. `Options::default()` leaves every choice to the data, at 99 %.
///
/// ```
/// use servoid_identification::{Options, Settling};
/// let options = Options { settling: "50".parse().unwrap(), ..Options::default() };
/// assert_eq!(options.settling, Settling::Samples(50));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Settling time N.
    pub settling: Settling,
    /// Number of frequencies n.
    pub frequencies: Frequencies,
    /// Noise order d.
    pub noise_order: NoiseOrder,
    /// Confidence level of every bound, between 0.5 and 0.99999.
    pub level: f64,
    /// Longest settling time that the automatic choice considers \[samples\]; `None` is a seventh
    /// of the record, at most 599.
    pub longest_settling: Option<usize>,
    /// Offsets and trends of runs.
    pub detrend: Detrend,
    /// What is known of the response before the data.
    pub prior: Prior,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            settling: Settling::Auto,
            frequencies: Frequencies::Auto,
            noise_order: NoiseOrder::Auto,
            level: 0.99,
            longest_settling: None,
            detrend: Detrend::Auto,
            prior: Prior::None,
        }
    }
}

impl Options {
    /// Checks what can be checked without data.
    ///
    /// # Errors
    /// A settling time below 3 or above 5000 samples, an even or too large number of frequencies, a noise order above 24,
    /// a level outside 0.5..0.99999.
    pub fn check(&self) -> Result<(), Error> {
        if let Settling::Samples(settling) = self.settling {
            if !(3..=LONGEST_SETTLING_BY_HAND).contains(&settling) {
                return Err(Error::Settling {
                    settling,
                    longest: LONGEST_SETTLING_BY_HAND,
                });
            }
            if let Frequencies::Count(frequencies) = self.frequencies
                && (frequencies.is_multiple_of(2) || frequencies > settling)
            {
                return Err(Error::Frequencies {
                    frequencies,
                    settling,
                });
            }
        }
        if let NoiseOrder::Order(order) = self.noise_order
            && order > MAX_NOISE_ORDER
        {
            return Err(Error::NoiseOrder {
                order,
                max: MAX_NOISE_ORDER,
            });
        }
        if !LEVELS.contains(&self.level) {
            return Err(Error::Level(self.level));
        }
        Ok(())
    }
}

/// A word that is neither `auto` nor a number where one of the two is wanted.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{given}` is not understood: give {wanted}")]
pub struct ParseOptionError {
    given: String,
    wanted: &'static str,
}

fn number(given: &str, wanted: &'static str) -> Result<usize, ParseOptionError> {
    given.parse().map_err(|_| ParseOptionError {
        given: given.to_owned(),
        wanted,
    })
}

impl FromStr for Settling {
    type Err = ParseOptionError;
    fn from_str(given: &str) -> Result<Self, Self::Err> {
        match given {
            "auto" => Ok(Self::Auto),
            _ => number(given, "`auto` or a number of samples").map(Self::Samples),
        }
    }
}

impl FromStr for Frequencies {
    type Err = ParseOptionError;
    fn from_str(given: &str) -> Result<Self, Self::Err> {
        match given {
            "auto" => Ok(Self::Auto),
            "narrow" => Ok(Self::Narrow),
            _ => number(given, "`auto`, `narrow` or an odd number").map(Self::Count),
        }
    }
}

impl FromStr for Detrend {
    type Err = ParseOptionError;
    fn from_str(given: &str) -> Result<Self, Self::Err> {
        match given {
            "auto" => Ok(Self::Auto),
            "none" => Ok(Self::None),
            "offset" => Ok(Self::Offset),
            "linear" => Ok(Self::Linear),
            _ => Err(ParseOptionError {
                given: given.to_owned(),
                wanted: "`auto`, `none`, `offset` or `linear`",
            }),
        }
    }
}

impl FromStr for Prior {
    type Err = ParseOptionError;
    fn from_str(given: &str) -> Result<Self, Self::Err> {
        match given {
            "none" => Ok(Self::None),
            "stable" => Ok(Self::Stable),
            _ => Err(ParseOptionError {
                given: given.to_owned(),
                wanted: "`none` or `stable`",
            }),
        }
    }
}

impl fmt::Display for Prior {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "none",
            Self::Stable => "stable",
        })
    }
}

impl fmt::Display for Detrend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::None => "none",
            Self::Offset => "offset",
            Self::Linear => "linear",
        })
    }
}

impl FromStr for NoiseOrder {
    type Err = ParseOptionError;
    fn from_str(given: &str) -> Result<Self, Self::Err> {
        match given {
            "auto" => Ok(Self::Auto),
            _ => number(given, "`auto` or a number").map(Self::Order),
        }
    }
}

impl fmt::Display for Settling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Samples(samples) => samples.fmt(f),
        }
    }
}

impl fmt::Display for Frequencies {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Narrow => f.write_str("narrow"),
            Self::Count(count) => count.fmt(f),
        }
    }
}

impl fmt::Display for NoiseOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Order(order) => order.fmt(f),
        }
    }
}
