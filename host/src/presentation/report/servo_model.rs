//! The servo as a machine in the page: its quantities with their intervals.

use super::content::{Page, Part};
use super::text::{escape, rows_of};
use crate::presentation::summary;
use servoid_identification::servo_model::Quantity;

/// The quantities of each servo, and of two beside each other.
pub(super) fn tables(page: &Page<'_>) -> String {
    let of_each: String = page.parts().filter_map(table).collect();
    of_each + &beside_each_other(page).unwrap_or_default()
}

fn beside_each_other(page: &Page<'_>) -> Option<String> {
    let (found, second) = (page.servo_models?, page.second.as_ref()?);
    let units = page.first.subject.units;
    let names = [page.first.subject.name, second.subject.name];
    let sentence =
        summary::sentence_on_servo_models(names[0], names[1], found, page.comparison, units);
    let heads: String = names
        .iter()
        .chain(found.bounds.valid().map(|_| &"difference"))
        .map(|name| format!("<th>{}</th>", escape(name)))
        .collect();
    let rows = rows_of(&summary::servo_model_rows(found, units));
    Some(format!(
        "<h2>The two as machines</h2>\n<p>{}</p>\n<div class=\"wide\"><table class=\"numbers\">\n<tr><th>{}</th>{heads}</tr>\n{rows}</table></div>\n<p class=\"faint\">{}</p>\n",
        escape(&sentence),
        summary::what_is_below(found),
        summary::how_servo_models_are_compared(found)
    ))
}

fn table(part: &Part<'_>) -> Option<String> {
    let document = part.servo_model?;
    let model = &document.model;
    let units = part.subject.units;
    let level = model.covariance.as_ref().map(|covariance| covariance.level);
    let row = |(quantity, row): (&Quantity, summary::QuantityRow)| {
        let turn = summary::per_60_degrees(quantity, units).unwrap_or_default();
        let [label, value, unit, interval, turn] =
            [&row.name, &row.value, &row.unit, &row.interval, &turn].map(|text| escape(text));
        format!(
            "<tr><th>{label}</th><td>{value}</td><td>{unit}</td><td>{interval}</td><td>{turn}</td></tr>\n"
        )
    };
    let rows = summary::quantity_rows(&model.quantities, units).into_iter();
    let rows: String = rows.map(row).collect();
    let remarks = summary::ServoRemarks::of(document, units);
    let paragraph = |remark: &String| format!("<p>{}</p>\n", escape(remark));
    let [before, behind] =
        [remarks.before, remarks.behind].map(|all| all.iter().map(paragraph).collect::<String>());
    let fit = &model.fit;
    Some(format!(
        "<h2>The servo as a machine: {}</h2>\n<p class=\"faint\">{}; fit {:.2} %, {:.2} % of parts that it had not seen (a linear servo of second order: {:.2} %); {}.</p>\n{before}<div class=\"wide\"><table class=\"numbers\">\n<tr><th></th><th>value</th><th></th><th>{}</th><th></th></tr>\n{rows}</table></div>\n{behind}",
        escape(part.subject.name),
        summary::kind_in_words(model),
        fit.simulation_percent,
        fit.held_out_percent,
        fit.linear_held_out_percent,
        escape(&summary::error_in_words(model, units)),
        summary::head_of_bounds(level),
    ))
}
