//! What a fit says.

use faer::Mat;

use super::estimates::Estimates;
use super::fitter::{FittedOrder, Fitter};
use super::intervals::{self, Widths};
use super::low_order::LowOrder;
use super::model::FlightModel;
use super::order::OrderTried;
use super::runs_apart::RunsApart;
use crate::numerics::pointwise_critical;
use crate::results::{Bounds, Interval, Reason};
use crate::thresholds::ORDER_REJECTED;

/// Poles of the highest order.
const HIGHEST: usize = 3;

/// What a fit was made under.
pub(super) struct Circumstances {
    /// Level of the bounds of the response.
    pub(super) level: Bounds<f64>,
    /// By how much the standard deviations of the gain, and of all others, are wider than those of even noise.
    pub(super) beyond_even_noise: [f64; 2],
    /// How runs differ, in the parameters.
    pub(super) runs: RunsApart,
    pub(super) band_hz: Option<[f64; 2]>,
    /// Whether the response is one of this motion alone: the servo is not linear.
    pub(super) is_of_motion: bool,
    /// The gain of the identified response, where all of it is known.
    pub(super) gain: Option<f64>,
    pub(super) hold_period_s: Option<f64>,
}

impl Circumstances {
    /// `of_even` noise, with what noise has beside that, and with how runs differ.
    fn covariance(&self, of_even: &Mat<f64>) -> Mat<f64> {
        let factor = |k: usize| self.beyond_even_noise[k.min(1)];
        Mat::from_fn(of_even.nrows(), of_even.ncols(), |i, k| {
            factor(i) * factor(k) * of_even[(i, k)] + self.runs.covariance(i, k)
        })
    }
}

/// The model of the `chosen` order of `fits`.
pub(super) fn of(
    fitter: &Fitter,
    chosen: &FittedOrder,
    fits: &[FittedOrder],
    under: &Circumstances,
) -> FlightModel {
    let order = chosen.order;
    let is_tested = under.level.valid().is_some();
    let is_rejected = chosen.tried.is_rejected();
    // A shape that is not the servo's is fitted best with another gain, and would rest elsewhere.
    let rests = under.gain.filter(|_| !is_tested || is_rejected);
    let transfer = LowOrder {
        gain: rests.unwrap_or(chosen.transfer.gain),
        ..chosen.transfer
    };
    let largest_error_percent = match rests {
        Some(_) => {
            100.0
                * fitter
                    .projection
                    .largest_difference(&fitter.impulse(&transfer))
        }
        None => chosen.tried.largest_error_percent,
    };
    let level = under
        .level
        .unless(is_rejected.then_some(Reason::OrderRejected));
    let ends = level.map(|level| {
        let of_even = pointwise_critical(level);
        let widths = Widths {
            critical: under.beyond_even_noise.map(|factor| factor * of_even),
            lowest_hz: under.band_hz.map(|ends| ends[0]),
            is_of_motion: under.is_of_motion,
        };
        let ends = intervals::of(fitter, chosen, fits, &widths);
        let widened = |(k, ends): (usize, Option<[f64; 2]>)| {
            let x = chosen.minimum.parameters[k];
            under.runs.widened(k, x, ends?, of_even)
        };
        ends.into_iter().enumerate().map(widened).collect()
    });
    let covariance = under.covariance(&chosen.minimum.covariance);
    let estimates = Estimates::new(&chosen.minimum, level, ends, covariance);
    let oscillates = transfer.oscillator.is_some();
    let last = chosen.minimum.parameters.len() - 1;
    let found = FlightModel {
        transfer,
        gain: match rests {
            Some(gain) => Interval::around(gain, None),
            None => estimates.interval(0),
        },
        delay_s: estimates.interval(1),
        omega_rad_s: oscillates.then(|| estimates.exponential(2)),
        damping: oscillates.then(|| estimates.exponential(3)),
        lag_s: transfer.lag_s.map(|_| estimates.exponential(last)),
        bounds: estimates.bounds(),
        order,
        tried: match is_tested {
            true => fits.iter().map(|fit| fit.tried).collect(),
            false => Vec::new(),
        },
        approximation: !is_tested || is_rejected,
        inflation: match is_tested {
            true => chosen.tried.lack_of_fit(),
            false => 1.0,
        },
        largest_error_percent,
        band_hz: under.band_hz,
        hold_period_s: under.hold_period_s,
        statement: String::new(),
    };
    let mut statement = statement(&found, &chosen.tried);
    if under.is_of_motion && found.gain.lower.is_some() {
        statement += " The servo is not linear, and its response may end more slowly than any order does: the interval of the gain holds that with such an end.";
    }
    FlightModel { statement, ..found }
}

