//! The page's text: verdict, metrics, advice, provenance.

use super::content::{Facts, Page, Part};
use crate::presentation::paper_values::Fact;
use crate::presentation::summary::{self, TableRow};
use servoid_identification::results::{Advice, Bounds};

/// Text without the characters that have a meaning in HTML.
pub(super) fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;");
    let text = text.replace('<', "&lt;").replace('>', "&gt;");
    text.replace('"', "&quot;").replace('\'', "&#39;")
}

/// JSON for a `<script>` element, which the text `</script>` in a file's name would otherwise end.
pub(super) fn json_in_page(value: &impl serde::Serialize) -> anyhow::Result<String> {
    Ok(serde_json::to_string(value)?.replace('<', "\\u003c"))
}

/// What the first screen says in short: each servo by itself, and the two together.
pub(super) fn words(page: &Page<'_>) -> String {
    let mut body = "<h2>In words</h2>\n".to_owned();
    body.extend(page.parts().map(|part| of_one(part, page.second.is_some())));
    if let (Some(found), Some(second)) = (page.comparison, page.second) {
        let [first, second] = [&page.first, &second].map(|part| escape(part.subject.name));
        let unit = page.first.subject.units.output.unwrap_or_default();
        let summary = found.summary_beside(page.servo_models, unit);
        body += &format!(
            "<p>The first is {first}, the second {second}. {}</p>\n",
            escape(summary)
        );
    }
    body
}

/// The data of one side, and what its models say. One servo's servo model has spoken on the first screen.
fn of_one(part: &Part<'_>, has_other: bool) -> String {
    let (name, model) = (escape(part.subject.name), part.subject.model);
    let files = part
        .provenance
        .iter()
        .filter_map(|facts| of_key(facts, "file"));
    let files: Vec<&str> = files.collect();
    let from = match files.len() {
        0 => "a model".to_owned(),
        1..=4 => escape(&files.join(", ")),
        many => format!("{many} recordings"),
    };
    let runs = match part.subject.record.map_or(0, |record| record.runs().len()) {
        0 => String::new(),
        1 => ", one run".to_owned(),
        many => format!(", {many} runs"),
    };
    let seconds = model.fit.samples_used as f64 * model.sample_period_s;
    let sentence = part
        .servo_model
        .filter(|_| has_other)
        .map(|found| summary::servo_sentence(&found.model, model, part.subject.units));
    let as_machine = sentence.map(|sentence| escape(&sentence) + " ");
    let linear = match part.servo_model {
        Some(_) => "As a linear servo: ",
        None => "",
    };
    let strokes = summary::of_one_size(model, part.metadata);
    let strokes = strokes.map(|strokes| format!(" Its strokes are {strokes}."));
    let by_order = part.low_order;
    let by_order =
        by_order.and_then(|flight| summary::low_order_sentence(flight, model, part.subject.units));
    let by_order = by_order.map(|sentence| format!(" {sentence}"));
    format!(
        "<p><b>{name}</b>, from {from}{runs}, {seconds:.1} s used. {}{linear}{}{}{}</p>\n",
        as_machine.unwrap_or_default(),
        escape(&summary::model_sentence(model, part.metadata)),
        escape(&by_order.unwrap_or_default()),
        escape(&strokes.unwrap_or_default())
    )
}

/// Metrics of one servo, or of two with their difference; further results of a comparison; the paper's values.
pub(super) fn numbers(page: &Page<'_>) -> String {
    let (rows, remark) = metrics(page);
    let mut body = format!(
        "<h2>Results</h2>\n<div class=\"wide\"><table class=\"numbers\">\n{rows}</table></div>\n<p class=\"faint\">{remark}</p>\n"
    );
    if let (Some(found), Some(second)) = (page.comparison, &page.second) {
        let names = [page.first.subject.name, second.subject.name];
        body += &table(&summary::facts_of_comparison(
            names[0],
            names[1],
            found,
            page.first.metadata.units(),
        ));
    }
    body + &paper(page)
}

