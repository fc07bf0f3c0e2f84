//! Up to which size steps are known from a recording that is not one of steps, such as that of a stick.

use crate::data::dataset::Dataset;
use crate::presentation::summary::{digits, with_unit};
use servoid_identification::results::{Advice, Check, Model};
use servoid_identification::{Record, Run};

/// A command of steps makes all of what it changes within a rise time from one row to the next: the squares of both have one mean, each over as many
/// rows. One that moves at an even speed has a ratio of one to the rows of the rise time, a stick that is read every other row of two.
const AT_ONCE: f64 = 0.5;

/// A share of the recording whose changes show as a whole: a few larger ones decide nothing of a response.
const MOST: f64 = 0.99;

/// How far the command moves within the time in which the servo answers, where that is by no steps. Recordings of servoid have the reference
/// that was asked for.
pub(super) fn advice(data: &Dataset, model: &Model) -> Option<Advice> {
    let is_of_rows = data.about.commands_at_rows || data.about.polled;
    let rise_s = model.metrics.rise_time_s.value.filter(|_| is_of_rows)?;
    let rows = (rise_s / data.record.sample_period_s()).round() as usize;
    let mut within = changes(&data.record, rows.max(1));
    let square = |changes: &[f64]| changes.iter().map(|change| change * change).sum::<f64>();
    let at_once = rows as f64 * square(&changes(&data.record, 1));
    if rows < 2 || at_once > AT_ONCE * square(&within) {
        return None;
    }
    within.sort_by(f64::total_cmp);
    let most = *within.get((MOST * within.len() as f64) as usize)?;
    let size = with_unit(
        digits(most, 2),
        data.about.units().input.unwrap_or_default(),
    );
    Some(Advice::new(
        Check::SmoothReference,
        format!(
            "This recording is not one of steps: within the rise time of {:.0} ms the command changes by up to {size} in {:.0} % of it, and times after \
             a step hold for steps up to that size.",
            1e3 * rise_s,
            100.0 * MOST
        ),
        most,
        0.0,
        "For larger ones, record steps: a servo may meet a limit of its speed there, which a servo model looks for in this recording.",
    ))
}

/// The sizes of the changes of the command over so many rows.
fn changes(record: &Record, rows: usize) -> Vec<f64> {
    let of_run = |run: &Run<'_>| -> Vec<f64> {
        let later = run.input().iter().skip(rows);
        let changes = run.input().iter().zip(later).map(|(a, b)| (b - a).abs());
        changes.filter(|change| change.is_finite()).collect()
    };
    record.runs().iter().flat_map(of_run).collect()
}
