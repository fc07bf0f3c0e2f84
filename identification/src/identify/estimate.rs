//! The fit by a plan.

use super::plan::Plan;
use crate::data::{Moments, Quantisation, Record, sensor_step};
use crate::diagnostics::square;
use crate::error::Error;
use crate::estimation::{
    Coordinates, FIRST_ORDER, GlsFit, NestedBanks, RowInformation, accurate_fit,
};

/// A fit and what it was made from.
#[derive(Clone)]
pub(super) struct Estimate {
    pub(super) coordinates: Coordinates,
    pub(super) information: RowInformation,
    pub(super) fit: GlsFit,
}

impl Estimate {
    /// By the plan, from moments; with the record at hand, QR can take over.
    pub(super) fn new(
        plan: &Plan,
        moments: &Moments,
        record: Option<&Record>,
    ) -> Result<Self, Error> {
        let coordinates = Coordinates::new(plan.basis);
        let found = accurate_fit(moments, record, &coordinates, plan.order, &plan.start);
        let (information, fit) = found.ok_or_else(|| not_excited(plan, moments))?;
        Ok(Self {
            coordinates,
            information,
            fit,
        })
    }

    /// Root mean square of the errors of the simulation, over the rows \[output\].
    pub(super) fn rmse(&self) -> f64 {
        (square(&self.information, &self.fit) / self.information.rows() as f64).sqrt()
    }

    /// The steps of the sensor, where they are larger than these errors.
    pub(super) fn steps_of_sensor(&self, record: &Record) -> Option<Quantisation> {
        // Most records have none, and the errors cost more than to see that.
        sensor_step(record)?;
        Quantisation::of(record, self.rmse())
    }

    /// The largest error of a level that they leave; 0 where noise is larger \[output\].
    pub(super) fn level_error(&self, record: &Record) -> f64 {
        let found = self.steps_of_sensor(record);
        found.map_or(0.0, |found| found.level_error())
    }
}

fn not_excited(plan: &Plan, moments: &Moments) -> Error {
    let basis = plan.basis;
    let scan = NestedBanks::scan(moments, basis.settling(), &[], FIRST_ORDER);
    let excited = scan.map_or(1, |scan| scan.excited());
    let highest = (excited / 2) as f64;
    let highest_hz = highest / (basis.settling() as f64 * moments.sample_period_s());
    Error::NotExcited {
        asked: basis.frequencies(),
        excited,
        highest_hz,
    }
}
