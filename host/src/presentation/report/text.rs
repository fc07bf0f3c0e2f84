//! The page's text: verdict, numbers, advice, provenance.

use super::content::{Facts, Page, Part};
use crate::presentation::summary;
use servoid_identification::comparison::Verdict;
use servoid_identification::results::Bounds;
use std::fmt::{Error, Result, Write};

/// Text for a page: what has a meaning in HTML loses it.
pub(super) fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            other => safe.push(other),
        }
    }
    safe
}

/// JSON for a `<script>` element, which the text `</script>` in a file's name would otherwise end.
pub(super) fn json_in_page(value: &impl serde::Serialize) -> anyhow::Result<String> {
    Ok(serde_json::to_string(value)?.replace('<', "\\u003c"))
}

/// What was measured, and the answer where two were.
pub(super) fn write_verdict(body: &mut String, page: &Page<'_>) -> Result {
    for part in page.parts() {
        let (name, model) = (escape(part.subject.name), part.subject.model);
        let files: Vec<&str> = part
            .provenance
            .iter()
            .filter_map(|facts| facts.iter().find(|(key, _)| key == "file"))
            .map(|(_, file)| file.as_str())
            .collect();
        let from = match files.len() {
            0 => "a model".to_owned(),
            1..=4 => escape(&files.join(", ")),
            many => format!("{many} recordings"),
        };
        let runs = part.subject.record.map_or(0, |record| record.runs().len());
        let runs = match runs {
            0 => String::new(),
            1 => ", one run".to_owned(),
            many => format!(", {many} runs"),
        };
        writeln!(
            body,
            "<p><b>{name}</b>: from {from}{runs}, {:.1} s used.</p>",
            model.fit.samples_used as f64 * model.sample_period_s
        )?;
        match model.level() {
            Bounds::Withdrawn(reason) => writeln!(
                body,
                "<p class=\"verdict different\">{name}: no bounds can be given, as {} (see the advice).</p>",
                reason.because()
            )?,
            Bounds::Valid(_) if !model.linear => writeln!(
                body,
                "<p class=\"verdict undecided\">{name}: not linear; the bounds are those of the linear description that fits this reference best (see the advice).</p>"
            )?,
            Bounds::Valid(_) => {}
        }
    }
    let Some(found) = page.comparison else {
        return Ok(());
    };
    let class = match found.verdict {
        Verdict::Different => "different",
        Verdict::Same => "same",
        Verdict::Undecided => "undecided",
    };
    let names = [
        page.first.subject.name,
        page.second.map_or("", |part| part.subject.name),
    ];
    writeln!(
        body,
        "<p class=\"verdict {class}\"><b>{class}</b> (the first is {}, the second {}). {}</p>",
        escape(names[0]),
        escape(names[1]),
        // A number and its unit stay on one line.
        escape(&found.summary)
            .replace(" %", "&nbsp;%")
            .replace(" ms", "&nbsp;ms")
    )
}

/// Metrics of one servo, or of two with their difference; what else a comparison found; the paper's
/// facts.
pub(super) fn write_numbers(body: &mut String, page: &Page<'_>) -> Result {
    writeln!(
        body,
        "<h2>What was found</h2>\n<div class=\"wide\"><table class=\"numbers\">"
    )?;
    let remark = write_metrics(body, page)?;
    writeln!(body, "</table></div>\n<p class=\"faint\">{remark}</p>")?;
    if let (Some(found), Some(second)) = (page.comparison, &page.second) {
        let facts =
            summary::facts_of_comparison(page.first.subject.name, second.subject.name, found);
        write_facts(body, &facts)?;
    }
    write_paper(body, page)
}

/// The rows of the table of metrics; what is to be said below it.
fn write_metrics(body: &mut String, page: &Page<'_>) -> std::result::Result<String, Error> {
    let head = |name: &str, level: &str| {
        let name = escape(name);
        format!("<th>{name}<br><span class=\"faint\">{level}</span></th>")
    };
    let parts: Vec<&Part<'_>> = page.parts().collect();
    let models: Vec<_> = parts.iter().map(|part| part.subject.model).collect();
    let mut heads: String = parts
        .iter()
        .map(|part| head(part.subject.name, &summary::level_text(part.subject.model)))
        .collect();
    let gain = common_gain(&parts);
    let compared = page.comparison.map(|found| (found, &found.bounds));
    let (rows, remark) = match compared {
        None => (summary::metric_rows(&models, &gain), String::new()),
        Some((_, Bounds::Withdrawn(_))) => (
            summary::metric_rows(&models, &gain),
            format!(
                "{} The metrics of each side are those of its own model.",
                summary::NOT_COMPARED
            ),
        ),
        Some((found, Bounds::Valid(bounds))) => {
            let level = summary::percent(bounds.level);
            heads += &head("difference", &format!("{level} %"));
            (
                summary::difference_rows(found, &gain),
                summary::how_compared(found).to_owned(),
            )
        }
    };
    writeln!(body, "<tr><th></th>{heads}</tr>")?;
    for row in rows {
        let cell = |(value, bounds): &(String, String)| {
            let value = escape(value);
            let bounds = match bounds.as_str() {
                "" => String::new(),
                bounds => format!("<br><span class=\"faint\">{}</span>", escape(bounds)),
            };
            format!("<td>{value}{bounds}</td>")
        };
        let cells: String = row.cells.iter().map(cell).collect();
        writeln!(body, "<tr><th>{}</th>{cells}</tr>", escape(&row.label))?;
    }
    Ok(remark)
}

