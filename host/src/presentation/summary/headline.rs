//! The answer in a sentence or two, for the head of a page.

use super::response::first_finding::{answers_first, first_finding, said_before};
use super::response::model_sentence::{
    certainty, half_way_and_settled, has_likely_times, hides_step, is_picture, what_answers,
};
use super::servo::servo_sentence::servo_sentence;
use super::two_servos::comparison::subject_in_words;
use super::wording::layout::first_sentence;
use super::wording::numbers::percent;
use super::wording::strokes::which_step;
use crate::data::model_metadata::ModelMetadata;
use crate::data::units::Units;
use servoid_identification::comparison::{Comparison, ComparisonBounds, Direction, Verdict};
use servoid_identification::results::{Bounds, Model};
use servoid_identification::servo_model::ServoModel;

/// How fast a servo is, and how sure that is.
pub(crate) fn headline_of_model(model: &Model, of: &ModelMetadata) -> String {
    if let Some(item) = first_finding(model) {
        let answer = match answers_first(model) && !item.finding.starts_with(NO_BOUNDS) {
            true => format!("{NO_BOUNDS}. "),
            false => String::new(),
        };
        return format!("{answer}{} {}", item.finding, item.remedy);
    }
    if hides_step(model) || model.band().is_some() {
        return certainty(model);
    }
    let parts = match has_likely_times(model) {
        true => half_way_and_settled(&model.metrics),
        false => Vec::new(),
    };
    let motion = match parts.is_empty() {
        true => String::new(),
        false => format!(
            "After a step{} {} {}.{} ",
            which_step(of),
            what_answers(model),
            parts.join(" and "),
            is_picture(model)
        ),
    };
    let before = said_before(model).map_or_else(String::new, |item| format!("{} ", item.finding));
    before + &motion + &certainty(model)
}

/// How an answer begins that has none.
const NO_BOUNDS: &str = "No bounds can be given";

/// The same of a servo model beside a linear one.
pub(crate) fn headline_of_servo(servo: &ServoModel, model: &Model, units: Units<'_>) -> String {
    let before = said_before(model).map_or_else(String::new, |item| format!("{} ", item.finding));
    before + &servo_sentence(servo, model, units)
}

/// Whether two differ, and by how much; `a` and `b` are their names, `units` those of both.
pub(crate) fn headline_of_comparison(a: &str, b: &str, found: &Comparison, units: Units) -> String {
    if found.same_data {
        return format!(
            "No verdict on {a} and {b}: they have samples in common, so their comparison shows nothing about the servo. Record the second \
             condition by itself, and name that file."
        );
    }
    let Bounds::Valid(bounds) = &found.bounds else {
        let reason = found.bounds.withdrawn().map(|reason| reason.because());
        return format!(
            "No verdict on {a} and {b}: for at least one of them no bounds can be given, because {}.",
            reason.unwrap_or_default()
        );
    };
    let ComparisonBounds {
        level,
        difference_percent: apart,
        ..
    } = bounds;
    let (least, most, margin) = (apart.at_least, apart.at_most, found.margin_percent);
    let sure = format!("{} % sure", percent(*level));
    let stroke = stroke_in_words(apart.stroke);
    let of = subject_in_words(found);
    if found.descriptions_of_different_motions {
        let unit = units.input.unwrap_or_default();
        let differ = found
            .motions
            .map(|both| both.a.difference_in_words(&both.b, unit));
        return format!(
            "No verdict on {a} and {b}: {}. What differs may be the motion and not the servo. Record both with the same reference.",
            differ.as_deref().unwrap_or("their references differ")
        );
    }
    // Step responses are of changes alone, so a verdict on them does not show that one servo rests elsewhere.
    let apart_at_rest = found.advice.iter().find(|item| item.is_of_zeros());
    let apart_at_rest = apart_at_rest.map_or_else(String::new, |item| {
        format!(" {}", first_sentence(&item.finding))
    });
    let by_steps = match found.verdict {
        Verdict::Different => format!(
            "{a} and {b} are {least:.1} to {most:.1} % of the step apart where they differ most{stroke} ({sure}, said {of}); {margin} % would have counted as the same."
        ),
        Verdict::Same => format!(
            "{a} and {b} are nowhere more than {most:.1} % of the step apart ({sure}, said {of}); up to {margin} % counts as the same."
        ),
        Verdict::Undecided if found.may_be_waits => format!(
            "No verdict on {a} and {b}: they are {least:.1} to {most:.1} % of the step apart where they differ most{stroke} ({sure}, said {of}), and each recording may have its own wait for pulses \
             in all of its times, which may make all of it but what counts as the same. Record three runs a side."
        ),
        Verdict::Undecided => format!(
            "{a} and {b} are {least:.1} to {most:.1} % of the step apart where they differ most{stroke} ({sure}, said {of}), and the margin of {margin} % lies between."
        ),
    };
    let play = found.rests_in_words([a, b], units.output.unwrap_or_default());
    let play = play.map_or_else(String::new, |play| format!(" {play}"));
    by_steps + &play + &apart_at_rest
}

/// The strokes that a difference was found in, where it is not in the response to all of them.
pub(super) fn stroke_in_words(stroke: Direction) -> &'static str {
    match stroke {
        Direction::Both => "",
        Direction::Up => ", on the way up",
        Direction::Down => ", on the way down",
    }
}
