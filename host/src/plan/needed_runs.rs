//! The number of runs for a wanted band, by trying.
//!
//! The noise part of a band shrinks with the square root of the runs. The rest does not: a servo that is not linear repeats its motion, more data
//! show more of the end of a response, and from three runs on a band contains how they differ, at few degrees of freedom. So that root
//! gives the least number alone, and simulated identifications of as many runs say what comes.

use super::band_width::{BandWidths, MOST_RUNS, NarrowingBand, Reach, RunsNeeded};
use super::request::PlanRequest;
use super::simulated_runs::simulated;
use servoid_identification::{Options, identify};

/// How closely the number is looked for, as a part of it: widths of single identifications scatter by more.
const CLOSELY: f64 = 0.1;

/// What is tried.
#[derive(Clone, Copy)]
pub(super) struct Effort {
    /// Simulated identifications of each number of runs.
    pub simulations: u64,
    /// How often the number is doubled at the most.
    pub doublings: u32,
}

impl PlanRequest {
    /// The least number of runs that is found to reach the wanted width, or the largest that was tried and does not, with its width. `None` where
    /// none is wanted, or where no number could: the bias alone is wider.
    pub(super) fn runs_needed(
        &self,
        band: &BandWidths,
        effort: Effort,
    ) -> Option<Result<RunsNeeded, RunsNeeded>> {
        let wanted_percent = self.wanted_percent?;
        let by_noise = NarrowingBand {
            widest_percent: band.widest_percent,
            floor_percent: band.bias_percent,
        };
        let Reach::Runs(fewest) = by_noise.reach(wanted_percent, self.runs) else {
            return None;
        };
        let of = |runs: u64, band_percent: f64| RunsNeeded {
            band_percent,
            runs,
            seconds: runs as f64 * self.run_s(),
        };
        let (mut too_few, mut runs, mut doublings) = (fewest - 1, fewest, 0);
        loop {
            let width = self.widest_percent_of(runs, band, effort);
            if width <= wanted_percent {
                break;
            }
            // What so many runs show of the servo, more show as well.
            let has_none = width.is_infinite();
            if has_none || runs == MOST_RUNS || doublings == effort.doublings {
                return Some(Err(of(runs, width)));
            }
            (too_few, runs, doublings) = (runs, (2 * runs).min(MOST_RUNS), doublings + 1);
        }
        while runs - too_few > 1 + (CLOSELY * runs as f64) as u64 {
            let middle = too_few + (runs - too_few) / 2;
            match self.widest_percent_of(middle, band, effort) <= wanted_percent {
                true => runs = middle,
                false => too_few = middle,
            }
        }
        Some(Ok(of(runs, wanted_percent)))
    }

    /// The width of so many runs together, the median of simulated identifications, infinite where that has no bounds; that of the runs of the
    /// request is `known`.
    fn widest_percent_of(&self, runs: u64, known: &BandWidths, effort: Effort) -> f64 {
        if runs == self.runs as u64 {
            return known.widest_percent;
        }
        let request = Self {
            runs: runs as usize,
            ..self.clone()
        };
        let options = Options {
            level: self.level,
            ..Options::default()
        };
        let width = |seed: u64| {
            let record = simulated(&request, seed).ok()?;
            let found = identify(&record, &options).ok()?;
            Some(100.0 * found.step.bounds.valid()?.widest_half_width())
        };
        let mut widths: Vec<f64> = (1..=effort.simulations)
            .map(|seed| width(seed).unwrap_or(f64::INFINITY))
            .collect();
        widths.sort_by(f64::total_cmp);
        let middle = widths.get(widths.len() / 2);
        middle.copied().unwrap_or(f64::INFINITY)
    }
}
