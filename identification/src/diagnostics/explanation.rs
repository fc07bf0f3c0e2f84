//! How a model came about: what was considered, and why this was chosen.

use serde::{Deserialize, Serialize};

use crate::data::Quantisation;
use crate::diagnostics::initial_rest::Contradicted;
use crate::diagnostics::linearity::Linearity;
use crate::diagnostics::misfit::Misfit;
use crate::diagnostics::run_scatter::RunComparison;
use crate::estimation::{BankCandidate, Excitation, OrderCandidate, Solver};
use crate::results::{Model, SelectedBy};
use crate::selection::Choice;
use crate::thresholds::MARGIN;

/// The way to a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Explanation {
    /// The choice of the settling time; `None` when it was given.
    pub settling: Option<Choice>,
    /// Banks at that settling time, by number of frequencies; empty when n was given.
    pub frequencies: Vec<BankCandidate>,
    /// Noise orders; empty when d was given.
    pub noise_orders: Vec<OrderCandidate>,
    /// Which arithmetic was used.
    pub path: Solver,
    /// Condition number of the normal equations (1-norm, offset projected out).
    pub condition: f64,
    /// Rows of the regression.
    pub rows: usize,
    /// Degrees of freedom behind each standard deviation of the step response.
    pub degrees_of_freedom: Vec<f64>,
    /// What was found when the errors are not noise; `None` when they are.
    pub model_errors: Option<Misfit>,
    /// Whether the errors of the first estimate follow the motion; `None` where that could not be
    /// tested.
    #[serde(default)]
    pub linearity: Option<Linearity>,
    /// The run that did not begin where it is said to have rested, if one did not.
    #[serde(default)]
    pub at_rest: Option<Contradicted>,
    /// Up to which frequency the input moves.
    #[serde(default)]
    pub excitation: Option<Excitation>,
    /// The steps of the sensor, where they are larger than the noise.
    #[serde(default)]
    pub resolution: Option<Quantisation>,
    /// How the runs compare; `None` with fewer than two.
    pub runs: Option<RunComparison>,
}

impl Explanation {
    /// The choice of the structure of `model` in words, one sentence for each decision.
    #[must_use]
    pub fn sentences(&self, model: &Model) -> Vec<String> {
        let structure = &model.structure;
        let period = model.sample_period_s;
        let mut sentences = Vec::new();
        if let Some(choice) = &self.settling {
            sentences.push(choice_in_words(choice, period));
        }
        if let (Some(narrowest), Some(all)) = (self.narrowest_bank(), self.frequencies.last()) {
            let gain = model.metrics.dc_gain.value.unwrap_or(1.0).abs();
            let percent = |half_width: f64| 100.0 * half_width / gain;
            let widths = [narrowest, all].map(|bank| percent(bank.half_width()));
            sentences.push(format!(
                "Frequencies: {} of {} that the input excites{}.",
                structure.frequencies,
                all.frequencies,
                if model.bounds.withdrawn().is_some() {
                    String::new()
                } else if narrowest.frequencies == all.frequencies {
                    format!(
                        ", and none would give a narrower band than all (mean half width {:.2} % of the \
                         gain)",
                        widths[1]
                    )
                } else {
                    format!(
                        "; with all the band has a mean half width of {:.2} % of the gain, and it would \
                         be narrowest, {:.2} %, with {}",
                        widths[1], widths[0], narrowest.frequencies
                    )
                }
            ));
        }
        if let Some(white) = self.noise_orders.first() {
            let best = self
                .noise_orders
                .iter()
                .map(|order| order.bic)
                .fold(white.bic, f64::min);
            sentences.push(if best < white.bic {
                format!(
                    "Noise: order {} by Bayes' criterion, which is smaller by {:.1} than for white noise.",
                    structure.noise_order,
                    white.bic - best
                )
            } else {
                format!(
                    "Noise: order {}; Bayes' criterion is smallest for white noise (order 0).",
                    structure.noise_order
                )
            });
        }
        if let Some(errors) = &self.model_errors {
            sentences.push(match errors.candidates.len() {
                0 => "The errors are not noise, and no part of the record shows how well a model predicts \
                      another; the estimator was taken that simulates the record better."
                    .to_owned(),
                tried => format!(
                    "The errors are not noise; of {tried} structures and estimators the simplest was \
                     taken that predicts unseen parts within half a point of the best."
                ),
            });
        }
        let path = match self.path {
            Solver::Moments => "lagged moments",
            Solver::Qr => "a triangular factor of the rows (QR)",
        };
        sentences.push(format!(
            "Arithmetic: {} rows through {path}, condition number {:.1e}.",
            self.rows, self.condition
        ));
        sentences
    }

