//! The number of runs for a wanted band, and what to do where more runs do not help.

use serde::Serialize;

/// The largest number of runs that is ever advised. Over a hundred runs a servo changes by more than the noise
/// part of the band, and a larger amplitude gives the same at once.
pub const MOST_RUNS: u64 = 100;

/// A band that more data narrow (half of its width where it is widest, percent of the step).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NarrowingBand {
    /// Its half width with the present data.
    pub widest_percent: f64,
    /// The part that more runs do not narrow: the bias by frequencies without power, and the motion that a servo
    /// that is not linear repeats in every run.
    pub floor_percent: f64,
}

/// The runs for a wanted band.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RunsNeeded {
    /// Half width where it is widest (percent of the step).
    pub band_percent: f64,
    /// Number of runs.
    pub runs: u64,
    /// Their duration, the rest before and after each reference included (s).
    pub seconds: f64,
}

/// Whether more runs reach a wanted width.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// This number of runs altogether reaches it, at most [`MOST_RUNS`].
    Runs(u64),
    /// More than [`MOST_RUNS`] would.
    TooManyRuns,
    /// No number of runs does.
    Never,
}

impl NarrowingBand {
    /// The half width after this many times the data: the noise part shrinks with the square root.
    #[must_use]
    pub fn widest_after(self, times: f64) -> f64 {
        let floor = self.floor_percent;
        (self.widest_percent - floor).max(0.0) / times.sqrt() + floor
    }

    /// K times the runs narrow the noise part of the band by the square root of K, because their information adds
    /// up. (A longer N, chosen where more data show more of the response, costs some of that.)
    ///
    /// ```
    /// use servoid::plan::{NarrowingBand, Reach};
    /// let band = NarrowingBand { widest_percent: 0.6, floor_percent: 0.1 };
    /// assert_eq!(band.reach(0.2, 1), Reach::Runs(25));
    /// assert_eq!(band.reach(0.11, 1), Reach::TooManyRuns);
    /// assert_eq!(band.reach(0.1, 1), Reach::Never);
    /// ```
    #[must_use]
    pub fn reach(self, wanted_percent: f64, runs: usize) -> Reach {
        let room = wanted_percent - self.floor_percent;
        if room <= 0.0 {
            return Reach::Never;
        }
        let times = ((self.widest_percent - self.floor_percent) / room).powi(2);
        // The factor keeps a quotient that is a whole number, but for its last digit, from being rounded up.
        let needed = (times * runs as f64 * (1.0 - 1e-9)).ceil().max(1.0);
        if needed <= MOST_RUNS as f64 {
            Reach::Runs(needed as u64)
        } else {
            Reach::TooManyRuns
        }
    }

    /// The number of runs for a wanted width, or what to do instead.
    #[must_use]
    pub fn advice(self, wanted_percent: f64, runs: usize) -> String {
        match self.reach(wanted_percent, runs) {
            Reach::Runs(needed) => format!(
                "about {needed} such runs together reach it: record them with --repeat and give all files to 'servoid identify'"
            ),
            Reach::TooManyRuns => format!(
                "+-{wanted_percent} % needs more than {MOST_RUNS} such runs; a larger --amplitude narrows the band in proportion while the servo stays linear, and 'servoid plan' ranks the references"
            ),
            Reach::Never => format!(
                "no number of such runs reaches +-{wanted_percent} %, because +-{:.2} % of the band is not noise; take a reference with sharp edges and with holds in which the servo comes to rest ('servoid plan' ranks them)",
                self.floor_percent
            ),
        }
    }
}
