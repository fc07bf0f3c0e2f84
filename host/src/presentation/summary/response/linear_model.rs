//! The linear model: the sentence and what stands before it, the metrics, and the facts of the fit.

use super::first_finding::{answers_first, first_finding};
use super::low_order::low_order_sentence;
use super::metrics;
use super::model_sentence::model_sentence;
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::summary::wording::layout::{findings, wrapped};
use crate::presentation::summary::wording::numbers::{
    decimals, number_with_unit, percent, probability,
};
use crate::presentation::summary::wording::strokes;
use servoid_identification::flight_model::FlightModel;
use servoid_identification::results::{Advice, Bounds, Model, Precedence, SelectedBy, six_digits};

/// The level of a model's bounds, as text.
pub(crate) fn level_text(model: &Model) -> String {
    match model.level() {
        Bounds::Valid(level) => format!("{} %", percent(level)),
        Bounds::Withdrawn(_) => "no bounds".to_owned(),
    }
}

/// How much of an identification is printed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extent<'a> {
    /// A sentence on the servo as a machine, where findings are said before it.
    pub of_servo: &'a str,
    /// The low-order model, which completes the sentence where the response is known in a band alone.
    pub low_order: Option<&'a FlightModel>,
    /// A picture of the step response, which comes after the sentence.
    pub picture: &'a str,
    /// Whether structure, residuals and widths are printed too.
    pub statistics: bool,
    /// Whether the servo as a machine is not linear, which this linear model may not show.
    pub machine_is_not_linear: bool,
}

/// The results of one identification: the answer first.
#[must_use]
pub fn of_model(source: &str, model: &Model, of: &ModelMetadata, extent: Extent<'_>) -> String {
    let units = of.units();
    let by_order = extent.low_order;
    let by_order = by_order.and_then(|flight| low_order_sentence(flight, model, units));
    let by_order = by_order.map_or_else(String::new, |sentence| format!(" {sentence}"));
    let sentence = wrapped(&(model_sentence(model, of) + &by_order), 0);
    let (first, advice): (Vec<Advice>, Vec<Advice>) = model
        .advice
        .iter()
        .cloned()
        .partition(|item| item.precedence() != Precedence::BelowTheResults);
    let first = match findings(&first) {
        none if none.is_empty() => none,
        some => some + "\n",
    };
    let of_servo = extent.of_servo;
    let head = match first_finding(model).is_some() && answers_first(model) {
        true => format!("{sentence}\n{first}{of_servo}"),
        false => format!("{first}{of_servo}{sentence}\n"),
    };
    let mut text = format!("{source}\n{head}{}", extent.picture);
    match model.level() {
        Bounds::Withdrawn(reason) => {
            let because = reason.because();
            let of = match model.band() {
                Some(_) => " OF THE STEP RESPONSE",
                None => "",
            };
            text += &format!("  ! NO BOUNDS{of} CAN BE GIVEN: {because} (see the advice)\n");
        }
        Bounds::Valid(_) if !model.linear => {
            text += "  ! NOT LINEAR: the bounds are those of the linear description that fits this reference best (see the advice)\n";
        }
        Bounds::Valid(_) if extent.machine_is_not_linear => {
            text += "  ! NOT LINEAR as a machine: these figures are of the recorded motion, and other steps, amplitudes or a sine may have others\n";
        }
        Bounds::Valid(_) => {}
    }
    let [samples, structure, fit, residuals] = facts(model, units.output);
    let band = ("step band", step_band(model));
    let offset = ("offset", offset(model, units.output));
    let of_motion = !model.linear || extent.machine_is_not_linear;
    text += &metrics::table(model, of, of_motion);
    text.push('\n');
    let facts = match extent.statistics {
        true => vec![samples, structure, fit, band, offset, residuals],
        false => vec![samples, fit],
    };
    let strokes = strokes::of_one_size(model, of).map(|strokes| ("strokes", strokes));
    for (name, value) in facts.into_iter().chain(strokes) {
        text += &format!("  {name:11} {}\n", wrapped(&value, 14));
    }
    text + &findings(&advice)
}

/// Samples, structure, fit and residuals, by name.
pub(crate) fn facts(model: &Model, unit: Option<&str>) -> [(&'static str, String); 4] {
    let (structure, fit, tests) = (&model.structure, &model.fit, &model.residuals);
    let period_ms = model.sample_period_s * 1e3;
    let samples = format!(
        "{} used, {} missing, every {} ms",
        fit.samples_used,
        fit.samples_missing,
        six_digits(period_ms)
    );
    let chosen = match structure.selected_by {
        SelectedBy::Auto => "chosen from the data",
        SelectedBy::Narrow => {
            "narrow: high frequencies are left out, which widens the bounds; they hold only if the response falls steeply there"
        }
        SelectedBy::User => "as asked for, and the rest from the data",
    };
    let settling = structure.settling_samples;
    let settling_ms = settling as f64 * period_ms;
    let structure = format!(
        "settling N = {settling} samples ({settling_ms:.0} ms), n = {} frequencies, noise order d = {} ({chosen})",
        structure.frequencies, structure.noise_order
    );
    let error = number_with_unit(fit.rmse, decimals(fit.rmse, 2), unit);
    let fit = format!(
        "{:.2} % simulated, {:.2} % one step ahead, error {error} rms",
        fit.simulation_percent, fit.one_step_percent
    );
    let residuals = format!(
        "white: {}, independent of the input: {}, linear: {}",
        probability(tests.whiteness_p),
        probability(tests.input_correlation_p),
        probability(tests.linearity_p)
    );
    [
        ("samples", samples),
        ("structure", structure),
        ("fit", fit),
        ("residuals", residuals),
    ]
}

fn offset(model: &Model, unit: Option<&str>) -> String {
    let digits = decimals(model.fit.rmse, 2);
    // A minus before nothing but zeros is none.
    let is_zero = format!("{:.digits$}", model.offset.abs()).parse() == Ok(0.0);
    let offset = if is_zero { 0.0 } else { model.offset };
    let offset = number_with_unit(offset, digits, unit);
    format!("{offset}, the output with the input at 0")
}

/// The width of the step response's bounds.
fn step_band(model: &Model) -> String {
    let Bounds::Valid(bounds) = &model.step.bounds else {
        return "none, as no bounds can be given".to_owned();
    };
    let (each, whole) = bounds.mean_half_widths();
    let digits = decimals(each, 2);
    format!(
        "±{each:.digits$} each point, ±{whole:.digits$} whole curve ({} %, of a unit step, mean)",
        percent(bounds.level)
    )
}
