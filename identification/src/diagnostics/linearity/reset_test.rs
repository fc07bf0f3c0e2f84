//! The regression on functions of the motion.

use std::ops::Range;

use faer::Mat;

use crate::data::{EXACTLY, Moments, Run, holds};
use crate::diagnostics::residuals::filtered_rows::{filtered, only, present, with_history};
use crate::diagnostics::residuals::further_columns::FurtherColumns;
use crate::diagnostics::residuals::residual_tests::ScoreTest;
use crate::diagnostics::residuals::simulation_error::Simulated;
use crate::estimation::{GlsFit, noise_filter};
use crate::numerics::{causal_filter, dot, times};

/// Functions of the simulated motion among the regressors.
pub(super) const FUNCTIONS: usize = 6;

/// A command is held where it stays for more than one part in so many of the settling time, as a rule.
const LEAST_HOLD: usize = 4;

/// Share of the largest value of the response over whose change the speed is taken: the larger of a part of .1, .3 and .5 the smaller is p of servos with
/// limited speed or drive, and no smaller is p of others.
const SPEED_OVER: f64 = 0.5;

/// Functions that each of several runs has for itself.
const OF_A_RUN: usize = 3;

/// The functions of the motion, run by run. Of all columns the functions that runs share are the first; those that
/// each run has for itself follow, run by run.
pub(super) struct ResetTest<'r> {
    pub(super) runs: Vec<RunColumns<'r>>,
    columns: usize,
}

/// One run in the regression, whatever speed is offered: everything is relative to the centre of the moments.
pub(super) struct RunRows<'r> {
    simulated: &'r Simulated<'r>,
    /// u, with its history before the run; 0 where it is missing.
    pub(super) input: Vec<f64>,
    /// D(z) u(k).
    filtered_input: Vec<f64>,
    /// Samples of history at the beginning of `input`.
    pub(super) history: usize,
    /// a(k), the answer to directions.
    directions: Vec<f64>,
    /// D(z) (y - ŷ)(k); 0 but in the rows of the regression.
    pub(super) errors: Vec<f64>,
    /// The rows of the regression.
    pub(super) rows: Vec<Range<usize>>,
}

/// One run with the functions that are offered.
pub(super) struct RunColumns<'r> {
    pub(super) of: &'r RunRows<'r>,
    /// The columns that are not 0 in this run.
    pub(super) columns: Vec<usize>,
    /// z_j(k) of these columns, 0 where the simulation is missing.
    pub(super) functions: Vec<Vec<f64>>,
    /// D(z) z_j(k); 0 but in the rows of the regression.
    filtered: Vec<Vec<f64>>,
}

/// Result of the regression.
pub(super) struct Found {
    /// By how much the functions that runs share reduce the sum of squares, beside all else.
    pub(super) reduction: f64,
    /// In how many directions.
    pub(super) degrees: usize,
    /// Directions in which runs differ from each other.
    pub(super) of_runs: usize,
    /// By how much these alone reduce the sum of squares.
    pub(super) reduction_of_runs: f64,
    /// Sum of squares that is left.
    pub(super) unexplained: f64,
    /// Coefficients of all columns whose combination is the part that the shared functions explain and the
    /// columns of the runs do not.
    pub(super) coefficients: Vec<f64>,
    /// The part of that combination that the fit's own parameters explain, the offset last.
    pub(super) response: Vec<f64>,
}

