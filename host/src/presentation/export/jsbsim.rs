//! A JSBSim system: hold, delay and poles.

use super::emulation::{FirstOrder, SecondOrder};
use super::error::ExportError;
use super::jsbsim_delay::{DelayOfParts, aligned};
use super::model::{Export, RestAtNeutral};
use super::statement::{InFile, low_order_covariance};
use super::text::{XML_STYLE, identifier, number};
use crate::data::units::Units;
use crate::presentation::summary::four_digits;
use crate::presentation::template::fill;
use servoid_identification::flight_model::{FlightModel, LowOrder};
use servoid_identification::servo_model::ServoModel;

/// To which time command and position belong.
pub(super) const TIME: &str = "Set a command at the time t, then run a step: it acts from t on. The position that is read behind this step is that at t too, although simulation/sim-time-sec is one step farther by then.";

/// What a command that is no number does.
pub(super) const NO_NUMBER: &str = "Numbers: a command that is no number leaves no position from then on, as the parts of JSBSim keep it. Check it before you set it.";

/// Pulses behind which the response is computed: each may begin at another part of a step.
const PULSES: u32 = 12;

/// Steps of a second: unless the simulation is set to others, and those that the file advises.
const RATES_HZ: [f64; 2] = [120.0, 500.0];

/// The system.
pub(super) fn write(export: &Export<'_>) -> Result<String, ExportError> {
    let flight = match &export.low_order {
        Ok(flight) => flight,
        Err(reason) => {
            return Err(ExportError::NoLowOrder {
                reason: reason.clone(),
                servo_model: export.servo_model.is_some_and(ServoModel::predicts),
            });
        }
    };
    let id = identifier(export.name);
    let held = export.frame_s() > 0.0;
    let mut paragraphs = export.statement(InFile {
        hold: held,
        offset: true,
    });
    paragraphs.extend(low_order_covariance(flight, &XML_STYLE));
    let [usual, advised] =
        RATES_HZ.map(|hz| four_digits(difference_percent(export, flight, 1.0 / hz)));
    let [usual_hz, advised_hz] = RATES_HZ;
    paragraphs.push(format!(
        "Run it at {advised_hz} Hz or more: JSBSim replaces poles by Tustin's rule. Behind a step of the command the position is that of the low-order model to {usual} % at {usual_hz} Hz, the usual rate of JSBSim, and to {advised} % at {advised_hz} Hz; the delay is right to a part of a step. {TIME} Set the step before the aircraft is loaded: delays are counted out then."
    ));
    let RestAtNeutral {
        command: centre,
        position: at_centre,
    } = export.rest_at_neutral();
    paragraphs.push(start(export.metadata.units(), centre, at_centre));
    paragraphs.push(NO_NUMBER.to_owned());
    let delay_s = flight.transfer.delay_s.max(0.0);
    let (filters, output) = filters(&flight.transfer, &id);
    let (hold, input) = before_servo(&id, centre, export.frame_s());
    let values = [
        ("about", XML_STYLE.comment(&paragraphs)),
        ("hold", hold.join("\n")),
        ("switch", hold_switch(&id, export.frame_s())),
        ("input", format!("fcs/{id}-{input}")),
        ("centre", number(centre)),
        ("offset", number(at_centre)),
        (
            "aligned",
            aligned(&id, &format!("fcs/{id}-delayed"), delay_s),
        ),
        ("delay", number(delay_s)),
        ("filters", filters),
        ("output", output),
        ("gain", number(flight.transfer.gain)),
        ("id", id),
    ];
    Ok(fill(include_str!("templates/servo.xml"), &values))
}

/// Where the system begins: its parts begin at 0, and the command is counted from the neutral one.
pub(super) fn start(units: Units<'_>, centre: f64, position: f64) -> String {
    let of = |unit: Option<&str>| unit.map(|unit| format!(" {unit}")).unwrap_or_default();
    format!(
        "Start: the system begins at rest under the command {}{}, where the position is {}{}, and goes from there to its first command.",
        number(centre),
        of(units.input),
        four_digits(position),
        of(units.output)
    )
}

/// What comes before the servo, and the end of the name of the property behind it: the command from `centre` on, held for a frame where there is
/// one. Held it is counted from there already, so that it is the neutral one until the first frame.
pub(super) fn before_servo(id: &str, centre: f64, frame_s: f64) -> (Vec<String>, &'static str) {
    let (mut parts, mut input) = (Vec::new(), "cmd");
    let mut add = |template: &str, name: &'static str| {
        let values = [
            ("id", id.to_owned()),
            ("centre", number(centre)),
            ("bias", number(-centre)),
            ("frame", number(frame_s)),
            ("input", std::mem::replace(&mut input, name).to_owned()),
        ];
        parts.push(fill(template, &values));
    };
    if centre != 0.0 {
        add(include_str!("templates/centred.xml"), "centred");
    }
    if frame_s > 0.0 {
        add(include_str!("templates/hold.xml"), "held");
    }
    (parts, input)
}

/// The property that takes the hold of a frame out, where there is one.
pub(super) fn hold_switch(id: &str, frame_s: f64) -> String {
    match frame_s > 0.0 {
        true => format!("\n  <property value=\"1\">fcs/{id}-hold</property>"),
        false => String::new(),
    }
}

/// The largest distance of the system from the low-order model behind a step of the command \[% of the step\], in steps of this length.
fn difference_percent(export: &Export<'_>, flight: &FlightModel, step_s: f64) -> f64 {
    let model = export.model;
    let of_band = model.band_estimate.as_ref();
    let settling = of_band.map_or(model.structure.settling_samples, |found| {
        found.settling_samples
    });
    let count = settling as f64 * model.sample_period_s / step_s;
    // No program has a delay below zero.
    let exact = LowOrder {
        gain: 1.0,
        delay_s: flight.transfer.delay_s.max(0.0),
        ..flight.transfer
    };
    let off = |part: f64| {
        let response = step_response(&exact, step_s, part).take(count as usize + 1);
        let apart = response
            .enumerate()
            .map(|(step, position)| (position - exact.step((step as f64 - part) * step_s)).abs());
        apart.fold(0.0, f64::max)
    };
    let parts = (0..PULSES).map(|pulse| (f64::from(pulse) * export.frame_s() / step_s).fract());
    100.0 * parts.map(off).fold(0.0, f64::max)
}

/// The position at the beginning of each step behind a command of 1 that begins at this `part` of the first one, as JSBSim computes it.
fn step_response(transfer: &LowOrder, step_s: f64, part: f64) -> impl Iterator<Item = f64> + use<> {
    let mut late = DelayOfParts::new(transfer.delay_s, step_s, 0.0);
    let mut lag = transfer.lag_s.map(|lag| FirstOrder::new(lag, step_s));
    let mut oscillator = transfer.oscillator.map(|found| {
        let w = found.omega_rad_s;
        SecondOrder::new(w * w, 2.0 * found.damping * w, step_s, 0.0)
    });
    let commands = std::iter::once(1.0 - part).chain(std::iter::repeat(1.0));
    commands.map(move |command| {
        let delayed = late.pass(command);
        let lagged = lag.as_mut().map_or(delayed, |lag| lag.pass(delayed));
        oscillator
            .as_mut()
            .map_or(lagged, |filter| filter.pass(lagged))
    })
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