/// The rows of the table of metrics, and a remark on them.
fn metrics(page: &Page<'_>) -> (String, String) {
    let head = |name: &str, level: &str| {
        let name = escape(name);
        format!("<th>{name}<br><span class=\"faint\">{level}</span></th>")
    };
    let head_of = |part: &Part<'_>| {
        let subject = part.subject;
        let strokes = summary::stroke_in_words(part.metadata);
        let strokes = strokes.map_or_else(String::new, |stroke| format!(", strokes of {stroke}"));
        let level = summary::level_text(subject.model) + &escape(&strokes);
        head(subject.name, &level)
    };
    let mut heads: String = page.parts().map(head_of).collect();
    let gain = common_gain(page);
    let metrics: Vec<_> = page
        .parts()
        .map(|part| &part.subject.model.metrics)
        .collect();
    let compared = page.comparison.map(|found| (found, &found.bounds));
    let (rows, remark) = match compared {
        Some((found, Bounds::Valid(bounds))) => {
            let level = summary::percent(bounds.level);
            heads += &head("difference", &format!("{level} %"));
            let remark = summary::how_compared(found).to_owned();
            (summary::difference_rows(found, &gain), remark)
        }
        _ => {
            let compared = compared.map(|_| {
                let why = summary::NOT_COMPARED;
                format!("{why} The metrics of each side are those of its own model.")
            });
            let withheld = page.parts().filter_map(|part| {
                let line = summary::withheld_line(&part.subject.model.metrics)?;
                Some(match page.second {
                    Some(_) => format!("{}: {line}.", part.subject.name),
                    None => format!("{line}."),
                })
            });
            let remarks: Vec<String> = compared.into_iter().chain(withheld).collect();
            (
                summary::metric_rows(&metrics, &gain),
                escape(&remarks.join(" ")),
            )
        }
    };
    (
        format!("<tr><th></th>{heads}</tr>\n{}", rows_of(&rows)),
        remark,
    )
}

/// Rows of numbers, with their bounds below them.
pub(super) fn rows_of(rows: &[TableRow]) -> String {
    let cell = |(value, bounds): &(String, String)| {
        let (value, bounds) = (escape(value), escape(bounds));
        match bounds.as_str() {
            "" => format!("<td>{value}</td>"),
            bounds => format!("<td>{value}<br><span class=\"faint\">{bounds}</span></td>"),
        }
    };
    let row = |row: &TableRow| {
        let cells: String = row.cells.iter().map(cell).collect();
        format!("<tr><th>{}</th>{cells}</tr>\n", escape(&row.label))
    };
    rows.iter().map(row).collect()
}

/// The unit of the gain, where all parts have the same units.
pub(super) fn common_gain(page: &Page<'_>) -> String {
    let first = page.first.subject.units;
    let alike = page.parts().all(|part| part.subject.units == first);
    let gain = if alike { first.gain() } else { None };
    gain.unwrap_or_default()
}

fn paper(page: &Page<'_>) -> String {
    if page.paper.is_empty() {
        return String::new();
    }
    let row = |fact: &Fact| {
        let (name, digits) = (escape(fact.fact), fact.digits);
        let (figure, paper, here) = (fact.figure, fact.paper, fact.here);
        format!(
            "<tr><th>{name}</th><td>{figure}</td><td>{paper}</td><td>{here:.digits$}</td></tr>\n"
        )
    };
    format!(
        "<h2>The paper's values beside these</h2>\n<div class=\"wide\"><table class=\"numbers\"><tr><th></th><th>figure</th><th>paper</th><th>here</th></tr>\n{}</table></div>\n",
        page.paper.iter().map(row).collect::<String>()
    )
}

fn table(facts: &[(String, String)]) -> String {
    let row = |(name, value): &(String, String)| {
        format!(
            "<tr><th>{}</th><td>{}</td></tr>\n",
            escape(name),
            escape(value)
        )
    };
    let rows: String = facts.iter().map(row).collect();
    format!("<div class=\"wide\"><table>\n{rows}</table></div>\n")
}