impl<'r> ResetTest<'r> {
    /// With the speed over so many samples on either side.
    pub(super) fn new(runs: &'r [RunRows<'r>], fit: &GlsFit, speed_over: usize) -> Option<Self> {
        let scale = Scale::of(runs, speed_over)?;
        let several = runs.len() > 1;
        let runs: Vec<RunColumns> = runs
            .iter()
            .enumerate()
            .map(|(index, run)| {
                let of_run = FUNCTIONS + OF_A_RUN * index;
                let own = several.then_some(of_run..of_run + OF_A_RUN);
                RunColumns::new(run, &scale, own, fit)
            })
            .collect();
        let columns = runs.iter().filter_map(|run| run.columns.last()).max()? + 1;
        Some(Self { runs, columns })
    }

    /// The regression on all columns beside the parameters of the fit, from cross moments alone.
    pub(super) fn regress(&self, fit: &GlsFit) -> Option<Found> {
        let cross = self.cross_moments(fit);
        let (own, score) = self.own_moments();
        let taken_over = &cross * &fit.solution.inverse;
        let left = &own - &taken_over * cross.transpose();
        let of = |columns: Range<usize>, score: &[f64]| {
            let (start, count) = (columns.start, columns.len());
            let block = |matrix: &Mat<f64>| {
                matrix
                    .as_ref()
                    .submatrix(start, start, count, count)
                    .to_owned()
            };
            ScoreTest::new(&block(&left), &block(&own), score)
        };
        let all = of(0..self.columns, &score)?;
        let mut coefficients = all.coefficients[..FUNCTIONS].to_vec();
        let mut found = Found {
            reduction: all.reduction,
            degrees: all.degrees,
            of_runs: 0,
            reduction_of_runs: 0.0,
            unexplained: fit.solution.rss - all.reduction,
            coefficients: Vec::new(),
            response: Vec::new(),
        };
        let of_runs = FUNCTIONS..self.columns;
        if !of_runs.is_empty()
            && let Some(runs) = of(of_runs.clone(), &score[of_runs.clone()])
        {
            found.reduction -= runs.reduction;
            found.degrees = found.degrees.checked_sub(runs.degrees).filter(|k| *k > 0)?;
            (found.of_runs, found.reduction_of_runs) = (runs.degrees, runs.reduction);
            // The part of the shared columns that those of the runs explain.
            let shared: Vec<f64> = of_runs
                .clone()
                .map(|i| (0..FUNCTIONS).map(|j| left[(i, j)] * coefficients[j]).sum())
                .collect();
            let taken = of(of_runs, &shared)?.coefficients;
            coefficients.extend(taken.iter().map(|taken| -taken));
        }
        found.response = times(&taken_over.transpose().to_owned(), &coefficients);
        found.coefficients = coefficients;
        Some(found)
    }

    /// Sum over the rows of D z_j(k) times the filtered regressors of the fit, the offset last: columns x
    /// (n+1).
    fn cross_moments(&self, fit: &GlsFit) -> Mat<f64> {
        let mut columns = FurtherColumns::new(fit, self.columns);
        for run in &self.runs {
            let functions: Vec<&[f64]> = run.filtered.iter().map(Vec::as_slice).collect();
            columns.add(&run.of.filtered_input, &run.columns, &functions);
        }
        columns.cross_moments().transpose().to_owned()
    }

    /// Sums over the rows of the products of the filtered columns with each other, and with the errors.
    fn own_moments(&self) -> (Mat<f64>, Vec<f64>) {
        let mut own = Mat::zeros(self.columns, self.columns);
        let mut score = vec![0.0; self.columns];
        for run in &self.runs {
            for (&i, z) in run.columns.iter().zip(&run.filtered) {
                score[i] += dot(z, &run.of.errors);
                for (&j, other) in run.columns.iter().zip(&run.filtered) {
                    own[(i, j)] += dot(z, other);
                }
            }
        }
        (own, score)
    }

    /// The square of the combination's product with the errors over the variance of that product, each error having its own. In many rows chance
    /// exceeds it no more often than χ² with [`Found::degrees`], which the best of all combinations has in noise of any evenness.
    pub(super) fn statistic_in_uneven_noise(&self, fit: &GlsFit, found: &Found) -> f64 {
        let combination = Combination::new(fit, found);
        let gain: f64 = noise_filter(&fit.ar).iter().sum();
        let (mut product, mut variance) = (0.0, 0.0);
        for run in &self.runs {
            let input = (run.of.filtered_input.as_slice(), gain);
            for (rows, beyond) in combination.beyond(run, &run.filtered, input) {
                for (beyond, error) in beyond.iter().zip(&run.of.errors[rows]) {
                    product += beyond * error;
                    variance += (beyond * (error - beyond)).powi(2);
                }
            }
        }
        if variance > 0.0 {
            product * product / variance
        } else {
            0.0
        }
    }

    /// The size of the combination found, less what the model explains of it, over the rows.
    pub(super) fn misfit(&self, fit: &GlsFit, found: &Found) -> MisfitSize {
        let combination = Combination::new(fit, found);
        let (mut square, mut fourth, mut count) = (0.0, 0.0, 0usize);
        for run in &self.runs {
            for (_, beyond) in combination.beyond(run, &run.functions, (&run.of.input, 1.0)) {
                square += dot(&beyond, &beyond);
                fourth += beyond.iter().map(|x| x.powi(4)).sum::<f64>();
                count += beyond.len();
            }
        }
        MisfitSize {
            rms: (square / count.max(1) as f64).sqrt(),
            local: if square > 0.0 {
                (fourth / square).sqrt()
            } else {
                0.0
            },
        }
    }
}

