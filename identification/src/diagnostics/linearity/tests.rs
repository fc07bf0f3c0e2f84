//! The fast regression against the explicit one.

use super::*;
use crate::data::{Moments, Record, Run};
use crate::diagnostics::linearity::reset_test::FUNCTIONS;
use crate::diagnostics::residuals::simulation_error::simulated;
use crate::estimation::{Coordinates, FsfBasis, GlsFit, GlsOptions, noise_filter};
use crate::numerics::{dot, times};
use crate::options::NoiseOrder;
use approx::assert_relative_eq;
use faer::Mat;
use faer::linalg::solvers::SolveLstsqCore;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const SETTLING: usize = 11;

/// A run of a first-order servo whose output is bent by `bend` s², under noise of first order.
fn run(seed: u64, samples: usize, bend: f64) -> Run<'static> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    // Levels from 3 to 5, held long enough for the servo to come near them.
    let level = |k: usize| 3.0 + ((k / 8).pow(2) * 7919 % 101) as f64 / 50.0;
    let input: Vec<f64> = (0..samples).map(level).collect();
    let (mut s, mut v) = (input[0], 0.0);
    let output: Vec<f64> = input
        .iter()
        .map(|u| {
            s += 0.5 * (u - s);
            v = 0.6 * v + 0.05 * normal();
            s + bend * s * s + v
        })
        .collect();
    Run::new(input, output).unwrap()
}

/// One run from rest, one with a sample missing.
fn record(bend: f64) -> Record<'static> {
    let first = run(1, 150, bend);
    let rest = first.input()[0];
    let second = run(2, 130, bend);
    let mut holed = second.output().to_vec();
    holed[60] = f64::NAN;
    let second = second.with_output(holed);
    Record::new(0.01, vec![first.with_input_at_rest(rest), second]).unwrap()
}

fn fitted(record: &Record, frequencies: usize) -> (RowInformation, GlsFit) {
    let options = GlsOptions {
        order: NoiseOrder::Order(1),
        ..GlsOptions::default()
    };
    let information = RowInformation::from_moments(Moments::of_record(record, SETTLING + 1, 2));
    let coordinates = Coordinates::new(FsfBasis::new(SETTLING, frequencies).unwrap());
    let fit = GlsFit::of(&information, &coordinates, &options).unwrap();
    (information, fit)
}

/// sum_i d_i x(k-i).
fn filtered_at(values: &[f64], d: &[f64], k: usize) -> f64 {
    d.iter().enumerate().map(|(i, di)| di * values[k - i]).sum()
}

/// The regression with every row and column written out.
struct Explicit {
    /// The regressors of the fit, the offset last.
    fit: Mat<f64>,
    /// All columns offered.
    offered: Mat<f64>,
    errors: Vec<f64>,
}

impl Explicit {
    fn new(offered: &ResetTest<'_>, fit: &GlsFit) -> Self {
        let d = noise_filter(&fit.ar);
        let columns = offered.runs.iter().flat_map(|run| &run.columns);
        let columns = columns.max().unwrap() + 1;
        let mut rows: Vec<(Vec<f64>, Vec<f64>, f64)> = Vec::new();
        for run in &offered.runs {
            for k in run.of.rows.iter().cloned().flatten() {
                let lagged = |m: usize| filtered_at(&run.of.input, &d, run.of.history + k - m);
                let lags: Vec<f64> = (0..SETTLING).map(lagged).collect();
                let mut row: Vec<f64> = match fit.coordinates.impulse_map() {
                    Some(map) => times(&map.transpose().to_owned(), &lags),
                    None => lags,
                };
                row.push(d.iter().sum());
                let mut offered = vec![0.0; columns];
                for (z, &column) in run.functions.iter().zip(&run.columns) {
                    offered[column] = filtered_at(z, &d, k);
                }
                rows.push((row, offered, run.of.errors[k]));
            }
        }
        let p = fit.coordinates.len();
        Self {
            fit: Mat::from_fn(rows.len(), p + 1, |i, j| rows[i].0[j]),
            offered: Mat::from_fn(rows.len(), columns, |i, j| rows[i].1[j]),
            errors: rows.into_iter().map(|row| row.2).collect(),
        }
    }

    /// What the fit's regressors and these `columns` leave of `values`, and the coefficients of both.
    fn left(&self, values: &[f64], columns: &[usize]) -> (Vec<f64>, Vec<f64>) {
        let p = self.fit.ncols();
        let matrix = Mat::from_fn(values.len(), p + columns.len(), |i, j| match j {
            j if j < p => self.fit[(i, j)],
            j => self.offered[(i, columns[j - p])],
        });
        let mut solution = Mat::from_fn(values.len(), 1, |i, _| values[i]);
        matrix
            .qr()
            .solve_lstsq_in_place_with_conj(faer::Conj::No, solution.as_mut());
        let solution = solution.col_as_slice(0)[..matrix.ncols()].to_vec();
        let fitted = times(&matrix, &solution);
        let left = values.iter().zip(fitted).map(|(e, f)| e - f).collect();
        (left, solution)
    }
}

fn square(values: &[f64]) -> f64 {
    dot(values, values)
}

