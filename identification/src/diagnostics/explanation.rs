//! How a model came about: what was considered, and why this was chosen.

use serde::{Deserialize, Serialize};

use crate::data::Quantisation;
use crate::diagnostics::causality::feedback::Feedback;
use crate::diagnostics::commands::noisy_commands::CommandNoise;
use crate::diagnostics::holds::hold_scatter::HoldScatter;
use crate::diagnostics::linearity::Linearity;
use crate::diagnostics::misfit::Misfit;
use crate::diagnostics::noise::hum::Hum;
use crate::diagnostics::noise::uneven_noise::UnevenNoise;
use crate::diagnostics::outlying::taken_out::TakenOut;
use crate::diagnostics::prior_outcome::PriorOutcome;
use crate::diagnostics::response_end::slow_end::{AllowedEnd, SlowEnd};
use crate::diagnostics::runs::initial_rest::Contradicted;
use crate::diagnostics::runs::run_scatter::RunComparison;
use crate::diagnostics::runs::start_elsewhere::StartElsewhere;
use crate::estimation::{BankCandidate, Excitation, OrderCandidate, Solver};
use crate::results::{Bounds, Model};
use crate::selection::Choice;
use crate::thresholds::MARGIN;

/// A bank at the settling time that was chosen. Where the bounds of the model are withdrawn, it has no widths
/// either.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Bank {
    /// n.
    pub frequencies: usize,
    /// Generalised cross-validation: rows RSS / (rows - n - 1)².
    pub gcv: f64,
    /// Mean 99 % half width of the step response from the noise alone.
    pub noise_half_width: Option<f64>,
    /// Bound of the truncation bias at the assumed roll-off.
    pub truncation_bias: Option<f64>,
}

impl Bank {
    pub(crate) fn new(found: &BankCandidate, level: Bounds<f64>) -> Self {
        let held = |width: f64| level.valid().map(|_| width);
        Self {
            frequencies: found.frequencies,
            gcv: found.gcv,
            noise_half_width: held(found.noise_half_width),
            truncation_bias: held(found.truncation_bias),
        }
    }

    /// Half width of the bound: noise and truncation bias together.
    #[must_use]
    pub fn half_width(&self) -> Option<f64> {
        Some(self.noise_half_width? + self.truncation_bias?)
    }
}

/// Steps of the sensor that are larger than the noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Resolution {
    /// δ \[output\].
    pub step: f64,
    /// Root mean square of the residuals, in steps.
    pub residual: f64,
    /// Largest error of a gain from rounding \[output per input\]; `None` where bounds are withdrawn.
    pub allowance: Option<f64>,
}

impl Resolution {
    pub(crate) fn new(found: &Quantisation, level: Bounds<f64>) -> Self {
        Self {
            step: found.step,
            residual: found.residual,
            allowance: level.valid().map(|_| found.allowance),
        }
    }
}

