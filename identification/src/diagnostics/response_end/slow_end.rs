//! Whether the response goes on beyond N as a slow end, and what the bounds allow for it.
//!
//! A slow end of a few percent of the response is below the noise in every single lag beyond N, and in slow noise in all of them
//! together. A test finds it in half of the recordings, and bounds that rest on the test miss it in the others. So the input
//! behind a slow lag of first order, with a time constant of N, is always looked at beside all parameters of the regression,
//!
//! ```text
//! D(z) y(k) = D(z) (sum_i h(i) u(k-i) + c + γ w(k)) + ε(k),     w(k) = ρ w(k-1) + (1 - ρ) u(k)
//! ```
//!
//! The lags up to N take their share of w, and what is left is its end.
//! With x = (Z'Z)^-1 Z'w and q = w'w - w'Z x, all behind the filter, γ is the score w'ε over q with the variance σ²/q, and with w in
//! the regression the other parameters change by -γ x (Frisch and Waugh, 1933). The part γ of the response is added to the impulse
//! response, what is left of it after N to its last sample, as always: together a direction δ, by which the response is off if γ is
//! left out.
//!
//! It is left out of the response, which without it is the better one where there is no slow end, and is in the bounds: the covariance
//! grows by δ δ' (γ² + σ²/q), the mean square of an end of which nothing was known before the record. What a record says of ends of different
//! time constants is nearly one number, γ √(q/σ²), so it does not say which of them it is: time constants of 2 N and 4 N are looked at too,
//! and the one counts that moves the response most. The final value gathers
//! all that comes after N, and slower ends have more of that: there the one counts that changes it most. The test counts the square of that number
//! for N as χ² of one degree of freedom.
//!
//! The steps of a sensor that noise does not dither are errors that follow the level. Errors of up to r in each of n rows change γ by up to
//! |D(1)| r √(n/q) (Cauchy and Schwarz): what exceeds that is counted.
//!
//! An input that repeats itself shows an end by its lags from N to where it repeats itself alone. Where these are few, σ²/q is large, and
//! where there are none, nothing is known of an end. The slower an end is, the less of it is left in such lags: there time constants of 8 N count, too.

use serde::{Deserialize, Serialize};

use crate::data::repetition;
use crate::data::{Moments, Run};
use crate::diagnostics::residuals::filtered_rows::{filtered, only, present, with_history};
use crate::diagnostics::residuals::simulation_error::Simulated;
use crate::estimation::{GlsFit, noise_filter};
use crate::numerics::{LaggedSums, chi_square_upper_tail, dot, times};
use crate::results::Bounds;
use crate::thresholds::UNSEEN_END;

use faer::Mat;

/// Time constants of the ends that bounds allow for, in settling times. With half of the first alone the whole curve is inside its band in
/// too few of the runs with a slow end in slow noise. Without the last, ends of eight settling times move the final value out of its bound
/// in a third of the runs.
const TIME_CONSTANTS: [f64; 3] = [1.0, 2.0, 4.0];

/// The same under an input that repeats itself. Without the last, ends of eight settling times take the curve out of its band in an eighth of the
/// runs. Under other inputs it would double the interval of the gain.
const TIME_CONSTANTS_OF_REPEATED: [f64; 4] = [1.0, 2.0, 4.0, 8.0];

/// An input that repeats itself is looked for up to this number of settling times, eight of the longest time constants: the slowest lag
/// has forgotten longer periods. A lag that has not would be at a place where nothing says that it was when the record began, and its way from
/// there would pass for knowledge of it.
pub(super) const PERIODS_LOOKED_FOR: usize = 64;

/// Whether the response goes on beyond N.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SlowEnd {
    /// Probability of an end at least as visible if there is none.
    pub p: f64,
    /// N that it was looked for beyond \[samples\].
    pub beyond: usize,
}

/// The slow end that bounds allow for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AllowedEnd {
    /// Part of the gain that has a time constant of N, as estimated \[output per input\].
    pub value: f64,
    /// Its standard deviation; `None` where bounds are withdrawn.
    pub sd: Option<f64>,
}

impl AllowedEnd {
    pub(crate) fn new(found: EstimatedEnd, level: Bounds<f64>) -> Self {
        Self {
            value: found.value,
            sd: level.valid().map(|_| found.sd),
        }
    }

    /// As one sentence, beside the gain.
    pub(crate) fn in_words(&self, gain: f64) -> String {
        let percent = 100.0 * self.value / gain;
        let time = "with the settling time as its time constant";
        match self.sd {
            Some(sd) => format!(
                "Slow end: {percent:.2} % of the gain, standard deviation {:.2} %, {time}; the bounds contain it.",
                100.0 * sd / gain.abs()
            ),
            None => format!("Slow end: {percent:.2} % of the gain, {time}."),
        }
    }
}

