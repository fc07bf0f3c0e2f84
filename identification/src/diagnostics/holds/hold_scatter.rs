//! What differs from hold to hold: when a command takes effect, and how far its level is off.

use serde::{Deserialize, Serialize};

use super::answer_scatter::allow_for_answer_scatter;
use super::held_run::HeldRun;
use super::level_scatter::{OffLevels, allow_for_level_scatter};
use crate::data::Moments;
use crate::diagnostics::residuals::simulation_error::Simulated;
use crate::estimation::GlsFit;
use crate::numerics::two_digits;

/// By how much holds differ beyond noise; the bounds allow for it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct HoldScatter {
    /// Standard deviation of the time of an answer about that of the others \[s\]; 0 where it is not beyond chance.
    pub answers_s: f64,
    /// Standard deviation by which a level is off, as if the command had been, another time at each visit \[units of the input\]; 0 as above.
    pub visits: f64,
    /// The same of what is alike at each visit to a level.
    pub levels: f64,
}

impl HoldScatter {
    /// In words.
    pub(crate) fn in_words(&self) -> String {
        let answers = (self.answers_s > 0.0).then(|| {
            format!(
                "answers to commands scatter by {} ms",
                two_digits(1e3 * self.answers_s)
            )
        });
        let off = self.visits.hypot(self.levels);
        let levels = (off > 0.0).then(|| {
            format!(
                "levels are off by {} in the unit of the command, as by rounding of what was written, or by friction",
                two_digits(off)
            )
        });
        let found: Vec<String> = answers.into_iter().chain(levels).collect();
        format!(
            "Holds differ beyond noise (standard deviations): {}.",
            found.join(", and ")
        )
    }
}

/// The covariance of `fit` becomes that with what differs from hold to hold; `None` where nothing does beyond chance.
pub(crate) fn allow_for_hold_scatter(
    runs: &[Simulated<'_>],
    moments: &Moments,
    fit: &mut GlsFit,
) -> Option<HoldScatter> {
    // The runs may be the beginning of a longer record, which has more answers, and more visits to the same levels.
    let rows: f64 = runs.iter().map(|run| run.errors.len() as f64).sum();
    let seen = (rows / fit.rows as f64).min(1.0);
    let held = HeldRun::all(runs, fit);
    let late = allow_for_answer_scatter(&held, seen, fit);
    let off = allow_for_level_scatter(&held, moments, seen, fit);
    let OffLevels { visits, levels } = off.unwrap_or_default();
    (late.is_some() || off.is_some()).then(|| HoldScatter {
        answers_s: late.unwrap_or_default() * moments.sample_period_s(),
        visits,
        levels,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_scatters_by_little_does_not_read_as_nothing() {
        let of = |answers_s: f64, visits: f64| {
            let found = HoldScatter {
                answers_s,
                visits,
                levels: 0.0,
            };
            found.in_words()
        };
        let little = of(1.234e-6, 0.0031);
        assert!(
            little.contains("scatter by 0.0012 ms, and levels are off by 0.0031 in the"),
            "{little}"
        );
        assert!(of(0.01234, 0.0).contains("scatter by 12 ms."));
    }
}
