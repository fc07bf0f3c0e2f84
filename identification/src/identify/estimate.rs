//! The fit, through moments if they are accurate enough, else through QR.

use super::plan::Plan;
use crate::data::{Moments, Record};
use crate::error::Error;
use crate::estimation::{
    Coordinates, FIRST_ORDER, GlsFit, GlsOptions, NestedBanks, RowInformation, is_accurate,
    triangular_factor,
};

/// Change of the noise model that counts as rest, in standard deviations that a coefficient has
/// at least, 1/sqrt(rows).
const REST: f64 = 1e-3;

/// A fit and what it was made from.
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
        let options = GlsOptions {
            order: plan.order,
            start: plan.start.clone(),
            tolerance: REST / (moments.rows() as f64).sqrt(),
            ..GlsOptions::default()
        };
        let information = RowInformation::from_moments(moments.clone());
        let fast = GlsFit::of(&information, &coordinates, &options)
            .filter(|fit| record.is_none() || is_accurate(&information, fit));
        if let Some(fit) = fast {
            return Ok(Self {
                coordinates,
                information,
                fit,
            });
        }
        let Some(record) = record else {
            return Err(not_excited(plan, moments));
        };
        let information = RowInformation::from_factor(moments, triangular_factor(record, moments));
        let options = GlsOptions {
            start: Vec::new(),
            ..options
        };
        match GlsFit::of(&information, &coordinates, &options) {
            Some(fit) => Ok(Self {
                coordinates,
                information,
                fit,
            }),
            None => Err(not_excited(plan, moments)),
        }
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
