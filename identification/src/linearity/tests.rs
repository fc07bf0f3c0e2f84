//! The fast regression against the explicit one.

use super::*;
use crate::basis::Basis;
use crate::gls::{self, GlsOptions};
use crate::linear::column;
use crate::normal::Coordinates;
use crate::options::NoiseOrder;
use crate::record::{Record, Run};
use crate::simulated::simulated;
use approx::assert_relative_eq;
use faer::linalg::solvers::SolveLstsqCore;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const SETTLING: usize = 11;

/// A run of a first-order servo whose output is bent by `bend` s², under noise of first order.
fn run(seed: u64, samples: usize, bend: f64) -> Run {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    // Levels from 3 to 5, held long enough for the servo to come near them.
    let level = |k: usize| 3.0 + (k / 8 * 7919 % 101) as f64 / 50.0;
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
fn record(bend: f64) -> Record {
    let first = run(1, 150, bend);
    let rest = first.input()[0];
    let second = run(2, 130, bend);
    let mut holed = second.output().to_vec();
    holed[60] = f64::NAN;
    let second = Run::new(second.input(), holed).unwrap();
    Record::new(0.01, vec![first.with_input_at_rest(rest), second]).unwrap()
}

fn fitted(record: &Record, frequencies: usize) -> (Information, GlsFit) {
    let options = GlsOptions {
        order: NoiseOrder::Order(1),
        ..GlsOptions::default()
    };
    let information = Information::from_moments(Moments::of_record(record, SETTLING + 1, 2));
    let coordinates = Coordinates::new(Basis::new(SETTLING, frequencies).unwrap());
    let fit = gls::fit(&information, &coordinates, &options).unwrap();
    (information, fit)
}

/// sum_i d_i x(k-i).
fn filtered_at(values: &[f64], d: &[f64], k: usize) -> f64 {
    d.iter().enumerate().map(|(i, di)| di * values[k - i]).sum()
}

/// The regression with every row and column written out: sum of squares, coefficients.
fn explicit(offered: &Offered, fit: &GlsFit, with_functions: bool) -> (f64, Vec<f64>) {
    let d = with_one(&fit.ar);
    let coordinates = &fit.coordinates;
    let p = coordinates.len();
    let columns = p + 1 + if with_functions { FUNCTIONS } else { 0 };
    let mut rows: Vec<(Vec<f64>, f64)> = Vec::new();
    for run in &offered.runs {
        for k in run.rows.iter().cloned().flatten() {
            let lagged = |m: usize| filtered_at(&run.input, &d, run.history + k - m);
            let lags: Vec<f64> = (0..SETTLING).map(lagged).collect();
            let mut row: Vec<f64> = match coordinates.impulse_map() {
                Some(map) => times(&map.transpose().to_owned(), &lags),
                None => lags,
            };
            row.push(d.iter().sum());
            row.extend(run.functions.iter().map(|z| filtered_at(z, &d, k)));
            rows.push((row, run.errors[k]));
        }
    }
    let matrix = Mat::from_fn(rows.len(), columns, |i, j| rows[i].0[j]);
    let errors: Vec<f64> = rows.iter().map(|(_, error)| *error).collect();
    let mut solution = column(&errors);
    matrix
        .qr()
        .solve_lstsq_in_place_with_conj(faer::Conj::No, solution.as_mut());
    let solution = solution.col_as_slice(0)[..columns].to_vec();
    let fitted = times(&matrix, &solution);
    let rss = errors
        .iter()
        .zip(fitted)
        .map(|(e, f)| (e - f).powi(2))
        .sum();
    (rss, solution)
}

#[test]
fn moments_by_transforms_give_what_the_explicit_regression_gives() {
    for frequencies in [SETTLING, 5] {
        let record = record(0.02);
        let (information, fit) = fitted(&record, frequencies);
        let runs = simulated(&record, &information.moments, &fit);
        let offered = Offered::new(&runs, &information.moments, &fit).unwrap();
        let (found, response) = offered.regress(&fit).unwrap();
        let (without, _) = explicit(&offered, &fit, false);
        let (with, solution) = explicit(&offered, &fit, true);
        assert_eq!(found.degrees, FUNCTIONS);
        // The fit is the minimum already.
        assert_relative_eq!(without, fit.solution.rss, max_relative = 1e-9);
        // Differences of sums of squares that are ten times as large, of columns whose condition
        // number is some 1e3.
        assert_relative_eq!(found.reduction, without - with, max_relative = 1e-7);
        let p = fit.coordinates.len();
        for (fast, slow) in found.coefficients.iter().zip(&solution[p + 1..]) {
            assert_relative_eq!(*fast, *slow, max_relative = 1e-5);
        }
        for (taken_over, slow) in response.iter().zip(&solution[..=p]) {
            assert_relative_eq!(*taken_over, -slow, max_relative = 1e-5, epsilon = 1e-7);
        }
    }
}

fn tested(record: &Record, information: &Information, fit: &GlsFit) -> Linearity {
    let runs = simulated(record, &information.moments, fit);
    test(&runs, information, fit).unwrap()
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
