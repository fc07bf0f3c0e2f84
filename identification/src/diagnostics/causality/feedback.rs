//! Whether the input was computed from the output, as in a closed loop.
//!
//! Regression of the output on the input takes for granted that the noise does not act on the input. A controller that
//! commands u from y carries the noise into u, and the estimate becomes a mixture of the servo and the inverse of the
//! controller. Two things show it:
//!
//! - **Inputs to come.** The noise of today is in the commands of tomorrow. So the next inputs, those at k+1 to k+L, are
//!   offered to the regression of y(k) beside all its parameters; the reduction of the sum of squares over σ² has the χ²
//!   distribution of a score test where the input is independent of the noise (P. E. Caines and C. W. Chan, *Feedback between
//!   stationary stochastic processes*, IEEE Trans. AC 20, 1975).
//! - **A response at lag 0 against the rest.** Feedback within one sample lets the output appear to answer at once, with the
//!   sign of the inverse of the controller, which is opposite to the motion of the servo where the loop is stable. Where nothing
//!   but the controller moves the input, all of the response is at lag 0.
//!
//! A smooth input does not separate lags: the errors of a servo that is not linear gather at lag 0 as anywhere, and what comes next in
//! the input follows from what was, whether it is smooth from row to row or from one pulse frame to the next. So neither shows a loop there; both show that the input does not determine the response. An input
//! of straight pieces is none of a controller: it would carry the bends of the motion into them. Inputs to come that explain the output
//! show there, too, that the response is not determined.
//!
//! Where the errors are no noise, [what makes the input](crate::diagnostics::causality::input_origin) is asked, too.

use faer::Mat;
use serde::{Deserialize, Serialize};

use super::input_origin::is_of_straight_pieces;
use crate::data::{Moments, Record, Run, usual_exact_hold};
use crate::diagnostics::residuals::filtered_rows::{filtered, only, present, with_history};
use crate::diagnostics::residuals::residual_tests::ScoreTest;
use crate::diagnostics::residuals::simulation_error::Simulated;
use crate::estimation::{Excitation, GlsFit, noise_filter};
use crate::numerics::{LaggedSums, chi_square_upper_tail, dot};
use crate::thresholds::{
    AGAINST_MOTION, ALL_AT_ONCE, EVIDENT_SHARE, FEEDBACK_SIGNIFICANCE, INPUT_EXPLAINED,
};

/// Inputs to come that are offered: a frame of servo pulses at the rig's rate.
const LEADS: usize = 10;

/// That the input follows the output.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Feedback {
    /// Probability of inputs to come that explain as much, if none was computed from the output; of runs that differ, in their own
    /// fits too.
    pub p: f64,
    /// Response at lag 0, in standard deviations; negative against the direction of the rest of the response.
    pub at_once: f64,
    /// Its size, as a share of the largest value of the step response.
    pub share: f64,
    /// Whether the input is smooth: then neither shows a loop.
    #[serde(default)]
    pub smooth: bool,
    /// Whether the input is made of straight pieces, as only a planned one is.
    #[serde(default)]
    pub planned: bool,
    /// Share of what is new in the input that past outputs explain, where the errors are not noise; `None` elsewhere, and
    /// where nothing is new.
    #[serde(default)]
    pub explained: Option<f64>,
}

impl Feedback {
    /// Whether it is beyond chance, where the errors are noise.
    #[must_use]
    pub fn is_found(&self) -> bool {
        (self.is_beyond_chance() || self.is_all_at_once()) && !self.smooth && !self.planned
    }

    /// Whether what would show a loop under another input shows that this one does not determine the response.
    pub(crate) fn mixes_lags(&self) -> bool {
        self.smooth && self.is_beyond_chance() || self.planned && self.is_followed()
    }

    fn is_beyond_chance(&self) -> bool {
        self.is_followed() || self.is_against_motion()
    }

    /// Whether nothing follows the response at lag 0.
    pub(crate) fn is_all_at_once(&self) -> bool {
        self.share > ALL_AT_ONCE
    }

    /// Whether inputs to come explain the output.
    pub(crate) fn is_followed(&self) -> bool {
        self.p < FEEDBACK_SIGNIFICANCE
    }

    /// Whether it is evident whatever the errors are.
    #[must_use]
    pub fn is_evident(&self) -> bool {
        let against_motion = self.is_against_motion() && self.share > EVIDENT_SHARE;
        against_motion && !self.smooth && !self.planned || self.is_explained()
    }

    /// Whether the outputs evidently make the input.
    pub(crate) fn is_explained(&self) -> bool {
        self.explained.is_some_and(|share| share > INPUT_EXPLAINED)
    }

    fn is_against_motion(&self) -> bool {
        self.at_once < -AGAINST_MOTION
    }
}

