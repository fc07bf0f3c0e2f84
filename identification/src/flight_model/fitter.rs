//! The fit of one order.

use super::levenberg_marquardt::{Descent, Minimum, best_minimum, descend};
use super::low_order::LowOrder;
use super::order::OrderTried;
use super::poles::PoleNames;
use super::projection::{LENGTH, Projection};
use super::slow_end;
use crate::data::Timing;

/// Fits orders to an estimate.
pub(super) struct Fitter {
    pub(super) projection: Projection,
    pub(super) timing: Timing,
}

/// A fitted order.
pub(super) struct FittedOrder {
    pub(super) order: usize,
    pub(super) transfer: LowOrder,
    pub(super) minimum: Minimum,
    pub(super) tried: OrderTried,
}

/// A pole that is so many times as fast as the samples shows in none of them; a fit that would do without it drives it to any size.
const HIDDEN: f64 = 100.0;

/// Rows by which an output may be early, for columns that were written one after the other.
const EARLIEST: f64 = 2.0;

impl FittedOrder {
    /// Whether one of its poles does not show in samples that are `period_s` apart.
    pub(super) fn has_hidden_pole(&self, period_s: f64) -> bool {
        self.transfer.fastest_pole() * period_s > HIDDEN
    }
}

impl Fitter {
    /// Increments of the response from sample to sample.
    pub(super) fn impulse(&self, transfer: &LowOrder) -> Vec<f64> {
        let (first_s, period_s) = (self.timing.seconds(0.0), self.timing.sample_period_s);
        let mut before = 0.0;
        transfer
            .steps_every(first_s, period_s, self.projection.length())
            .into_iter()
            .map(|g| g - std::mem::replace(&mut before, g))
            .collect()
    }

    /// What such a servo leaves of the whitened estimate. No end of one that rings faster than samples show, which looks like another that rings slowly, and of one that
    /// answers before its command: a servo with a zero, which no order has, would look like it.
    pub(super) fn residuals(&self, transfer: &LowOrder) -> Vec<f64> {
        let period_s = self.timing.sample_period_s;
        let is_early = transfer.delay_s < -EARLIEST * period_s;
        match is_early || transfer.rings_unseen(period_s) {
            true => vec![f64::INFINITY; self.projection.rank()],
            false => self.projection.residuals(&self.impulse(transfer)),
        }
    }

    /// Half steps of derivatives by the parameters of `transfer`.
    pub(super) fn increments(&self, transfer: &LowOrder) -> Vec<f64> {
        let mut increments = vec![1e-4; transfer.parameters().len()];
        increments[0] = 1e-4 * transfer.gain.abs();
        increments[1] = 1e-2 * self.timing.sample_period_s;
        increments
    }

    /// The best minimum of one order.
    pub(super) fn best(&self, order: usize, starts: &[LowOrder]) -> Option<FittedOrder> {
        let residuals = |x: &[f64]| self.residuals(&LowOrder::from_parameters(order, x));
        let from = |starts: &[LowOrder]| {
            let starts = starts.iter();
            let starts = starts.map(|start| (start.parameters(), self.increments(start)));
            best_minimum(&residuals, starts)
        };
        let minimum = from(starts)?;
        // The same poles have their names by the convention.
        let found = LowOrder::from_parameters(order, &minimum.parameters);
        let minimum = match found.with_closest_pair() {
            named if named == found => minimum,
            named => from(&[named]).unwrap_or(minimum),
        };
        let transfer = LowOrder::from_parameters(order, &minimum.parameters);
        let impulse = self.impulse(&transfer);
        let error = self.projection.largest_difference(&impulse);
        let tried = OrderTried::new(order, &minimum, self.projection.rank(), error)?;
        let slow_end_p = (self.projection.is_of_band()).then(|| {
            slow_end::probability(&minimum, &self.slow_ends(&transfer, self.settling_s()))
        });
        Some(FittedOrder {
            order,
            tried: match slow_end_p {
                Some(p) => tried.with_second_test(p),
                None => tried,
            },
            transfer,
            minimum,
        })
    }

    /// The way down from `start`, a servo of third order whose poles keep these names.
    pub(super) fn descend(&self, start: &LowOrder, names: PoleNames) -> Descent {
        let residuals = |x: &[f64]| self.residuals(&names.of(LowOrder::from_parameters(3, x)));
        let increments = self.increments(start);
        descend(&residuals, &start.parameters(), &increments, 1e-6)
    }

    /// The settling time of the estimate \[s\].
    pub(super) fn settling_s(&self) -> f64 {
        let settling = self.projection.length() / LENGTH;
        self.timing.seconds(settling as f64)
    }

    /// What slow ends that are as large as the whole response of `transfer` would add to the whitened estimate, one of each time constant up to this one.
    pub(super) fn slow_ends(&self, transfer: &LowOrder, longest_s: f64) -> Vec<Vec<f64>> {
        let ends = slow_end::time_constants(transfer, longest_s).into_iter();
        let end = |time_constant| {
            let end = LowOrder {
                oscillator: None,
                lag_s: Some(time_constant),
                ..*transfer
            };
            self.projection.projected(&self.impulse(&end))
        };
        ends.map(end).collect()
    }
}
