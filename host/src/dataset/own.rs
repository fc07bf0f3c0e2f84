//! Recordings of this program.

use super::{About, DatasetError, DatasetOptions, Loaded, run};
use crate::recording::{Completeness, ReadError, Recording};
use std::path::Path;

/// The run of a recording: of its reference, or of all of it.
pub(super) fn from_recording(
    recording: &Recording,
    path: &Path,
    options: &DatasetOptions,
) -> Result<Loaded, DatasetError> {
    let range = if options.with_rest {
        0..u64::MAX
    } else {
        recording.reference_samples()
    };
    let (input, mut output) = recording.columns(range);
    let healthy = recording.header.healthy_degrees();
    let broken = healthy.map_or(0, |range| drop_unhealthy(&mut output, range));
    let run = run(input, output, path, options.at_rest)?;
    let mut remarks = Vec::new();
    let (shown, rows) = (path.display(), recording.samples.len());
    match &recording.completeness {
        Completeness::Complete => {}
        Completeness::Early(reason) => remarks.push(format!(
            "{shown} was ended on purpose ({reason}): it has {rows} rows"
        )),
        Completeness::Partial(reason) => {
            remarks.push(format!("{shown} is partial ({reason}): it has {rows} rows"));
        }
    }
    if broken > 0 {
        remarks.push(format!(
            "{}: in {broken} samples the sensor read outside its healthy range; they count as missing",
            path.display()
        ));
    }
    let period_s = recording.header.sample_period_s;
    if options.period_s.is_some() {
        remarks.push(format!(
            "{} is a recording and says itself that its samples are {period_s} s apart; --period is not used for it",
            path.display()
        ));
    }
    let condition = Some(recording.header.condition.clone()).filter(|c| !c.is_empty());
    let end = match &recording.completeness {
        Completeness::Partial(reason) => format!("partial ({reason})"),
        Completeness::Early(reason) => format!("on purpose ({reason})"),
        Completeness::Complete => "complete".to_owned(),
    };
    let mut provenance = vec![
        ("file".to_owned(), path.display().to_string()),
        ("end".to_owned(), end),
    ];
    provenance.extend(recording.header.facts());
    let about = About {
        unit: Some("deg"),
        condition,
        provenance: vec![provenance],
        remarks,
    };
    let phase_s = recording.header.sample_phase_s;
    if !(phase_s >= 0.0 && phase_s.is_finite()) {
        let reason = "sample_phase_s is no time after an edge".to_owned();
        return Err(ReadError::DamagedHeader {
            path: path.to_owned(),
            line: 1,
            reason,
        }
        .into());
    }
    Ok(Loaded {
        runs: vec![run],
        period_s,
        phase_s,
        about,
    })
}

/// Marks readings that no healthy sensor gives as missing; returns how many.
fn drop_unhealthy(output: &mut [f64], (lowest, highest): (f64, f64)) -> usize {
    // Positions are written with four decimals, so the range's own ends may seem to be beyond it.
    let slack = 1e-3;
    let healthy = (lowest - slack)..=(highest + slack);
    let broken = output
        .iter_mut()
        .filter(|y| !y.is_nan() && !healthy.contains(*y));
    broken.map(|y| *y = f64::NAN).count()
}
