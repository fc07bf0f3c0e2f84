//! Why a model has the structure that it has, as text.

use crate::summary::decimals;
use servoid_identification::model::Structure;
use servoid_identification::normal::Path;
use servoid_identification::{Explanation, Model};
use std::fmt::Write;

/// Lines of a table that are printed; a long search is thinned out to about so many.
const MOST_LINES: usize = 16;

/// The way to the structure, as tables.
#[must_use]
pub fn as_text(explanation: &Explanation, model: &Model) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _infallible = write_text(&mut text, explanation, &model.structure);
    for sentence in explanation.sentences(model) {
        let _infallible = writeln!(text, "\n  {sentence}");
    }
    text
}

fn write_text(text: &mut String, e: &Explanation, structure: &Structure) -> std::fmt::Result {
    writeln!(text, "\nhow the structure came about")?;
    let arithmetic = match e.path {
        Path::Moments => "lagged moments, one pass",
        Path::Qr => "QR on the rows, as the moments are too ill-conditioned",
    };
    let least = e
        .degrees_of_freedom
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min);
    writeln!(
        text,
        "  arithmetic  {arithmetic}; condition number {:.0}; {} rows for {} parameters; at least {least:.0} degrees of freedom",
        e.condition,
        e.rows,
        structure.frequencies + 1 + structure.noise_order
    )?;
    match &e.settling {
        None => writeln!(
            text,
            "  settling    N = {} was asked for",
            structure.settling_samples
        )?,
        Some(choice) => {
            writeln!(
                text,
                "\n  settling time: the smallest N that is 1.75 times the settling that it finds itself, and that\n  the fit with N = {} does not contradict (by more than 4.75 standard deviations)\n\n  {:>8} {:>10} {:>16}",
                choice.longest, "N", "settles at", "contradiction"
            )?;
            for c in &choice.candidates {
                let mark = if c.accepted { "  <- chosen" } else { "" };
                writeln!(
                    text,
                    "  {:>8} {:>10} {:>13.1} sd{mark}",
                    c.settling, c.detected, c.contradiction
                )?;
            }
            if !choice.settled {
                writeln!(
                    text,
                    "  none was accepted: the longest is used, and the response may not be over by then"
                )?;
            }
        }
    }
    if !e.noise_orders.is_empty() {
        writeln!(
            text,
            "\n  noise order: the smallest BIC\n\n  {:>8} {:>14}",
            "d", "BIC"
        )?;
        for c in &e.noise_orders {
            let mark = if c.order == structure.noise_order {
                "  <- chosen"
            } else {
                ""
            };
            writeln!(text, "  {:>8} {:>14.1}{mark}", c.order, c.bic)?;
        }
    }
    if !e.frequencies.is_empty() {
        writeln!(
            text,
            "\n  frequencies: n = N holds without further assumptions; fewer are narrower in white noise, and\n  biased by what they leave out (GCV, the error of prediction, relative to the least)\n\n  {:>8} {:>14} {:>12} {:>12}",
            "n", "GCV / least", "noise +-", "bias up to"
        )?;
        let digits = e
            .frequencies
            .last()
            .map_or(4, |c| decimals(c.noise_half_width, 2));
        let gcv = e.frequencies.iter().map(|c| c.gcv);
        let least = gcv.fold(f64::INFINITY, f64::min);
        let every = e.frequencies.len().div_ceil(MOST_LINES);
        for (i, c) in e.frequencies.iter().enumerate() {
            let chosen = c.frequencies == structure.frequencies;
            if chosen || i % every == 0 {
                let mark = if chosen { "  <- chosen" } else { "" };
                writeln!(
                    text,
                    "  {:>8} {:>14.4} {:>12.digits$} {:>12.digits$}{mark}",
                    c.frequencies,
                    c.gcv / least,
                    c.noise_half_width,
                    c.truncation_bias
                )?;
            }
        }
    }
    Ok(())
}
