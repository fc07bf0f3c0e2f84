//! Which reference, and over which frequencies.

use servoid_protocol::reference::HIGHEST_MILLIHERTZ;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// Which reference.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// The paper's.
    #[default]
    Staircase,
    /// Many levels, each reached from all others.
    Stairs,
    /// A pseudo-random binary sequence.
    Prbs,
    /// A sine whose frequency moves evenly.
    Sweep,
    /// Many sines at once.
    Multisine,
    /// A table in a CSV file.
    Steps(PathBuf),
}

impl FromStr for Kind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "staircase" => Ok(Self::Staircase),
            "stairs" => Ok(Self::Stairs),
            "prbs" => Ok(Self::Prbs),
            "sweep" => Ok(Self::Sweep),
            "multisine" => Ok(Self::Multisine),
            file if file.to_lowercase().ends_with(".csv") => Ok(Self::Steps(file.into())),
            _ => Err(
                "choose staircase, stairs, prbs, sweep, multisine, or a table of steps, FILE.csv"
                    .to_owned(),
            ),
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Staircase => f.write_str("staircase"),
            Self::Stairs => f.write_str("stairs"),
            Self::Prbs => f.write_str("prbs"),
            Self::Sweep => f.write_str("sweep"),
            Self::Multisine => f.write_str("multisine"),
            Self::Steps(file) => file.display().fmt(f),
        }
    }
}

/// Two frequencies (Hz), written LOW:HIGH.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrequencyBand {
    /// Where it begins.
    pub first: f64,
    /// Where it ends.
    pub last: f64,
}

impl FromStr for FrequencyBand {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<f64>().ok();
        let highest = f64::from(HIGHEST_MILLIHERTZ) * 1e-3;
        text.split_once(':')
            .and_then(|(first, last)| Some((number(first)?, number(last)?)))
            .filter(|(first, last)| [first, last].iter().all(|f| (0.0..=highest).contains(*f)))
            .map(|(first, last)| Self { first, last })
            .ok_or_else(|| {
                format!("two frequencies from 0 to {highest} Hz are needed, such as 0.2:15")
            })
    }
}
