//! Results as text for a terminal.

mod beyond_linear;
mod both_models;
mod comparison;
mod first_finding;
mod headline;
mod key_figures;
mod layout;
mod measured_limits;
mod metrics;
mod model_sentence;
mod numbers;
mod quantity_table;
mod servo_comparison;
mod servo_model;
mod servo_sentence;
mod sixty_degrees;
mod speed_words;
mod strokes;
mod top_speeds;
mod what_to_record;
mod whole_stroke;

pub use beyond_linear::{of_flight_model, of_limits};
pub use both_models::{answer_of_servo_model, of_both_models};
pub use comparison::of_comparison;
pub(crate) use metrics::TableRow;
pub use model_sentence::model_sentence;
pub(crate) use servo_comparison::{how_servo_models_are_compared, servo_model_rows};
pub use servo_comparison::{of_servo_models, sentence_on_servo_models};
pub use servo_model::of_servo_model;
pub(crate) use servo_sentence::LOOKS_LIKE_A_LOAD;
pub use servo_sentence::servo_sentence;
pub(crate) use servo_sentence::unlikely_speed;
pub(crate) use sixty_degrees::sixty_degrees;
pub(crate) use strokes::{of_one_size, stroke_in_words};
pub(crate) use what_to_record::advice_on_servo_model;

pub(crate) use comparison::{
    NOT_COMPARED, facts_of_comparison, how_compared, table_of_comparison, verdict,
};
pub(crate) use first_finding::first_finding;
pub(crate) use headline::{headline_of_comparison, headline_of_model, headline_of_servo};
pub(crate) use key_figures::{
    KEY_FIGURES, KeyFigure, of_both, of_both_machines, of_comparison as key_figures_of_comparison,
    of_machine, of_response,
};
pub(crate) use layout::{first_sentence, listed_words, wrapped};
pub(crate) use metrics::{difference_rows, metric_rows, withheld_line};
pub(crate) use numbers::{decimals, digits, four_digits, head_of_bounds, percent, probability};
pub(crate) use quantity_table::{QuantityRow, quantities, quantity_rows};
pub(crate) use servo_model::{run_offsets_in_words, terms_in_words};
pub(crate) use servoid_identification::results::with_unit;

use crate::data::model_metadata::ModelMetadata;
use first_finding::answers_first;
use layout::findings;
use servoid_identification::results::{
    Advice, Bounds, Model, Precedence, SelectedBy, Validation, six_digits,
};

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
    /// A picture of the step response, which comes after the sentence.
    pub picture: &'a str,
    /// Whether structure, residuals and widths are printed too.
    pub statistics: bool,
}

/// The results of one identification: the answer first.
#[must_use]
pub fn of_model(source: &str, model: &Model, of: &ModelMetadata, extent: Extent<'_>) -> String {
    let units = of.units();
    let sentence = wrapped(&model_sentence(model, of), 0);
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
        Bounds::Valid(_) => {}
    }
    let [samples, structure, fit, residuals] = facts(model, units.output);
    let band = ("step band", step_band(model));
    let offset = ("offset", offset(model, units.output));
    text += &metrics::table(model, of);
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

fn number_with_unit(number: f64, digits: usize, unit: Option<&str>) -> String {
    with_unit(format!("{number:.digits$}"), unit.unwrap_or_default())
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

/// How well a model predicted a recording that it was not identified from; `own_fits` are the fits of the linear and the servo model to
/// the recording that they come from \[%\], which identification prints.
#[must_use]
pub fn of_validation(
    linear: Option<&Validation>,
    servo_model: Option<&Validation>,
    own_fits: (f64, Option<f64>),
    unit: Option<&str>,
    advice: &[Advice],
) -> String {
    let (own, own_of_servo) = own_fits;
    let line = |found| validation_line(found, unit);
    let own_of_servo = own_of_servo.filter(|_| servo_model.is_some());
    let own = match (linear, own_of_servo) {
        (Some(_), Some(of_servo)) => format!("{of_servo:.2} % (servo model) and {own:.2} %"),
        (None, Some(of_servo)) => format!("{of_servo:.2} %"),
        (_, None) => format!("{own:.2} %"),
    };
    let text = match (linear.map(line), servo_model.map(line)) {
        (Some(linear), None) => linear,
        (linear, servo) => {
            let named = |name: &str, line: String| format!("{name:<13} {line}");
            let servo = servo.map(|line| named("servo model:", line));
            let linear = linear.map(|line| named("linear model:", line));
            servo.into_iter().chain(linear).collect()
        }
    };
    format!(
        "{text}the fit of the recording that the model comes from is {own}\n{}",
        findings(advice)
    )
}

fn validation_line(validation: &Validation, unit: Option<&str>) -> String {
    let digits = decimals(validation.rmse, 2);
    let error = number_with_unit(validation.rmse, digits, unit);
    let sign = if validation.bias.is_sign_negative() {
        ""
    } else {
        "+"
    };
    let bias = number_with_unit(validation.bias, digits, unit);
    let from_rest = match validation.runs_from_rest {
        0 => "",
        _ => ", the first ones too, because the runs appear to begin at rest",
    };
    format!(
        "fit {:.2} %, error {error} rms, bias {sign}{bias}, {} samples{from_rest}\n",
        validation.fit_percent, validation.samples_used
    )
}
