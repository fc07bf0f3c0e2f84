//! What it takes to make a band as narrow as is wanted, and what would help where more runs do not.

use serde::Serialize;

/// More runs than this are no advice: what changes in a servo over a hundred of them is more than a band of
/// noise has in it, and a larger amplitude gives the same at once.
pub const MOST_RUNS: u64 = 100;

/// A band as more data change it (half of its width where it is widest, percent of the step).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shrinking {
    /// With the data that there are.
    pub widest_percent: f64,
    /// What stays however many runs there are: what frequencies without power may hide, and what a servo
    /// that is not linear repeats in every run.
    pub stays_percent: f64,
}

/// What it takes to make the band as narrow as is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Needed {
    /// Half width where it is widest (percent of the step).
    pub band_percent: f64,
    /// Runs.
    pub runs: u64,
    /// How long they take, the rest before and after each reference included (s).
    pub seconds: f64,
}

/// How a wanted width can be had.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// With so many runs altogether, no more than [`MOST_RUNS`].
    Runs(u64),
    /// With so many more that something else is better.
    TooManyRuns,
    /// With no number of runs.
    Never,
}

impl Shrinking {
    /// After so many times the data: the noise's part shrinks with the root.
    #[must_use]
    pub fn widest_after(self, times: f64) -> f64 {
        let stays = self.stays_percent;
        (self.widest_percent - stays).max(0.0) / times.sqrt() + stays
    }

    /// K times the runs narrow the noise's part of the band by the square root of K: their information
    /// adds up. (A longer N, chosen where more data show more of the response, costs some of that.)
    ///
    /// ```
    /// use servoid::plan::{Reach, Shrinking};
    /// let band = Shrinking { widest_percent: 0.6, stays_percent: 0.1 };
    /// assert_eq!(band.reach(0.2, 1), Reach::Runs(25));
    /// assert_eq!(band.reach(0.11, 1), Reach::TooManyRuns);
    /// assert_eq!(band.reach(0.1, 1), Reach::Never);
    /// ```
    #[must_use]
    pub fn reach(self, wanted_percent: f64, runs: usize) -> Reach {
        let room = wanted_percent - self.stays_percent;
        if room <= 0.0 {
            return Reach::Never;
        }
        let times = ((self.widest_percent - self.stays_percent) / room).powi(2);
        // A whole number stays one whatever the last digit of the division says.
        let needed = (times * runs as f64 * (1.0 - 1e-9)).ceil().max(1.0);
        if needed <= MOST_RUNS as f64 {
            Reach::Runs(needed as u64)
        } else {
            Reach::TooManyRuns
        }
    }

    /// How many runs it takes, or what to do instead.
    #[must_use]
    pub fn advice(self, wanted_percent: f64, runs: usize) -> String {
        match self.reach(wanted_percent, runs) {
            Reach::Runs(needed) => format!(
                "about {needed} such runs together get there: record them (--repeat) and give all files to 'servoid identify'"
            ),
            Reach::TooManyRuns => format!(
                "+-{wanted_percent} % is more than {MOST_RUNS} such runs away; a larger --amplitude narrows the band in proportion as long as the servo stays linear, and 'servoid plan' ranks the references"
            ),
            Reach::Never => format!(
                "no number of such runs gives +-{wanted_percent} %: +-{:.2} % of the band is not noise but what the reference does not tell; take one with sharp edges and holds in which the servo comes to rest ('servoid plan' ranks them)",
                self.stays_percent
            ),
        }
    }
}
