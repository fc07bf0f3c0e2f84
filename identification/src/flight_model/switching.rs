//! The switching model: a flight model with different dynamics for up and down strokes.
//!
//! Each change a of the command starts its own response, a g_up(t) upwards or a g_down(t) downwards. Both
//! have one gain K, but separate delays and poles. The direction-split estimate
//! ([`crate::nonlinear::direction`]) is linear in the output, so the projection of the plain model also
//! serves here, over both banks at once.
//!
//! The output at rest is on the line c + K u. Overlapping strokes are superposed, which a real servo need not
//! follow, and the speed of a real servo may not grow with the stroke. The model is valid for strokes of the
//! recorded sizes, which it states.

use faer::Mat;
use serde::{Deserialize, Serialize};

use super::guess::Guess;
use super::low_order::LowOrder;
use super::options::FlightModelOptions;
use super::order::{Estimates, OrderTried, simplest};
use super::projection::{LENGTH, Projection, with_history};
use super::search::{Minimum, best_minimum};
use crate::data::record::Record;
use crate::data::timing::Timing;
use crate::error::Error;
use crate::estimation::least_squares::Coordinates;
use crate::nonlinear::direction::two_inputs::{self, TwoInputMoments};
use crate::nonlinear::direction::{DirectionModel, changes_bank};
use crate::numerics::linear_algebra::times;
use crate::options::NoiseOrder;
use crate::results::metrics::Interval;
use crate::results::model::{Model, ParameterBounds};
use crate::results::validity::Bounds;

/// The dynamics of strokes in one direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StrokeDynamics {
    /// The transfer function; the gain is common to both directions.
    pub transfer: LowOrder,
    /// L \[s\].
    pub delay_s: Interval,
    /// ω \[rad/s\].
    pub omega_rad_s: Interval,
    /// ζ.
    pub damping: Interval,
    /// T \[s\], order 3.
    pub lag_s: Option<Interval>,
}

/// A flight model with two sets of dynamics.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SwitchingModel {
    /// K \[output per input\].
    pub gain: Interval,
    /// c: output at rest at a command of zero.
    pub offset: Interval,
    /// Strokes upwards.
    pub up: StrokeDynamics,
    /// Strokes downwards.
    pub down: StrokeDynamics,
    /// Level of the intervals and covariance of \[K, up: L, ln ω, ln ζ, ln T, down: the same\], widened already,
    /// where bounds hold.
    #[serde(flatten)]
    pub bounds: Bounds<ParameterBounds>,
    /// Orders 2 and 3.
    pub tried: Vec<OrderTried>,
    /// Poles for each direction.
    pub order: usize,
    /// Whether the data reject the order, so that this is an approximation.
    pub approximation: bool,
    /// χ²/dof by which the covariance was multiplied; 1 when the order is not rejected.
    pub inflation: f64,
    /// Largest error of either response \[% of the stroke\].
    pub largest_error_percent: f64,
    /// Smallest and largest commanded change in the record, for which the model is valid.
    pub stroke_sizes: (f64, f64),
    /// Period at which the command is held before it reaches this model \[s\].
    pub hold_period_s: Option<f64>,
}

/// Fits both directions of `split`, found with `model` in `record`. The order, 2 or 3, is the one
/// with the smaller χ² + dim x · ln(rank).
///
/// # Errors
/// One of the responses does not rise, or the record is not the one of the models.
pub fn fit_switching(
    record: &Record,
    model: &Model,
    split: &DirectionModel,
    options: &FlightModelOptions,
) -> Result<SwitchingModel, Error> {
    let fitter = PairFitter::new(record, model)?;
    let guesses = [
        Guess::of_curve(&split.up.value, fitter.timing),
        Guess::of_curve(&split.down.value, fitter.timing),
    ];
    let [Some(up), Some(down)] = guesses else {
        return Err(Error::NoResponse);
    };
    let pairs = |order: usize, second: Option<[LowOrder; 2]>| -> Vec<[LowOrder; 2]> {
        let starts = |guess: &Guess, k: usize| guess.starts(order, second.map(|pair| pair[k]));
        starts(&up, 0)
            .into_iter()
            .zip(starts(&down, 1))
            .map(|(up, down)| [up, down])
            .collect()
    };
    let second = fitter.best(2, &pairs(2, None)).ok_or(Error::NoResponse)?;
    let third = fitter.best(3, &pairs(3, Some(second.transfers)));
    let mut fits = vec![second];
    fits.extend(third);
    let tried = fits.iter().map(|fit| fit.tried).collect();
    let best = simplest(&fits, |fit| fit.tried)
        .next()
        .ok_or(Error::NoResponse)?;
    Ok(best.report(record, split, tried, options.frame_period_s))
}

/// [K, up: L, ln ω, ln ζ, ln T, down: ...].
fn to_parameters(transfers: &[LowOrder; 2]) -> Vec<f64> {
    let gain = f64::midpoint(transfers[0].gain, transfers[1].gain);
    let sides = transfers
        .iter()
        .flat_map(|transfer| transfer.parameters().split_off(1));
    std::iter::once(gain).chain(sides).collect()
}

fn from_parameters(order: usize, x: &[f64]) -> [LowOrder; 2] {
    let each = (x.len() - 1) / 2;
    [0, 1].map(|side| {
        let own = &x[1 + side * each..1 + (side + 1) * each];
        let with_gain: Vec<f64> = std::iter::once(x[0]).chain(own.iter().copied()).collect();
        LowOrder::from_parameters(order, &with_gain)
    })
}

