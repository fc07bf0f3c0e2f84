//! Whether each run of a record by itself leaves its servo nothing but noise, where all of them together do not.
//!
//! Then the equation lacks nothing: supply, temperature or friction changed between the runs, and no one servo made them all.

use super::candidates::polished;
use super::search_progress::Watch;
use super::search_setup::{CLIP, fine_grid, longest_delay_s, usable_stretches};
use crate::data::Record;
use crate::servo_model::descent::chosen_terms::Descent;
use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::descent::starting_values::Shown;
use crate::servo_model::uncertainty::validity::against;
use crate::thresholds::RUNS_ALONE_LEAVE;
use rayon::prelude::*;

/// Whether the servo `of_all` changed between the runs of `record`, of which it lacks up to `lacking` \[output, rms\]: each run by itself has a servo with these terms
/// whose errors are noise, and lacks far less.
pub(super) fn servo_changed(
    record: &Record,
    controllers: &[usize],
    (of_all, lacking): (&Point, f64),
    watch: &dyn Watch,
) -> bool {
    let count = record.runs().len();
    let alone = |run: usize| lacking_alone(record, controllers, (of_all, run), watch);
    let lacking_alone: Option<Vec<f64>> = (0..count).into_par_iter().map(alone).collect();
    let square = |all: Vec<f64>| all.iter().map(|rms| rms * rms).sum::<f64>() / count as f64;
    let left = lacking_alone.map(square);
    count > 1 && left.is_some_and(|left| left < RUNS_ALONE_LEAVE * lacking * lacking)
}

/// What the servo of one run lacks at the most \[output, rms\], with the terms of all; `None` where its errors are not noise, or something else speaks against it.
fn lacking_alone(
    record: &Record,
    controllers: &[usize],
    (of_all, run): (&Point, usize),
    watch: &dyn Watch,
) -> Option<f64> {
    let record = record.with_runs(vec![record.runs().get(run)?.clone()]);
    let controllers = controllers.get(run..=run).unwrap_or_default();
    let (mut parts, fold_of) = usable_stretches(&record, controllers).ok()?;
    let period_s = record.sample_period_s();
    let shown = Shown::by(&parts, period_s);
    let shown = shown.with_stops(of_all.stops);
    let shown = shown.with_pulse_end(of_all.pulse_end);
    let from = Point {
        run_offsets: Vec::new(),
        ..of_all.clone()
    };
    let descent = Descent {
        grid: fine_grid(&from, &record),
        clip: CLIP * shown.output_sd,
        longest_delay_s: longest_delay_s(period_s),
        converged: 1e-5,
        watch,
    };
    let (best, found) = polished(&mut parts, &fold_of, &shown, &from, &descent);
    against(&parts, &best, &found)
        .is_none()
        .then_some(found.discrepancy)
}
