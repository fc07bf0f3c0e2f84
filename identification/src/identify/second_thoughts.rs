//! What is done when the errors are not noise: another structure or estimator, by how well it predicts.

use super::collected::Collected;
use super::estimate::Estimate;
use super::{Pipeline, noise_lags};
use crate::basis::Basis;
use crate::error::Error;
use crate::gls::{self, GlsOptions};
use crate::model_error::{self, BothEstimators, ModelErrors, Prediction};
use crate::moments::Moments;
use crate::normal::Information;
use crate::options::{Frequencies, NoiseOrder};
use crate::structure;

impl Pipeline<'_> {
    /// The estimate, after what its errors have to say; and what that was, if it was anything.
    pub(super) fn estimate(&mut self) -> Result<(Estimate, Option<ModelErrors>), Error> {
        let first = Estimate::new(&self.plan, &self.collected.moments, self.record)?;
        let both = BothEstimators::new(&first.information, &first.coordinates, &first.fit);
        let Some(both) = both.filter(BothEstimators::errors_are_not_noise) else {
            return Ok((first, None));
        };
        let candidates = self.rank_by_prediction();
        let adopted = match candidates.first() {
            Some(best) => {
                self.adopt(*best)?;
                Estimate::new(&self.plan, &self.collected.moments, self.record)?
            }
            None => first,
        };
        let errors = self.model_errors(&adopted, &both, candidates);
        Ok((adopted, Some(errors)))
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
                let longest = structure::longest_for_prediction(record, cap);
                model_error::settlings(settling, longest.max(choice.longest))
            }
        };
        let frequencies = match self.options.frequencies {
            Frequencies::Count(count) => Some(count),
            _ => None,
        };
        model_error::rank(record, &settlings, frequencies, self.options.noise_order)
    }

    /// Makes `best` the plan.
    fn adopt(&mut self, best: Prediction) -> Result<(), Error> {
        self.plan.basis = Basis::new(best.settling, best.frequencies)?;
        self.plan.start = Vec::new();
        if !best.generalised {
            self.plan.order = NoiseOrder::Order(0);
        }
        if let Some(record) = self.record {
            self.collected = Collected::again(record, best.settling, self.plan.order);
        }
        Ok(())
    }

    fn model_errors(
        &self,
        adopted: &Estimate,
        before: &BothEstimators,
        candidates: Vec<Prediction>,
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
        let other = gls::fit(&Information::from_moments(moments), coordinates, &options);
        ModelErrors {
            least_squares_percent: before.least_squares_percent,
            generalised_percent: before.generalised_percent,
            candidates,
            other_step: other.map_or_else(Vec::new, |fit| {
                coordinates.basis.step_response(&fit.theta())
            }),
            untold_from_hz: model_error::untold_from_hz(&adopted.information.moments, coordinates),
        }
    }
}
