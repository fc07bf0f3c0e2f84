//! The runs of a record, each identified on its own.

use servoid_identification::results::Model;
use servoid_identification::{Identification, Options, Record, Settling, identify};

/// Most runs that are identified one by one.
const MOST_RUNS_ALONE: usize = 10;

/// Each run of a record identified on its own, with the settling time that all of them have together.
/// Nothing where there is one run, or one is too short for a model.
#[must_use]
pub(super) fn runs_alone(record: &Record, found: &Identification) -> Vec<Model> {
    let runs = record.runs();
    if !(2..=MOST_RUNS_ALONE).contains(&runs.len()) {
        return Vec::new();
    }
    let default = Options::default();
    let options = Options {
        settling: Settling::Samples(found.model.structure.settling_samples),
        level: found.model.level().into_valid().unwrap_or(default.level),
        ..default
    };
    let alone = |run: &servoid_identification::Run| {
        let record = Record::new(record.sample_period_s(), vec![run.clone()])?;
        identify(
            &record.with_sample_phase(found.model.sample_phase_s),
            &options,
        )
    };
    let models: Result<Vec<Model>, _> = runs.iter().map(alone).collect();
    models.unwrap_or_default()
}
