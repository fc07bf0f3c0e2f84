//! Recordings of this program.

use super::about::{About, SensorCalibration};
use super::error::DatasetFault;
use super::loaded::{Loaded, run};
use super::options::DatasetOptions;
use super::sensor_delay::{SensorDelay, in_ms};
use crate::data::FAR_FROM_COMMAND_DEG;
use crate::data::clock_error::internal_clock_error;
use crate::data::degrees::DegreeScale;
use crate::data::frozen_sensor::{FrozenSensor, StandStill};
use crate::data::recording::{Completeness, Header, Recording};
use servoid_identification::results::Check;
use servoid_protocol::hello::INTERNAL_CLOCK_ERROR;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use std::path::Path;

/// The run of a recording: of its reference, or of all of it.
pub(super) fn from_recording(
    recording: &Recording,
    path: &Path,
    options: &DatasetOptions,
) -> Result<Loaded<'static>, DatasetFault> {
    let header = &recording.header;
    let range = match options.with_rest {
        true => 0..u64::MAX,
        false => recording.reference_samples(),
    };
    let scale = DegreeScale::of_recording(header);
    let rows = recording.rows_of(range.clone());
    if rows.is_empty() {
        return Err(DatasetFault::NoReference {
            end: end_of(recording),
            rows: recording.rows.len(),
            begins: range.start,
        });
    }
    let delay = SensorDelay::of(header)?;
    let still = stand_stills(recording);
    // What the sensor shows late of the end comes after it.
    let later = range.end.saturating_add(delay.samples as u64);
    let (mut input, mut output) = scale.columns(recording.rows_of(range.start..later));
    let ends = [rows.first(), rows.last()].map(|row| row.map_or(0, |row| row.sample));
    let [first, last] = ends;
    input.truncate((last - first) as usize + 1);
    for (sample, position) in (first..).zip(&mut output) {
        if still.iter().any(|still| still.samples.contains(&sample)) {
            *position = f64::NAN;
        }
    }
    let output = delay.taken_out(&output, input.len());
    // What was recorded before and after the reference shows the noise of a servo at rest.
    let mut rest = Vec::new();
    for range in [0..range.start, range.end..u64::MAX] {
        let (input, output) = scale.columns(recording.rows_of(range));
        if !input.is_empty() {
            rest.push(run(input, output, None)?);
        }
    }
    let mut about = about(recording, path, options, scale.unhealthy(rows), &still);
    let apart_deg = apart_from_command(&input, &output);
    if apart_deg.abs() > FAR_FROM_COMMAND_DEG {
        about.add(
            Check::Zeros,
            format!("{}: the position lies {apart_deg:+.1} degrees from the command on average", path.display()),
            [apart_deg, FAR_FROM_COMMAND_DEG],
            "Look whether the servo stood at a stop, as under pulses of the other type, and at neutral, pulse type and zero of the sensor in the rig file.",
        );
    }
    Ok(Loaded {
        controllers: Vec::new(),
        // The pulses themselves are in the file, in whole microseconds.
        runs: vec![run(input, output, options.at_rest)?.with_exact_input()],
        rest,
        period_s: header.sample_period_s,
        phase_s: delay.phase_s,
        about: About {
            sensor_delay_uncertainty_s: delay.uncertainty_s,
            sensor_delay_s: Some(delay.delay_s),
            board_id: header.known_board_id(),
            ..about
        },
    })
}

/// Where a recording comes from, `broken` of whose samples no healthy sensor gives.
fn about(
    recording: &Recording,
    path: &Path,
    options: &DatasetOptions,
    broken: usize,
    still: &[StandStill],
) -> About {
    let header = &recording.header;
    let mut provenance = vec![
        ("file".to_owned(), path.display().to_string()),
        ("end".to_owned(), end_of(recording)),
    ];
    provenance.extend(header.facts());
    let mut about = About {
        pulse_frame_s: Some(f64::from(header.pulse_period_us) / 1e6),
        staircase: header.is_of_staircase(),
        input_unit: Some("deg".to_owned()),
        output_unit: Some("deg".to_owned()),
        condition: Some(header.condition.clone()).filter(|c| !c.is_empty()),
        provenance: vec![provenance],
        us_per_degree: Some(header.us_per_degree),
        calibrations: vec![SensorCalibration::of(header)],
        ..About::default()
    };
    let shown = path.display().to_string();
    note_end(&mut about, &shown, recording);
    note_instrument(&mut about, &shown, header);
    note_readings(&mut about, &shown, broken, still);
    if options.period_s.is_some() {
        let period_s = header.sample_period_s;
        about.remarks.push(format!(
            "{shown} is a recording whose header states that its samples are {period_s} s apart; --period is not used for it"
        ));
    }
    about
}