/// γ with its standard deviation \[output per input\], before it is decided whether bounds hold.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EstimatedEnd {
    pub(crate) value: f64,
    pub(crate) sd: f64,
}

/// Whether the input shows nothing of an end, or repeats itself and shows so little that the response may end anywhere after N, beside
/// this gain.
pub(crate) fn is_unseen(columns: Option<&SlowColumns>, gain: f64) -> bool {
    columns.is_none_or(|found| found.repeats && found.end().sd > UNSEEN_END * gain.abs())
}

/// The input behind slow lags, each as a further column of a regression.
pub(crate) struct SlowColumns {
    /// N \[samples\].
    lags: usize,
    /// One of each time constant.
    columns: Vec<SlowColumn>,
    /// Variance of ε.
    variance: f64,
    /// Length of the largest vector of errors that the steps of the sensor leave behind the filter \[output\].
    of_rounding: f64,
    /// Whether the input of a run repeats itself.
    repeats: bool,
}

struct SlowColumn {
    /// \[samples\]
    time_constant: f64,
    /// (Z'Z)^-1 Z'w, the offset last.
    shared: Vec<f64>,
    /// What the other columns leave of w'w.
    left: f64,
    /// w'ε, of errors but for what runs differ by.
    score: f64,
}

/// Products of a column with itself, the offset's column and the errors.
#[derive(Default)]
struct Products {
    own: f64,
    with_offset: f64,
    score: f64,
}

/// The regression that slow columns stand beside.
pub(crate) struct Regression<'a> {
    /// N \[samples\].
    pub(crate) lags: usize,
    /// Lags of the input and the output that a row has.
    pub(crate) row_lags: (usize, usize),
    /// What the input is relative to.
    pub(crate) centre: f64,
    pub(crate) ar: &'a [f64],
    /// Variance of ε.
    pub(crate) variance: f64,
    /// The largest error of a level that the steps of the sensor leave \[output\].
    pub(crate) level_error: f64,
    /// (Z'Z)^-1, the offset last.
    pub(crate) inverse: &'a Mat<f64>,
}

/// One run of it.
pub(crate) struct RegressionRun<'a> {
    pub(crate) run: &'a Run<'a>,
    /// The inputs whose lags are columns, each with N and the order of D samples before the first.
    pub(crate) inputs: Vec<Vec<f64>>,
    /// y - ŷ; 0 where it is missing.
    pub(crate) errors: Vec<f64>,
}

