//! The linear model and the servo as a machine in one text.

use super::response::first_finding::{first_finding, said_before};
use super::response::linear_model::{Extent, of_model};
use super::servo::linear_beside::is_called_linear;
use super::servo::servo_model::of_servo_model;
use super::servo::servo_sentence::servo_sentence;
use super::wording::layout::wrapped;
use crate::data::model_file::ServoModelDocument;
use crate::data::model_metadata::ModelMetadata;
use crate::data::units::Units;
use servoid_identification::flight_model::FlightModel;
use servoid_identification::results::Model;
use servoid_identification::servo_model::ServoModel;

/// What kind of servo it is as a machine, where that is the answer: a finding that leaves nothing to be said before it stands in the place
/// of the sentence.
#[must_use]
pub fn answer_of_servo_model(
    servo: &ServoModelDocument,
    linear: &Model,
    units: Units<'_>,
) -> Option<String> {
    let speaks = first_finding(linear).is_none();
    speaks.then(|| servo_sentence(&servo.model, linear, units))
}

/// The same behind the finding on a stop, which the servo has and the linear model has not.
fn beside_stop(servo: &ServoModel, linear: &Model, units: Units<'_>) -> Option<String> {
    let of_stop = first_finding(linear)?.is_of_travel_end();
    (of_stop && !servo.stops.are_none()).then(|| servo_sentence(servo, linear, units))
}

/// The results of one identification: the answer first, which is that of the servo model where there is one. Its figures come before those of a linear
/// model that has no bounds where they have intervals. `picture` is one of the step
/// response, and with `statistics` structure, residuals and widths are printed too. `low_order` completes the sentence on a band.
#[must_use]
pub fn of_both_models(
    source: &str,
    model: &Model,
    of: &ModelMetadata,
    servo: Option<&ServoModelDocument>,
    low_order: Option<&FlightModel>,
    (picture, statistics): (&str, bool),
) -> String {
    let units = of.units();
    let answer = servo.and_then(|servo| answer_of_servo_model(servo, model, units));
    let beside_stop = servo.and_then(|servo| beside_stop(&servo.model, model, units));
    let is_behind = said_before(model).is_some() || beside_stop.is_some();
    let sentence = answer.or(beside_stop);
    let sentence = sentence.map_or_else(String::new, |answer| wrapped(&answer, 0) + "\n\n");
    // What is to be said before it stands behind the name of the data.
    let (before, of_servo) = match is_behind {
        true => ("", &*sentence),
        false => (&*sentence, ""),
    };
    let extent = Extent {
        of_servo,
        low_order,
        picture,
        statistics,
        machine_is_not_linear: !is_called_linear(model, servo.map(|servo| &servo.model)),
    };
    let figures = servo.map(|servo| of_servo_model(servo, units, statistics));
    let figures = figures.unwrap_or_default();
    let is_sure = servo.is_some_and(|servo| servo.model.covariance.valid().is_some());
    match is_sure && model.frequency.bounds.valid().is_none() && of_servo.is_empty() {
        true => {
            let linear = of_model(&format!("linear model of {source}"), model, of, extent);
            format!("{before}{source}\n{figures}\n{linear}")
        }
        false => before.to_owned() + &of_model(source, model, of, extent) + &figures,
    }
}
