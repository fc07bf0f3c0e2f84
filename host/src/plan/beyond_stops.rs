//! Whether a reference goes beyond the stops of the assumed servo.
//!
//! Every reference of one amplitude does then. A servo at its stop has no response to identify, and a band forecast from such strokes is
//! that of shorter ones.

use super::request::PlanRequest;
use crate::presentation::summary::four_digits;
use servoid_simulator::{SERVO_SCALE, ServoKind, SimulationOptions};

/// What to say of a reference that goes beyond a stop of the servo; `None` where it does not, or where the stops are not known.
pub(super) fn in_words(request: &PlanRequest) -> Option<String> {
    let [low, high] = stops_us(request.assumed.simulation.as_ref()?);
    let (lowest, highest) = request.reference.extremes_us();
    let met = [
        (f64::from(lowest) < low).then_some(low),
        (f64::from(highest) > high).then_some(high),
    ];
    // The servo turns by a scale of its own, and the rig file counts degrees by another.
    let degrees = |us: f64| us / request.us_per_degree;
    let met: Vec<String> = met
        .into_iter()
        .flatten()
        .map(|us| format!("{} deg", four_digits(degrees(us))))
        .collect();
    let stops = match &met[..] {
        [] => return None,
        [one] => format!("the stop at {one}"),
        both => format!("the stops at {}", both.join(" and ")),
    };
    let largest = (10.0 * degrees(high.min(-low)).abs() + 1e-9).floor() / 10.0;
    let remedy = match largest > 0.0 && high > 0.0 && low < 0.0 {
        true => {
            format!("take --amplitude {largest} or less, or a table of steps between the stops")
        }
        false => "take a table of steps between the stops".to_owned(),
    };
    Some(format!(
        "The servo runs into {stops} under this reference: 'servoid identify' gives no bounds where it sees that, and elsewhere takes it for a \
         shorter stroke. What follows is of such runs; {remedy}."
    ))
}

/// The pulses at which the servo meets its stops, from the neutral one on, the shorter one first (µs); infinite where it meets none.
fn stops_us(options: &SimulationOptions) -> [f64; 2] {
    let [first, second] = match &options.servo {
        ServoKind::Machine(machine) => {
            let range = machine.servo.range();
            range.map(|command| (command - machine.neutral_command) / machine.command_per_degree)
        }
        _ => {
            let stops = options.conditions.stops;
            stops.map_or([f64::NEG_INFINITY, f64::INFINITY], <[f64; 2]>::from)
        }
    };
    let us = |degrees: f64| degrees * SERVO_SCALE.us_per_degree;
    [us(first.min(second)), us(first.max(second))]
}