struct PairFitter {
    timing: Timing,
    /// Length of the responses to u and to |du|.
    length: usize,
    /// Of both banks at once. Its step response is g_up followed by g_down.
    projection: Projection,
}

impl PairFitter {
    fn new(record: &Record, model: &Model) -> Result<Self, Error> {
        let basis = model.basis()?;
        let settling = basis.settling();
        let length = LENGTH * settling;
        let second = changes_bank(settling)?;
        let coordinates = Coordinates::new(basis);
        let moments = TwoInputMoments::of_record(&with_history(record, settling)?, length);
        let fit = two_inputs::fit(&moments, &coordinates, &second, NoiseOrder::Auto)
            .ok_or(Error::OneDirection)?;
        let projection = two_inputs::projection(&moments, &coordinates, &second, &fit.ar, length)
            .ok_or(Error::OneDirection)?;
        let (n, n2) = (coordinates.len(), second.frequencies());
        let p = n + n2;
        let covariance = fit.covariance.as_ref().submatrix(0, 0, p, p).to_owned();
        let projection = projection
            .as_ref()
            .submatrix(0, 0, p, 2 * length)
            .to_owned();
        let (step, impulse) = (coordinates.step_map(), second.impulse_map());
        let to_curves = Mat::from_fn(2 * settling, p, |i, k| {
            let (m, sign) = (i % settling, if i < settling { 1.0 } else { -1.0 });
            if k < n {
                step[(m, k)]
            } else {
                sign * impulse[(m, k - n)]
            }
        });
        let parameters = &fit.parameters[..p];
        let curves = (times(&to_curves, parameters), to_curves);
        Ok(Self {
            timing: record.timing(),
            length,
            projection: Projection::new(parameters, &covariance, &projection, curves)
                .ok_or(Error::NoResponse)?,
        })
    }

    /// Response to u, then to |du|, sample by sample.
    fn responses(&self, transfers: &[LowOrder; 2]) -> Vec<f64> {
        let [up, down] = transfers.map(|transfer| {
            transfer.steps((0..self.length).map(|i| self.timing.seconds(i as f64)))
        });
        let mut before = 0.0;
        let mean = up.iter().zip(&down).map(|(up, down)| {
            let g = f64::midpoint(*up, *down);
            g - std::mem::replace(&mut before, g)
        });
        let split = up.iter().zip(&down).map(|(up, down)| (up - down) / 2.0);
        mean.chain(split).collect()
    }

    fn best(&self, order: usize, starts: &[[LowOrder; 2]]) -> Option<FittedPair> {
        let residuals = |x: &[f64]| {
            self.projection
                .residuals(&self.responses(&from_parameters(order, x)))
        };
        let starts = starts.iter().map(|start| {
            let x = to_parameters(start);
            let mut increments = vec![1e-4; x.len()];
            increments[0] = 1e-4 * x[0].abs();
            for delay in [1, 1 + (x.len() - 1) / 2] {
                increments[delay] = 1e-2 * self.timing.sample_period_s;
            }
            (x, increments)
        });
        let minimum = best_minimum(&residuals, starts)?;
        let transfers = from_parameters(order, &minimum.parameters);
        let responses = self.responses(&transfers);
        let error = self.projection.largest_difference(&responses) / transfers[0].gain.abs();
        Some(FittedPair {
            order,
            transfers,
            tried: OrderTried::new(order, &minimum, self.projection.rank(), error)?,
            minimum,
        })
    }
}

struct FittedPair {
    order: usize,
    transfers: [LowOrder; 2],
    minimum: Minimum,
    tried: OrderTried,
}

impl FittedPair {
    fn report(
        &self,
        record: &Record,
        split: &DirectionModel,
        tried: Vec<OrderTried>,
        hold_period_s: Option<f64>,
    ) -> SwitchingModel {
        let estimates = Estimates::new(&self.minimum, &self.tried, split.level);
        let each = (self.minimum.parameters.len() - 1) / 2;
        let stroke = |side: usize| {
            let first = 1 + side * each;
            StrokeDynamics {
                transfer: self.transfers[side],
                delay_s: estimates.interval(first),
                omega_rad_s: estimates.exponential(first + 1),
                damping: estimates.exponential(first + 2),
                lag_s: (self.order == 3).then(|| estimates.exponential(first + 3)),
            }
        };
        SwitchingModel {
            gain: estimates.interval(0),
            offset: split.level_at(0.0),
            up: stroke(0),
            down: stroke(1),
            bounds: estimates.bounds(),
            tried,
            order: self.order,
            approximation: self.tried.is_rejected(),
            inflation: estimates.inflation,
            largest_error_percent: self.tried.largest_error_percent,
            stroke_sizes: stroke_sizes(record),
            hold_period_s,
        }
    }
}

/// Smallest and largest change of the command from one sample to the next.
fn stroke_sizes(record: &Record) -> (f64, f64) {
    record
        .runs()
        .iter()
        .flat_map(|run| run.input().windows(2))
        .map(|pair| (pair[1] - pair[0]).abs())
        .filter(|size| *size > 0.0)
        .fold((f64::INFINITY, 0.0), |(small, large), size| {
            (small.min(size), large.max(size))
        })
}