impl SlowColumns {
    /// Beside the complete bank of `fit`, from its errors in `runs`; `None` where the input does not show slow ends.
    ///
    /// `level_error` is the largest error of a level that the steps of the sensor leave \[output\].
    pub(crate) fn new(
        runs: &[Simulated<'_>],
        moments: &Moments,
        fit: &GlsFit,
        level_error: f64,
    ) -> Option<Self> {
        let lags = fit.coordinates.basis.settling();
        let regression = Regression {
            lags,
            row_lags: (moments.input_lags(), moments.output_lags()),
            centre: moments.centre.0,
            ar: &fit.ar,
            variance: fit.variance,
            level_error,
            inverse: &fit.solution.inverse,
        };
        let runs = runs.iter().map(|run| RegressionRun {
            run: &run.run,
            inputs: vec![with_history(
                &run.run,
                lags + fit.ar.len(),
                moments.centre.0,
            )],
            // What runs differ by is no end of their common response.
            errors: run.own_errors().iter().copied().map(present).collect(),
        });
        Self::beside(&regression, runs, |by_input| {
            let by_lag = Mat::from_fn(lags, 1, |a, _| by_input[0][a]);
            fit.coordinates.compress(by_lag).col_as_slice(0).to_vec()
        })
    }

    /// Beside any regression; `columns` makes products with its columns, but for the offset's, of those with the lags of each input.
    pub(crate) fn beside<'a>(
        regression: &Regression<'_>,
        runs: impl Iterator<Item = RegressionRun<'a>>,
        columns: impl Fn(&[Vec<f64>]) -> Vec<f64>,
    ) -> Option<Self> {
        let (lags, centre) = (regression.lags, regression.centre);
        let d = noise_filter(regression.ar);
        let gain: f64 = d.iter().sum();
        let runs: Vec<_> = runs
            .map(|run| (repetition::of(run.run, PERIODS_LOOKED_FOR * lags), run))
            .collect();
        let repeats = runs.iter().any(|(period, _)| period.is_some());
        let times: &[f64] = match repeats {
            true => &TIME_CONSTANTS_OF_REPEATED,
            false => &TIME_CONSTANTS,
        };
        let time_constants: Vec<f64> = times.iter().map(|times| times * lags as f64).collect();
        let mut sums: Vec<LaggedSums> = Vec::new();
        let mut all: Vec<Products> = times.iter().map(|_| Products::default()).collect();
        let mut count = 0;
        for (period, regression_run) in &runs {
            let RegressionRun {
                run,
                inputs,
                errors,
            } = regression_run;
            let rows = run.complete_rows(regression.row_lags.0, regression.row_lags.1);
            count += rows.iter().map(std::ops::Range::len).sum::<usize>();
            let errors = filtered(errors, &d);
            let slow = time_constants.iter().map(|time_constant| {
                let behind = behind_lag(run, *time_constant, centre, *period);
                only(&rows, filtered(&behind, &d))
            });
            let slow: Vec<Vec<f64>> = slow.collect();
            for (products, slow) in all.iter_mut().zip(&slow) {
                products.own += dot(slow, slow);
                products.with_offset += gain * slow.iter().sum::<f64>();
                products.score += dot(slow, &errors);
            }
            let history = lags + regression.ar.len();
            sums.resize_with(inputs.len(), || LaggedSums::new(lags, time_constants.len()));
            let slow: Vec<&[f64]> = slow.iter().map(Vec::as_slice).collect();
            for (sums, input) in sums.iter_mut().zip(inputs) {
                sums.add(&filtered(input, &d)[history + 1 - lags..], &slow);
            }
        }
        let by_input: Vec<Vec<Vec<f64>>> = sums.iter().map(LaggedSums::sums).collect();
        let found = (0..).zip(time_constants.into_iter().zip(all)).map(
            |(which, (time_constant, products))| {
                let by_input: Vec<Vec<f64>> = by_input
                    .iter()
                    .map(|sums: &Vec<Vec<f64>>| sums[which].clone())
                    .collect();
                let cross = columns(&by_input);
                SlowColumn::new(time_constant, &products, cross, regression.inverse)
            },
        );
        Some(Self {
            lags,
            columns: found.collect::<Option<_>>()?,
            variance: regression.variance,
            of_rounding: gain.abs() * regression.level_error * (count as f64).sqrt(),
            repeats,
        })
    }

    /// The test of an end.
    pub(crate) fn test(&self) -> SlowEnd {
        let end = self.end();
        SlowEnd {
            p: chi_square_upper_tail((end.value / end.sd).powi(2), 1),
            beyond: self.lags,
        }
    }

    /// The end \[output per input\].
    pub(crate) fn end(&self) -> EstimatedEnd {
        self.end_of(&self.columns[0], self.variance)
    }

    /// γ beyond what the steps of the sensor explain, where ε has this variance.
    fn end_of(&self, column: &SlowColumn, variance: f64) -> EstimatedEnd {
        let explained = self.of_rounding / column.left.sqrt();
        let value = column.score / column.left;
        EstimatedEnd {
            value: (value.abs() - explained).max(0.0).copysign(value),
            sd: (variance / column.left).sqrt(),
        }
    }

    /// The covariance of `fit`, which is `ratio` times that of its rows for outliers, becomes that with a slow end.
    pub(crate) fn allow_in(&self, fit: &mut GlsFit, ratio: f64) -> EstimatedEnd {
        fit.further.slow_end = Some(self.allowance(ratio));
        self.end_of(&self.columns[0], ratio * self.variance)
    }

    /// How the step response of the lags up to N changes where one of the ends stands beside them in the regression, of each of them, and the standard deviation
    /// of that.
    pub(crate) fn changes_of_step(&self) -> impl Iterator<Item = (Vec<f64>, Vec<f64>)> {
        self.columns.iter().map(|column| {
            let end = self.end_of(column, self.variance);
            let mut sum = 0.0;
            let shared = column.shared[..self.lags].iter().map(|x| {
                sum += x;
                sum
            });
            shared.map(|off| (-end.value * off, end.sd * off)).unzip()
        })
    }

    /// By how much the parameters are allowed to be off for a slow end, in standard deviations of ε, the offset last. The covariance
    /// is `ratio` times that of the rows for outliers.
    pub(crate) fn allowance(&self, ratio: f64) -> Vec<f64> {
        self.moved(|column| {
            let end = self.end_of(column, ratio * self.variance);
            end.value.hypot(end.sd)
        })
    }

    /// The same for a record that has not been made: where the response is over, γ² is σ²/q on average.
    pub(crate) fn expect_in(&self, fit: &mut GlsFit) {
        let size = |column: &SlowColumn| (2.0 * self.variance / column.left).sqrt();
        fit.further.slow_end = Some(self.moved(size));
    }