#[test]
fn moments_by_transforms_give_what_the_explicit_regression_gives() {
    let both = record(0.02);
    let first = Record::new(0.01, vec![both.runs()[0].clone()]).unwrap();
    let shared: Vec<usize> = (0..FUNCTIONS).collect();
    // The motion of all runs together and the offset are regressors of the fit already, so the last run
    // has but its delay to itself.
    let of_both = [0, 1, 2, 4].map(|own| FUNCTIONS + own).to_vec();
    for (record, of_runs) in [(first, vec![]), (both, of_both)] {
        for frequencies in [SETTLING, 5] {
            let (information, fit) = fitted(&record, frequencies);
            let runs = simulated(&record, &information.moments, &fit);
            let rows = RunRows::all(&runs, &information.moments, &fit);
            let offered = ResetTest::new(&rows, &fit, 2).unwrap();
            let found = offered.regress(&fit).unwrap();
            assert_eq!((found.degrees, found.of_runs), (FUNCTIONS, of_runs.len()));
            let explicit = Explicit::new(&offered, &fit);
            let all: Vec<usize> = [shared.clone(), of_runs.clone()].concat();
            let (fitted, _) = explicit.left(&explicit.errors, &[]);
            let (without, _) = explicit.left(&explicit.errors, &of_runs);
            let (with, solution) = explicit.left(&explicit.errors, &all);
            // The fit is the minimum already.
            assert_relative_eq!(square(&fitted), fit.solution.rss, max_relative = 1e-9);
            // Differences of sums of squares that are ten times as large, of columns whose condition
            // number is some 1e3.
            let reduction = square(&without) - square(&with);
            assert_relative_eq!(found.reduction, reduction, max_relative = 1e-7);
            assert_relative_eq!(found.unexplained, square(&with), max_relative = 1e-7);
            let slow = &solution[fit.coordinates.len() + 1..];
            for (fast, slow) in found.coefficients.iter().zip(&slow[..FUNCTIONS]) {
                assert_relative_eq!(*fast, *slow, max_relative = 1e-5);
            }
            // The combination is what all else leaves of the shared functions.
            let mut gamma = found.coefficients.clone();
            gamma[FUNCTIONS..].fill(0.0);
            let (slow, _) = explicit.left(&times(&explicit.offered, &gamma), &of_runs);
            let taken_over = times(&explicit.fit, &found.response);
            let combined = times(&explicit.offered, &found.coefficients);
            for ((combined, taken_over), slow) in combined.iter().zip(taken_over).zip(&slow) {
                assert_relative_eq!(combined - taken_over, *slow, epsilon = 1e-7);
            }
        }
    }
}

fn tested(record: &Record, information: &RowInformation, fit: &GlsFit) -> Linearity {
    let runs = simulated(record, &information.moments, fit);
    test_linearity(&runs, information, fit, 0.0).unwrap()
}

#[test]
fn a_bent_characteristic_is_found_with_its_size() {
    // s runs over 3..5, where its square departs from a line by 0.3 rms if s is uniform: 0.09 at
    // this bend, beside a motion of 0.58 (1 + 8 * 0.3) = 1.97 rms: 4.6 %. s is not uniform, hence
    // a factor of two to each side.
    let bent = record(0.3);
    let (information, fit) = fitted(&bent, SETTLING);
    let found = tested(&bent, &information, &fit);
    assert!(found.is_rejected(), "{found:?}");
    assert!((2.3..9.2).contains(&found.misfit_percent), "{found:?}");
    let straight = record(0.0);
    let (information, fit) = fitted(&straight, SETTLING);
    let found = tested(&straight, &information, &fit);
    assert!(!found.is_rejected(), "{found:?}");
}

#[test]
fn runs_that_differ_are_not_bent() {
    // Two runs whose gains differ by a fifth, the second about levels that are 4 higher: a common line does
    // not go through both, and a bent one would.
    let straight = record(0.0);
    let [first, second] = straight.runs() else {
        unreachable!("there are two runs")
    };
    let input: Vec<f64> = second.input().iter().map(|u| u + 4.0).collect();
    let clean = input.iter().scan(input[0], |s, u| {
        *s += 0.5 * (u - *s);
        Some(*s)
    });
    let output = second.output().iter().zip(clean);
    let stronger: Vec<f64> = output.map(|(y, s)| y + 4.0 + 0.2 * s).collect();
    let stronger = Run::new(input, stronger).unwrap();
    let record = Record::new(0.01, vec![first.clone(), stronger]).unwrap();
    let (information, fit) = fitted(&record, SETTLING);
    let found = tested(&record, &information, &fit);
    assert!(found.p > 1e-3, "{found:?}");
}

#[test]
fn a_run_that_is_too_short_or_does_not_move_hides_no_finding() {
    let bent = record(0.3);
    let mut runs = bent.runs().to_vec();
    let level = runs[0].input()[0];
    runs.push(bent.runs()[0].part(0..4));
    runs.push(
        Run::new(vec![level; 60], vec![level + 0.3 * level * level; 60])
            .unwrap()
            .with_input_at_rest(level),
    );
    let record = Record::new(0.01, runs).unwrap();
    let (information, fit) = fitted(&record, SETTLING);
    let found = tested(&record, &information, &fit);
    assert!(found.is_rejected(), "{found:?}");
}
