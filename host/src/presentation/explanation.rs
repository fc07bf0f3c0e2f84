//! Why a model has the structure that it has, as text.

use crate::presentation::summary::decimals;
use servoid_identification::diagnostics::Explanation;
use servoid_identification::results::{Model, Structure};
use servoid_identification::thresholds::{CONTRADICTION, MARGIN};
use std::fmt::Write;

/// Lines of a table that are printed; a long search is thinned out to about so many.
const MOST_LINES: usize = 16;

/// The way to the structure, as tables.
pub(crate) fn as_text(explanation: &Explanation, model: &Model) -> String {
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
    let parameters = structure.frequencies + 1 + structure.noise_order;
    write!(
        text,
        "  data        {} rows for {parameters} parameters",
        e.rows
    )?;
    match &e.degrees_of_freedom {
        Some(degrees) => {
            let least = degrees.iter().copied().fold(f64::INFINITY, f64::min);
            writeln!(
                text,
                "; every bound rests on {least:.0} degrees of freedom or more"
            )?;
        }
        None => writeln!(text)?,
    }
    write_settling(text, e, structure)?;
    if !e.noise_orders.is_empty() {
        write_noise_orders(text, e, structure)?;
    }
    if !e.frequencies.is_empty() {
        write_frequencies(text, e, structure)?;
    }
    Ok(())
}

fn write_settling(text: &mut String, e: &Explanation, structure: &Structure) -> std::fmt::Result {
    let Some(choice) = &e.settling else {
        let asked_for = structure.settling_samples;
        return writeln!(text, "  settling    N = {asked_for} was asked for");
    };
    writeln!(
        text,
        "\n  settling time N: the response is taken to be over after N samples. For each N that was tried, 'settles at'\n  is the number of samples after which the response found with it rests, and 'apart' its distance from the response\n  found with the longest, N = {} (in standard deviations of the difference). The smallest N is chosen that is {MARGIN} times its\n  'settles at', with {CONTRADICTION} sd apart at most.\n\n  {:>8} {:>10} {:>16}",
        choice.longest, "N", "settles at", "apart"
    )?;
    for c in &choice.candidates {
        let mark = mark(c.settling == structure.settling_samples);
        writeln!(
            text,
            "  {:>8} {:>10} {:>13.1} sd{mark}",
            c.settling, c.detected, c.contradiction
        )?;
    }
    let settling = structure.settling_samples;
    if choice.candidates.iter().all(|c| c.settling != settling) {
        writeln!(text, "  the model has N = {settling}, for the reason below")?;
    }
    if !choice.settled {
        writeln!(
            text,
            "  none was accepted: the longest is used, and the response may not be over by then"
        )?;
    }
    Ok(())
}

/// Behind the line of a table that was taken.
fn mark(chosen: bool) -> &'static str {
    if chosen { "  <- chosen" } else { "" }
}

fn write_noise_orders(
    text: &mut String,
    e: &Explanation,
    structure: &Structure,
) -> std::fmt::Result {
    writeln!(
        text,
        "\n  noise order d: how many of the last errors the noise model makes use of. Bayes' criterion (BIC) weighs what an\n  order explains against how many numbers it takes; the smallest is chosen.\n\n  {:>8} {:>20}",
        "d", "BIC above smallest"
    )?;
    let smallest = e.noise_orders.iter().map(|c| c.bic);
    let smallest = smallest.fold(f64::INFINITY, f64::min);
    for c in &e.noise_orders {
        let mark = mark(c.order == structure.noise_order);
        writeln!(text, "  {:>8} {:>20.1}{mark}", c.order, c.bic - smallest)?;
    }
    Ok(())
}

fn write_frequencies(
    text: &mut String,
    e: &Explanation,
    structure: &Structure,
) -> std::fmt::Result {
    let widths = e.frequencies.last().and_then(|c| c.noise_half_width);
    write!(
        text,
        "\n  frequencies n: by how many the response is described. With n = N nothing is left out; {}'prediction' is the\n  error of predicting what was not seen (generalised cross-validation), the least being 1.\n\n  {:>8} {:>14}",
        match widths {
            Some(_) =>
                "with fewer, the band of the\n  noise is narrower, and what is left out may add as much as 'left out' (both for a unit step). ",
            None => "",
        },
        "n",
        "prediction"
    )?;
    match widths {
        Some(_) => writeln!(text, " {:>12} {:>12}", "noise ±", "left out")?,
        None => writeln!(text)?,
    }
    let digits = widths.map_or(4, |width| decimals(width, 2));
    let gcv = e.frequencies.iter().map(|c| c.gcv);
    let least = gcv.fold(f64::INFINITY, f64::min);
    let every = e.frequencies.len().div_ceil(MOST_LINES);
    for (i, c) in e.frequencies.iter().enumerate() {
        let chosen = c.frequencies == structure.frequencies;
        if chosen || i % every == 0 {
            let ratio = c.gcv / least;
            // Without any noise nothing is a multiple of the least error, which is 0.
            let prediction = match ratio.is_finite() {
                true => format!("{ratio:.4}"),
                false => "-".to_owned(),
            };
            write!(text, "  {:>8} {prediction:>14}", c.frequencies)?;
            for width in [c.noise_half_width, c.truncation_bias]
                .into_iter()
                .flatten()
            {
                write!(text, " {width:>12.digits$}")?;
            }
            writeln!(text, "{}", mark(chosen))?;
        }
    }
    Ok(())
}
