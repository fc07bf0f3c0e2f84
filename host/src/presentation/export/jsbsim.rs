//! A JSBSim system: hold, delay and poles.

use super::error::ExportError;
use super::model::Export;
use super::statement::low_order_covariance;
use super::text::{XML_STYLE, identifier, number};
use crate::presentation::summary::four_digits;
use crate::presentation::template::fill;
use servoid_identification::flight_model::LowOrder;

/// Steps of a second, unless the simulation is set to others.
const USUAL_HZ: f64 = 120.0;

/// The system.
pub(super) fn write(export: &Export<'_>) -> Result<String, ExportError> {
    let flight = match &export.low_order {
        Ok(flight) => flight,
        Err(reason) => return Err(ExportError::NoLowOrder(reason.clone())),
    };
    let id = identifier(export.name);
    let held = export.frame_s() > 0.0;
    let mut paragraphs = export.statement(held);
    paragraphs.extend(low_order_covariance(flight, &XML_STYLE));
    paragraphs.push(format!(
        "Run it at 500 Hz or more: JSBSim replaces poles by Tustin's rule and has delays of whole steps, so that the position is right to half a step of time. At {USUAL_HZ} Hz, the usual rate of JSBSim, that is {} ms, or {} % of a step of the command where the response is steepest. The position that a step of JSBSim gives is that of its beginning, when its command begins to act. Set the step before the aircraft is loaded: delays are counted out then.",
        four_digits(0.5e3 / USUAL_HZ),
        four_digits(100.0 * 0.5 / USUAL_HZ * steepest(export))
    ));
    let (filters, output) = filters(&flight.transfer, &id);
    let input = if held { "held" } else { "cmd" };
    let frame = [("id", id.clone()), ("frame", number(export.frame_s()))];
    let hold = held.then(|| fill(include_str!("templates/hold.xml"), &frame));
    let values = [
        ("about", XML_STYLE.comment(&paragraphs)),
        ("hold", hold.unwrap_or_default()),
        ("input", format!("fcs/{id}-{input}")),
        ("delay", number(flight.transfer.delay_s.max(0.0))),
        ("filters", filters),
        ("output", output),
        ("gain", number(flight.transfer.gain)),
        ("id", id),
    ];
    Ok(fill(include_str!("templates/servo.xml"), &values))
}

/// The largest slope of the step response, as shares of its final value for each second.
fn steepest(export: &Export<'_>) -> f64 {
    let response = &export.model.step.value;
    let last = response.last().copied().unwrap_or(f64::NAN);
    let slope = |(earlier, later): (&f64, &f64)| ((later - earlier) / last).abs();
    let slopes = response.iter().zip(response.iter().skip(1)).map(slope);
    slopes.fold(0.0, f64::max) / export.model.sample_period_s
}

/// The poles, one component for each factor of the denominator, and the property that they end in.
fn filters(transfer: &LowOrder, id: &str) -> (String, String) {
    let mut parts = Vec::new();
    let mut last = format!("fcs/{id}-aligned");
    let mut add = |template: &str, name: &str, mut values: Vec<(&str, String)>| {
        let output = format!("fcs/{id}-{name}");
        let input = std::mem::replace(&mut last, output);
        values.extend([("id", id.to_owned()), ("input", input)]);
        parts.push(fill(template, &values));
    };
    if let Some(lag) = transfer.lag_s {
        let values = vec![("c1", number(1.0 / lag))];
        add(include_str!("templates/lag.xml"), "lagged", values);
    }
    if let Some(oscillator) = transfer.oscillator {
        let w = oscillator.omega_rad_s;
        let values = vec![
            ("square", number(w * w)),
            ("middle", number(2.0 * oscillator.damping * w)),
        ];
        add(include_str!("templates/oscillator.xml"), "moved", values);
    }
    (parts.join("\n"), last)
}
