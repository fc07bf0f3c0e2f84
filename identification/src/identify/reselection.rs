//! What is done when the errors are not noise: another structure or estimator, by how well it predicts.

use super::collected::Collected;
use super::estimate::Estimate;
use super::{Pipeline, noise_lags};
use crate::data::moments::Moments;
use crate::diagnostics::linearity::{self, Linearity};
use crate::diagnostics::misfit::{self, BothEstimators, MisfitEvidence, ModelErrors, Prediction};
use crate::diagnostics::simulation_error::simulated;
use crate::diagnostics::standstill_noise;
use crate::error::Error;
use crate::estimation::fsf_basis::FsfBasis;
use crate::estimation::gls::{self, GlsOptions};
use crate::estimation::least_squares::RowInformation;
use crate::options::{Frequencies, NoiseOrder, Options};
use crate::selection::settling_time;

/// An estimate, and what its errors had to say about it.
pub(super) struct Considered {
    pub(super) estimate: Estimate,
    /// Of the first estimate, which may have been replaced since.
    pub(super) linearity: Option<Linearity>,
    pub(super) model_errors: Option<ModelErrors>,
}

impl Pipeline<'_> {
    /// The estimate, after what its errors have to say; and what that was, if it was anything.
    pub(super) fn estimate(&mut self) -> Result<Considered, Error> {
        let mut first = Estimate::new(&self.plan, &self.collected.moments, self.record)?;
        let mut linearity = self.linearity_of(&first);
        if let Some(shorter) = self.within_holds(linearity)? {
            linearity = self.linearity_of(&shorter).or(linearity);
            first = shorter;
        }
        let suspect = linearity
            .is_some_and(|found| found.errors_follow_motion() || found.between_runs().is_some());
        let both = BothEstimators::new(&first.information, &first.fit, suspect);
        let sign = both
            .as_ref()
            .and_then(|both| both.sign(linearity, || self.share_seen(&first)));
        let (Some(both), Some(sign)) = (both, sign) else {
            return Ok(Considered {
                estimate: first,
                linearity,
                model_errors: None,
            });
        };
        let candidates = self.rank_by_prediction();
        let adopted = match candidates.first() {
            Some(best) => {
                self.adopt(*best)?;
                Estimate::new(&self.plan, &self.collected.moments, self.record)?
            }
            None => self.better_at_simulation(first, &both)?,
        };
        let errors = self.model_errors(&adopted, &both, candidates, sign);
        Ok(Considered {
            estimate: adopted,
            linearity,
            model_errors: Some(errors),
        })
    }

    fn linearity_of(&self, estimate: &Estimate) -> Option<Linearity> {
        let record = self.record?;
        let (information, fit) = (&estimate.information, &estimate.fit);
        let runs = simulated(record, &information.moments, fit);
        let mut found = linearity::test(&runs, information, fit)?;
        // A response that goes on beyond N leaves errors that are not at rest either.
        let settled = self
            .plan
            .choice
            .as_ref()
            .is_none_or(|choice| choice.settled);
        found.rest = settled
            .then(|| standstill_noise::compare(&runs, record.rest(), information, fit))
            .flatten();
        Some(found)
    }

    /// An estimate that looks no further than the input usually stands still, when a servo that is not
    /// linear seemed to respond for longer. Beyond, the next steps are under way, and what they answer
    /// differently because of this one passes for a late part of its response.
    fn within_holds(&mut self, linearity: Option<Linearity>) -> Result<Option<Estimate>, Error> {
        let Some((record, choice)) = self.record.zip(self.plan.choice.as_ref()) else {
            return Ok(None);
        };
        let hold = misfit::usual_hold(record);
        if !linearity.is_some_and(|found| found.is_rejected()) || choice.settling <= hold {
            return Ok(None);
        }
        let options = Options {
            longest_settling: Some(hold.saturating_sub(usize::from(hold.is_multiple_of(2)))),
            ..*self.options
        };
        // Holds that are too short for any choice, or for the response, limit nothing.
        let Ok((collected, mut plan)) = Collected::from_record(record, &options) else {
            return Ok(None);
        };
        let Some(choice) = plan.choice.as_mut().filter(|choice| choice.settled) else {
            return Ok(None);
        };
        choice.within_holds = true;
        (self.collected, self.plan) = (collected, plan);
        Estimate::new(&self.plan, &self.collected.moments, self.record).map(Some)
    }

    /// The share of the input's steps that the record shows to be followed.
    fn share_seen(&self, estimate: &Estimate) -> f64 {
        let step = estimate
            .coordinates
            .basis
            .step_response(&estimate.fit.theta());
        self.record
            .map_or(1.0, |record| misfit::share_seen(record, &step))
    }

    /// Estimators by how well they predict parts of the record that they have not seen.
    fn rank_by_prediction(&self) -> Vec<Prediction> {
        let Some(record) = self.record else {
            return Vec::new();
        };
        let settling = self.plan.basis.settling();
        let settlings = match &self.plan.choice {
            None => vec![settling],
            Some(choice) => {
                let cap = self.options.longest_settling;
                let longest = settling_time::longest_for_prediction(record, cap);
                misfit::settlings(settling, longest.max(choice.longest))
            }
        };
        let frequencies = match self.options.frequencies {
            Frequencies::Count(count) => Some(count),
            _ => None,
        };
        misfit::rank(record, &settlings, frequencies, self.options.noise_order)
    }

    /// What is taken where no part of the record tells how well an estimator predicts another: the
    /// first one, unless plain least squares simulates the record better. Then the settling time,
    /// which was detected by the same weights, is not to be trusted either, and the longest that the
    /// record supports is taken, if its input determines that.
    fn better_at_simulation(
        &mut self,
        first: Estimate,
        both: &BothEstimators,
    ) -> Result<Estimate, Error> {
        if both.generalised_percent >= both.least_squares_percent {
            return Ok(first);
        }
        let planned = self.plan.basis;
        if let Some(choice) = &self.plan.choice
            && planned.is_complete()
        {
            let longest = FsfBasis::full(choice.longest)?;
            self.take(longest, NoiseOrder::Order(0));
            let longest = Estimate::new(&self.plan, &self.collected.moments, self.record);
            if longest.is_ok() {
                return longest;
            }
        }
        self.take(planned, NoiseOrder::Order(0));
        Estimate::new(&self.plan, &self.collected.moments, self.record)
    }

    /// Makes `best` the plan.
    fn adopt(&mut self, best: Prediction) -> Result<(), Error> {
        let basis = FsfBasis::new(best.settling, best.frequencies)?;
        let order = match best.generalised {
            true => self.plan.order,
            false => NoiseOrder::Order(0),
        };
        self.take(basis, order);
        Ok(())
    }

    /// Makes this bank and this order of the noise the plan.
    fn take(&mut self, basis: FsfBasis, order: NoiseOrder) {
        self.plan.basis = basis;
        self.plan.start = Vec::new();
        self.plan.order = order;
        if let Some(record) = self.record {
            self.collected = Collected::again(record, basis.settling(), order);
        }
    }

    fn model_errors(
        &self,
        adopted: &Estimate,
        before: &BothEstimators,
        candidates: Vec<Prediction>,
        sign: MisfitEvidence,
    ) -> ModelErrors {
        let generalised = self.plan.order != NoiseOrder::Order(0);
        // The other estimator at the structure that was taken; with its own noise model if it has
        // one, which needs further lags.
        let other = if generalised {
            NoiseOrder::Order(0)
        } else {
            self.options.noise_order
        };
        let lags = noise_lags(other);
        let moments = match self.record {
            Some(record) => Moments::of_record(record, self.plan.basis.settling() + lags, lags + 1),
            None => adopted.information.moments.clone(),
        };
        let options = GlsOptions {
            order: other,
            ..GlsOptions::default()
        };
        let coordinates = &adopted.coordinates;
        let other = gls::fit(
            &RowInformation::from_moments(moments),
            coordinates,
            &options,
        );
        ModelErrors {
            least_squares_percent: before.least_squares_percent,
            generalised_percent: before.generalised_percent,
            candidates,
            other_step: other.map_or_else(Vec::new, |fit| {
                coordinates.basis.step_response(&fit.theta())
            }),
            unexcited_above_hz: misfit::unexcited_above_hz(
                &adopted.information.moments,
                coordinates,
            ),
            sign,
        }
    }
}
