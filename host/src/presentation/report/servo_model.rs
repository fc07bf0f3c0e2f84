//! The servo as a machine in the page: its quantities with their intervals.

use super::content::{Page, Part};
use super::text::{escape, rows_of};
use crate::presentation::summary;
use servoid_identification::results::Bounds;

/// The quantities of each servo, and of two beside each other.
pub(super) fn tables(page: &Page<'_>) -> String {
    let of_each: String = page.parts().filter_map(table).collect();
    of_each + &beside_each_other(page).unwrap_or_default()
}

fn beside_each_other(page: &Page<'_>) -> Option<String> {
    let (found, second) = (page.servo_models?, page.second.as_ref()?);
    let units = page.first.subject.units;
    let names = [page.first.subject.name, second.subject.name];
    let sentence = summary::sentence_on_servo_models(names[0], names[1], found, units);
    let heads: String = names
        .iter()
        .chain(found.bounds.valid().map(|_| &"difference"))
        .map(|name| format!("<th>{}</th>", escape(name)))
        .collect();
    let rows = rows_of(&summary::servo_model_rows(found, units));
    Some(format!(
        "<h2>The two as machines</h2>\n<p>{}</p>\n<div class=\"wide\"><table class=\"numbers\">\n<tr><th></th>{heads}</tr>\n{rows}</table></div>\n<p class=\"faint\">{}</p>\n",
        escape(&sentence),
        summary::how_servo_models_are_compared(found)
    ))
}

fn table(part: &Part<'_>) -> Option<String> {
    let model = &part.servo_model?.model;
    let units = part.subject.units;
    let level = model.covariance.as_ref().map(|covariance| covariance.level);
    let remark = match level {
        Bounds::Valid(_) if model.alternatives.is_empty() => String::new(),
        Bounds::Valid(_) => format!(
            " {} other sets of terms predict as well: the intervals hold for all of them.",
            model.alternatives.len()
        ),
        Bounds::Withdrawn(reason) => {
            format!(" No intervals can be given, as {}.", reason.because())
        }
    };
    let offsets = summary::run_offsets_in_words(model, units);
    let remark = remark + &offsets.map_or_else(String::new, |sentence| format!(" {sentence}"));
    let row = |row: summary::QuantityRow| {
        let [label, value, unit, interval] =
            [&row.name, &row.value, &row.unit, &row.interval].map(|text| escape(text));
        format!("<tr><th>{label}</th><td>{value}</td><td>{unit}</td><td>{interval}</td></tr>\n")
    };
    let rows = summary::quantity_rows(&model.quantities, units).into_iter();
    let rows: String = rows.map(|(_, found)| row(found)).collect();
    let advice: String = summary::advice_on_servo_model(model)
        .iter()
        .map(|advice| format!("<p>{}</p>\n", escape(advice)))
        .collect();
    let fit = &model.fit;
    Some(format!(
        "<h2>The servo as a machine: {}</h2>\n<p class=\"faint\">{}; fit {:.2} %, {:.2} % of parts that it had not seen (a linear servo of second order: {:.2} %).{}</p>\n<div class=\"wide\"><table class=\"numbers\">\n<tr><th></th><th>value</th><th></th><th>{}</th></tr>\n{rows}</table></div>\n{advice}",
        escape(part.subject.name),
        summary::kind_in_words(model),
        fit.simulation_percent,
        fit.held_out_percent,
        fit.linear_held_out_percent,
        escape(&remark),
        summary::head_of_bounds(level),
    ))
}
