//! The intervals of the parameters of an order, over all orders that the data do not distinguish from it.
//!
//! An order is taken where a higher one is not needed, and not where it is known to be that of the servo. A servo with one pole more that does not show has another delay:
//! a lag of T that no test sees looks like a delay that is longer by T, with intervals of the lower order that do not hold it. So the interval of a parameter is what
//! [profile](super::profile) it has in a servo of third order, of which the poles beyond the order may be as fast as they want, and which the lower orders are limits of.
//!
//! A slow end that no test sees changes the parameters, too. What it may be is estimated and allowed for as in the bounds of a step response
//! ([`slow_end::allowances`]).
//!
//! The bounds of a servo that is not linear allow for no slow end, and its creep into a dead band is one. So the interval of its gain contains what that is beside an end of each
//! time constant, up to the length of the responses that are held against the estimate ([`slow_end::gains`]).
//!
//! Where an interval says nothing, there is none.

use std::f64::consts::{LN_10, TAU};

use super::fitter::{FittedOrder, Fitter};
use super::levenberg_marquardt::Minimum;
use super::low_order::{LowOrder, Oscillator};
use super::poles::PoleNames;
use super::profile::Profile;
use super::projection::LENGTH;
use super::slow_end;
use crate::numerics::not_negative;

/// Lags that a fit begins with where a lower order was fitted, in its own time constants.
const BEGINNING: f64 = 0.1;

/// The widest interval of a delay that says something, to each side, in what the servo is late by in all.
const WIDEST_DELAY: f64 = 1.0;

/// The widest interval of what is above zero, to each side: a factor of ten.
const WIDEST_LOGARITHM: f64 = LN_10;

/// Minima that are no further apart in χ² are the same.
const SAME: f64 = 0.1;

/// Which parameter the lag is in third order.
const LAG_IN_THIRD: usize = 4;

/// Lower and upper end for each parameter of an order; `None` where the data do not determine it.
pub(super) type Ends = Vec<Option<[f64; 2]>>;

/// What intervals are made with.
pub(super) struct Widths {
    /// Critical values of the gain and of the others, in standard deviations of even noise.
    pub(super) critical: [f64; 2],
    /// The lowest frequency of the band that the response is known in \[Hz\]; `None` where all of it is.
    pub(super) lowest_hz: Option<f64>,
    /// Whether the response is one of this motion alone: the servo is not linear.
    pub(super) is_of_motion: bool,
}

/// The ends for `chosen`, an order of `fits`.
pub(super) fn of(
    fitter: &Fitter,
    chosen: &FittedOrder,
    fits: &[FittedOrder],
    widths: &Widths,
) -> Ends {
    let profiles = Profiles::of(fitter, chosen, fits);
    let by_slow_ends = by_slow_ends(fitter, chosen, widths.lowest_hz);
    let x = &chosen.minimum.parameters;
    let farthest = farthest(&chosen.transfer);
    let ends = |k: usize| {
        let critical = widths.critical[k.min(1)];
        let sd = not_negative(chosen.minimum.covariance[(k, k)]).sqrt();
        let own = match chosen.order {
            3 => [x[k]; 2],
            _ => [x[k] - critical * sd, x[k] + critical * sd],
        };
        let step = sd.clamp(1e-3 * farthest[k], 0.1 * farthest[k]);
        let [lower, upper] = profiles.ends(k, own, step, farthest[k], critical)?;
        let by_end = critical * by_slow_ends[k];
        let ends = [
            x[k] - (x[k] - lower).hypot(by_end),
            x[k] + (upper - x[k]).hypot(by_end),
        ];
        let ends = match k == 0 && widths.is_of_motion {
            true => (gains_with_ends(fitter, chosen, critical)?.into_iter())
                .fold(ends, |[a, b], [lower, upper]| [a.min(lower), b.max(upper)]),
            false => ends,
        };
        let is_narrow = ends.iter().all(|end| (end - x[k]).abs() <= farthest[k]);
        is_narrow.then_some(ends)
    };
    (0..x.len()).map(ends).collect()
}

/// What slow ends that do not show may change of each parameter. In a band those count whose corner is in it: below it the order is assumed. Elsewhere the bounds of the gain
/// allow for them already.
fn by_slow_ends(fitter: &Fitter, chosen: &FittedOrder, lowest_hz: Option<f64>) -> Vec<f64> {
    let settling_s = fitter.settling_s();
    let longest_s = lowest_hz.map_or(settling_s, |hz| settling_s.min(1.0 / (TAU * hz)));
    let ends = fitter.slow_ends(&chosen.transfer, longest_s);
    let mut all = slow_end::allowances(&chosen.minimum, &ends);
    if lowest_hz.is_none() {
        all[0] = 0.0;
    }
    all
}

