//! The report's figures below its first screen, in order, with captions.

use super::content::{Page, Part};
use super::text::escape;
use crate::presentation::plots::{self, Figure, MOST_RUNS, PaperFigure, PaperFigureKind};
use crate::presentation::summary;
use servoid_identification::thresholds::RUNS_FOR_MEAN;

/// A figure, and a sentence or two below it.
pub(super) struct Shown {
    pub(super) figure: Figure,
    caption: String,
}

impl Shown {
    fn new(figure: Figure, caption: impl Into<String>) -> Self {
        let caption = caption.into();
        Self { figure, caption }
    }
}

/// The paper's Figs 4 to 12, as far as there are data, and further ones.
pub(super) fn all(page: &Page<'_>) -> Vec<Shown> {
    let mut all = Vec::new();
    // Without bounds the difference shows no more than the step responses side by side.
    let compared = page
        .comparison
        .filter(|found| found.bounds.valid().is_some());
    if let (Some(found), Some(second)) = (compared, &page.second) {
        let (a, b) = (page.first.subject.name, second.subject.name);
        let title = format!("Difference of the step responses, {b} - {a}");
        let figure = plots::difference("difference", &title, a, b, found);
        let verdict = summary::verdict(found.verdict);
        all.push(Shown::new(figure, format!(
            "The bands hold everywhere at once. Outside the margin somewhere: different; inside it everywhere: same. Verdict: {verdict}."
        )));
    }
    for (part, place) in page.parts().zip(["first", "second"]) {
        all.extend(part.held_out.map(|found| {
            let name = format!("held-out-{place}");
            let title = format!("Servo model and linear model, {}", part.subject.name);
            let unit = part.subject.units.output;
            Shown::new(
                plots::held_out(&name, &title, found, unit),
                plots::held_out_caption(found),
            )
        }));
    }
    let second = page.second.as_ref().map(|part| &part.subject);
    // The paper's numbers say something of its own experiment only.
    let numbered = page.parts().all(|part| part.staircase);
    for found in plots::paper(&page.first.subject, second, numbered) {
        let caption = caption(&found, page);
        all.push(Shown::new(found.figure, caption));
    }
    for (part, place) in page.parts().zip(["first", "second"]) {
        all.extend(diagnostics(part, place));
    }
    all.retain(|shown| !shown.figure.panels.is_empty());
    all
}

/// Structure, residuals and scatter of one side.
fn diagnostics(part: &Part<'_>, place: &str) -> Vec<Shown> {
    let (subject, explanation, model) = (&part.subject, part.explanation, part.subject.model);
    let name = |figure: &str| format!("{figure}-{place}");
    let title = |figure: &str| format!("{figure}, {}", subject.name);
    let mut shown = Vec::new();
    if let Some(explanation) = explanation {
        let (name, title) = (name("structure"), title("Structure choice"));
        shown.push(Shown::new(
            plots::structure(&name, &title, explanation, model),
            "Settling time N, noise order d and number of frequencies n, with the criterion of each choice, and the rest of the response at its end.",
        ));
    }
    if let (Some(explanation), Some(record)) = (explanation, subject.record) {
        let (name, title) = (name("left-out"), title("Samples that were left out"));
        shown.push(Shown::new(
            plots::left_out(&name, &title, record, &explanation.taken_out, subject.units.output),
            "What the others predict is far from the marked samples. The model was made without them: look for glitches of the sensor or its wiring.",
        ));
    }
    if let Some(record) = subject.record {
        let (name, title) = (name("residuals"), title("Residual tests"));
        shown.push(Shown::new(
            plots::residuals(&name, &title, model, record),
            "One lag in a hundred lies outside its 99 % bound by chance. Many outside, above: the noise model is incomplete; below, beyond the settling time: the response is longer than N or not linear; before lag 0: the input reacts to the output.",
        ));
    }
    if let Some(runs) = explanation.and_then(|explanation| explanation.runs.as_ref()) {
        let level = model.level().into_valid();
        let (name, title) = (name("runs"), title("Run-to-run scatter"));
        shown.push(Shown::new(
            plots::run_scatter(&name, &title, runs, part.runs, level, subject.units.output),
            match level {
                Some(_) if runs.runs.len() < RUNS_FOR_MEAN => {
                    "Runs that lie farther apart than noise allows show what changes from run to run: supply, friction, clocks. The bounds of the model do not contain it; that takes three runs."
                }
                Some(_) => {
                    "Runs that lie farther apart than noise allows show what changes from run to run: supply, friction, clocks. The bounds of the model contain it."
                }
                None => {
                    "Differences between the runs. The part of noise in them is not known, because the model has no bounds."
                }
            },
        ));
    }
    shown
}