/// The way to a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Explanation {
    /// The choice of the settling time; `None` when it was given.
    pub settling: Option<Choice>,
    /// Banks at that settling time, by number of frequencies; empty when n was given.
    pub frequencies: Vec<Bank>,
    /// Noise orders; empty when d was given.
    pub noise_orders: Vec<OrderCandidate>,
    /// Which arithmetic was used.
    pub path: Solver,
    /// Condition number of the normal equations (1-norm, offset projected out).
    pub condition: f64,
    /// Rows of the regression.
    pub rows: usize,
    /// Degrees of freedom behind each standard deviation of the step response; `None` where there are no bounds.
    pub degrees_of_freedom: Option<Vec<f64>>,
    /// What was found when the errors are not noise; `None` when they are.
    pub model_errors: Option<Misfit>,
    /// Whether the errors of the first estimate follow the motion; `None` where that could not be
    /// tested.
    #[serde(default)]
    pub linearity: Option<Linearity>,
    /// The run that did not begin at the rest that was stated, if one did not.
    #[serde(default)]
    pub at_rest: Option<Contradicted>,
    /// That runs begin elsewhere than where the servo comes to rest later, where they do.
    #[serde(default)]
    pub start: Option<StartElsewhere>,
    /// Up to which frequency the input moves.
    #[serde(default)]
    pub excitation: Option<Excitation>,
    /// The steps of the sensor, where they are larger than the noise.
    #[serde(default)]
    pub resolution: Option<Resolution>,
    /// Samples that were taken out as outlying.
    #[serde(default)]
    pub taken_out: Vec<TakenOut>,
    /// Noise in the column of a command that is held but for it; `None` where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command_noise: Option<CommandNoise>,
    /// Periodic disturbances that were taken out.
    #[serde(default)]
    pub hum: Vec<Hum>,
    /// Change of the output over each run that was taken out as a trend; empty where there was none.
    #[serde(default)]
    pub drift: Vec<f64>,
    /// By how much the noise varies, where it does beyond chance.
    #[serde(default)]
    pub uneven_noise: Option<UnevenNoise>,
    /// By how much holds differ, where they do beyond chance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hold_scatter: Option<HoldScatter>,
    /// That the response goes on beyond N, where it does.
    #[serde(default)]
    pub slow_end: Option<SlowEnd>,
    /// The slow end that bounds, where they hold, allow for; `None` where they rest on the response being over after N.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub allowed_end: Option<AllowedEnd>,
    /// Whether the input follows the output; `None` where the errors are no noise.
    #[serde(default)]
    pub feedback: Option<Feedback>,
    /// What became of the stable prior; `None` where it was not asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prior: Option<PriorOutcome>,
    /// How the runs compare; `None` with fewer than two.
    pub runs: Option<RunComparison>,
}

impl Explanation {
    /// Whether answers to commands come sooner or later than the model says, beyond noise: commands wait, or the servo is not linear.
    #[must_use]
    pub fn answers_scatter(&self) -> bool {
        self.hold_scatter.is_some_and(|found| found.answers_s > 0.0)
    }

    /// Whether bounds allow for a response that goes on beyond N.
    pub(crate) fn may_go_on(&self) -> bool {
        self.allowed_end.is_some() || matches!(self.prior, Some(PriorOutcome::Used { .. }))
    }

    /// Whether what the errors of a plain model hide of the end of the response may be in those of a model of both directions: N was chosen,
    /// and the errors are no steps of the sensor.
    pub(crate) fn may_go_on_by_direction(&self) -> bool {
        self.settling.is_some() && self.resolution.is_none()
    }

    /// The choice of the structure of `model` in words, one sentence for each decision.
    #[must_use]
    pub fn sentences(&self, model: &Model) -> Vec<String> {
        let structure = &model.structure;
        let period = model.sample_period_s;
        let mut sentences = Vec::new();
        if let Some(choice) = &self.settling {
            sentences.push(choice_in_words(choice, period));
        }
        if let Some(all) = self.frequencies.last() {
            let gain = model.metrics.dc_gain.value.unwrap_or(1.0).abs();
            let percent = |bank: &Bank| bank.half_width().map(|half| 100.0 * half / gain);
            let narrowest = self
                .narrowest_bank()
                .and_then(|bank| Some((bank.frequencies, percent(bank)?)));
            let widths = match (narrowest, percent(all)) {
                (Some((count, _)), Some(width)) if count == all.frequencies => format!(
                    "{} (mean half width {width:.2} % of the gain)",
                    match structure.frequencies < count {
                        true => "; all of them would give the narrowest band",
                        false => ", and none would give a narrower band than all",
                    }
                ),
                (Some((count, least)), Some(width)) => format!(
                    "; with all the band has a mean half width of {width:.2} % of the gain, and it would be \
                     narrowest, {least:.2} %, with {count}"
                ),
                _ => String::new(),
            };
            sentences.push(format!(
                "Frequencies: {} of {} that the input excites{widths}.",
                structure.frequencies, all.frequencies
            ));
        }
        if let Some(white) = self.noise_orders.first() {
            let all = self.noise_orders.iter().map(|order| order.bic);
            let gained = white.bic - all.fold(white.bic, f64::min);
            let order = structure.noise_order;
            sentences.push(match gained > 0.0 {
                true => format!(
                    "Noise: order {order} by Bayes' criterion, which is smaller by {gained:.1} than for white noise."
                ),
                false => format!(
                    "Noise: order {order}; Bayes' criterion is smallest for white noise (order 0)."
                ),
            });
        }
        if let (Some(end), Some(gain)) = (&self.allowed_end, model.metrics.dc_gain.value) {
            sentences.push(end.in_words(gain));
        }
        let allowed_for = match model.bounds.valid() {
            Some(_) => " The bounds allow for it.",
            None => "",
        };
        let uneven = self.uneven_noise.as_ref().map(UnevenNoise::in_words);
        let scatter = self.hold_scatter.as_ref().map(HoldScatter::in_words);
        let varying = uneven.into_iter().chain(scatter);
        sentences.extend(varying.map(|found| found + allowed_for));
        sentences.extend(left_out_in_words(&self.taken_out, period));
        sentences.extend(self.prior.as_ref().map(PriorOutcome::in_words));
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

    fn narrowest_bank(&self) -> Option<&Bank> {
        let widths = self
            .frequencies
            .iter()
            .filter_map(|bank| Some((bank, bank.half_width()?)));
        widths
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(bank, _)| bank)
    }
}