fn statement(found: &FlightModel, tried: &OrderTried) -> String {
    let mut text = format!(
        "Order {}: {}; {}.",
        found.order,
        quality(found, tried),
        hold(found)
    );
    if found.bounds.valid().is_some() {
        text += &of_intervals(found);
    }
    if found.approximation && found.transfer.delay_s < 0.0 {
        text += " Its delay is part of the shape, and none of the servo: nothing answers before its command.";
    }
    if found.transfer.has_real_poles_alone() {
        text += " Its three poles are real, and which of them is called the lag is a convention: the two that are closest are w and zeta.";
    }
    text
}

fn quality(found: &FlightModel, tried: &OrderTried) -> String {
    let rejected = match found.tried.is_empty() {
        false => format!(" (p < {ORDER_REJECTED})"),
        true => String::new(),
    };
    let error = found.largest_error_percent;
    match (found.approximation, found.band_hz) {
        (false, None) => not_rejected(tried),
        (false, Some([from, to])) => format!(
            "from {from:.2} to {to:.1} Hz {}; below and above, the order is assumed, and the gain at rest rests on it",
            not_rejected(tried)
        ),
        (true, None) => format!(
            "approximation{rejected}: its step response is at most {error:.1} % of the step from the identified one"
        ),
        (true, Some([from, to])) => format!(
            "approximation{rejected}: from {from:.2} to {to:.1} Hz its frequency response is at most {error:.1} % of that at {from:.2} Hz from the identified \
             one; below and above, nothing shows how far it is off, the gain at rest included"
        ),
    }
}

/// The digits of the table of orders, so that both are one number.
fn not_rejected(tried: &OrderTried) -> String {
    format!(
        "not rejected (lack of fit p = {:.3}; rejected below {ORDER_REJECTED})",
        tried.p
    )
}

fn hold(found: &FlightModel) -> String {
    found.hold_period_s.map_or_else(
        || "the delay counts from the applied edge of the command".to_owned(),
        |period| {
            format!(
                "the hold of the command for {:.1} ms comes before it: a sample and hold, or {:.1} ms more of delay",
                1e3 * period,
                1e3 * period / 2.0
            )
        },
    )
}

/// Which servos the intervals hold, and which there are not.
fn of_intervals(found: &FlightModel) -> String {
    let mut text = String::new();
    if found.order < HIGHEST {
        text += &format!(
            " The recording does not distinguish it from a servo of more poles, up to {HIGHEST}: the delay is that beside the poles of this order, and the intervals hold \
             what each quantity is of with more."
        );
    }
    let all = [
        ("gain", Some(found.gain)),
        ("delay", Some(found.delay_s)),
        ("natural frequency", found.omega_rad_s),
        ("damping ratio", found.damping),
        ("lag", found.lag_s),
    ];
    let is_open = |interval: &Interval| interval.lower.or(interval.upper).is_none();
    let open = all
        .into_iter()
        .filter(|(_, interval)| interval.as_ref().is_some_and(is_open));
    let open: Vec<&str> = open.map(|(name, _)| name).collect();
    if !open.is_empty() {
        text += &format!(
            " There is no interval of {}: other servos of up to {HIGHEST} poles fit as well with any.",
            open.join(", ")
        );
    }
    text
}
