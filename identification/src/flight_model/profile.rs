//! How far a parameter may go: its likelihood profile (D. J. Venzon and S. H. Moolgavkar, Applied Statistics, 1988).
//!
//! The parameter is held at a value, the others take what fits best, and χ² rises. Where it has risen by the square of the critical value, the interval ends. A covariance
//! is the curvature at the minimum alone, and delay and further lags exchange one for the other far beyond it.

use super::fitter::Fitter;
use super::levenberg_marquardt::descend;
use super::low_order::LowOrder;
use super::poles::PoleNames;
use crate::numerics::dot;

/// Steps on the way to an end, each longer by this factor than the one before.
const STEPS: usize = 16;
const LONGER: f64 = 1.6;

/// Steps by which an end is narrowed down.
const NARROWER: usize = 5;

/// Share of a decrease of χ² at which the others have found their place.
const CONVERGED: f64 = 1e-6;

/// The profiles of a servo of third order around a minimum.
pub(super) struct Profile<'a> {
    pub(super) fitter: &'a Fitter,
    pub(super) names: PoleNames,
    /// The parameters there.
    pub(super) minimum: Vec<f64>,
    /// χ² from which it rises: at the minimum, or higher.
    pub(super) least: f64,
}

/// A point of a profile: all parameters, and by how much χ² has risen, as its root.
struct Point {
    parameters: Vec<f64>,
    root: f64,
}

impl Profile<'_> {
    fn root(&self, chi_square: f64) -> f64 {
        match chi_square.is_finite() {
            true => (chi_square - self.least).max(0.0).sqrt(),
            false => f64::INFINITY,
        }
    }

    /// Where parameter `k` has χ² risen by the square of `critical`, in the direction of `step`, the first one. `None` where that is further away than `farthest`.
    pub(super) fn end(&self, k: usize, step: f64, farthest: f64, critical: f64) -> Option<f64> {
        let mut inner = Point {
            parameters: self.minimum.clone(),
            root: 0.0,
        };
        let (mut step, from) = (step, self.minimum[k]);
        // By what the others went beside the last step.
        let mut direction = vec![0.0; inner.parameters.len()];
        for _ in 0..STEPS {
            let value = inner.parameters[k] + step;
            let further: Vec<f64> = (inner.parameters.iter().zip(&direction))
                .map(|(x, slope)| x + step * slope)
                .collect();
            let near = self.better([&inner.parameters, &further], k, value);
            let outer = self.at(k, value, &near);
            if outer.root >= critical {
                return Some(self.between(k, inner, outer, critical));
            }
            if (outer.parameters[k] - from).abs() > farthest {
                return None;
            }
            let pairs = outer.parameters.iter().zip(&inner.parameters);
            direction = pairs.map(|(outer, inner)| (outer - inner) / step).collect();
            inner = outer;
            step *= LONGER;
        }
        None
    }

    /// The best point with parameter `k` at this value, from one that is near, and from the same with the poles that its order lacks where they show.
    fn at(&self, k: usize, value: f64, near: &[f64]) -> Point {
        let servo = LowOrder::from_parameters(3, near);
        let shown = self.names.with_visible_poles(self.names.of(servo));
        let shown = shown.map(|shown| self.from(k, value, &shown.parameters()));
        let found = self.from(k, value, near);
        match shown {
            Some(shown) if shown.root < found.root => shown,
            _ => found,
        }
    }

    /// The one of two with parameter `k` at this value that fits better.
    fn better(&self, of: [&[f64]; 2], k: usize, value: f64) -> Vec<f64> {
        let [near, further] = of.map(|parameters| {
            let mut parameters = parameters.to_vec();
            parameters[k] = value;
            let servo = self.names.of(LowOrder::from_parameters(3, &parameters));
            let left = self.fitter.residuals(&servo);
            (self.root(dot(&left, &left)), parameters)
        });
        match further.0 < near.0 {
            true => further.1,
            false => near.1,
        }
    }

    /// The best point with parameter `k` at this value, from `start`.
    fn from(&self, k: usize, value: f64, start: &[f64]) -> Point {
        let whole = |free: &[f64]| {
            let mut all = free.to_vec();
            all.insert(k, value);
            all
        };
        let without = |all: &[f64]| {
            let mut free = all.to_vec();
            free.remove(k);
            free
        };
        let residuals = |free: &[f64]| {
            let servo = LowOrder::from_parameters(3, &whole(free));
            self.fitter.residuals(&self.names.of(servo))
        };
        let increments = (self.fitter).increments(&LowOrder::from_parameters(3, start));
        let found = descend(
            &residuals,
            &without(start),
            &without(&increments),
            CONVERGED,
        );
        Point {
            parameters: whole(&found.parameters),
            root: self.root(found.sum_of_squares),
        }
    }

    /// The value of parameter `k` between two points on both sides of the end, by the rule of false position with halved weights (Illinois).
    fn between(&self, k: usize, mut inner: Point, mut outer: Point, critical: f64) -> f64 {
        let (mut below, mut above) = (inner.root - critical, outer.root - critical);
        if !above.is_finite() {
            above = critical;
        }
        let mut last = 0.0;
        for _ in 0..NARROWER {
            let share = (below / (below - above)).clamp(0.05, 0.95);
            let [a, b] = [&inner, &outer].map(|point| point.parameters[k]);
            let found = self.at(k, a + share * (b - a), &inner.parameters);
            let value = found.root - critical;
            if value.abs() < 0.01 * critical {
                return found.parameters[k];
            }
            if value < 0.0 {
                (inner, below) = (found, value);
                above *= if last < 0.0 { 0.5 } else { 1.0 };
            } else {
                (outer, above) = (found, if value.is_finite() { value } else { critical });
                below *= if last > 0.0 { 0.5 } else { 1.0 };
            }
            last = value;
        }
        // The outer one is no less than the end.
        outer.parameters[k]
    }
}
