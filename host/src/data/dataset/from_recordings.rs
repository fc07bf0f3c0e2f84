//! Recordings of this program.

use super::about::About;
use super::error::DatasetError;
use super::loaded::{Loaded, run};
use super::options::DatasetOptions;
use crate::data::degrees::DegreeScale;
use crate::data::recording::{Completeness, ReadError, Recording};
use servoid_identification::Run;
use servoid_identification::results::Check;
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
    let scale = DegreeScale::of_recording(&recording.header);
    let rows = recording.rows_of(range.clone());
    if rows.is_empty() {
        return Err(DatasetError::NoReference {
            path: path.to_owned(),
            end: said_end(recording),
            rows: recording.rows.len(),
            begins: range.start,
        });
    }
    let (input, output) = scale.columns(rows);
    let run = run(input, output, path, options.at_rest)?;
    let rest = match options.with_rest {
        true => Vec::new(), // It is part of the run.
        false => rest(recording, &range, &scale, path)?,
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
        period_s: recording.header.sample_period_s,
        phase_s,
        about: about(recording, path, options, scale.unhealthy(rows)),
    })
}

/// What a recording says of itself, `broken` of whose samples no healthy sensor gives.
fn about(recording: &Recording, path: &Path, options: &DatasetOptions, broken: usize) -> About {
    let header = &recording.header;
    let mut provenance = vec![
        ("file".to_owned(), path.display().to_string()),
        ("end".to_owned(), said_end(recording)),
    ];
    provenance.extend(header.facts());
    let mut about = About {
        by_servoid: true,
        input_unit: Some("deg".to_owned()),
        output_unit: Some("deg".to_owned()),
        condition: Some(header.condition.clone()).filter(|c| !c.is_empty()),
        provenance: vec![provenance],
        ..About::default()
    };
    let (shown, rows) = (path.display(), recording.rows.len());
    match &recording.completeness {
        Completeness::Complete => {}
        Completeness::Early(reason) => about.remarks.push(format!(
            "{shown} was ended on purpose ({reason}): it has {rows} rows"
        )),
        Completeness::Partial(reason) => about.add(
            Check::Partial,
            format!("{shown} is partial ({reason}): it has {rows} rows"),
            [rows as f64, samples_meant(recording)],
            "The missing rows are left out and the bounds are as wide as that makes them; capture again for the rest.",
        ),
    }
    if !header.unproved.is_empty() {
        about.add(
            Check::Unproved,
            format!(
                "{shown} was recovered from a recording whose header was damaged; check these, which nothing proves: {}",
                header.unproved
            ),
            [0.0, 0.0],
            "Hold these values against the rig file, or capture again.",
        );
    }
    if broken > 0 {
        about.remarks.push(format!(
            "{shown}: in {broken} samples the sensor read outside its healthy range; they count as missing"
        ));
    }
    if options.period_s.is_some() {
        let period_s = header.sample_period_s;
        about.remarks.push(format!(
            "{shown} is a recording and says itself that its samples are {period_s} s apart; --period is not used for it"
        ));
    }
    about
}

/// Samples that the run was to have, by a header that may say anything.
fn samples_meant(recording: &Recording) -> f64 {
    let header = &recording.header;
    let rolls = f64::from(header.pre_roll_frames) + f64::from(header.post_roll_frames);
    (rolls + f64::from(header.reference_frames)) * SAMPLES_PER_FRAME as f64
}

/// What was recorded before and after the reference, which shows the noise of a servo at rest.
fn rest(
    recording: &Recording,
    reference: &Range<u64>,
    scale: &DegreeScale,
    path: &Path,
) -> Result<Vec<Run>, DatasetError> {
    [0..reference.start, reference.end..u64::MAX]
        .into_iter()
        .map(|range| scale.columns(recording.rows_of(range)))
        .filter(|(input, _)| !input.is_empty())
        .map(|(input, output)| run(input, output, path, None))
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