/// The combination of the functions that was found, and the model's answer that is part of it.
struct Combination<'f> {
    coefficients: &'f [f64],
    impulse: Vec<f64>,
    offset: f64,
}

impl<'f> Combination<'f> {
    fn new(fit: &GlsFit, found: &'f Found) -> Self {
        let (offset, coordinates) = found.response.split_last().unwrap_or((&0.0, &[]));
        Self {
            coefficients: &found.coefficients,
            impulse: fit.coordinates.impulse(coordinates),
            offset: *offset,
        }
    }

    /// The combination of the `functions` of a run, less the model's answer to `input` and an offset of the size `one`, in each stretch of
    /// the rows.
    fn beyond<'r>(
        &'r self,
        run: &'r RunColumns<'r>,
        functions: &'r [Vec<f64>],
        (input, one): (&[f64], f64),
    ) -> impl Iterator<Item = (Range<usize>, Vec<f64>)> + 'r {
        let answer = causal_filter(&self.impulse, input, None).split_off(run.of.history);
        let offset = self.offset * one;
        run.of.rows.iter().cloned().map(move |rows| {
            let answer = answer[rows.clone()].iter();
            let mut beyond: Vec<f64> = answer.map(|answer| -answer - offset).collect();
            for (z, &column) in functions.iter().zip(&run.columns) {
                let coefficient = self.coefficients.get(column).unwrap_or(&0.0);
                for (beyond, z) in beyond.iter_mut().zip(&z[rows.clone()]) {
                    *beyond += coefficient * z;
                }
            }
            (rows, beyond)
        })
    }
}

/// How large a misfit is \[output\].
pub(super) struct MisfitSize {
    /// Root mean square over all rows.
    pub(super) rms: f64,
    /// The same over the rows weighted by its own square: how large it is where it is.
    pub(super) local: f64,
}

/// Samples on either side over which a slower speed is taken: the fewest in which the response `step` changes by [`SPEED_OVER`] of its largest value
/// somewhere. From one row to the next a servo hardly moves where rows are close together, and the speed of the simulation is what the noise
/// has left in the response.
pub(super) fn slower_speed_over(step: &[f64]) -> usize {
    let largest = step.iter().fold(0.0f64, |most, g| most.max(g.abs()));
    let changes = |apart: &usize| {
        let pairs = step.iter().zip(step.iter().skip(2 * apart));
        pairs.fold(0.0f64, |most, (a, b)| most.max((b - a).abs())) >= SPEED_OVER * largest
    };
    (1..step.len() / 2).find(changes).unwrap_or(1)
}

/// How position and speed are taken, and what brings them to a size of one.
struct Scale {
    position: f64,
    speed: f64,
    /// Samples on either side over which the speed is taken.
    speed_over: usize,
}

impl Scale {
    /// `None` when nothing moves.
    fn of(runs: &[RunRows<'_>], speed_over: usize) -> Option<Self> {
        let (mut position, mut speed, mut count) = (0.0, 0.0, 0usize);
        for RunRows { simulated: run, .. } in runs {
            for (s, v) in run
                .output
                .iter()
                .zip(run.speed_over(speed_over))
                .filter(|(s, _)| !s.is_nan())
            {
                position += s * s;
                speed += v * v;
                count += 1;
            }
        }
        (position > 0.0 && speed > 0.0).then(|| Self {
            position: (position / count as f64).sqrt(),
            speed: (speed / count as f64).sqrt(),
            speed_over,
        })
    }
}

impl<'r> RunRows<'r> {
    /// Those of `runs`, which `fit` has simulated.
    pub(super) fn all(runs: &'r [Simulated<'r>], moments: &Moments, fit: &GlsFit) -> Vec<Self> {
        let of_run = |run| Self::new(run, moments, fit);
        runs.iter().map(of_run).collect()
    }

