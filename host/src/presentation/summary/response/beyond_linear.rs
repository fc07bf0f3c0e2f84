//! Results beyond the linear response, as text for a terminal: low-order models, strokes by direction, limits.

use crate::presentation::summary::wording::layout::wrapped;
use crate::presentation::summary::wording::numbers::{
    digits, digits_beside, head_of_bounds, probability,
};
use servoid_identification::flight_model::FlightModel;
use servoid_identification::nonlinear::{DirectionModel, Limits, RateVerdict, Symmetry};
use servoid_identification::results::{Bounds, Interval};
use servoid_identification::thresholds::ASYMMETRY_FALSE_ALARM;
use std::f64::consts::TAU;

/// Said of intervals of a servo that is not linear.
const OF_DESCRIPTION: &str = "The servo is not linear: these intervals are those of the linear description of this recording. Its own dead time and bandwidth are in the \
    servo model.";

/// A low-order model for a flight simulation, of a servo that is `linear` or not.
#[must_use]
pub fn of_flight_model(flight: &FlightModel, linear: bool) -> String {
    let rows = [
        ("gain K", "", 1.0, Some(flight.gain)),
        ("delay L", "ms", 1e3, Some(flight.delay_s)),
        ("natural frequency w", "rad/s", 1.0, flight.omega_rad_s),
        ("damping zeta", "", 1.0, flight.damping),
        ("lag T", "ms", 1e3, flight.lag_s),
    ];
    let head = head_of_bounds(flight.bounds.as_ref().map(|bounds| bounds.level));
    let mut text = format!(
        "\nlow-order model: {}\n  {:22} {:>10} {:5} {head}\n",
        flight.formula(),
        "",
        "value",
        ""
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
        let width = interval.and_then(|of| Some(scale * of.width()?));
        let number = |bound: f64| digits_beside(scale * bound, 4, width);
        let end = |bound: Option<f64>| bound.map_or("-".to_owned(), number);
        let bounds = match (lower, upper) {
            (None, None) => String::new(),
            (Some(lower), None) => format!("{} or more", number(lower)),
            _ => format!("{} .. {}", end(lower), end(upper)),
        };
        let hertz = match unit {
            "rad/s" => format!("  = {:.3} Hz", value / TAU),
            _ => String::new(),
        };
        let line = format!("  {name:22} {:>10} {unit:5} {bounds}{hertz}", number(value));
        text += &format!("{}\n", line.trim_end());
    }
    let of_error = match flight.band_hz {
        Some([from, _]) => format!("of the response at {} Hz", digits(from, 2)),
        None => "of the step".to_owned(),
    };
    for tried in &flight.tried {
        let chosen = tried.order == flight.order;
        text += &format!(
            "  order {}: chi2 {:.1} of {} degrees of freedom, lack of fit {}, at most {:.2} % {of_error} from the identified response{}\n",
            tried.order,
            tried.chi_square,
            tried.degrees_of_freedom,
            probability(Some(tried.p)),
            tried.largest_error_percent,
            if chosen { "  <- chosen" } else { "" }
        );
    }
    let doubt = match linear || flight.bounds.valid().is_none() {
        true => String::new(),
        false => format!("  {}\n", wrapped(OF_DESCRIPTION, 2)),
    };
    let at_any_sample = match flight.approximation && flight.band_hz.is_none() {
        true => format!("  {}\n", wrapped(AT_ANY_SAMPLE, 2)),
        false => String::new(),
    };
    text + "  " + &flight.statement + "\n" + &at_any_sample + &doubt
}

/// Said of an approximation, of which a file has a larger figure.
const AT_ANY_SAMPLE: &str = "These distances are counted by what the recording determines of a response. A file states the largest at any sample, which may be larger.";

/// Said where strokes go in one direction.
pub(crate) const STROKES_OF_ONE_DIRECTION: &str =
    "Up and down strokes cannot be compared in this recording.";

