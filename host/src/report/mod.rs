//! One page that holds everything: what was measured, the numbers with their intervals, the advice,
//! and the paper's figures to zoom in. It needs no network, no server and no other file.

mod interactive;

use crate::plots::Figure;
use crate::plots::figures::{self, Subject};
use crate::summary;
use crate::template::fill;
use anyhow::Result;
use std::fmt::Write;

/// The page around it all; `{{name}}` stands for what is put in.
const PAGE: &str = include_str!("page.html");

/// One servo in the report.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// Model, and record where there is one.
    pub subject: Subject<'a>,
    /// Where the data come from, a line each: name and value.
    pub provenance: &'a [(String, String)],
}

/// Makes the page for one servo, or for two to be held against each other.
///
/// # Errors
/// When a number has no form in JSON.
pub fn page(title: &str, first: &Part<'_>, second: Option<&Part<'_>>) -> Result<String> {
    let parts: Vec<&Part<'_>> = std::iter::once(first).chain(second).collect();
    let figures = figures::paper(&first.subject, second.map(|part| &part.subject));
    let mut body = String::new();
    write_numbers(&mut body, &parts)?;
    for part in &parts {
        write_advice(&mut body, part)?;
    }
    for Figure { name, title, .. } in &figures {
        writeln!(
            body,
            "<section><h2>{}</h2><div class=\"figure\" id=\"{}\"></div></section>",
            escape(title),
            escape(name)
        )?;
    }
    for part in &parts {
        write_provenance(&mut body, part)?;
    }
    let drawn: Vec<_> = figures.iter().map(interactive::plotly_json).collect();
    let models: Vec<_> = parts.iter().map(|part| part.subject.model).collect();
    let made_by = format!(
        "servoid {}. Bounds are those of a linear servo: they cover noise, not a servo that changes from run to run or saturates.",
        env!("CARGO_PKG_VERSION")
    );
    let values: [(&str, &str); 6] = [
        ("title", &escape(title)),
        ("made_by", &escape(&made_by)),
        ("body", &body),
        ("figures", &json_in_page(&drawn)?),
        ("models", &json_in_page(&models)?),
        ("library", &interactive::library()),
    ];
    Ok(fill(PAGE, &values))
}

/// Text for a page: what has a meaning in HTML loses it.
fn escape(text: &str) -> String {
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
fn json_in_page(value: &impl serde::Serialize) -> Result<String> {
    Ok(serde_json::to_string(value)?.replace('<', "\\u003c"))
}

fn write_numbers(body: &mut String, parts: &[&Part<'_>]) -> std::fmt::Result {
    let heads: String = parts
        .iter()
        .map(|part| {
            let level = summary::level_text(part.subject.model);
            let name = escape(part.subject.name);
            format!("<th class=\"number\">{name}</th><th>{level} interval</th>")
        })
        .collect();
    writeln!(
        body,
        "<h2>What was found</h2>\n<div class=\"wide\"><table><tr><th></th>{heads}</tr>"
    )?;
    let metrics: Vec<_> = parts
        .iter()
        .map(|part| &part.subject.model.metrics)
        .collect();
    for row in summary::metric_rows(&metrics) {
        let cells: String = row
            .cells
            .iter()
            .map(|(value, bounds)| {
                format!(
                    "<td class=\"number\">{}</td><td class=\"faint\">{}</td>",
                    escape(value),
                    escape(bounds)
                )
            })
            .collect();
        writeln!(body, "<tr><th>{}</th>{cells}</tr>", escape(&row.label))?;
    }
    body.push_str("</table></div>\n");
    for part in parts {
        writeln!(
            body,
            "<p>{}: {}</p>",
            escape(part.subject.name),
            escape(&summary::one_line(part.subject.model, part.subject.unit))
        )?;
    }
    Ok(())
}

fn write_advice(body: &mut String, part: &Part<'_>) -> std::fmt::Result {
    let advice = &part.subject.model.advice;
    if advice.is_empty() {
        return Ok(());
    }
    writeln!(
        body,
        "<h2>Advice: {}</h2>\n<ul class=\"advice\">",
        escape(part.subject.name)
    )?;
    for item in advice {
        writeln!(
            body,
            "<li><b>{}</b><br>{}</li>",
            escape(&item.finding),
            escape(&item.remedy)
        )?;
    }
    body.push_str("</ul>\n");
    Ok(())
}

fn write_provenance(body: &mut String, part: &Part<'_>) -> std::fmt::Result {
    if part.provenance.is_empty() {
        return Ok(());
    }
    writeln!(
        body,
        "<h2>Where it comes from: {}</h2>\n<div class=\"wide\"><table>",
        escape(part.subject.name)
    )?;
    for (name, value) in part.provenance {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_from_elsewhere_stay_texts() {
        let hostile = "</script><script>alert('x')</script>\"&{{library}}";
        assert!(!escape(hostile).contains('<'));
        assert!(!json_in_page(&[hostile]).unwrap().contains('<'));
        let values = [
            ("title", escape(hostile)),
            ("library", "THE LIBRARY".into()),
        ];
        let page = fill(PAGE, &values);
        assert_eq!(
            page.matches("THE LIBRARY").count(),
            1,
            "a value is never filled in again"
        );
        assert!(!page.contains("alert('x')"));
    }

    #[test]
    fn the_library_is_one_script() {
        let library = interactive::library();
        assert!(library.starts_with("<script") && library.ends_with("</script>"));
        assert_eq!(library.matches("</script>").count(), 1);
    }
}