/// A sentence on bounds below a figure of the models of this page: `whole` where all of them have bounds.
fn of_bounds(found: &PaperFigure, page: &Page<'_>, whole: &str) -> String {
    // The figures of the first servo show it alone.
    let drawn = if found.of_second { 2 } else { 1 };
    let (with, without): (Vec<&Part<'_>>, Vec<&Part<'_>>) =
        page.parts().take(drawn).partition(|part| {
            let model = part.subject.model;
            let is_of_band = found.kind == PaperFigureKind::Frequency && model.band().is_some();
            is_of_band || model.bounds.valid().is_some()
        });
    let names: Vec<&str> = without.iter().map(|part| part.subject.name).collect();
    let none = format!(
        "No bounds can be given for {}: the advice has the reason.",
        summary::listed_words(&names)
    );
    match (with.is_empty(), without.is_empty()) {
        (_, true) => whole.to_owned(),
        (false, false) => format!("{none} {whole}"),
        (true, false) => none,
    }
}

fn caption(found: &PaperFigure, page: &Page<'_>) -> String {
    match found.kind {
        PaperFigureKind::Measurement => of_measurement(found, page),
        PaperFigureKind::Step => {
            let bounds = "The area holds the whole curve, the dashed lines each point by itself.";
            format!(
                "The response to a step of 1 at time 0. {}",
                of_bounds(found, page, bounds)
            )
        }
        PaperFigureKind::Frequency => {
            let bounds = "The areas are bounds for each frequency by itself.";
            format!(
                "Bode plot of the servo's own response, freed of the hold of the samples (1 Hz is 6.283 rad/s). {}",
                of_bounds(found, page, bounds)
            )
        }
        PaperFigureKind::FirstOnSecond => {
            "The first servo's model, driven by the second's command: the error of flying by the bench model."
                .to_owned()
        }
        PaperFigureKind::Validation => {
            "Simulated from the reference alone, on the first run; below, the residuals.".to_owned()
        }
    }
}

fn of_measurement(found: &PaperFigure, page: &Page<'_>) -> String {
    let part = match found.of_second {
        true => page.second.as_ref(),
        false => Some(&page.first),
    };
    let record = part.and_then(|part| part.subject.record);
    match record.map_or(0, |record| record.runs().len()) {
        runs if runs > MOST_RUNS => {
            format!("The command and the position; of {runs} runs, the first {MOST_RUNS}.")
        }
        _ => "The command and the position.".to_owned(),
    }
}

/// Places for the figures in the page, and an index of them.
pub(super) fn places(figures: &[Shown]) -> String {
    let (mut index, mut places) = (String::new(), String::new());
    for Shown { figure, caption } in figures {
        let [name, title, caption] =
            [&figure.name, &figure.title, caption].map(|text| escape(text));
        index += &format!("<a href=\"#at-{name}\">{title}</a>\n");
        places += &format!(
            "<section id=\"at-{name}\"><h2>{title}</h2><div class=\"figure\" id=\"{name}\"></div><p class=\"faint\">{caption}</p></section>\n"
        );
    }
    format!("<h2>Figures</h2>\n<nav>{index}</nav>\n{places}")
}
