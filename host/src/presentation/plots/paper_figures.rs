//! The paper's figures, made from recordings and models.

use super::figure::{Figure, Named};
use super::response::{bode, step_response};
use super::signals::{input_output, validation};
use crate::data::units::Units;
use servoid_identification::results::Model;
use servoid_identification::{Record, Run};

/// All figures of one identification: Figs 4-7 of the paper for this record.
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
    let name = |what: &str| format!("{prefix}-{what}");
    let mut figures = vec![
        input_output(
            &name("input-output"),
            "Reference and measurement",
            record,
            units,
        ),
        step_response(&name("step"), "Step response", &named, units),
        bode(&name("bode"), "Frequency response", &named),
    ];
    figures.extend(record.runs().iter().zip(1..).map(|(run, number)| {
        let name = match record.runs().len() {
            1 => name("validation"),
            _ => name(&format!("validation-run-{number}")),
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

/// One servo under one condition.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// Its name: bench, aircraft, a file's name.
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
            let (name, unit) = ("fig-09-first-on-second", second.units.output);
            let title = format!("Fig. 9: {} model on {} data", first.name, second.name);
            later.insert(1, validation(name, &title, &[first.named()], run, unit));
        }
        all.extend(later);
    }
    all
}

/// Measurement, step response, frequency response and validation of one servo, with these numbers
/// of the paper's figures.
fn of_one(subject: &Subject<'_>, models: &[Named<'_>], numbers: [&str; 4]) -> Vec<Figure> {
    let (own, units) = (subject.name, subject.units);
    let names: Vec<&str> = models.iter().map(|m| m.name).collect();
    let names = names.join(" and ");
    let texts = [
        ("measurement", format!("{own}, reference and measurement")),
        ("step-response", format!("step response, {names}")),
        ("frequency-response", format!("frequency response, {names}")),
        (
            "validation",
            format!("model against measurement, {names} on {own} data"),
        ),
    ];
    let mut labels = numbers
        .into_iter()
        .zip(texts)
        .map(|(number, (kind, text))| {
            let title = format!("Fig. {}: {text}", number.trim_start_matches('0'));
            (format!("fig-{number}-{kind}"), title)
        });
    let [io, step, frequency, fit] = std::array::from_fn(|_| labels.next().unwrap_or_default());
    let measurement = |record| input_output(&io.0, &io.1, record, units);
    let validated = |run| validation(&fit.0, &fit.1, models, run, units.output);
    let mut figures: Vec<Figure> = subject.record.map(measurement).into_iter().collect();
    figures.push(step_response(&step.0, &step.1, models, units));
    figures.push(bode(&frequency.0, &frequency.1, models));
    figures.extend(subject.first_run().map(validated));
    figures
}
