//! The response at a row of frequencies with its covariance, and what is read from it.

use std::f64::consts::PI;

use faer::Mat;

use super::whole_response::{Functions, WholeResponse};
use crate::data::Timing;
use crate::estimation::{CurveVariance, RunPart, neighbour_correlation};
use crate::identify::estimate::Estimate;
use crate::numerics::{SampleMean, dot, not_negative, pointwise_critical};
use crate::results::{
    BandPoint, Bounds, FrequencyBounds, FrequencyResponse, MetricBounds, Metrics,
};
use crate::thresholds::WIDEST_IN_BAND;

/// Frequencies among which the ends of the band are looked for.
const SCAN: usize = 200;

/// Frequencies within the band: those of a document, and three between each two of them, between which crossings are straight.
const FINE: usize = 4 * (COARSE - 1) + 1;

/// Frequencies of a document.
const COARSE: usize = 120;

/// The response at rest and at a row of frequencies.
pub(super) struct Points {
    /// \[rad/sample\]; the first is 0.
    omegas: Vec<f64>,
    /// Re G and Im G in turn.
    values: Vec<f64>,
    spread: CurveVariance,
    /// Covariance of each with the response at rest.
    with_rest: Vec<f64>,
    /// Standard deviations of a bound to each side.
    critical: Vec<f64>,
    /// By how much the bounds of each are wider than those of even noise of a known size.
    beyond_even_noise: Vec<f64>,
}

impl Points {
    /// Within the band where bounds of this level are narrow, from `lowest` \[rad/s\] on; `None` where that is less than an octave. With the responses
    /// of single `runs` their mean, with how they differ in the bounds.
    pub(super) fn in_band(
        whole: &WholeResponse,
        runs: &[WholeResponse],
        level: f64,
        lowest: f64,
    ) -> Option<Self> {
        let estimate = &whole.estimate;
        let period = estimate.information.moments.sample_period_s();
        let fundamental = estimate.coordinates.basis.fundamental();
        let lowest = (lowest * period).max(0.1 * fundamental);
        let at = |omegas: &[f64]| Self::at(whole, runs, level, omegas);
        let (from, to) = at(&logarithmic(lowest, PI, SCAN)).narrow_band()?;
        (to >= 2.0 * from).then(|| at(&logarithmic(from, to, FINE)))
    }

    /// At rest and at `omegas` \[rad/sample\], with bounds of this level.
    fn at(whole: &WholeResponse, runs: &[WholeResponse], level: f64, omegas: &[f64]) -> Self {
        let omegas: Vec<f64> = std::iter::once(0.0).chain(omegas.iter().copied()).collect();
        let functions = whole.functions(&omegas);
        let noise = OfNoise::of(whole, &functions);
        let of_runs: Vec<Vec<f64>> = (runs.iter())
            .map(|run| run.values(&run.functions(&omegas)))
            .collect();
        let mean = SampleMean::of(&of_runs);
        let count = 2 * omegas.len();
        let of_noise = |i: usize, k: usize| noise.covariance(i, k);
        let of_runs = |i: usize, k: usize| mean.as_ref().map_or(0.0, |mean| mean.covariance(i, k));
        let sum = |i: usize, k: usize| of_noise(i, k) + of_runs(i, k);
        let (noise_sd, noise_correlation) = spread_of(count, of_noise);
        let by_noise = CurveVariance {
            sd: noise_sd,
            neighbour_correlation: noise_correlation,
            degrees_of_freedom: noise.degrees_of_freedom.clone(),
            of_runs: None,
        };
        let normal = pointwise_critical(level);
        let wider = (noise.less_sure.iter()).zip(by_noise.critical(normal));
        let beyond_even_noise = wider
            .map(|(less_sure, critical)| less_sure * critical / normal)
            .collect();
        let spread = match &mean {
            None => by_noise,
            Some(mean) => {
                let (sd, neighbour_correlation) = spread_of(count, sum);
                CurveVariance {
                    sd,
                    neighbour_correlation,
                    degrees_of_freedom: by_noise.degrees_of_freedom,
                    of_runs: Some(RunPart {
                        sd: deviations(count, of_runs),
                        noise_sd: by_noise.sd,
                        noise_correlation: by_noise.neighbour_correlation,
                        degrees: mean.degrees(),
                    }),
                }
            }
        };
        Self {
            beyond_even_noise,
            with_rest: (0..count).map(|i| sum(i, 0)).collect(),
            values: match &mean {
                None => whole.values(&functions),
                Some(mean) => mean.value.clone(),
            },
            critical: spread.critical(normal),
            spread,
            omegas,
        }
    }

    fn magnitude(&self, k: usize) -> f64 {
        self.values[2 * k].hypot(self.values[2 * k + 1])
    }

    /// Whether the half width of a bound is a small share of the response at the point `k`.
    fn is_narrow(&self, k: usize) -> bool {
        let half = |i: usize| self.critical[i] * self.spread.sd[i];
        half(2 * k).hypot(half(2 * k + 1)) <= WIDEST_IN_BAND * self.magnitude(k)
    }

    /// The ends of the longest stretch of narrow bounds, over the logarithm of frequency.
    fn narrow_band(&self) -> Option<(f64, f64)> {
        let narrow: Vec<usize> = (1..self.omegas.len())
            .filter(|&k| self.is_narrow(k))
            .collect();
        let stretch = narrow
            .chunk_by(|a, b| a + 1 == *b)
            .max_by_key(|s| s.len())?;
        Some((
            self.omegas[*stretch.first()?],
            self.omegas[*stretch.last()?],
        ))
    }

