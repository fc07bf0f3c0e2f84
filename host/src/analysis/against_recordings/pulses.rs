//! The pulses that the commands of a recording wait for.
//!
//! The servo of a receiver or a flight controller sees a command with the next pulse, and a log has the command with the row in which it was written. When pulses
//! came is not in it, nor how long their frame is by the clock of the log: both are [looked for](crate::analysis::command_times::pulse_search).

use crate::analysis::command_times::pulse_search::{ClosestPulses, OF_STATED};
use crate::data::dataset::command_changes;
use crate::data::model_metadata::{PULSE_FRAMES_S, SHORTEST_FRAME_S};
use crate::presentation::summary::{four_digits, with_unit};
use anyhow::{Result, bail};
use serde::Serialize;
use servoid_identification::Record;
use servoid_identification::results::six_digits;

/// How far the length of a frame may be from the stated one \[%\].
const WITHIN_PERCENT: f64 = 100.0 * OF_STATED;

/// What says that commands wait for pulses of a length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum By {
    /// Who validates.
    Statement,
    /// The recording of the servo model, whose commands did.
    OwnRecording,
}

/// Pulses that commands of a recording wait for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StatedPulses {
    /// From one pulse to the next by the clock of the recording \[s\].
    pub frame_s: f64,
    /// The same as it was stated.
    pub stated_frame_s: f64,
    /// Of each run, the first pulse after its first row \[s\]; `null` of a run that the model cannot be held against. Where commands were polled, or written
    /// between two rows, it is known to a row.
    pub first_pulse_s: Vec<Option<f64>>,
    /// The error of the model (rms) with these pulses, and the largest with pulses of the stated length at another moment in each run \[output\].
    pub rmse: [f64; 2],
    /// The least with pulses of the stated length \[output\].
    pub rmse_as_stated: f64,
    /// So far predictions with commands of one row sooner or later are from the one with these pulses (rms): within a row of a pulse a command may have met it or the next \[output\].
    pub rms_beside_pulses: f64,
    /// Whether all changes of the command are whole frames apart, as if they stood at their pulses.
    pub changes_whole_frames_apart: bool,
    /// A change of the length that matters \[s\].
    #[serde(skip)]
    frame_step_s: f64,
    #[serde(skip)]
    by: By,
}

impl StatedPulses {
    /// Of the commands of `record`; those within a row of a pulse make up to `rms_beside_pulses`.
    pub(super) fn of(
        found: ClosestPulses,
        (stated_frame_s, by): (f64, By),
        record: &Record,
        rms_beside_pulses: f64,
    ) -> Self {
        Self {
            rms_beside_pulses,
            changes_whole_frames_apart: are_whole_frames_apart(record, found.frame_s),
            frame_s: found.frame_s,
            stated_frame_s,
            first_pulse_s: found.first_pulse_s,
            rmse: [found.rmse, found.largest_rmse],
            rmse_as_stated: found.rmse_as_stated,
            frame_step_s: found.frame_step_s,
            by,
        }
    }

    /// How long their frame is, and how much that and their moments matter.
    pub(super) fn in_words(&self, unit: Option<&str>, has_own_frame: bool) -> String {
        let [least, largest] = self
            .rmse
            .map(|error| with_unit(four_digits(error), unit.unwrap_or("")));
        let as_stated = with_unit(four_digits(self.rmse_as_stated), unit.unwrap_or(""));
        let stated_ms = six_digits(1e3 * self.stated_frame_s);
        let decimals = (-(1e3 * self.frame_step_s).log10()).ceil().clamp(0.0, 6.0) as usize;
        let [as_it_is, what] = match self.by {
            By::Statement => ["as stated", "what was stated"],
            By::OwnRecording => [
                "as in the recording of the servo model",
                "those in the recording of the servo model",
            ],
        };
        let closest = match self.frame_s == self.stated_frame_s {
            true => format!(
                "With pulses every {stated_ms} ms, {as_it_is}, at moments that were looked for, the model is closest: error {least} rms, and up to {largest} \
                 with others. No other length that was tried, within {WITHIN_PERCENT} % of that, is closer."
            ),
            false => format!(
                "With pulses every {:.decimals$} ms, by the clock of this recording, at moments that were looked for, the model is closest of all lengths that were tried, within {WITHIN_PERCENT} % of \
                 {what}: error {least} rms. With {stated_ms} ms it is {as_stated}, and up to {largest} with other moments. Pulses of quite another length show by a smaller error.",
                1e3 * self.frame_s
            ),
        };
        let beside = match self.rms_beside_pulses {
            rms if rms > 0.0 => {
                let how_much = match rms < self.rmse[0] {
                    true => format!(
                        "up to {} rms",
                        with_unit(four_digits(rms), unit.unwrap_or(""))
                    ),
                    false => "all".to_owned(),
                };
                format!(
                    " Commands within a row of a pulse may have met it or the next: {how_much} of the error may be of that."
                )
            }
            _ => String::new(),
        };
        let twice = match has_own_frame {
            true => "",
            false => {
                " If those of the model's own recording waited for pulses too, half a frame is in its delay already, and counts twice here."
            }
        };
        // Pulses of another length walk against such commands, as no wrong delay does.
        let is_as_stated = (self.frame_s - self.stated_frame_s).abs() < 2.0 * self.frame_step_s;
        let at_pulses = match self.changes_whole_frames_apart && is_as_stated {
            false => "",
            true => {
                " But all commands change whole frames apart, so they may stand at their pulses already. Then they wait for nothing, and the moments that were looked for \
                 hide a wrong delay of the model: what holds is a validation without --frame-ms."
            }
        };
        format!("{closest}{beside}{twice}{at_pulses}")
    }
}

