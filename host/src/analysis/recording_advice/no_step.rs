//! Up to which size steps are known from a recording that is not one of steps, such as that of a stick.

use crate::data::dataset::Dataset;
use crate::presentation::summary::{digits, with_unit};
use servoid_identification::results::{Advice, Check, Model};
use servoid_identification::{Record, Run};

/// A command of steps makes all of what it changes within a rise time from one row to the next: the squares of both have one mean, each over as many
/// rows. One that moves at an even speed has a ratio of one to the rows of the rise time. This far between the two it is one of steps.
const AT_ONCE: f64 = 0.5;

/// A share of the recording whose motion shows as a whole: a few rows decide nothing of a response.
const MOST: f64 = 0.99;

/// Parts of the rise time over each of which speeds are means: from row to row, the errors of a response that the recording hardly determines are larger than its
/// changes of speed.
const PARTS: usize = 5;

/// After steps up to which size the servo moves no faster, and gains no speed more quickly, than in the recording, where that is not one of steps. Recordings of
/// servoid have the reference that was asked for.
pub(crate) fn advice(data: &Dataset, model: &Model) -> Option<Advice> {
    let rise_s = model
        .metrics
        .rise_time_s
        .value
        .filter(|_| data.about.is_of_rows())?;
    let rows = (rise_s / data.record.sample_period_s()).round() as usize;
    if rows < 2 || is_of_steps(&data.record, rows) || is_vague(model) {
        return None;
    }
    let most = largest_step(&data.record, model, (rows / PARTS).max(1))?;
    let size = with_unit(
        digits(most, 2),
        data.about.units().input.unwrap_or_default(),
    );
    Some(Advice::new(
        Check::SmoothReference,
        format!(
            "This recording is not one of steps: in {:.0} % of it the servo moves no faster, or gains speed no more quickly, than after a step of {size}, and times after \
             a step hold for steps up to that size.",
            100.0 * MOST
        ),
        most,
        0.0,
        "For larger ones, record steps: a servo may meet a limit of its speed or of its drive there, which a servo model looks for in this recording.",
    ))
}

/// Whether the response of `model` is known so badly that its errors may move faster than the servo, as of one without bounds.
fn is_vague(model: &Model) -> bool {
    let Some(bounds) = model.step.bounds.valid() else {
        return true;
    };
    let ends = bounds.pointwise.lower.iter().zip(&bounds.pointwise.upper);
    let widest = ends
        .map(|(lower, upper)| (upper - lower) / 2.0)
        .fold(0.0, f64::max);
    let end = model.step.value.last().copied().unwrap_or(0.0);
    widest > VAGUE * end.abs()
}

/// Half width of the bounds of a response, as a share of its end, above which it is that.
const VAGUE: f64 = 0.1;

/// Whether what the command changes within so many rows it changes from one row to the next.
fn is_of_steps(record: &Record, rows: usize) -> bool {
    let square = |rows: usize| changes(record, rows).iter().map(|x| x * x).sum::<f64>();
    let even = 1.0 / rows as f64;
    rows as f64 * square(1) > (even + AT_ONCE * (1.0 - even)) * square(rows)
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

/// The largest step after which the model has no more speed, and no more change of it, than it has in the recording; speeds are means over `lag` rows.
fn largest_step(record: &Record, model: &Model, lag: usize) -> Option<f64> {
    let mut step = vec![0.0; 2 * lag];
    step.extend(&model.step.value);
    let runs = record.runs().iter().map(|run| model.simulate(run));
    let runs: Vec<Vec<f64>> = runs.collect();
    let of_order = |difference: fn([f64; 3]) -> f64| {
        let sizes = |y: &Vec<f64>| -> Vec<f64> {
            let (later, last) = (y.iter().skip(lag), y.iter().skip(2 * lag));
            let threes = y.iter().zip(later).zip(last);
            let sizes = threes.map(|((a, b), c)| difference([*a, *b, *c]).abs());
            sizes.filter(|size| size.is_finite()).collect()
        };
        let mut recorded: Vec<f64> = runs.iter().flat_map(sizes).collect();
        recorded.sort_by(f64::total_cmp);
        let recorded = *recorded.get((MOST * recorded.len() as f64) as usize)?;
        let of_step = sizes(&step).into_iter().fold(0.0, f64::max);
        (of_step > 0.0).then(|| recorded / of_step)
    };
    let by_speed = of_order(|[_, before, now]| now - before)?;
    let by_acceleration = of_order(|[first, before, now]| now - 2.0 * before + first)?;
    Some(by_speed.min(by_acceleration))
}
