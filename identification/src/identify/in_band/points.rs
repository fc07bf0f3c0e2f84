//! The response at a row of frequencies with its covariance, and what is read from it.

use std::f64::consts::PI;

use faer::Mat;

use crate::data::Timing;
use crate::diagnostics::Tails;
use crate::estimation::CurveVariance;
use crate::identify::estimate::Estimate;
use crate::numerics::{dot, not_negative, pointwise_critical, times};
use crate::results::{
    BandPoint, Bounds, FrequencyBounds, FrequencyResponse, MetricBounds, Metrics, frequency_map,
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
    /// Within the band where bounds of this level are narrow, from `lowest` \[rad/s\] on; `None` where that is less than an octave.
    pub(super) fn in_band(
        estimate: &Estimate,
        tails: &Tails,
        level: f64,
        lowest: f64,
    ) -> Option<Self> {
        let period = estimate.information.moments.sample_period_s();
        let fundamental = estimate.coordinates.basis.fundamental();
        let lowest = (lowest * period).max(0.1 * fundamental);
        let at = |omegas: &[f64]| Self::at(estimate, tails, level, omegas);
        let (from, to) = at(&logarithmic(lowest, PI, SCAN)).narrow_band()?;
        (to >= 2.0 * from).then(|| at(&logarithmic(from, to, FINE)))
    }

    /// At rest and at `omegas` \[rad/sample\], with bounds of this level.
    fn at(estimate: &Estimate, tails: &Tails, level: f64, omegas: &[f64]) -> Self {
        let Estimate {
            coordinates,
            information,
            fit,
        } = estimate;
        let omegas: Vec<f64> = std::iter::once(0.0).chain(omegas.iter().copied()).collect();
        let map = frequency_map(coordinates, &omegas);
        let by_ends = tails.functions(&map, &omegas);
        let mut values = times(&map, fit.solution.response());
        for (value, by_ends) in values.iter_mut().zip(times(&by_ends, tails.gains())) {
            *value += by_ends;
        }
        let of_lags = CurveVariance::of_fit(information, fit, &map);
        let lags = map.ncols();
        let unit = fit.unit_covariance();
        let weighted = unit.as_ref().submatrix(0, 0, lags, lags) * map.transpose();
        let functions = map.transpose().to_owned();
        let ends = by_ends.transpose().to_owned();
        // Noise that is not even, and errors of the commands, make the ends as much less sure as the lags.
        let even = fit.solution.inverse.as_ref().submatrix(0, 0, lags, lags) * &functions;
        let less_sure: Vec<f64> = (0..values.len())
            .map(|i| {
                let of =
                    |weighted: &Mat<f64>| dot(weighted.col_as_slice(i), functions.col_as_slice(i));
                (of(&weighted) / of(&even)).max(1.0).sqrt()
            })
            .collect();
        let weighted_ends = tails.covariance() * &ends;
        let product = |i: usize, k: usize| {
            fit.variance * dot(weighted.col_as_slice(i), functions.col_as_slice(k))
                + less_sure[i]
                    * less_sure[k]
                    * dot(weighted_ends.col_as_slice(i), ends.col_as_slice(k))
        };
        let sd: Vec<f64> = (0..values.len())
            .map(|i| not_negative(product(i, i)).sqrt())
            .collect();
        let correlation = |i: usize| match sd[i - 1] * sd[i] {
            scale if scale > 0.0 => (product(i - 1, i) / scale).clamp(-1.0, 1.0),
            _ => 1.0,
        };
        let spread = CurveVariance {
            neighbour_correlation: (1..sd.len()).map(correlation).collect(),
            degrees_of_freedom: of_lags.degrees_of_freedom,
            of_runs: None,
            sd,
        };
        let normal = pointwise_critical(level);
        let critical = spread.critical(normal);
        let wider = |(less_sure, critical): (&f64, &f64)| less_sure * critical / normal;
        Self {
            beyond_even_noise: less_sure.iter().zip(&critical).map(wider).collect(),
            critical,
            spread,
            with_rest: (0..values.len()).map(|i| product(i, 0)).collect(),
            omegas,
            values,
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
        let (values, correlation) = (pairs(&self.values), &self.spread.neighbour_correlation);
        // Between points they are not asked for.
        let mut neighbours: Vec<f64> = (kept.iter())
            .flat_map(|k| [correlation[2 * k], 0.0])
            .collect();
        neighbours.pop();
        let spread = CurveVariance {
            sd: pairs(&self.spread.sd),
            degrees_of_freedom: pairs(&self.spread.degrees_of_freedom),
            neighbour_correlation: neighbours,
            of_runs: None,
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

/// So many frequencies, evenly over the logarithm.
fn logarithmic(from: f64, to: f64, count: usize) -> Vec<f64> {
    let ratio = (to / from).ln() / (count - 1) as f64;
    (0..count)
        .map(|k| from * (ratio * k as f64).exp())
        .collect()
}