/// The unit of the gain, where all parts have the same units.
fn common_gain(parts: &[&Part<'_>]) -> String {
    let mut units = parts.iter().map(|part| part.subject.units);
    let first = units.next();
    let alike = units.all(|other| Some(other) == first);
    let gain = first.filter(|_| alike).and_then(|units| units.gain());
    gain.unwrap_or_default()
}

fn write_paper(body: &mut String, page: &Page<'_>) -> Result {
    if page.paper.is_empty() {
        return Ok(());
    }
    writeln!(
        body,
        "<h2>The paper's facts beside these</h2>\n<div class=\"wide\"><table class=\"numbers\"><tr><th></th><th>figure</th><th>paper</th><th>here</th></tr>"
    )?;
    for fact in page.paper {
        writeln!(
            body,
            "<tr><th>{}</th><td>{}</td><td>{}</td><td>{:.*}</td></tr>",
            escape(fact.fact),
            fact.figure,
            fact.paper,
            fact.digits,
            fact.here
        )?;
    }
    body.push_str("</table></div>\n");
    Ok(())
}

fn write_facts(body: &mut String, facts: &[(String, String)]) -> Result {
    body.push_str("<div class=\"wide\"><table>\n");
    for (name, value) in facts {
        writeln!(
            body,
            "<tr><th>{}</th><td>{}</td></tr>",
            escape(name),
            escape(value)
        )?;
    }
    body.push_str("</table></div>\n");
    Ok(())
}

/// The advice of both models and of the comparison.
pub(super) fn write_advice(body: &mut String, page: &Page<'_>) -> Result {
    let of_parts = page
        .parts()
        .map(|part| (part.subject.name, &part.subject.model.advice));
    let of_comparison = page
        .comparison
        .map(|found| ("the comparison", &found.advice));
    for (name, advice) in of_parts.chain(of_comparison) {
        if advice.is_empty() {
            continue;
        }
        writeln!(
            body,
            "<h2>Advice: {}</h2>\n<ul class=\"advice\">",
            escape(name)
        )?;
        for item in advice {
            let (finding, remedy) = (escape(&item.finding), escape(&item.remedy));
            writeln!(body, "<li><b>{finding}</b><br>{remedy}</li>")?;
        }
        body.push_str("</ul>\n");
    }
    Ok(())
}

/// How the models came about, in words.
pub(super) fn write_structure(body: &mut String, page: &Page<'_>) -> Result {
    writeln!(body, "<h2>How the numbers came about</h2>")?;
    for part in page.parts() {
        let (name, model) = (escape(part.subject.name), part.subject.model);
        let line = summary::one_line(model, part.subject.units.output);
        writeln!(body, "<p><b>{name}</b>: {}</p>", escape(&line))?;
        let sentences = part.explanation.map(|e| e.sentences(model));
        if let Some(sentences) = sentences {
            writeln!(body, "<p>{}</p>", escape(&sentences.join(" ")))?;
        }
    }
    Ok(())
}

/// Where the data come from: what the files of one side agree on once, the rest file by file.
pub(super) fn write_provenance(body: &mut String, page: &Page<'_>) -> Result {
    for part in page.parts().filter(|part| !part.provenance.is_empty()) {
        writeln!(
            body,
            "<h2>Where it comes from: {}</h2>",
            escape(part.subject.name)
        )?;
        let mut keys: Vec<&str> = Vec::new();
        for (key, _) in part.provenance.iter().flatten() {
            if !keys.contains(&key.as_str()) {
                keys.push(key);
            }
        }
        let facts: Vec<(String, String)> = keys
            .into_iter()
            .map(|key| (key.to_owned(), of_all_files(part.provenance, key)))
            .collect();
        write_facts(body, &facts)?;
    }
    Ok(())
}

fn of_all_files(files: &[Facts], key: &str) -> String {
    let of = |facts: &Facts| {
        let found = facts.iter().find(|(name, _)| name == key);
        found.map_or("-", |(_, value)| value.as_str()).to_owned()
    };
    let mut values: Vec<String> = files.iter().map(of).collect();
    if values.iter().all(|value| Some(value) == values.first()) {
        values.truncate(1);
    }
    values.join("; ")
}
