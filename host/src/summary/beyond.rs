//! What goes beyond the linear response, as text for a terminal: low-order models, strokes apart, limits.

use super::probability;
use servoid_identification::direction::{DirectionModel, Symmetry};
use servoid_identification::flight_model::FlightModel;
use servoid_identification::limits::Limits;
use servoid_identification::metrics::Interval;
use std::fmt::Write;

/// A low-order model for a flight simulation.
#[must_use]
pub fn of_flight_model(flight: &FlightModel) -> String {
    let mut text =
        String::from("\nlow-order model: K e^(-Ls) / ((1 + 2 zeta s/w + s^2/w^2) (1 + Ts))\n");
    let level = super::percent(flight.level);
    let rows = [
        ("gain K", "", 1.0, Some(flight.gain)),
        ("delay L", "ms", 1e3, Some(flight.delay_s)),
        ("natural frequency w", "rad/s", 1.0, flight.omega_rad_s),
        ("damping zeta", "", 1.0, flight.damping),
        ("lag T", "ms", 1e3, flight.lag_s),
    ];
    let _infallible = writeln!(
        text,
        "  {:22} {:>10} {:5} {level} % interval",
        "", "value", ""
    );
    for (name, unit, scale, interval) in rows {
        let Some(Interval {
            value: Some(value),
            lower,
            upper,
        }) = interval
        else {
            continue;
        };
        let number =
            |bound: Option<f64>| bound.map_or("-".to_owned(), |b| format!("{:.4}", b * scale));
        let _infallible = writeln!(
            text,
            "  {name:22} {:>10.4} {unit:5} {} .. {}",
            value * scale,
            number(lower),
            number(upper)
        );
    }
    for tried in &flight.tried {
        let mark = if tried.order == flight.order {
            "  <- chosen"
        } else {
            ""
        };
        let _infallible = writeln!(
            text,
            "  order {}: chi2 {:.1} of {} degrees of freedom, lack of fit {}, largest error {:.2} % of the step{mark}",
            tried.order,
            tried.chi_square,
            tried.degrees_of_freedom,
            probability(Some(tried.p)),
            tried.largest_error_percent
        );
    }
    text + "  " + &flight.statement + "\n"
}

/// Up and down strokes apart, and the limits of a linear model; `unit` is that of input and output.
#[must_use]
pub fn of_limits(
    limits: &Limits,
    directions: Option<&DirectionModel>,
    unit: Option<&str>,
) -> String {
    let units = unit.map_or_else(
        || "positions in the recording's unit, speeds in that unit per second".to_owned(),
        |unit| format!("positions in {unit}, speeds in {unit}/s"),
    );
    let mut text = format!("\nlimits of a linear model ({units})\n");
    let of_strokes = directions.map_or_else(
        || "Up and down strokes cannot be told apart in this recording.".to_owned(),
        |directions| of_symmetry(&directions.symmetry),
    );
    let _infallible = writeln!(text, "  {of_strokes}");
    for statement in limits.statements() {
        let _infallible = writeln!(text, "  {statement}");
    }
    text
}

/// Whether up and down strokes differ, and whether by enough to matter.
fn of_symmetry(symmetry: &Symmetry) -> String {
    let p = probability(Some(symmetry.p));
    let largest = format!(
        "{:.1} % of the stroke, {:.0} ms after the edge",
        100.0 * symmetry.largest_difference.abs(),
        1e3 * symmetry.at_s
    );
    let significant = symmetry.largest_deviation > symmetry.critical_value;
    if symmetry.asymmetric {
        format!("Up and down strokes differ ({p}): by up to {largest}.")
    } else if significant {
        format!(
            "Up and down strokes differ ({p}), but by so little that they count as alike: {largest}, at the most."
        )
    } else {
        format!(
            "Up and down strokes show no clear difference: the largest one, {largest}, may be noise ({p})."
        )
    }
}
