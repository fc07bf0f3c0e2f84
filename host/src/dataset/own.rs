//! Recordings of this program.

use super::{About, DatasetError, DatasetOptions, Loaded, run};
use crate::recording::{Completeness, ReadError, Recording};
use servoid_identification::Run;
use servoid_identification::advice::Advice;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use std::ops::Range;
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
    let (input, mut output) = recording.columns(range.clone());
    if input.is_empty() {
        return Err(DatasetError::NoReference {
            path: path.to_owned(),
            end: said_end(recording),
            rows: recording.samples.len(),
            begins: range.start,
        });
    }
    let healthy = recording.header.healthy_degrees();
    let broken = healthy.map_or(0, |range| drop_unhealthy(&mut output, range));
    let run = run(input, output, path, options.at_rest)?;
    let rest = match options.with_rest {
        true => Vec::new(), // It is part of the run.
        false => rest(recording, &range, healthy, path)?,
    };
    let (mut remarks, mut advice) = (Vec::new(), Vec::new());
    let (shown, rows) = (path.display(), recording.samples.len());
    if let Completeness::Early(reason) = &recording.completeness {
        remarks.push(format!(
            "{shown} was ended on purpose ({reason}): it has {rows} rows"
        ));
    }
    if let Completeness::Partial(reason) = &recording.completeness {
        let remark = format!("{shown} is partial ({reason}): it has {rows} rows");
        let frames = u32::from(recording.header.pre_roll_frames)
            + recording.header.reference_frames
            + u32::from(recording.header.post_roll_frames);
        advice.push(Advice::new(
            "partial",
            format!("{remark}."),
            rows as f64,
            f64::from(frames) * SAMPLES_PER_FRAME as f64,
            "The missing rows are left out and the bounds are as wide as that makes them; capture again for the rest.",
        ));
        remarks.push(remark);
    }
    if !recording.header.unproved.is_empty() {
        let remark = format!(
            "{} was recovered from a recording whose header was damaged; check these, which nothing proves: {}",
            path.display(),
            recording.header.unproved
        );
        advice.push(Advice::new(
            "unproved",
            format!("{remark}."),
            0.0,
            0.0,
            "Hold these values against the rig file, or capture again.",
        ));
        remarks.push(remark);
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
    let mut provenance = vec![
        ("file".to_owned(), path.display().to_string()),
        ("end".to_owned(), said_end(recording)),
    ];
    provenance.extend(recording.header.facts());
    let about = About {
        by_servoid: true,
        input_unit: Some("deg".to_owned()),
        output_unit: Some("deg".to_owned()),
        condition,
        provenance: vec![provenance],
        remarks,
        advice,
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
        rest,
        period_s,
        phase_s,
        about,
    })
}

/// What was recorded before and after the reference, which shows the noise of a servo at rest.
fn rest(
    recording: &Recording,
    reference: &Range<u64>,
    healthy: Option<(f64, f64)>,
    path: &Path,
) -> Result<Vec<Run>, DatasetError> {
    [0..reference.start, reference.end..u64::MAX]
        .into_iter()
        .map(|range| recording.columns(range))
        .filter(|(input, _)| !input.is_empty())
        .map(|(input, mut output)| {
            if let Some(range) = healthy {
                drop_unhealthy(&mut output, range);
            }
            super::run(input, output, path, None)
        })
        .collect()
}

/// Whether all of it is there, and why not.
fn said_end(recording: &Recording) -> String {
    match &recording.completeness {
        Completeness::Partial(reason) => format!("partial ({reason})"),
        Completeness::Early(reason) => format!("on purpose ({reason})"),
        Completeness::Complete => "complete".to_owned(),
    }
}

/// What is to be said of a recording whose columns were named, so that it is read as any CSV file.
pub(super) fn remark_on_named(bytes: &[u8], path: &Path) -> String {
    let what = match Recording::parse(bytes, path) {
        Ok(recording) => format!("{}, {}", path.display(), said_end(&recording)),
        Err(damage) => damage.to_string(),
    };
    format!(
        "{} is a recording of servoid, but with its columns named its rows are taken as they are, neither checked nor cut to the reference: {what}",
        path.display()
    )
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
