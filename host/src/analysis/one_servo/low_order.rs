//! The low-order model of data.

use crate::data::dataset::Dataset;
use crate::data::model_metadata::ModelMetadata;
use servoid_identification::Identification;
use servoid_identification::diagnostics::TakenOut;
use servoid_identification::flight_model::{self, FlightModel, FlightModelOptions};
use servoid_identification::results::{Advice, Model, Reason};
use std::borrow::Cow;

/// The low-order model or the reason why there is none, where one is wanted: on request, and where the response is known in a band alone, which no simulation has
/// a use for.
pub fn low_order(
    asked: bool,
    data: &Dataset,
    found: &Identification,
) -> Option<Result<FlightModel, String>> {
    let wanted = asked || found.model.band().is_some();
    wanted.then(|| fit(data, found).map_err(|error| error.to_string()))
}

fn fit(
    data: &Dataset,
    found: &Identification,
) -> Result<FlightModel, servoid_identification::Error> {
    let options = FlightModelOptions {
        frame_period_s: ModelMetadata::from(&data.about).pulse_frame_s,
        ..FlightModelOptions::default()
    };
    // Glitches that were taken out of the data for the frequency response are left out here, too.
    let record = match found.model.band() {
        Some(_) => {
            let taken_out = &found.explanation.taken_out;
            Cow::Owned(TakenOut::without_spikes(taken_out, &data.record))
        }
        None => Cow::Borrowed(&data.record),
    };
    let fitted = flight_model::fit(&record, &of_waits_freed(&found.model), &options)?;
    Ok(fitted.with_delay_error(data.about.sensor_delay_uncertainty_s))
}

/// The model, without bounds where it has waits for pulses in its response: no delay with poles is like them, and how far off its figures are, noise does not say.
fn of_waits_freed(model: &Model) -> Cow<'_, Model> {
    match model.advice.iter().any(Advice::is_of_waits) {
        true => Cow::Owned(model.clone().withdrawn_for(Reason::CommandsWait)),
        false => Cow::Borrowed(model),
    }
}
