//! The paper's figures, made from recordings and models.

use super::figure::Figure;
use super::named::Named;
use super::response::{bode, step_response};
use super::signals::{input_output, validation};
use crate::data::units::Units;
use servoid_identification::results::Model;
use servoid_identification::{Record, Run};

/// Everything that is drawn of one identification: Figs 4-7 of the paper for this record.
#[must_use]
pub fn identification(
    prefix: &str,
    record: &Record,
    model: &Model,
    units: Units<'_>,
) -> Vec<Figure> {
    let named = [Named {
        name: "model",
        model,
    }];
    let mut figures = vec![
        input_output(
            &format!("{prefix}-input-output"),
            "Reference and measurement",
            record,
            units,
        ),
        step_response(&format!("{prefix}-step"), "Step response", &named, units),
        bode(&format!("{prefix}-bode"), "Frequency response", &named),
    ];
    figures.extend(record.runs().iter().zip(1..).map(|(run, number)| {
        let name = match record.runs().len() {
            1 => format!("{prefix}-validation"),
            _ => format!("{prefix}-validation-run-{number}"),
        };
        validation(
            &name,
            "Model against measurement",
            &named,
            run,
            units.output,
        )
    }));
    figures
}

/// One servo under one condition: what a report draws.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// What it is called: bench, aircraft, a file's name.
    pub name: &'a str,
    /// Its model.
    pub model: &'a Model,
    /// The record it was identified from, where that is at hand.
    pub record: Option<&'a Record>,
    /// The units of its record, where they are known.
    pub units: Units<'a>,
}

impl<'a> Subject<'a> {
    fn named(&self) -> Named<'a> {
        Named {
            name: self.name,
            model: self.model,
        }
    }

    fn first_run(&self) -> Option<&'a Run> {
        self.record.and_then(|record| record.runs().first())
    }
}

/// The paper's Figs 4-7 of one servo and, where there is a second one, Figs 8-12 as well. As in the
/// paper, the second one's results are drawn with the first one's.
#[must_use]
pub fn paper(first: &Subject<'_>, second: Option<&Subject<'_>>) -> Vec<Figure> {
    let mut all = of_one(first, &[first.named()], ["04", "05", "06", "07"]);
    if let Some(second) = second {
        let both = [first.named(), second.named()];
        let mut later = of_one(second, &both, ["08", "10", "11", "12"]);
        if let Some(run) = second.first_run() {
            let title = format!("Fig. 9: {} model on {} data", first.name, second.name);
            let figure = validation(
                "fig-09-first-on-second",
                &title,
                &[first.named()],
                run,
                second.units.output,
            );
            later.insert(1, figure);
        }
        all.extend(later);
    }
    all
}

/// Measurement, step response, frequency response and validation of one servo, with these numbers
/// of the paper's figures.
fn of_one(subject: &Subject<'_>, models: &[Named<'_>], numbers: [&str; 4]) -> Vec<Figure> {
    let [io, step, frequency, fit] = numbers;
    let names: Vec<&str> = models.iter().map(|m| m.name).collect();
    let names = names.join(" and ");
    let title =
        |number: &str, what: &str| format!("Fig. {}: {what}", number.trim_start_matches('0'));
    let mut figures = Vec::new();
    if let Some(record) = subject.record {
        let title = title(io, &format!("{}, reference and measurement", subject.name));
        figures.push(input_output(
            &format!("fig-{io}-measurement"),
            &title,
            record,
            subject.units,
        ));
    }
    figures.push(step_response(
        &format!("fig-{step}-step-response"),
        &title(step, &format!("step response, {names}")),
        models,
        subject.units,
    ));
    figures.push(bode(
        &format!("fig-{frequency}-frequency-response"),
        &title(frequency, &format!("frequency response, {names}")),
        models,
    ));
    if let Some(run) = subject.first_run() {
        let title = title(
            fit,
            &format!(
                "model against measurement, {names} on {} data",
                subject.name
            ),
        );
        figures.push(validation(
            &format!("fig-{fit}-validation"),
            &title,
            models,
            run,
            subject.units.output,
        ));
    }
    figures
}
