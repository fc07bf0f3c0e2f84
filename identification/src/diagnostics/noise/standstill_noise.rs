//! The errors in motion against the noise at standstill.
//!
//! A flexible noise model takes errors that follow the motion slowly for drift, and a recording of motion alone
//! cannot separate the two. A recording of standstill can: there the noise is measured without any motion. So
//! D_r(z) is fitted to the output while the input is held, and behind that filter the errors of the simulation in
//! motion must be as small as those at standstill,
//!
//! ```text
//! s_m² / s_r² ~ F,     s_m² = mean (D_r(z) v)²  in motion,     s_r² = mean (D_r(z) (y - ȳ))²  at standstill.
//! ```
//!
//! Like is compared with like, so the quality of D_r does not matter: the motion is cut into pieces as long as a
//! stretch of standstill, each about its own mean. Drift that is too slow for a stretch of standstill is not in
//! a piece of motion either.
//!
//! White noise in motion alone, as scatter of the times of sampling makes it, is no sign of a servo that is not linear, whose errors go on
//! from sample to sample. Behind D_r, white noise has the correlation ρ of neighbours that follows from D_r; so of an excess E over the
//! noise at standstill, with C between neighbours, (C - ρ E) / (1 - ρ) goes on, at least, and that must be beyond chance, too.
//!
//! Three things may make the noise at standstill too small, and are allowed for. Half a step of the output is added
//! to it, because a servo that stands on one code shows no noise. The loudest fifth of the pieces is left
//! out, so that a few glitches are no evidence. Where there are several runs, each has a gain, a delay and an
//! offset of its own, because supply and clock change them from run to run. Noise that is too large at standstill,
//! of a servo that still creeps, can only hide a finding.

use faer::Mat;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::data::{EXACTLY, Run, holds};
use crate::diagnostics::residuals::simulation_error::{SAMPLES, Simulated, beginnings, square};
use crate::estimation::{GlsFit, NoiseFit, RowInformation, best_order, noise_filter};
use crate::numerics::dot;
use crate::options::MAX_AUTO_ORDER;
use crate::thresholds::{FEWEST_AT_REST, LOUDEST_LEFT_OUT, SHORTEST_REST};

/// The errors in motion against the noise at standstill.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StandstillNoise {
    /// Probability of errors at least as large, and that go on as much from sample to sample, if they are the noise at standstill.
    pub p: f64,
    /// Root mean square of the errors in motion over that of the noise at standstill, both behind the filter
    /// that whitens the latter.
    pub ratio: f64,
    /// Residuals of the simulation that noise does not explain, relative to the output about its mean \[% rms\].
    pub misfit_percent: f64,
}

/// Compares the errors of `fit` in `runs` with the noise at standstill, in the runs and in the recordings around
/// them, `rest`; `None` when no standstill is long enough.
#[must_use]
pub(crate) fn against_standstill(
    runs: &[Simulated<'_>],
    rest: &[Run],
    information: &RowInformation,
    fit: &GlsFit,
) -> Option<StandstillNoise> {
    let rest: Vec<_> = beginnings(rest, SAMPLES).collect();
    let recorded = Recorded {
        runs: runs.iter().map(|simulated| &simulated.run).collect(),
        rest: rest.iter().collect(),
    };
    let noise = StandstillModel::of(&recorded, fit.coordinates.basis.settling())?;
    let order = noise.ar.len();
    // Of one length each.
    let mut pieces: Vec<Behind> = pieces(runs, noise.typical)
        .map(|piece| noise.behind_filter(piece))
        .collect();
    pieces.sort_by(|a, b| a.square.total_cmp(&b.square));
    pieces.truncate(pieces.len() - pieces.len() / LOUDEST_LEFT_OUT);
    let filtered: f64 = pieces.iter().map(|piece| piece.square).sum();
    let neighbours: f64 = pieces.iter().map(|piece| piece.neighbours).sum();
    let count = pieces.len() * (noise.typical - order);
    // The part of the noise that the fitted response explains, spread over all rows.
    let share = fit.degrees_of_freedom() / information.rows() as f64;
    let degrees = (count as f64 - pieces.len() as f64) * share;
    if degrees < FEWEST_AT_REST as f64 {
        return None;
    }
    let f = (filtered / degrees) / noise.variance;
    let white = noise.neighbours_of_white();
    let goes_on = (neighbours / degrees / noise.variance - white * (f - 1.0)) / (1.0 - white);
    let distribution = FisherSnedecor::new(degrees, noise.degrees).ok()?;
    let own = sum_of_squares(runs.iter().map(Simulated::own_errors))
        / sum_of_squares(runs.iter().map(|run| &*run.errors));
    let left = (own * square(information, fit) / information.moments.output_spread()).sqrt();
    Some(StandstillNoise {
        p: distribution.sf(f.min(1.0 + goes_on)).clamp(0.0, 1.0),
        ratio: f.sqrt(),
        misfit_percent: 100.0 * left * (1.0 - 1.0 / f).max(0.0).sqrt(),
    })
}

/// Sum of the squares that are there.
fn sum_of_squares<'a>(runs: impl Iterator<Item = &'a [f64]>) -> f64 {
    let present = runs.flatten().filter(|error| !error.is_nan());
    present.map(|error| error * error).sum()
}

