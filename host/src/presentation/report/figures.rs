//! The report's figures in order, each with what it shows and how to read it.

use super::content::{Page, Part};
use super::text::escape;
use crate::presentation::plots::Figure;
use crate::presentation::plots::paper_figures;
use crate::presentation::plots::signals::MOST_RUNS;
use crate::presentation::plots::{difference, residuals, scatter, structure};
use std::fmt::Write;

/// A figure, and a sentence or two below it.
pub(super) struct Shown {
    pub(super) figure: Figure,
    caption: String,
}

/// The paper's Figs 4 to 12, as far as there are data, and those that it does not have.
pub(super) fn all(page: &Page<'_>) -> Vec<Shown> {
    let mut all = Vec::new();
    // Without bounds the difference says nothing that the step responses side by side do not.
    let compared = page
        .comparison
        .filter(|found| found.bounds.valid().is_some());
    if let (Some(found), Some(second)) = (compared, &page.second) {
        let (a, b) = (page.first.subject.name, second.subject.name);
        all.push(Shown {
            figure: difference::difference(
                "difference",
                &format!("Difference of the step responses, {b} - {a}"),
                a,
                b,
                found,
            ),
            caption: format!(
                "The bands hold everywhere at once. Outside the margin somewhere: different; inside it everywhere: same. Verdict: {}.",
                format!("{:?}", found.verdict).to_lowercase()
            ),
        });
    }
    let second = page.second.as_ref().map(|part| &part.subject);
    let of_paper = paper_figures::paper(&page.first.subject, second);
    all.extend(of_paper.into_iter().map(|figure| Shown {
        caption: caption(&figure, page),
        figure,
    }));
    for (index, part) in page.parts().enumerate() {
        all.extend(beyond(part, index));
    }
    all.retain(|shown| !shown.figure.panels.is_empty());
    all
}

/// Structure, residuals and scatter of one side.
fn beyond(part: &Part<'_>, index: usize) -> Vec<Shown> {
    let (subject, explanation) = (&part.subject, part.explanation);
    let name = |what: &str| format!("{what}-{}", if index == 0 { "first" } else { "second" });
    let title = |what: &str| format!("{what}, {}", subject.name);
    let mut shown = Vec::new();
    if let Some(explanation) = explanation {
        shown.push(Shown {
            figure: structure::structure(
                &name("structure"),
                &title("Structure choice"),
                explanation,
                subject.model,
            ),
            caption: "Settling time N, noise order d and number of frequencies n, with what each was chosen by, and what is left of the response at its end.".into(),
        });
    }
    if let Some(record) = subject.record {
        shown.push(Shown {
            figure: residuals::residuals(
                &name("residuals"),
                &title("Residual tests"),
                subject.model,
                record,
            ),
            caption: "One lag in a hundred lies outside its 99 % bound by chance. Many outside, above: the noise model is incomplete; below, beyond the settling time: the response is longer than N or not linear; before lag 0: the input reacts to the output.".into(),
        });
    }
    if let Some(runs) = explanation.and_then(|explanation| explanation.runs.as_ref()) {
        let model = subject.model;
        let level = model.level().into_valid();
        let caption = match level {
            Some(_) => {
                "Runs that lie farther apart than noise allows show what changes from run to run: supply, friction, clocks. The bounds of the model do not contain it; the p-value of a comparison does."
            }
            None => {
                "How far the runs lie apart. How much of that is noise is not known, as the model has no bounds."
            }
        };
        shown.push(Shown {
            figure: scatter::run_scatter(
                &name("runs"),
                &title("Run-to-run scatter"),
                runs,
                part.runs,
                level,
                subject.units.output,
            ),
            caption: caption.into(),
        });
    }
    shown
}

/// What is said of bounds below a figure of the models of this page: `whole` where all of them have some.
fn of_bounds(figure: &Figure, page: &Page<'_>, whole: &str) -> String {
    // Up to Fig. 6 only the first servo is drawn.
    let drawn = if figure.name.as_str() < "fig-07" {
        1
    } else {
        2
    };
    let without: Vec<&str> = page
        .parts()
        .take(drawn)
        .map(|part| &part.subject)
        .filter(|subject| subject.model.bounds.withdrawn().is_some())
        .map(|subject| subject.name)
        .collect();
    let models = page.parts().take(drawn).count();
    if without.is_empty() {
        return whole.to_owned();
    }
    let none = format!(
        "No bounds can be given for {}: the advice says why.",
        without.join(" and ")
    );
    match without.len() < models {
        true => format!("{none} {whole}"),
        false => none,
    }
}

fn caption(figure: &Figure, page: &Page<'_>) -> String {
    let of = |part: &str| figure.name.contains(part);
    if of("measurement") {
        let part = match of("fig-08") {
            true => page.second.as_ref(),
            false => Some(&page.first),
        };
        let runs = part
            .and_then(|part| part.subject.record)
            .map(|record| record.runs().len());
        let more = if runs > Some(MOST_RUNS) {
            format!(
                "; of {} runs, the first {MOST_RUNS}",
                runs.unwrap_or_default()
            )
        } else {
            String::new()
        };
        format!("The command and the position{more}.")
    } else if of("step") {
        let bounds = "The area holds the whole curve, the dashed lines each point by itself.";
        format!(
            "The answer to a step of 1 at time 0. {}",
            of_bounds(figure, page, bounds)
        )
    } else if of("frequency") {
        format!(
            "Bode plot of the servo's own response, freed of the hold of the samples. {}",
            of_bounds(
                figure,
                page,
                "The areas are bounds for each frequency by itself."
            )
        )
    } else if of("fig-09") {
        "The first servo's model, driven by the second's command: the error of flying by the bench model.".into()
    } else {
        "Simulated from the reference alone, on the first run; below, what is left.".into()
    }
}

/// Places for the figures in the page, and an index of them.
pub(super) fn write_places(body: &mut String, figures: &[Shown]) -> std::fmt::Result {
    body.push_str("<h2>Figures</h2>\n<nav>");
    for Shown { figure, .. } in figures {
        let (name, title) = (escape(&figure.name), escape(&figure.title));
        writeln!(body, "<a href=\"#at-{name}\">{title}</a>")?;
    }
    body.push_str("</nav>\n");
    for Shown { figure, caption } in figures {
        let (name, title) = (escape(&figure.name), escape(&figure.title));
        writeln!(
            body,
            "<section id=\"at-{name}\"><h2>{title}</h2><div class=\"figure\" id=\"{name}\"></div><p class=\"faint\">{}</p></section>",
            escape(caption)
        )?;
    }
    Ok(())
}
