//! A model of low order, as documents have it.

use serde::{Deserialize, Serialize};

use super::low_order::LowOrder;
use super::order::OrderTried;
use crate::options::LEVELS;
use crate::results::{Bounds, Interval, ParameterBounds, is_sized};

/// A fitted model of low order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FlightModel {
    /// The transfer function.
    pub transfer: LowOrder,
    /// K \[output per input\]. An interval that says nothing of a parameter is none.
    pub gain: Interval,
    /// L \[s\], from the applied edge of the command. The value is that beside the poles of this order; the interval holds the dead time of servos of up to three poles.
    pub delay_s: Interval,
    /// ω \[rad/s\], orders 2 and 3.
    pub omega_rad_s: Option<Interval>,
    /// ζ, orders 2 and 3.
    pub damping: Option<Interval>,
    /// T \[s\], orders 1 and 3.
    pub lag_s: Option<Interval>,
    /// Level of the intervals and covariance of \[K, L, ln ω, ln ζ, ln T\], of those that the order has, where bounds hold. The covariance is that of
    /// a servo of this order; the intervals hold those of up to three poles, and are wider.
    #[serde(flatten)]
    pub bounds: Bounds<ParameterBounds>,
    /// Number of poles.
    pub order: usize,
    /// Every order that could be fitted. Empty for a fit to a model without bounds, whose noise is not known, and
    /// with it no test of fit.
    pub tried: Vec<OrderTried>,
    /// Whether the data reject the order, so that the model is an approximation.
    pub approximation: bool,
    /// χ²/dof of an order that is rejected, and so by how much more than noise it is off; 1 when it is not.
    pub inflation: f64,
    /// Largest difference of the step response from the identified one \[% of the step\], or of the frequency response in a band \[% of that at its lowest
    /// frequency\]; no error from the servo itself.
    pub largest_error_percent: f64,
    /// Ends of the band whose frequency response it was fitted to, where that is all that is known: below and above, the order is assumed \[Hz\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band_hz: Option<[f64; 2]>,
    /// Period at which the command is held before it reaches this model \[s\].
    pub hold_period_s: Option<f64>,
    /// The result as a sentence.
    pub statement: String,
}

impl FlightModel {
    /// The transfer function of this order, as text of ASCII characters.
    pub fn formula(&self) -> &'static str {
        match self.order {
            1 => "K exp(-L s) / (1 + T s)",
            2 => "K exp(-L s) / (1 + 2 zeta s/w + s^2/w^2)",
            _ => "K exp(-L s) / ((1 + 2 zeta s/w + s^2/w^2) (1 + T s))",
        }
    }

    /// Whether order, parameters and covariance agree and the poles are stable. A fitted model is always
    /// consistent; one that was read from a file must be checked.
    pub fn is_consistent(&self) -> bool {
        let transfer = &self.transfer;
        let oscillates = transfer.oscillator.is_some();
        let order = 2 * usize::from(oscillates) + usize::from(transfer.lag_s.is_some());
        let parameters = transfer.parameters();
        let count = parameters.len();
        let bounds = match &self.bounds {
            Bounds::Valid(bounds) => {
                LEVELS.contains(&bounds.level)
                    && bounds.covariance.len() == count
                    && bounds.covariance.iter().all(|row| is_sized(row, count))
            }
            Bounds::Withdrawn(_) => self
                .intervals()
                .all(|interval| interval.lower.or(interval.upper).is_none()),
        };
        order == self.order
            && (1..=3).contains(&order)
            // The logarithm of what must be above zero is no number otherwise.
            && is_sized(&parameters, count)
            && self.band_hz.is_none_or(|ends| is_sized(&ends, 2))
            && bounds
    }

    /// The same with an interval of the delay that allows for output that was recorded up to `seconds` earlier or later than it
    /// is taken for. The covariance is that of the noise alone.
    #[must_use]
    pub fn with_delay_error(mut self, seconds: f64) -> Self {
        self.delay_s = self.delay_s.widened(seconds);
        self
    }

    fn intervals(&self) -> impl Iterator<Item = Interval> {
        let of_some_orders = [self.omega_rad_s, self.damping, self.lag_s];
        let of_all = [self.gain, self.delay_s];
        of_all
            .into_iter()
            .chain(of_some_orders.into_iter().flatten())
    }
}