    fn new(simulated: &'r Simulated<'r>, moments: &Moments, fit: &GlsFit) -> Self {
        let d = noise_filter(&fit.ar);
        let history = fit.coordinates.basis.settling() + fit.ar.len();
        let run = &simulated.run;
        let input = with_history(run, history, moments.centre.0);
        let rows = run.complete_rows(moments.input_lags(), moments.output_lags());
        Self {
            simulated,
            filtered_input: filtered(&input, &d),
            input,
            history,
            directions: answer_to_directions(run, history, fit),
            errors: only(&rows, filtered(&simulated.errors, &d)),
            rows,
        }
    }
}

impl<'r> RunColumns<'r> {
    fn new(of: &'r RunRows<'r>, scale: &Scale, of_run: Option<Range<usize>>, fit: &GlsFit) -> Self {
        let motion = SimulatedMotion::new(of.simulated, scale);
        let mut functions = motion.bent();
        functions.push(of.directions.clone());
        let mut columns: Vec<usize> = (0..FUNCTIONS).collect();
        if let Some(of_run) = of_run {
            functions.extend(motion.of_a_run());
            columns.extend(of_run);
        }
        let d = noise_filter(&fit.ar);
        let in_rows = |values: &Vec<f64>| only(&of.rows, filtered(values, &d));
        Self {
            of,
            filtered: functions.iter().map(in_rows).collect(),
            columns,
            functions,
        }
    }
}

/// What the servo of `fit` answers to the direction of the last change of the command. Friction pushes like a command against the
/// direction of the motion, from its first sample to its last, and holds the servo off its target at rest. 0 for a command that is
/// not held: a square wave beside a sine would stand for what a short bank leaves of the sine.
fn answer_to_directions(run: &Run, history: usize, fit: &GlsFit) -> Vec<f64> {
    let holds = holds(run, EXACTLY);
    let enough = fit.coordinates.basis.settling() / LEAST_HOLD;
    let long = holds.iter().filter(|hold| hold.samples.len() > enough);
    if 2 * long.count() < holds.len() {
        return vec![0.0; run.len()];
    }
    let mut directions = vec![0.0; history + run.len()];
    let mut last = 0.0;
    for hold in holds {
        last = (hold.before).map_or(last, |before| (hold.level - before).signum());
        directions[history..][hold.samples].fill(last);
    }
    causal_filter(&fit.impulse(), &directions, None).split_off(history)
}

/// Position s and speed v of a simulated run, of a size of one.
struct SimulatedMotion(Vec<(f64, f64)>);

impl SimulatedMotion {
    fn new(simulated: &Simulated<'_>, scale: &Scale) -> Self {
        let speed = simulated.speed_over(scale.speed_over);
        let scaled = |(s, v): (&f64, f64)| (s / scale.position, v / scale.speed);
        Self(simulated.output.iter().zip(speed).map(scaled).collect())
    }

    /// s², s³, v |v|, |v|, s |v|.
    fn bent(&self) -> Vec<Vec<f64>> {
        vec![
            self.each(|s, _| s * s),
            self.each(|s, _| s * s * s),
            self.each(|_, v| v * v.abs()),
            self.each(|_, v| v.abs()),
            self.each(|s, v| s * v.abs()),
        ]
    }

    /// s, v, 1: by a gain, a delay and an offset of its own.
    fn of_a_run(&self) -> [Vec<f64>; OF_A_RUN] {
        [
            self.each(|s, _| s),
            self.each(|_, v| v),
            self.each(|_, _| 1.0),
        ]
    }

    /// 0 where the simulation is missing.
    fn each(&self, function: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let each = |(s, v): &(f64, f64)| present(function(*s, *v));
        self.0.iter().map(each).collect()
    }
}
