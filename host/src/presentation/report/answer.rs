//! The first screen of the page: the verdict, its picture, and six numbers.

use super::content::{Page, Part};
use super::text::escape;
use crate::data::units::Units;
use crate::presentation::plots::{self, DrawnAnswer, Figure, Named, NamedServo};
use crate::presentation::summary::{self, KEY_FIGURES, KeyFigure};
use servoid_identification::comparison::Comparison;
use servoid_identification::results::Bounds;
use servoid_identification::servo_model::ServoModel;

/// What the first screen rests on.
enum Basis<'a> {
    /// One servo as a machine.
    Machine(&'a ServoModel),
    /// Two servos as machines, where they say more than the step responses, as in the terminal.
    Machines([&'a ServoModel; 2]),
    /// Linear models.
    Linear,
}

impl<'a> Basis<'a> {
    fn of(page: &Page<'a>) -> Self {
        let machine = |part: &Part<'a>| part.servo_model.map(|found| &found.model);
        let machines_first = page.servo_models.is_some_and(|servos| {
            let verdict = page.comparison.is_some_and(Comparison::has_verdict);
            !verdict || servos.answer_before(page.comparison)
        });
        match (&page.second, machine(&page.first)) {
            (None, Some(model)) if model.better_linear_percent().is_none() && model.predicts() => {
                Self::Machine(model)
            }
            (Some(second), Some(first)) if machines_first => match machine(second) {
                Some(second) => Self::Machines([first, second]),
                None => Self::Linear,
            },
            _ => Self::Linear,
        }
    }
}

/// The first screen; its picture is [`picture`].
pub(super) fn screen(page: &Page<'_>) -> String {
    let numbers = key_figures(page);
    let number = |figure: &KeyFigure| {
        let [label, value, below] =
            [&figure.label, &figure.value, &figure.below].map(|text| escape(text));
        format!(
            "<div><dt>{label}</dt><dd><b>{value}</b><br><span class=\"faint\">{below}</span></dd></div>\n"
        )
    };
    let numbers: String = numbers.iter().take(KEY_FIGURES).map(number).collect();
    format!(
        "{}<noscript><p class=\"verdict\">The figures need JavaScript, which is off here; everything in words and numbers is below.</p></noscript>\n<div class=\"look\"><div><div class=\"figure\" id=\"answer\"></div><p class=\"faint below\">{}</p></div>\n<dl class=\"key\">\n{numbers}</dl></div>\n",
        verdict(page),
        escape(&caption(page)),
    )
}

/// The verdict on one servo or two.
fn verdict(page: &Page<'_>) -> String {
    let paragraph = |kind: &str, word: &str, sentence: &str| {
        // A number and its unit stay on one line.
        let sentence = escape(sentence)
            .replace(" %", "&nbsp;%")
            .replace(" ms", "&nbsp;ms");
        format!("<p class=\"verdict {kind}\" id=\"verdict\">{word}{sentence}</p>\n")
    };
    let first = &page.first;
    let Some(second) = &page.second else {
        let own = first.subject.model;
        let doubt = summary::first_finding(own).is_some();
        return match (first.servo_model, own.level()) {
            (Some(found), _) if !doubt => paragraph(
                "servo",
                "",
                &summary::headline_of_servo(&found.model, own, first.subject.units),
            ),
            (_, Bounds::Valid(_)) => {
                paragraph("", "", &summary::headline_of_model(own, first.metadata))
            }
            (_, Bounds::Withdrawn(_)) => paragraph(
                "different",
                "",
                &summary::headline_of_model(own, first.metadata),
            ),
        };
    };
    let names = [first.subject.name, second.subject.name];
    let machines = page
        .servo_models
        .filter(|_| matches!(Basis::of(page), Basis::Machines(_)));
    if let Some(found) = machines {
        let units = first.subject.units;
        let sentence =
            summary::sentence_on_servo_models(names[0], names[1], found, page.comparison, units);
        let by_steps = page.comparison.map_or_else(String::new, |found| {
            format!(
                " By the step responses alone they are {}.",
                summary::verdict(found.verdict)
            )
        });
        return paragraph("servo", "", &(sentence + &by_steps));
    }
    match page.comparison {
        Some(found) => {
            let word = summary::verdict(found.verdict);
            let sentence = summary::headline_of_comparison(names[0], names[1], found, units(page));
            paragraph(word, &format!("<b>{word}</b>. "), &sentence)
        }
        None => paragraph(
            "",
            "",
            &format!(
                "{} and {} side by side, without a verdict.",
                names[0], names[1]
            ),
        ),
    }
}

/// The six numbers.
fn key_figures(page: &Page<'_>) -> Vec<KeyFigure> {
    let (first, units) = (&page.first, page.first.subject.units);
    match (Basis::of(page), &page.second) {
        (Basis::Machine(model), _) => summary::of_machine(model, first.low_order, units),
        (Basis::Machines(models), _) => page
            .servo_models
            .map(|found| summary::of_both_machines(found, models, units))
            .unwrap_or_default(),
        (Basis::Linear, None) => summary::of_response(first.subject.model, first.low_order, units),
        (Basis::Linear, Some(second)) => match page.comparison {
            Some(found) if found.bounds.valid().is_some() => {
                summary::key_figures_of_comparison(second.subject.name, found, units)
            }
            _ => {
                let models = [first.subject.model, second.subject.model];
                summary::of_both(models, &super::text::common_gain(page))
            }
        },
    }
}

/// The picture.
pub(super) fn picture(page: &Page<'_>) -> Figure {
    let shown = match Basis::of(page) {
        Basis::Machine(model) => DrawnAnswer::AsMachines(vec![NamedServo {
            name: "",
            model,
            middle: middle_of_commands(&page.first),
        }]),
        Basis::Machines(models) => {
            let servos = page.parts().zip(models).map(|(part, model)| NamedServo {
                name: part.subject.name,
                model,
                middle: middle_of_commands(part),
            });
            DrawnAnswer::AsMachines(servos.collect())
        }
        Basis::Linear => {
            let models = page.parts().map(|part| Named {
                name: part.subject.name,
                model: part.subject.model,
            });
            DrawnAnswer::Linear(models.collect())
        }
    };
    plots::answer(&shown, units(page))
}

/// Units that all sides have; none where they differ.
fn units<'a>(page: &Page<'a>) -> Units<'a> {
    let units = page.first.subject.units;
    let alike = page.parts().all(|part| part.subject.units == units);
    if alike { units } else { Units::default() }
}

/// A few words below the picture.
fn caption(page: &Page<'_>) -> String {
    let bounds = |part: &Part<'_>| part.subject.model.bounds.valid().is_some();
    match Basis::of(page) {
        Basis::Machine(_) | Basis::Machines(_) => {
            "Strokes of the servo model from rest, each divided by its size."
        }
        Basis::Linear if page.parts().all(bounds) => {
            "Answer to a step of the command; the band holds the whole curve."
        }
        Basis::Linear => {
            "Answer to a step of the command; no band is drawn where no bounds can be given."
        }
    }
    .to_owned()
}

/// The middle of the commands of a record; 0 where there is none.
fn middle_of_commands(part: &Part<'_>) -> f64 {
    let record = part.subject.record;
    let runs = record.into_iter().flat_map(|record| record.runs());
    let commands = runs.flat_map(|run| run.input()).filter(|u| u.is_finite());
    let ends = commands.fold(None, |ends: Option<(f64, f64)>, &u| {
        let (low, high) = ends.unwrap_or((u, u));
        Some((low.min(u), high.max(u)))
    });
    ends.map_or(0.0, |(low, high)| (low + high) / 2.0)
}