    /// The frequency response of a document, without the response at rest.
    pub(super) fn frequency_response(
        &self,
        timing: Timing,
        level: Bounds<f64>,
    ) -> FrequencyResponse {
        let kept: Vec<usize> = (1..self.omegas.len())
            .step_by(FINE / (COARSE - 1))
            .collect();
        let pairs = |of: &[f64]| -> Vec<f64> {
            kept.iter()
                .flat_map(|k| [of[2 * k], of[2 * k + 1]])
                .collect()
        };
        let values = pairs(&self.values);
        // Between points they are not asked for.
        let neighbours = |correlation: &[f64]| -> Vec<f64> {
            let mut own: Vec<f64> = (kept.iter())
                .flat_map(|k| [correlation[2 * k], 0.0])
                .collect();
            own.pop();
            own
        };
        let spread = CurveVariance {
            sd: pairs(&self.spread.sd),
            degrees_of_freedom: pairs(&self.spread.degrees_of_freedom),
            neighbour_correlation: neighbours(&self.spread.neighbour_correlation),
            of_runs: self.spread.of_runs.as_ref().map(|runs| RunPart {
                sd: pairs(&runs.sd),
                noise_sd: pairs(&runs.noise_sd),
                noise_correlation: neighbours(&runs.noise_correlation),
                degrees: runs.degrees,
            }),
        };
        let omegas: Vec<f64> = kept.iter().map(|&k| self.omegas[k]).collect();
        let bounds = level.map(|level| FrequencyBounds::new(&values, &spread, level, Vec::new()));
        FrequencyResponse::new(timing.sample_period_s, &omegas, &values, bounds)
    }

    /// By how much the bounds are wider than those of even noise of a known size, where they are most so in the band.
    pub(super) fn beyond_even_noise(&self) -> f64 {
        let in_band = self.beyond_even_noise.iter().skip(2);
        in_band.copied().fold(1.0, f64::max)
    }

    /// Gain, bandwidth and the frequency of -90 degrees, where the response at rest is known as well as the band.
    pub(super) fn metrics(&self, timing: Timing, level: Bounds<f64>) -> Metrics {
        let point = |k: usize| BandPoint {
            omega_rad_s: self.omegas[k] / timing.sample_period_s,
            value: (self.values[2 * k], self.values[2 * k + 1]),
            sd: (self.spread.sd[2 * k], self.spread.sd[2 * k + 1]),
            correlation: self.spread.neighbour_correlation[2 * k],
            with_rest: (self.with_rest[2 * k], self.with_rest[2 * k + 1]),
            critical: self.critical[2 * k].max(self.critical[2 * k + 1]),
        };
        let all: Vec<BandPoint> = (0..self.omegas.len()).map(point).collect();
        let bounds = level.map(|level| MetricBounds { level });
        Metrics::in_band(&all[0], &all[1..], self.is_narrow(0), timing, bounds)
    }
}

/// What noise makes of Re G and Im G in turn at a row of frequencies.
struct OfNoise {
    variance: f64,
    /// Of lags and ends: (Z'Z)^-1 w, and w, a function in each column.
    lags: [Mat<f64>; 2],
    ends: [Mat<f64>; 2],
    /// By how much each is less sure than in even noise.
    less_sure: Vec<f64>,
    degrees_of_freedom: Vec<f64>,
}

impl OfNoise {
    fn of(whole: &WholeResponse, Functions { lags: map, ends }: &Functions) -> Self {
        let Estimate {
            information, fit, ..
        } = &whole.estimate;
        let of_lags = CurveVariance::of_fit(information, fit, map);
        let lags = map.ncols();
        let unit = fit.unit_covariance();
        let weighted = unit.as_ref().submatrix(0, 0, lags, lags) * map.transpose();
        let functions = map.transpose().to_owned();
        let ends = ends.transpose().to_owned();
        // Noise that is not even, and errors of the commands, make the ends as much less sure as the lags.
        let even = fit.solution.inverse.as_ref().submatrix(0, 0, lags, lags) * &functions;
        let less_sure = |i: usize| {
            let of = |weighted: &Mat<f64>| dot(weighted.col_as_slice(i), functions.col_as_slice(i));
            (of(&weighted) / of(&even)).max(1.0).sqrt()
        };
        Self {
            variance: fit.variance,
            less_sure: (0..map.nrows()).map(less_sure).collect(),
            ends: [whole.tails.covariance() * &ends, ends],
            lags: [weighted, functions],
            degrees_of_freedom: of_lags.degrees_of_freedom,
        }
    }

    fn covariance(&self, i: usize, k: usize) -> f64 {
        let of = |[weighted, functions]: &[Mat<f64>; 2]| {
            dot(weighted.col_as_slice(i), functions.col_as_slice(k))
        };
        let ends = self.less_sure[i] * self.less_sure[k] * of(&self.ends);
        self.variance * of(&self.lags) + ends
    }
}

fn deviations(count: usize, covariance: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    (0..count)
        .map(|i| not_negative(covariance(i, i)).sqrt())
        .collect()
}

/// The standard deviation of each, and its correlation with the one before it.
fn spread_of(count: usize, covariance: impl Fn(usize, usize) -> f64) -> (Vec<f64>, Vec<f64>) {
    let sd = deviations(count, &covariance);
    let correlation = neighbour_correlation(count, covariance, |i| sd[i - 1] * sd[i]);
    (sd, correlation)
}

/// So many frequencies, evenly over the logarithm.
fn logarithmic(from: f64, to: f64, count: usize) -> Vec<f64> {
    let ratio = (to / from).ln() / (count - 1) as f64;
    (0..count)
        .map(|k| from * (ratio * k as f64).exp())
        .collect()
}