    /// The lowest frequency of which the input does not tell the response of `model` \[Hz\]; `None` where it
    /// tells of all, or frequencies were left out by the caller's choice alone. Bounds have no level where
    /// there is one.
    #[must_use]
    pub fn unexcited_above_hz(&self, model: &Model) -> Option<f64> {
        if let Some(untold) = self
            .model_errors
            .as_ref()
            .and_then(|e| e.unexcited_above_hz)
        {
            return Some(untold);
        }
        let basis = model.basis().ok()?;
        let unbounded = self.excitation.is_some_and(|found| !found.bounded);
        // The choice for prediction leaves out what does not help it, whether the input has it or not.
        let lacking = match &self.model_errors {
            Some(_) => unbounded && self.excitation.is_some_and(|found| found.is_smooth()),
            None => {
                let chosen = model.structure.selected_by == SelectedBy::Auto;
                unbounded || chosen && !basis.has_all_frequencies()
            }
        };
        let next = (basis.highest() + 1) as f64;
        lacking.then(|| next / (basis.settling() as f64 * model.sample_period_s))
    }

    fn narrowest_bank(&self) -> Option<&BankCandidate> {
        self.frequencies
            .iter()
            .min_by(|a, b| a.half_width().total_cmp(&b.half_width()))
    }
}

fn choice_in_words(choice: &Choice, period: f64) -> String {
    let seconds = |samples: usize| samples as f64 * period;
    let outcome = if choice.settled {
        format!(
            "is the shortest tried that is at least {MARGIN} times the {:.3} s after which the \
             response rests, and that a fit of {:.3} s does not contradict",
            seconds(choice.detected),
            seconds(choice.longest)
        )
    } else {
        format!(
            "is the longest that the record allows; the response still moves at {:.3} s",
            seconds(choice.detected)
        )
    };
    let settling = seconds(choice.settling);
    let limited = if choice.within_holds {
        " None longer than the usual hold of the reference was tried, because the servo is not linear: \
         what it answers to the next step differently would pass for a late response to this one."
    } else {
        ""
    };
    format!(
        "Settling time: {settling:.3} s ({} samples) {outcome}.{limited}",
        choice.settling
    )
}

#[cfg(test)]
mod tests {
    use crate::{Options, Record, identify_explained};

    #[test]
    fn every_decision_has_its_sentence() {
        let u: Vec<f64> = (0..900).map(|k| f64::from(k * k / 900 % 2)).collect();
        let y: Vec<f64> = u
            .iter()
            .enumerate()
            .scan(0.0, |y, (k, u)| {
                *y += 0.3 * (u - *y);
                Some(*y + 0.01 * ((k * 7919 % 101) as f64 / 50.0 - 1.0))
            })
            .collect();
        let record = Record::from_slices(0.01, &u, &y).unwrap();
        let found = identify_explained(&record, &Options::default()).unwrap();
        let sentences = found.explanation.sentences(&found.model);
        for (beginning, sentence) in ["Settling time:", "Frequencies:", "Noise:", "Arithmetic:"]
            .iter()
            .zip(&sentences)
        {
            assert!(sentence.starts_with(beginning), "{sentence}");
        }
    }
}
