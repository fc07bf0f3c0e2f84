//! Widths of a step response's bands, and the number of runs for a wanted one.

use serde::Serialize;
use servoid_identification::results::StepBounds;

/// Half widths of a step response's bands (percent of the step).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BandWidths {
    /// Confidence level.
    pub level: f64,
    /// The whole curve's band, where it is widest.
    pub widest_percent: f64,
    /// That of the widest of the simulated identifications: one in some takes a longer settling time than the others.
    pub widest_of_all_percent: f64,
    /// The whole curve's band, on average.
    pub mean_percent: f64,
    /// The bounds of single points, on average.
    pub mean_pointwise_percent: f64,
    /// The part of each that more runs do not narrow: the bias by frequencies without power.
    pub bias_percent: f64,
    /// The part of the widest that noise does not explain, the bias included. Runs of a simulated servo repeat
    /// it, so more of them do not narrow it.
    pub beyond_noise_percent: f64,
    /// The part of the simulated identifications that had no bounds (percent of them).
    pub without_bounds_percent: f64,
}

/// Half the width from which on a band holds no step as well: it says nothing (percent of the step).
const WHOLE_STEP_PERCENT: f64 = 100.0;

/// Whether a band of this half width still says something of a step.
pub(super) fn shows_step(widest_percent: f64) -> bool {
    widest_percent < WHOLE_STEP_PERCENT
}

impl BandWidths {
    pub(super) fn of(bounds: &StepBounds) -> Self {
        let (pointwise, whole) = bounds.mean_half_widths();
        Self {
            level: bounds.level,
            widest_percent: 100.0 * bounds.widest_half_width(),
            widest_of_all_percent: 100.0 * bounds.widest_half_width(),
            mean_percent: 100.0 * whole,
            mean_pointwise_percent: 100.0 * pointwise,
            bias_percent: 100.0 * bounds.bias(),
            beyond_noise_percent: 0.0,
            without_bounds_percent: 0.0,
        }
    }

    /// The mean of several of one level; NaN of none.
    pub(super) fn mean(all: &[Self]) -> Self {
        let mean = |of: fn(&Self) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        Self {
            level: all.first().map_or(f64::NAN, |w| w.level),
            widest_percent: mean(|w| w.widest_percent),
            widest_of_all_percent: all
                .iter()
                .map(|w| w.widest_of_all_percent)
                .fold(f64::NAN, f64::max),
            mean_percent: mean(|w| w.mean_percent),
            mean_pointwise_percent: mean(|w| w.mean_pointwise_percent),
            bias_percent: mean(|w| w.bias_percent),
            beyond_noise_percent: mean(|w| w.beyond_noise_percent),
            without_bounds_percent: mean(|w| w.without_bounds_percent),
        }
    }

    /// The widest, and the part of it that more runs do not narrow.
    pub(super) fn narrowing(&self) -> NarrowingBand {
        NarrowingBand {
            widest_percent: self.widest_percent,
            floor_percent: self.bias_percent.max(self.beyond_noise_percent),
        }
    }
}

/// The largest number of runs that is ever advised. Over a hundred runs a servo changes by more than the noise
/// part of the band, and a larger amplitude gives the same at once.
pub(super) const MOST_RUNS: u64 = 100;

/// A band that more data narrow (half of its width where it is widest, percent of the step).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NarrowingBand {
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
pub(super) enum Reach {
    /// This number of runs altogether reaches it, at most [`MOST_RUNS`].
    Runs(u64),
    TooManyRuns,
    Never,
}

impl NarrowingBand {
    /// The half width after this many times the data: the noise part shrinks with the square root.
    pub(super) fn widest_after(self, times: f64) -> f64 {
        let floor = self.floor_percent;
        (self.widest_percent - floor).max(0.0) / times.sqrt() + floor
    }

    /// K times the runs narrow the noise part of the band by the square root of K, because their information adds
    /// up. (A longer N, chosen where more data show more of the response, costs some of that.)
    pub(super) fn reach(self, wanted_percent: f64, runs: usize) -> Reach {
        let room = wanted_percent - self.floor_percent;
        if room <= 0.0 {
            return Reach::Never;
        }
        let times = ((self.widest_percent - self.floor_percent) / room).powi(2);
        // The factor keeps a quotient that is a whole number, but for its last digit, from being rounded up.
        let needed = (times * runs as f64 * (1.0 - 1e-9)).ceil().max(1.0);
        match needed <= MOST_RUNS as f64 {
            true => Reach::Runs(needed as u64),
            false => Reach::TooManyRuns,
        }
    }

    /// The number of runs for a wanted width, or another remedy.
    pub(crate) fn advice(self, wanted_percent: f64, runs: usize) -> String {
        match self.reach(wanted_percent, runs) {
            Reach::Runs(needed) => format!(
                "by its noise alone {needed} such runs together would reach it, and no fewer: record them with --repeat and give all files to 'servoid identify'. From three runs on the band also has how runs differ, and a servo that is not linear repeats its motion in all: 'servoid plan --band {wanted_percent}' tries it"
            ),
            Reach::TooManyRuns => format!(
                "±{wanted_percent} % needs more than {MOST_RUNS} such runs; a larger --amplitude narrows the band in proportion while the servo stays linear, and 'servoid plan' ranks the references"
            ),
            Reach::Never => format!(
                "no number of such runs reaches ±{wanted_percent} %, because ±{:.2} % of the band is not noise; take a reference with sharp edges and with holds in which the servo comes to rest ('servoid plan' ranks them)",
                self.floor_percent
            ),
        }
    }
}
