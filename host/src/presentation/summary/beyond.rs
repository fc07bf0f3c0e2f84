//! What goes beyond the linear response, as text for a terminal: low-order models, strokes apart, limits.

use super::numbers::{percent, probability};
use servoid_identification::flight_model::FlightModel;
use servoid_identification::nonlinear::{DirectionModel, Limits, Symmetry};
use servoid_identification::results::{Bounds, Interval};
use std::fmt::Write;

/// A low-order model for a flight simulation.
#[must_use]
pub fn of_flight_model(flight: &FlightModel) -> String {
    let mut text =
        String::from("\nlow-order model: K e^(-Ls) / ((1 + 2 zeta s/w + s^2/w^2) (1 + Ts))\n");
    let interval = match &flight.bounds {
        Bounds::Valid(bounds) => format!("{} % interval", percent(bounds.level)),
        Bounds::Withdrawn(_) => "no bounds".to_owned(),
    };
    let rows = [
        ("gain K", "", 1.0, Some(flight.gain)),
        ("delay L", "ms", 1e3, Some(flight.delay_s)),
        ("natural frequency w", "rad/s", 1.0, flight.omega_rad_s),
        ("damping zeta", "", 1.0, flight.damping),
        ("lag T", "ms", 1e3, flight.lag_s),
    ];
    let _infallible = writeln!(text, "  {:22} {:>10} {:5} {interval}", "", "value", "");
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
        let bounds = match (lower, upper) {
            (None, None) => String::new(),
            _ => format!("{} .. {}", number(lower), number(upper)),
        };
        let line = format!("  {name:22} {:>10.4} {unit:5} {bounds}", value * scale);
        let _infallible = writeln!(text, "{}", line.trim_end());
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

/// Probability below which noise does not explain differences.
const CHANCE: f64 = 0.001;

/// Whether up and down strokes differ, and whether by enough to matter.
fn of_symmetry(symmetry: &Symmetry) -> String {
    let p = probability(Some(symmetry.p));
    let largest = format!(
        "{:.1} % of the stroke, {:.0} ms after the edge",
        100.0 * symmetry.largest_difference.abs(),
        1e3 * symmetry.at_s
    );
    // The clearest difference need not be the largest one.
    let clearest = format!(
        "{:.1} standard deviations where they differ most clearly, and noise alone comes to {:.1}",
        symmetry.largest_deviation, symmetry.critical_value
    );
    if symmetry.asymmetric {
        return format!("Up and down strokes differ ({p}): by up to {largest}.");
    }
    if symmetry.largest_deviation > symmetry.critical_value {
        return format!(
            "Up and down strokes differ ({clearest}), but by so little that they count as alike: by {largest}, at the most."
        );
    }
    let beginning =
        format!("Up and down strokes show no clear difference: up to {largest}, but {clearest}.");
    if symmetry.p < CHANCE {
        // Many small differences can be more than noise where no single one is.
        return format!(
            "{beginning} Taken together the differences are more than noise ({p}), as other errors of a linear model leave them."
        );
    }
    beginning
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_said_of_the_strokes_does_not_contradict_itself() {
        let said = |p: f64, largest_deviation: f64, largest_difference: f64| {
            of_symmetry(&Symmetry {
                p,
                largest_deviation,
                critical_value: 4.0,
                asymmetric: largest_deviation > 4.0 && largest_difference > 0.02,
                largest_difference,
                at_s: 0.05,
            })
        };
        assert!(
            said(1e-9, 30.0, 0.3)
                .starts_with("Up and down strokes differ (p < 0.001): by up to 30.0 %")
        );
        let small = said(1e-9, 6.0, 0.008);
        assert!(
            small.contains("differ (6.0 standard deviations") && small.contains("at the most"),
            "{small}"
        );
        let unclear = said(1e-9, 3.0, 0.27);
        assert!(
            unclear.contains("no clear difference") && unclear.contains("Taken together"),
            "{unclear}"
        );
        assert!(!said(0.3, 2.0, 0.01).contains("(p "));
    }
}