/// The data of the comparison.
struct Recorded<'a> {
    runs: Vec<&'a Run<'a>>,
    /// Recorded around the runs.
    rest: Vec<&'a Run<'a>>,
}

/// Errors behind the filter that whitens the noise at standstill.
struct Behind {
    /// Sum of squares.
    square: f64,
    /// Sum of the products of neighbours.
    neighbours: f64,
}

/// The noise at standstill.
struct StandstillModel {
    /// d_1..d_d of D_r.
    ar: Vec<f64>,
    /// Expected (D_r v)² of samples that D_r has not been fitted to.
    variance: f64,
    /// Degrees of freedom of the variance.
    degrees: f64,
    /// The usual length of a stretch \[samples\].
    typical: usize,
}

impl StandstillModel {
    fn of(recorded: &Recorded<'_>, settling: usize) -> Option<Self> {
        let stretches = recorded.stretches(settling);
        let count: usize = stretches.iter().map(|stretch| stretch.len()).sum();
        if count < FEWEST_AT_REST {
            return None;
        }
        let mut lengths: Vec<usize> = stretches.iter().map(|stretch| stretch.len()).collect();
        lengths.sort_unstable();
        let typical = lengths[lengths.len() / 2];
        let size = MAX_AUTO_ORDER + 1;
        let mut moments = Mat::zeros(size, size);
        for stretch in &stretches {
            add_moments(&about_mean(stretch), &mut moments);
        }
        let rows = count - MAX_AUTO_ORDER * stretches.len();
        let rounding = (0.5 * recorded.smallest_step()).powi(2);
        for i in 0..size {
            moments[(i, i)] += rounding * rows as f64;
        }
        // Noise is never too small for this: the steps of numbers are steps as well.
        let noise = NoiseFit::new(&moments, 0.0)?;
        let order = best_order(&noise.candidates(rows));
        let ar = noise.coefficients(order);
        let degrees = (rows - order - stretches.len()) as f64;
        let square = quadratic(&moments, &noise_filter(&ar));
        // Akaike's final prediction error: D_r fits the samples that it is from better than others.
        let unseen = 1.0 + order as f64 / rows as f64;
        Some(Self {
            ar,
            variance: unseen * square / degrees,
            degrees,
            typical,
        })
    }

    /// D_r v, v being `piece` about its mean.
    fn behind_filter(&self, piece: &[f64]) -> Behind {
        let d = noise_filter(&self.ar);
        let filtered = |window: &[f64]| window.iter().rev().zip(&d).map(|(v, d)| d * v).sum();
        let filtered: Vec<f64> = about_mean(piece).windows(d.len()).map(filtered).collect();
        Behind {
            square: dot(&filtered, &filtered),
            neighbours: filtered.windows(2).map(|pair| pair[0] * pair[1]).sum(),
        }
    }

    /// The correlation of neighbours of white noise behind D_r.
    fn neighbours_of_white(&self) -> f64 {
        let d = noise_filter(&self.ar);
        let neighbours: f64 = d.windows(2).map(|pair| pair[0] * pair[1]).sum();
        neighbours / dot(&d, &d)
    }
}

fn about_mean(values: &[f64]) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|value| value - mean).collect()
}

/// E[i,j] += sum v(k-i) v(k-j), over the k that have all of it.
fn add_moments(values: &[f64], moments: &mut Mat<f64>) {
    let order = moments.nrows() - 1;
    let rows = values.len() - order;
    for i in 0..=order {
        for j in 0..=i {
            let late = &values[order - i..order - i + rows];
            let early = &values[order - j..order - j + rows];
            let sum: f64 = late.iter().zip(early).map(|(a, b)| a * b).sum();
            moments[(i, j)] += sum;
            if i != j {
                moments[(j, i)] += sum;
            }
        }
    }
}

