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
    pub record: Option<&'a Record<'a>>,
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

    fn first_run(&self) -> Option<&'a Run<'a>> {
        self.record.and_then(|record| record.runs().first())
    }
}

/// What a figure of the paper shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PaperFigureKind {
    /// Command and position.
    Measurement,
    /// The step response.
    Step,
    /// The frequency response.
    Frequency,
    /// The model against its measurement.
    Validation,
    /// The first model against the second measurement.
    FirstOnSecond,
}

/// One of the paper's figures.
#[derive(Clone, Debug, PartialEq)]
pub struct PaperFigure {
    /// The drawing.
    pub figure: Figure,
    /// What it shows.
    pub kind: PaperFigureKind,
    /// Whether it is one of the second servo.
    pub of_second: bool,
}

/// The figures that the paper has of one servo, Figs 4-7, and of two: Figs 8-12 as well. As in the paper, the second one's
/// results are drawn with the first one's. `numbered` names the paper's figures, which says something only of its experiment.
#[must_use]
pub fn paper(
    first: &Subject<'_>,
    second: Option<&Subject<'_>>,
    numbered: bool,
) -> Vec<PaperFigure> {
    let of_first = Series {
        subject: first,
        models: &[first.named()],
        numbers: numbered.then_some(["04", "05", "06", "07"]),
        of_second: false,
    };
    let mut all = of_first.figures();
    if let Some(second) = second {
        let of_second = Series {
            subject: second,
            models: &[first.named(), second.named()],
            numbers: numbered.then_some(["08", "10", "11", "12"]),
            of_second: true,
        };
        let mut later = of_second.figures();
        if let Some(run) = second.first_run() {
            let (name, title) = labels(
                numbered.then_some("09"),
                "first-on-second",
                &format!("{} model on {} data", first.name, second.name),
            );
            let figure = PaperFigure {
                figure: validation(&name, &title, &[first.named()], run, second.units.output),
                kind: PaperFigureKind::FirstOnSecond,
                of_second: true,
            };
            let behind_measurement = usize::from(second.record.is_some());
            later.insert(behind_measurement, figure);
        }
        all.extend(later);
    }
    all
}

/// Name and title of a figure, with its number in the paper where that says something.
fn labels(number: Option<&str>, name: &str, title: &str) -> (String, String) {
    match number {
        None => (name.to_owned(), title.to_owned()),
        Some(number) => (
            format!("fig-{number}-{name}"),
            format!(
                "Fig. {} of the paper: {title}",
                number.trim_start_matches('0')
            ),
        ),
    }
}

/// Measurement, step response, frequency response and validation of one servo.
struct Series<'a> {
    subject: &'a Subject<'a>,
    /// The models that are drawn.
    models: &'a [Named<'a>],
    /// The numbers of the four figures in the paper.
    numbers: Option<[&'static str; 4]>,
    of_second: bool,
}

impl Series<'_> {
    fn figures(&self) -> Vec<PaperFigure> {
        let (own, units, models) = (self.subject.name, self.subject.units, self.models);
        let names: Vec<&str> = models.iter().map(|model| model.name).collect();
        let names = names.join(" and ");
        let label = |index: usize, name: &str, title: &str| {
            let number = self.numbers.and_then(|all| all.get(index).copied());
            let name = match (number, self.of_second) {
                (None, false) => format!("{name}-first"),
                (None, true) => format!("{name}-second"),
                (Some(_), _) => name.to_owned(),
            };
            labels(number, &name, title)
        };
        let mut figures = Vec::new();
        let mut add = |kind: PaperFigureKind, figure: Figure| {
            let of_second = self.of_second;
            figures.push(PaperFigure {
                figure,
                kind,
                of_second,
            });
        };
        if let Some(record) = self.subject.record {
            let title = format!("reference and measurement, {own}");
            let (name, title) = label(0, "measurement", &title);
            add(
                PaperFigureKind::Measurement,
                input_output(&name, &title, record, units),
            );
        }
        let (name, title) = label(1, "step-response", &format!("step response, {names}"));
        add(
            PaperFigureKind::Step,
            step_response(&name, &title, models, units),
        );
        let title = format!("frequency response, {names}");
        let (name, title) = label(2, "frequency-response", &title);
        add(PaperFigureKind::Frequency, bode(&name, &title, models));
        if let Some(run) = self.subject.first_run() {
            let title = format!("model against measurement, {names} on {own} data");
            let (name, title) = label(3, "validation", &title);
            let figure = validation(&name, &title, models, run, units.output);
            add(PaperFigureKind::Validation, figure);
        }
        figures
    }
}