/// The probability below which chance does not bring changes of the command a whole number of frames apart.
const NOT_BY_CHANCE: f64 = 1e-3;

/// So near to a whole number of rows a frame is one, but for rounding.
const WHOLE_ROWS: f64 = 1e-6;

/// Whether the changes of each command are whole frames apart, to a row, which those that are written at any row are by chance one time in so many rows as a frame has.
fn are_whole_frames_apart(record: &Record, frame_s: f64) -> bool {
    let rows_of_frame = frame_s / record.sample_period_s();
    let apart = |input: &[f64]| -> Vec<f64> {
        let changes: Vec<usize> = command_changes(input).collect();
        // From the first one on: holds of one length are all as far from whole frames.
        let first = changes.first().copied().unwrap_or_default();
        let later = changes.iter().skip(1).map(|row| row - first);
        later.map(|rows| rows as f64 / rows_of_frame).collect()
    };
    let all: Vec<f64> = (record.runs().iter())
        .flat_map(|run| apart(run.input()))
        .collect();
    // Written at rows, changes whole frames apart are off by up to a row where a frame is no whole number of rows: on two of them then, and on all where it has two.
    let is_whole = (rows_of_frame - rows_of_frame.round()).abs() < WHOLE_ROWS;
    let on_frames = if is_whole { 1.0 } else { 2.0 };
    let by_chance = (on_frames / rows_of_frame).min(1.0).powi(all.len() as i32);
    by_chance < NOT_BY_CHANCE
        && (all.iter()).all(|frames| (frames - frames.round()).abs() * rows_of_frame < 1.0)
}

/// Frames that users state, in seconds.
///
/// # Errors
/// The recording has its commands at their pulses, or no servo has such a frame.
pub(super) fn frame_s(frame_ms: f64, recorded_s: Option<f64>) -> Result<f64> {
    if let Some(recorded_s) = recorded_s {
        bail!(
            "commands of servoid's own recordings stand at their pulses, every {} ms, and need no --frame-ms",
            1e3 * recorded_s
        );
    }
    let frame_s = 1e-3 * frame_ms;
    if !PULSE_FRAMES_S.contains(&frame_s) || frame_s < SHORTEST_FRAME_S {
        bail!("--frame-ms must be a number of milliseconds from 1 to 1000");
    }
    Ok(frame_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Levels of some rows of 2 ms each.
    fn record(rows: &[usize]) -> Record<'static> {
        let held = rows.iter().zip([1.0, -1.0].into_iter().cycle());
        let input: Vec<f64> = held
            .flat_map(|(rows, level)| std::iter::repeat_n(level, *rows))
            .collect();
        Record::of_run(0.002, input.clone(), input).unwrap()
    }

    #[test]
    fn commands_that_change_whole_frames_apart_differ_from_others() {
        let apart = |rows: &[usize]| are_whole_frames_apart(&record(rows), 0.02);
        assert!(apart(&[3, 100, 200, 50, 110, 70]));
        assert!(!apart(&[3, 100, 205, 45, 110, 70]));
        // Three of ten rows are on one grid by chance in one of a hundred recordings.
        assert!(!apart(&[3, 100, 200, 70]));
        // Frames of about two rows have no change that is a whole row off.
        let each_row = [1; 40];
        assert!(!are_whole_frames_apart(&record(&each_row), 0.003_998));
        // A row of a frame each has nothing else.
        assert!(!are_whole_frames_apart(
            &record(&[3, 100, 200, 50, 110, 70]),
            0.002
        ));
    }

    #[test]
    fn frames_that_no_servo_has_are_refused() {
        assert_eq!(frame_s(20.0, None).unwrap(), 0.02);
        for (frame_ms, recorded_s) in [(0.02, None), (f64::NAN, None), (20.0, Some(0.02))] {
            assert!(frame_s(frame_ms, recorded_s).is_err());
        }
    }
}