/// That a recording has not all of its rows.
fn note_end(about: &mut About, shown: &str, recording: &Recording) {
    let rows = recording.rows.len();
    match &recording.completeness {
        Completeness::Complete => {}
        Completeness::Early(reason) => about.remarks.push(format!(
            "{shown} was ended on purpose ({reason}): it has {rows} rows"
        )),
        Completeness::Partial(reason) => about.add(
            Check::Partial,
            format!("{shown} is partial ({reason}): it has {rows} rows"),
            [rows as f64, samples_meant(recording)],
            "The missing rows are left out; capture again for the rest.",
        ),
    }
}

/// What is not known well of the sensor, the clock and the header.
fn note_instrument(about: &mut About, shown: &str, header: &Header) {
    let [delay_ms, uncertainty_ms] =
        [header.sensor_delay_s, header.sensor_delay_uncertainty_s].map(in_ms);
    if delay_ms > 0.0 || uncertainty_ms > 0.0 {
        about.add(
            Check::SensorDelay,
            format!(
                "{shown} was recorded by a sensor that lags by {delay_ms} ms, known to {uncertainty_ms} ms: all times count from the shaft, and their \
                 intervals are wider by {uncertainty_ms} ms; the responses as a whole may be that much earlier or later, and what the sensor \
                 smooths is still in them"
            ),
            [delay_ms, uncertainty_ms],
            "Where this matters, measure the sensor's delay, and state it in the rig file (sensor.delay_ms, sensor.delay_uncertainty_ms).",
        );
    }
    if header.has_inexact_clock() {
        about.inexact_clock = true;
        about.add(
            Check::InexactClock,
            format!(
                "{shown} was recorded on the board's internal oscillator, which is off by {}: so were all times and all pulses, and a servo that another clock commands may seem different for that alone",
                internal_clock_error()
            ),
            [100.0 * INTERNAL_CLOCK_ERROR[1], 0.0],
            "Repair the crystal of the board, and capture again.",
        );
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
}

/// Samples that count as missing: `broken` ones that no healthy sensor gives, and those of a sensor that stood still.
fn note_readings(about: &mut About, shown: &str, broken: usize, still: &[StandStill]) {
    if broken > 0 {
        about.add_change(
            format!(
                "{shown}: in {broken} samples the sensor read outside its healthy range; they count as missing."
            ),
            broken,
        );
    }
    if let Some(first) = still.first() {
        let frozen = still
            .iter()
            .map(|still| still.samples.end - still.samples.start);
        let frozen = frozen.sum::<u64>();
        about.add(
            Check::FrozenSensor,
            format!("{shown}: {first}; {frozen} samples of this kind count as missing"),
            [frozen as f64, 0.0],
            "Mend the sensor, its wires or the servo's power, and capture again.",
        );
    }
}

/// How far the position lies from the command on average \[deg\]; not a number where nothing is known.
fn apart_from_command(input: &[f64], output: &[f64]) -> f64 {
    let apart = input.iter().zip(output);
    let apart = apart.map(|(command, position)| position - command);
    let known: Vec<f64> = apart.filter(|apart| !apart.is_nan()).collect();
    known.iter().sum::<f64>() / known.len() as f64
}

/// The stretches in which the sensor's reading stood still though the command changed.
fn stand_stills(recording: &Recording) -> Vec<StandStill> {
    let mut sensor = FrozenSensor::new(recording.header.sample_period_s);
    for row in &recording.rows {
        sensor.take(row.sample, row.pulse, row.counts);
    }
    sensor.found().to_vec()
}

/// Samples that the run was to have, by its header.
fn samples_meant(recording: &Recording) -> f64 {
    let header = &recording.header;
    let rolls = f64::from(header.pre_roll_frames) + f64::from(header.post_roll_frames);
    (rolls + f64::from(header.reference_frames)) * SAMPLES_PER_FRAME as f64
}

/// Whether all of it is there, and why not.
fn end_of(recording: &Recording) -> String {
    match &recording.completeness {
        Completeness::Partial(reason) => format!("partial ({reason})"),
        Completeness::Early(reason) => format!("on purpose ({reason})"),
        Completeness::Complete => "complete".to_owned(),
    }
}

/// What the file at `path` is as a recording: whole, in part, or damaged.
pub(super) fn state(bytes: &[u8], path: &Path) -> String {
    match Recording::parse(bytes, path) {
        Ok(recording) => format!("{}, {}", path.display(), end_of(&recording)),
        Err(damage) => damage.to_string(),
    }
}