/// How up and down strokes compare; there are no `directions` where the recording has strokes in one alone.
#[must_use]
pub fn of_strokes(limits: &Limits, directions: Option<&DirectionModel>) -> String {
    directions.map_or_else(
        || STROKES_OF_ONE_DIRECTION.to_owned(),
        |directions| match &directions.symmetry {
            Bounds::Valid(symmetry) => {
                let limited = [&limits.rate_up, &limits.rate_down].iter().any(|rate| {
                    matches!(rate.verdict, RateVerdict::Limited | RateVerdict::GrowsLess)
                });
                match symmetry.asymmetric && limited {
                    true => of_other_sizes(symmetry),
                    false => of_symmetry(symmetry),
                }
            }
            Bounds::Withdrawn(reason) => format!(
                "Up and down strokes are not compared, because {}.",
                reason.because()
            ),
        },
    )
}

/// What [`of_strokes`] says of up and down strokes, and the limits of a linear model; `unit` is that of input and output.
#[must_use]
pub fn of_limits(limits: &Limits, strokes: &str, unit: Option<&str>) -> String {
    let units = unit.map_or_else(
        || "positions in the recording's unit, speeds in that unit per second".to_owned(),
        |unit| format!("positions in {unit}, speeds in {unit}/s"),
    );
    format!(
        "\nlimits of a linear model ({units})\n  {}\n{}",
        wrapped(strokes, 2),
        findings_on_limits(limits)
    )
}

/// The findings on limits, and below those that are open what to record, once for neighbours that need the same.
fn findings_on_limits(limits: &Limits) -> String {
    let [up, down] =
        [&limits.rate_up, &limits.rate_down].map(|rate| (&rate.statement, &rate.remedy));
    let hysteresis = (&limits.hysteresis.statement, &limits.hysteresis.remedy);
    let ends = limits.ends.iter().flatten();
    let ends = ends.map(|end| (&end.statement, &end.remedy));
    let all: Vec<(&String, &Option<String>)> =
        [up, down, hysteresis].into_iter().chain(ends).collect();
    let mut text = String::new();
    for (index, (statement, remedy)) in all.iter().enumerate() {
        let finding = match remedy {
            Some(remedy) => without_remedy(statement, remedy),
            None => (*statement).clone(),
        };
        text += &format!("  {}\n", wrapped(&finding, 4));
        let next = all.get(index + 1).and_then(|(_, next)| next.as_ref());
        if let Some(remedy) = remedy.as_ref().filter(|remedy| next != Some(*remedy)) {
            text += &format!("    {}\n", wrapped(remedy, 4));
        }
    }
    text
}

/// The finding alone of a statement that ends with its remedy.
fn without_remedy(statement: &str, remedy: &str) -> String {
    let end = statement.len().saturating_sub(remedy.len() + 2);
    let finding = statement.get(..end).unwrap_or(statement);
    format!("{finding}.")
}

/// "5.6 % of the stroke, 92 ms after the edge".
fn largest_difference(symmetry: &Symmetry) -> String {
    format!(
        "{:.1} % of the stroke, {:.0} ms after the edge",
        100.0 * symmetry.largest_difference.abs(),
        1e3 * symmetry.at_s
    )
}

/// Of different answers where the speed does not grow in proportion to the stroke: the test has one response for strokes of all sizes, so that other sizes
/// in one direction pass for another answer.
fn of_other_sizes(symmetry: &Symmetry) -> String {
    format!(
        "Whether up and down strokes differ is not known: their mean responses do, by up to {}, but the speed does not grow in proportion to the stroke, so that \
         strokes of other sizes do that, too. The speeds below differ by a tenth and more for that reason alone.",
        largest_difference(symmetry)
    )
}

/// Whether up and down strokes differ, and whether by enough to matter.
fn of_symmetry(symmetry: &Symmetry) -> String {
    let p = probability(Some(symmetry.p));
    let largest = largest_difference(symmetry);
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
    if symmetry.p < ASYMMETRY_FALSE_ALARM {
        // Many small differences can be more than noise where no single one is.
        return format!(
            "{beginning} Taken together the differences are more than noise ({p}); other errors of a linear model cause such differences too."
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