/// The advice of both models and of the comparison, each check once.
pub(super) fn advice(page: &Page<'_>) -> String {
    let of_parts = page.parts().flat_map(|part| {
        let advice = part.subject.model.advice.iter();
        advice.map(|item| (part.subject.name, item))
    });
    let checks = Advice::by_check(of_parts);
    // The comparison repeats what bears on it of a side, whose model has said it.
    let said = |item: &Advice| {
        let mut all = checks.iter().flatten();
        item.bears_on_comparison() && all.any(|(_, own)| own.is_of_same_check(item))
    };
    let of_comparison = page.comparison.into_iter().flat_map(|found| &found.advice);
    let further = of_comparison.filter(|item| !said(item));
    let further: Vec<[(&str, &Advice); 1]> = further.map(|item| [("", item)]).collect();
    let items: String = (checks.iter().map(Vec::as_slice))
        .chain(further.iter().map(<[_; 1]>::as_slice))
        .map(|found| of_check(found, page.second.is_some()))
        .collect();
    match items.is_empty() {
        true => items,
        false => format!("<h2>Advice</h2>\n<ul class=\"advice\">\n{items}</ul>\n"),
    }
}

/// The findings of one check, of each side by its name where there are two, and each remedy once.
fn of_check(found: &[(&str, &Advice)], two_sides: bool) -> String {
    let mut remedies: Vec<&str> = found.iter().map(|(_, item)| item.remedy.as_str()).collect();
    remedies.dedup();
    let finding = |(name, item): &(&str, &Advice)| match two_sides && !name.is_empty() {
        true => format!("{name}: {}", item.finding),
        false => item.finding.clone(),
    };
    let findings: Vec<String> = found.iter().map(|one| escape(&finding(one))).collect();
    format!(
        "<li><b>{}</b><br>{}</li>\n",
        findings.join("<br>"),
        escape(&remedies.join(" "))
    )
}

/// The choice of the models' structures, in words.
pub(super) fn structure(page: &Page<'_>) -> String {
    let mut body = "<h2>Data, structure and fit</h2>\n".to_owned();
    for part in page.parts() {
        let (name, model) = (escape(part.subject.name), part.subject.model);
        let facts = summary::facts(model, part.subject.units.output);
        let facts = facts.map(|(name, value)| format!("{name}: {value}"));
        body += &format!("<p><b>{name}</b>: {}</p>\n", escape(&facts.join("; ")));
        if let Some(explanation) = part.explanation {
            let sentences = explanation.sentences(model).join(" ");
            body += &format!("<p>{}</p>\n", escape(&sentences));
        }
    }
    body
}

/// The origin of the data: what the files of one side agree on once, the rest file by file.
pub(super) fn provenance(page: &Page<'_>) -> String {
    let mut body = String::new();
    for part in page.parts().filter(|part| !part.provenance.is_empty()) {
        let mut facts: Vec<(String, String)> = Vec::new();
        for (key, _) in part.provenance.iter().flatten() {
            if of_key(&facts, key).is_none() {
                facts.push((key.clone(), of_all_files(part.provenance, key)));
            }
        }
        let name = escape(part.subject.name);
        body += &format!("<h2>Origin of the data: {name}</h2>\n{}", table(&facts));
    }
    body
}

fn of_key<'a>(facts: &'a [(String, String)], key: &str) -> Option<&'a str> {
    let found = facts.iter().find(|(name, _)| name == key);
    found.map(|(_, value)| value.as_str())
}

fn of_all_files(files: &[Facts], key: &str) -> String {
    let mut values: Vec<&str> = files
        .iter()
        .map(|facts| of_key(facts, key).unwrap_or("-"))
        .collect();
    if values.iter().all(|value| Some(value) == values.first()) {
        values.truncate(1);
    }
    values.join("; ")
}