/// Places that are written out: of more, nobody looks at each.
const MOST_PLACES: usize = 100;

/// Where samples were left out, all places; `None` where none were.
fn left_out_in_words(taken_out: &[TakenOut], period: f64) -> Option<String> {
    let several = taken_out.iter().any(|found| found.run > 1);
    let place = |found: &TakenOut| {
        let seconds = |sample: usize| format!("{:.3}", sample as f64 * period);
        let begin = seconds(found.sample);
        let stretch = match found.samples {
            1 => format!("{begin} s"),
            samples => format!("{begin} to {} s", seconds(found.sample + samples - 1)),
        };
        match several {
            true => format!("{stretch} of run {}", found.run),
            false => stretch,
        }
    };
    let places: Vec<String> = taken_out.iter().take(MOST_PLACES).map(place).collect();
    let more = match taken_out.len() - places.len() {
        0 => String::new(),
        more => format!(", and at {more} places more"),
    };
    let samples: usize = taken_out.iter().map(|found| found.samples).sum();
    (samples > 0).then(|| {
        let are = if samples == 1 { "sample" } else { "samples" };
        format!("Left out: {samples} {are}, at {}{more}.", places.join(", "))
    })
}

fn choice_in_words(choice: &Choice, period: f64) -> String {
    let seconds = |samples: usize| samples as f64 * period;
    let outcome = if choice.for_slow_end {
        "is the longest that the record allows, because a slow end of the response goes on beyond shorter ones"
            .to_owned()
    } else if choice.settled {
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
        " None was tried that is longer than the usual hold of the reference, or than the output takes to rest, because the servo is not linear: \
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
    use super::{TakenOut, left_out_in_words};
    use crate::{Options, Record, identify_explained};

    #[test]
    fn all_places_of_what_was_left_out_are_named() {
        let at = |run: usize, sample: usize, samples: usize| TakenOut {
            run,
            sample,
            samples,
            spike: samples == 1,
            other_stroke: false,
        };
        assert_eq!(left_out_in_words(&[], 0.01), None);
        let few = [
            at(1, 662, 1),
            at(1, 856, 1),
            at(1, 2291, 1),
            at(1, 5724, 13),
        ];
        let words = "Left out: 16 samples, at 6.620 s, 8.560 s, 22.910 s, 57.240 to 57.360 s.";
        assert_eq!(left_out_in_words(&few, 0.01).as_deref(), Some(words));
        let many: Vec<TakenOut> = (0..130).map(|k| at(2, k, 1)).collect();
        let words = left_out_in_words(&many, 1.0).unwrap();
        assert!(
            words.starts_with("Left out: 130 samples, at 0.000 s of run 2,"),
            "{words}"
        );
        assert!(
            words.ends_with("99.000 s of run 2, and at 30 places more."),
            "{words}"
        );
    }

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
        let record = Record::of_run(0.01, &u, &y).unwrap();
        let found = identify_explained(&record, &Options::default()).unwrap();
        let sentences = found.explanation.sentences(&found.model);
        for (beginning, sentence) in [
            "Settling time:",
            "Frequencies:",
            "Noise:",
            "Slow end:",
            "Arithmetic:",
        ]
        .iter()
        .zip(&sentences)
        {
            assert!(sentence.starts_with(beginning), "{sentence}");
        }
    }
}