/// Tests the errors of `fit` in `runs`, which are those of `record`. `at_once` is the response at lag 0 in standard deviations and its share, where it is known.
pub(crate) fn feedback(
    record: &Record,
    runs: &[Simulated<'_>],
    moments: &Moments,
    fit: &GlsFit,
    (at_once, share): (f64, f64),
) -> Feedback {
    Feedback {
        p: inputs_to_come(runs, moments, fit).unwrap_or(1.0),
        at_once,
        share,
        smooth: Excitation::of(moments).is_smooth() || frames_are_smooth(record, fit),
        planned: is_of_straight_pieces(record),
        explained: None,
    }
}

/// Frames in the settling time, at least, of a command that is held for frames: stairs are held for longer, and are smooth from level to level, too.
const FRAMES: usize = 4;

/// Lags of the levels of a command in frames that show whether it is smooth.
const LEVELS: usize = 100;

/// Whether the command is held for frames and smooth from one to the next.
fn frames_are_smooth(record: &Record, fit: &GlsFit) -> bool {
    let hold = usual_exact_hold(record);
    if hold < 2 || FRAMES * hold > fit.coordinates.basis.settling() {
        return false;
    }
    let levels = |run: &Run<'_>| {
        let input = run.input();
        let first = input.windows(2).position(|pair| pair[0] != pair[1])?;
        let levels: Vec<f64> = input[first..].iter().copied().step_by(hold).collect();
        Run::new(levels.clone(), levels).ok()
    };
    let runs = record.runs().iter().filter_map(levels).collect();
    let levels = Record::new(hold as f64 * record.sample_period_s(), runs);
    levels.is_ok_and(|levels| Excitation::of(&Moments::of_record(&levels, LEVELS, 1)).is_smooth())
}

fn inputs_to_come(runs: &[Simulated<'_>], moments: &Moments, fit: &GlsFit) -> Option<f64> {
    let lags = fit.coordinates.basis.settling();
    let d = noise_filter(&fit.ar);
    let gain: f64 = d.iter().sum();
    // The leads, and behind them the errors.
    let mut sums = LaggedSums::new(lags, LEADS + 1);
    let mut own = Mat::<f64>::zeros(LEADS, LEADS);
    let (mut with_offset, mut score) = ([0.0; LEADS + 1], [0.0; LEADS]);
    for run in runs {
        let history = lags + fit.ar.len();
        let input = with_history(&run.run, history, moments.centre.0);
        let rows = run
            .run
            .complete_rows(moments.input_lags(), moments.output_lags());
        // Beyond the end of a run the input is taken to stay at the centre: a function of the input like any other.
        let lead = |lead: usize| {
            let mut ahead = input[(history + lead).min(input.len())..].to_vec();
            ahead.resize(input.len() - history, 0.0);
            only(&rows, filtered(&ahead, &d))
        };
        let leads: Vec<Vec<f64>> = (1..=LEADS).map(lead).collect();
        let errors: Vec<f64> = run.own_errors().iter().copied().map(present).collect();
        let errors = only(&rows, filtered(&errors, &d));
        for i in 0..LEADS {
            score[i] += dot(&leads[i], &errors);
            with_offset[i] += gain * leads[i].iter().sum::<f64>();
            for j in 0..=i {
                let product = dot(&leads[i], &leads[j]);
                own[(i, j)] += product;
                if i != j {
                    own[(j, i)] += product;
                }
            }
        }
        with_offset[LEADS] += gain * errors.iter().sum::<f64>();
        let columns = leads.iter().chain([&errors]).map(Vec::as_slice);
        let columns: Vec<&[f64]> = columns.collect();
        sums.add(&filtered(&input, &d)[history + 1 - lags..], &columns);
    }
    let sums = sums.sums();
    let by_coordinate = fit
        .coordinates
        .compress(Mat::from_fn(lags, LEADS + 1, |a, j| sums[j][a]));
    let p = fit.coordinates.len();
    let with_regressors = Mat::from_fn(LEADS + 1, p + 1, |j, i| match i < p {
        true => by_coordinate[(i, j)],
        false => with_offset[j],
    });
    let cross = with_regressors.as_ref().subrows(0, LEADS);
    let weighted = cross * &fit.solution.inverse;
    let left = &own - &weighted * cross.transpose();
    // What gains, delays and offsets of runs leave of the errors is not all beside the regressors: those are of the rows beside missing samples, too.
    let of_errors = &weighted * with_regressors.row(LEADS).transpose();
    for (score, of_regressors) in score.iter_mut().zip(of_errors.iter()) {
        *score -= of_regressors;
    }
    let found = ScoreTest::new(&left, &own, &score)?;
    Some(chi_square_upper_tail(
        found.reduction / fit.variance,
        found.degrees,
    ))
}
