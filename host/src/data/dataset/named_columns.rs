//! A recording of servoid whose columns are named, as where its header is damaged: its times are those of the recording all the same.

use super::about::SensorCalibration;
use super::error::DatasetFault;
use super::loaded::{Loaded, run};
use super::options::DatasetOptions;
use super::sensor_delay::SensorDelay;
use crate::data::recording::Header;
use servoid_identification::Run;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use std::ops::Range;

/// The rows of a recording, `loaded` as those of any table, with the sample phase, the sensor's delay and the reference that its header
/// states. A header that has lost them has the phase of every board, and no reference: then all rows are used.
pub(super) fn timed(
    loaded: Loaded<'static>,
    header: &Header,
    options: &DatasetOptions,
) -> Result<Loaded<'static>, DatasetFault> {
    let mut header = header.clone();
    header.sample_period_s = loaded.period_s;
    if header.sample_phase_s == 0.0 {
        header.sample_phase_s = 1e-6 * f64::from(header.train().first_sample_us());
    }
    let delay = SensorDelay::of(&header)?;
    let mut rest = Vec::new();
    let mut runs = Vec::new();
    let mut is_cut = true;
    for whole in &loaded.runs {
        let samples = whole.input().len();
        let range = reference(&header, samples).filter(|_| !options.with_rest);
        is_cut &= range.is_some();
        let range = range.unwrap_or(0..samples);
        for around in [0..range.start, range.end..samples] {
            if !around.is_empty() {
                rest.push(part(
                    whole,
                    around,
                    &SensorDelay {
                        samples: 0,
                        ..delay
                    },
                    None,
                )?);
            }
        }
        runs.push(part(whole, range, &delay, whole.input_at_rest())?);
    }
    let mut about = loaded.about;
    if !is_cut && !options.with_rest {
        about.remarks.push(
            "nothing states where the reference begins in these rows, so the rest around it is used, too".to_owned(),
        );
    }
    about.sensor_delay_s = Some(delay.delay_s);
    about.board_id = header.known_board_id();
    about.calibrations = vec![SensorCalibration::of(&header)];
    about.sensor_delay_uncertainty_s = about.sensor_delay_uncertainty_s.max(delay.uncertainty_s);
    about.pulse_frame_s = Some(f64::from(header.pulse_period_us) / 1e6);
    Ok(Loaded {
        runs,
        rest,
        phase_s: delay.phase_s,
        about,
        ..loaded
    })
}

/// The samples of the reference in a run of so many; `None` where the header does not state as many.
fn reference(header: &Header, samples: usize) -> Option<Range<usize>> {
    let Range { start, end } = header.reference_samples()?;
    let after = u64::from(header.post_roll_frames) * SAMPLES_PER_FRAME as u64;
    let is_whole = end + after == samples as u64;
    is_whole.then_some(start as usize..end as usize)
}

/// A part of a run, with what the sensor shows later of it.
fn part(
    whole: &Run<'_>,
    range: Range<usize>,
    delay: &SensorDelay,
    at_rest: Option<f64>,
) -> Result<Run<'static>, DatasetFault> {
    let input = whole
        .input()
        .get(range.clone())
        .unwrap_or_default()
        .to_vec();
    let output = whole.output().get(range.start..).unwrap_or_default();
    let output = delay.taken_out(output, input.len());
    let part = run(input, output, at_rest)?;
    Ok(match whole.label() {
        Some(label) => part.with_label(label),
        None => part,
    })
}