/// d'E d, E being larger than d needs.
fn quadratic(moments: &Mat<f64>, d: &[f64]) -> f64 {
    let row = |i: usize| {
        d.iter()
            .enumerate()
            .map(|(j, dj)| moments[(i, j)] * dj)
            .sum::<f64>()
    };
    d.iter().enumerate().map(|(i, di)| di * row(i)).sum()
}

impl<'a> Recorded<'a> {
    /// The output wherever the input has been held for long enough: in holds of the runs that are longer than
    /// the settling time, and in the recordings around them.
    fn stretches(&self, settling: usize) -> Vec<&'a [f64]> {
        let mut found = Vec::new();
        for run in &self.runs {
            let from_rest = run
                .input_at_rest()
                .filter(|u| run.input().first() == Some(u));
            for (index, hold) in holds(run, EXACTLY).into_iter().enumerate() {
                let settled = if index == 0 && from_rest.is_some() {
                    0
                } else {
                    settling
                };
                add_settled(&run.output()[hold.samples], settled, &mut found);
            }
        }
        for run in &self.rest {
            for hold in holds(run, EXACTLY) {
                // A settling time that was found too long must not leave nothing.
                let settled = settling.min(hold.samples.len() / 2);
                add_settled(&run.output()[hold.samples], settled, &mut found);
            }
        }
        found
    }

    /// The smallest step between neighbouring values of the output.
    fn smallest_step(&self) -> f64 {
        let runs = self.runs.iter().chain(&self.rest);
        runs.flat_map(|run| run.output().windows(2))
            .map(|pair| (pair[1] - pair[0]).abs())
            .filter(|step| *step > 0.0)
            .fold(f64::INFINITY, f64::min)
    }
}

fn add_settled<'a>(output: &'a [f64], settled: usize, found: &mut Vec<&'a [f64]>) {
    let settled = output.get(settled..).unwrap_or_default();
    found.extend(
        settled
            .split(|y| y.is_nan())
            .filter(|part| part.len() >= SHORTEST_REST),
    );
}

