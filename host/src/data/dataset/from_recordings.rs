//! Recordings of this program.

use super::{About, DatasetError, DatasetOptions, Loaded, run};
use crate::data::recording::{Completeness, ReadError, Recording};
use servoid_identification::Run;
use servoid_identification::advice::{Advice, Check};
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
        about: about(recording, path, options, broken),
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
    let (shown, rows) = (path.display(), recording.samples.len());
    match &recording.completeness {
        Completeness::Complete => {}
        Completeness::Early(reason) => about.remarks.push(format!(
            "{shown} was ended on purpose ({reason}): it has {rows} rows"
        )),
        Completeness::Partial(reason) => about.tell(
            Check::Partial,
            format!("{shown} is partial ({reason}): it has {rows} rows"),
            [rows as f64, samples_meant(recording)],
            "The missing rows are left out and the bounds are as wide as that makes them; capture again for the rest.",
        ),
    }
    if !header.unproved.is_empty() {
        about.tell(
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

impl About {
    /// Says something that every result has to carry too; it counts `value` where `threshold` was meant.
    fn tell(&mut self, check: Check, remark: String, [value, threshold]: [f64; 2], remedy: &str) {
        let finding = format!("{remark}.");
        self.advice
            .push(Advice::new(check, finding, value, threshold, remedy));
        self.remarks.push(remark);
    }
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
