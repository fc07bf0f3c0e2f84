//! The offset that runs have in common where the zero of the sensor moves between them.
//!
//! It is the mean of the offsets of the runs, each run once: each shows the zero at one time, however long it takes. All that is stated at the common
//! offset is at this one: the offset of the linear model and of the servo model, what the offset of each run is above it, and the output at a stop.

/// The mean of the offsets of runs; `None` of no run.
pub(crate) fn common_offset(of_runs: &[f64]) -> Option<f64> {
    let count = of_runs.len() as f64;
    (count > 0.0).then(|| of_runs.iter().sum::<f64>() / count)
}