/// Pieces of `length` samples that are all there.
fn pieces<'a>(runs: &'a [Simulated<'_>], length: usize) -> impl Iterator<Item = &'a [f64]> {
    // Runs of one servo differ, and that is no sign of errors in motion.
    runs.iter()
        .flat_map(|run| run.own_errors().split(|error| error.is_nan()))
        .flat_map(move |whole| whole.chunks_exact(length))
}

#[cfg(test)]
mod tests {
    use crate::results::Check;
    use crate::results::Model;
    use crate::{Options, Record, Run, identify};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    const REST: usize = 300;

    /// A first-order servo under random levels, after rest and before rest, under noise of first
    /// order; it comes to rest `off` (standard deviation) from where it should, another time each time. White noise of
    /// `in_motion` times the change of the position from sample to sample is added.
    fn identified(seed: u64, off: f64, step: f64, in_motion: f64) -> Model {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let holds: Vec<(f64, f64)> = (0..100).map(|_| (3.0 * normal(), off * normal())).collect();
        let mut input = vec![0.0; REST];
        let mut error = vec![0.0; REST];
        for (level, off) in holds {
            input.extend([level; 20]);
            error.extend([off; 20]);
        }
        input.extend([0.0; REST]);
        error.extend([0.0; REST]);
        let (mut s, mut e, mut v) = (0.0, 0.0, 0.0);
        let output: Vec<f64> = input
            .iter()
            .zip(error)
            .map(|(u, off)| {
                let change = 0.4 * (u - s);
                s += change;
                e += 0.4 * (off - e);
                v = 0.8 * v + 0.03 * normal();
                let y = s + e + v + in_motion * change * normal();
                if step > 0.0 {
                    (y / step).round() * step
                } else {
                    y
                }
            })
            .collect();
        let all = Run::new(input, output).unwrap();
        let end = all.len() - REST;
        let record = Record::new(0.01, vec![all.part(REST..end)])
            .unwrap()
            .with_rest(vec![all.part(0..REST), all.part(end..all.len())]);
        identify(&record, &Options::default()).unwrap()
    }

    fn is_found(model: &Model) -> bool {
        !model.linear
    }

    #[test]
    fn noise_at_standstill_shows_errors_that_pass_for_drift() {
        // 0.2 beside levels of 3: 7 % of the motion, and four times the noise of 0.05.
        let model = identified(1, 0.2, 0.0, 0.0);
        assert!(is_found(&model), "{:?}", model.residuals);
        let percent = model.residuals.beyond_rest_percent.unwrap();
        // The servo follows each hold to the end, so that the errors are 0.2 rms less what is lost
        // on the way, and the response takes up some of them.
        assert!((4.0..7.5).contains(&percent), "{percent}");
        assert!(model.residuals.rest_p.unwrap() < 1e-4);
        let size = |words: &str| words.contains("times the noise at rest");
        assert!(model.advice.iter().any(|advice| size(&advice.finding)));
    }

    #[test]
    fn the_same_noise_is_no_finding_whatever_the_steps_of_the_sensor() {
        // Steps from none to ten times the noise, which rest at one code or between two.
        for step in [0.0, 0.02, 0.1, 0.5] {
            for seed in 0..6 {
                let model = identified(seed, 0.0, step, 0.0);
                let p = model.residuals.rest_p.unwrap();
                assert!(p > 1e-3 && !is_found(&model), "{step}, seed {seed}: {p}");
            }
        }
    }

    #[test]
    fn white_noise_in_motion_is_no_finding() {
        for seed in 0..6 {
            // A tenth of the change: up to three times the noise at rest.
            let model = identified(seed, 0.0, 0.0, 0.1);
            let p = model.residuals.rest_p.unwrap();
            assert!(p > 1e-3 && !is_found(&model), "seed {seed}: {p}");
            assert!(model.bounds.valid().is_some(), "{:?}", model.advice);
        }
    }

    /// Runs of a linear servo whose gain changes from run to run by `scatter` (standard deviation), under
    /// random levels of their own, each from rest to rest.
    fn of_runs(seed: u64, scatter: f64) -> Model {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let (mut runs, mut rest) = (Vec::new(), Vec::new());
        for _ in 0..4 {
            let gain = 1.0 + scatter * normal();
            let levels: Vec<f64> = (0..60).map(|_| 3.0 * normal()).collect();
            let held = levels.iter().flat_map(|level| [*level; 20]);
            let still = [0.0; REST];
            let input: Vec<f64> = still.into_iter().chain(held).chain(still).collect();
            let (mut s, mut v) = (0.0, 0.0);
            let output: Vec<f64> = input
                .iter()
                .map(|u| {
                    s += 0.4 * (gain * u - s);
                    v = 0.8 * v + 0.03 * normal();
                    s + v
                })
                .collect();
            let all = Run::new(input, output).unwrap();
            let end = all.len() - REST;
            let part = |samples| all.part(samples).into_owned();
            runs.push(part(REST..end));
            rest.extend([part(0..REST), part(end..all.len())]);
        }
        let record = Record::new(0.01, runs).unwrap().with_rest(rest);
        identify(&record, &Options::default()).unwrap()
    }

    #[test]
    fn runs_that_differ_are_not_taken_for_a_servo_that_is_not_linear() {
        for seed in 0..6 {
            let model = of_runs(seed, 0.04);
            let mut advice = model.advice.iter();
            assert!(
                advice.any(|advice| advice.check == Check::RunScatter),
                "seed {seed}"
            );
            let p = model.residuals.rest_p.unwrap();
            assert!(p > 1e-3 && !is_found(&model), "seed {seed}: {p}");
        }
    }

    #[test]
    fn runs_that_differ_by_much_are_not_of_one_servo() {
        let model = of_runs(1, 0.4);
        let advised = |words: &str| {
            model
                .advice
                .iter()
                .any(|advice| advice.finding.contains(words))
        };
        assert!(
            advised("the runs are not of one servo"),
            "{:?}",
            model.advice
        );
        assert!(model.bounds.valid().is_none());
    }

    #[test]
    fn without_standstill_there_is_no_test() {
        let input: Vec<f64> = (0..900).map(|k| f64::from(k / 7 * 7919 % 101)).collect();
        let output: Vec<f64> = input
            .iter()
            .scan(0.0, |s, u| {
                *s += 0.4 * (u - *s);
                Some(*s)
            })
            .enumerate()
            .map(|(k, s)| s + 0.01 * (k * 7919 % 101) as f64)
            .collect();
        let record = Record::of_run(0.01, &input, &output).unwrap();
        let model = identify(&record, &Options::default()).unwrap();
        assert_eq!(model.residuals.rest_p, None);
    }
}