    /// δ times the size of an end, in standard deviations of ε, the offset last: of the column that moves the response up to N most, with the
    /// change of the final value by the column that changes that most.
    fn moved(&self, size: impl Fn(&SlowColumn) -> f64) -> Vec<f64> {
        let sd = self.variance.sqrt();
        let all: Vec<Vec<f64>> = (self.columns.iter())
            .map(|column| {
                let direction = column.direction(self.lags);
                direction.iter().map(|x| size(column) / sd * x).collect()
            })
            .collect();
        let last = self.lags - 1;
        let before_last = |moved: &Vec<f64>| largest_sum(&moved[..last]);
        let total = |moved: &Vec<f64>| moved[..=last].iter().sum::<f64>();
        let largest = all.iter().map(|moved| total(moved).abs());
        let largest = largest.fold(0.0, f64::max);
        let by_motion = |a: &Vec<f64>, b: &Vec<f64>| before_last(a).total_cmp(&before_last(b));
        let mut moved = all.into_iter().max_by(by_motion).unwrap_or_default();
        let own = total(&moved);
        moved[last] += largest.copysign(own) - own;
        moved
    }
}

/// The largest of the running sums, without its sign.
fn largest_sum(values: &[f64]) -> f64 {
    let mut sum = 0.0;
    let sums = values.iter().map(|x| {
        sum += x;
        f64::abs(sum)
    });
    sums.fold(0.0, f64::max)
}

impl SlowColumn {
    /// `None` where it is not new beside the lags.
    fn new(
        time_constant: f64,
        products: &Products,
        mut cross: Vec<f64>,
        inverse: &Mat<f64>,
    ) -> Option<Self> {
        cross.push(products.with_offset);
        let shared = times(inverse, &cross);
        let left = products.own - dot(&cross, &shared);
        // A millionth of new information is rounding.
        (left > 1e-6 * products.own).then_some(Self {
            time_constant,
            shared,
            left,
            score: products.score,
        })
    }

    /// δ, the offset last.
    fn direction(&self, lags: usize) -> Vec<f64> {
        let keep = rate(self.time_constant);
        let mut direction = self.shared.clone();
        let mut rest = 1.0;
        for x in &mut direction[..lags - 1] {
            *x -= rest * (1.0 - keep);
            rest *= keep;
        }
        direction[lags - 1] -= rest;
        direction
    }
}

/// The input of `run` relative to `centre`, behind a lag of first order that was at rest before. A missing value is the one before.
///
/// An input with a `period` is one that had repeated itself before: whether the servo was at rest when the record began is not known then, and how
/// it would come from there is all that such an input shows of a lag that outlasts the period.
pub(super) fn behind_lag(
    run: &Run,
    time_constant: f64,
    centre: f64,
    period: Option<usize>,
) -> Vec<f64> {
    let keep = rate(time_constant);
    let input = run.input();
    let first = input.iter().find(|u| !u.is_nan()).copied();
    let at_rest = run.input_at_rest().or(first).map_or(0.0, |u| u - centre);
    let behind = |input: &[f64], before: f64| -> Vec<f64> {
        let (mut state, mut last) = (before, at_rest);
        let next = |u: &f64| {
            if !u.is_nan() {
                last = u - centre;
            }
            state = keep * state + (1.0 - keep) * last;
            state
        };
        input.iter().map(next).collect()
    };
    let Some(period) = period else {
        return behind(input, at_rest);
    };
    let once = behind(&input[..period], 0.0);
    let left = keep.powi(i32::try_from(period).unwrap_or(i32::MAX));
    behind(input, once[period - 1] / (1.0 - left))
}

/// What is left of a lag after one sample.
pub(super) fn rate(time_constant: f64) -> f64 {
    (-time_constant.recip()).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten settling times are shorter than what the slowest lag remembers: a record that begins in the middle of such a motion shows the same of
    /// it in every period, and no way there.
    #[test]
    fn an_input_of_long_periods_shows_no_way_to_its_steady_state() {
        const N: usize = 97;
        const HOLD: usize = 500;
        let level = |k: usize| {
            if (k / HOLD).is_multiple_of(2) {
                5.0
            } else {
                -5.0
            }
        };
        let input: Vec<f64> = (0..4200).map(level).collect();
        let run = Run::new(input.clone(), input).unwrap();
        let period = repetition::of(&run, PERIODS_LOOKED_FOR * N);
        assert_eq!(period, Some(2 * HOLD));
        for times in TIME_CONSTANTS_OF_REPEATED {
            let behind = behind_lag(&run, times * N as f64, 0.0, period);
            for (now, later) in behind.iter().zip(&behind[2 * HOLD..]) {
                assert!((now - later).abs() < 1e-9, "{now} and {later}");
            }
        }
    }
}