/// The intervals of the gain beside slow ends of each time constant; `None` where one is not seen at all.
fn gains_with_ends(fitter: &Fitter, chosen: &FittedOrder, critical: f64) -> Option<Vec<[f64; 2]>> {
    // The settling time of a servo that is not linear may be that of its fast part alone.
    let longest_s = LENGTH as f64 * fitter.settling_s();
    let ends = fitter.slow_ends(&chosen.transfer, longest_s);
    slow_end::gains(&chosen.minimum, &ends, critical)
}

/// How far each parameter of `servo` may go before its interval says nothing.
fn farthest(servo: &LowOrder) -> Vec<f64> {
    let of_pair = servo.oscillator.map(|o| 2.0 * o.damping / o.omega_rad_s);
    let late = servo.delay_s.abs() + of_pair.unwrap_or(0.0) + servo.lag_s.unwrap_or(0.0);
    let mut all = vec![WIDEST_LOGARITHM; servo.parameters().len()];
    all[0] = servo.gain.abs();
    all[1] = WIDEST_DELAY * late;
    all
}

/// The profiles in servos of third order.
struct Profiles<'a> {
    /// Around the order that was chosen.
    own: Profile<'a>,
    /// Around the best one, where that is another.
    best: Option<Profile<'a>>,
    order: usize,
}

impl<'a> Profiles<'a> {
    fn of(fitter: &'a Fitter, chosen: &FittedOrder, fits: &[FittedOrder]) -> Self {
        let (names, own, at_own) = match chosen.order {
            3 => {
                let minimum = &chosen.minimum;
                let (x, at) = (minimum.parameters.clone(), minimum.sum_of_squares);
                (PoleNames::AsTheyAre, x, at)
            }
            _ => {
                let (names, start) = as_third(&chosen.transfer);
                let found = fitter.descend(&start, names);
                (names, found.parameters, found.sum_of_squares)
            }
        };
        let third = fits.iter().find(|fit| fit.order == 3);
        let best = third.map(|fit| &fit.minimum);
        let best = best.filter(|best| best.sum_of_squares < at_own - SAME);
        // Not from the smallest of all: a pair of poles that is not there fits some noise at one of many frequencies, and so more of it than two parameters do.
        let least = chosen.minimum.sum_of_squares;
        let profile = |names, minimum| Profile {
            fitter,
            names,
            minimum,
            least,
        };
        let of_best = |best: &Minimum| {
            let x = best.parameters.clone();
            profile(PoleNames::AsTheyAre, x)
        };
        Self {
            best: best.map(of_best),
            own: profile(names, own),
            order: chosen.order,
        }
    }

    /// The ends of parameter `k` of the order, no narrower than `own`: `None` where one is further away than `farthest`.
    fn ends(
        &self,
        k: usize,
        own: [f64; 2],
        step: f64,
        farthest: f64,
        critical: f64,
    ) -> Option<[f64; 2]> {
        let in_third = match (self.order, k) {
            (1, 2) => LAG_IN_THIRD,
            _ => k,
        };
        // Delay and gain are the same whatever the poles are called; the others are not those of poles with other names.
        let best = self.best.as_ref().filter(|_| k < 2);
        let mut ends = own;
        for profile in std::iter::once(&self.own).chain(best) {
            let lower = profile.end(in_third, -step, farthest, critical)?;
            let upper = profile.end(in_third, step, farthest, critical)?;
            ends = [ends[0].min(lower), ends[1].max(upper)];
        }
        Some(ends)
    }
}

/// A servo of first or second order as one of third, with poles that hardly show.
fn as_third(servo: &LowOrder) -> (PoleNames, LowOrder) {
    match (servo.oscillator, servo.lag_s) {
        (None, Some(lag)) => {
            let pair = Oscillator {
                omega_rad_s: 1.0 / (BEGINNING * lag),
                damping: 1.0,
            };
            let third = LowOrder {
                delay_s: (servo.delay_s - 2.0 * BEGINNING * lag).max(servo.delay_s.min(0.0)),
                oscillator: Some(pair),
                ..*servo
            };
            (PoleNames::LagIsSlowest, third)
        }
        (Some(pair), _) => {
            let lag = BEGINNING / (pair.omega_rad_s * pair.damping.max(1.0));
            let third = LowOrder {
                delay_s: (servo.delay_s - lag).max(servo.delay_s.min(0.0)),
                lag_s: Some(lag),
                ..*servo
            };
            (PoleNames::LagIsFastest, third)
        }
        (None, None) => (PoleNames::AsTheyAre, *servo),
    }
}
