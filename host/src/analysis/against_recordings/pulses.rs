//! A recording whose commands wait for pulses of a stated frame.
//!
//! The servo of a receiver or a flight controller sees a command with the next pulse, and a log has the command with the row in which it was written. When pulses
//! came is not in it, so that it is looked for: of all moments that the pulses of a run may have, those with which the model is closest are taken.

use crate::analysis::command_times::commands_at_pulses::at_pulses;
use crate::data::model_metadata::{PULSE_FRAMES_S, SHORTEST_FRAME_S};
use crate::presentation::summary::{four_digits, with_unit};
use anyhow::{Result, bail};
use serde::Serialize;
use servoid_identification::{Record, Run};

/// Moments of pulses that are tried in a frame, evenly spaced.
const TRIED: usize = 12;

/// Times that their distance is halved about the best one.
const HALVED: usize = 3;

/// Pulses that commands of a recording wait for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StatedPulses {
    /// From one pulse to the next \[s\].
    pub frame_s: f64,
    /// Of each run, the first pulse after its first row \[s\]; `null` of a run that the model cannot be held against.
    pub first_pulse_s: Vec<Option<f64>>,
    /// The mean error of the model with these moments (rms), and the largest with another moment in each run \[output\].
    pub rmse: [f64; 2],
}

impl StatedPulses {
    /// Where the pulses are, and how much that matters. `has_own_frame` where the recording of the model has commands at its pulses.
    pub(super) fn in_words(&self, unit: Option<&str>, has_own_frame: bool) -> String {
        let ms = |seconds: f64| four_digits(1e3 * seconds);
        let first: Vec<String> = (self.first_pulse_s.iter())
            .map(|pulse| pulse.map_or_else(|| "-".to_owned(), |pulse_s| ms(pulse_s).to_string()))
            .collect();
        let of_runs = match first.len() {
            1 => "of the run",
            _ => "of each run",
        };
        let [least, largest] = self
            .rmse
            .map(|error| with_unit(four_digits(error), unit.unwrap_or("")));
        let twice = match has_own_frame {
            true => "",
            false => {
                " If those of the model's own recording waited for pulses too, half a frame is in its delay already, and counts twice here."
            }
        };
        format!(
            "Commands wait for pulses every {} ms, the first {} ms after the first row {of_runs}: with these moments, which were looked for, the model is closest \
             (error {least} rms; with others up to {largest}).{twice}",
            ms(self.frame_s),
            first.join(", "),
        )
    }
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

/// The record with its commands at pulses every `frame_s`. `errors` are those of the model (rms) in one run of it, by the number of the run; `None` where
/// there is none.
///
/// # Errors
/// The model cannot be held against any run.
pub(super) fn at_closest_pulses<'r>(
    record: &Record<'r>,
    frame_s: f64,
    errors: &dyn Fn(Run<'r>, usize) -> Option<f64>,
) -> Result<(Record<'r>, StatedPulses)> {
    let period_s = record.sample_period_s();
    let (mut runs, mut first_pulse_s) = (Vec::new(), Vec::new());
    let (mut samples, mut squares) = (0.0, [0.0; 2]);
    for (number, run) in record.runs().iter().enumerate() {
        let at = |pulse_s: f64| with_pulses(run, [frame_s, pulse_s].map(|time| time / period_s));
        let error = |pulse_s: f64| errors(at(pulse_s)?, number);
        let found = closest(frame_s, &error);
        first_pulse_s.push(found.map(|found| found.pulse_s));
        let held = found.and_then(|found| at(found.pulse_s));
        runs.push(held.unwrap_or_else(|| run.clone()));
        if let Some(found) = found {
            let of_run = run.len() as f64;
            samples += of_run;
            for (sum, error) in squares.iter_mut().zip([found.error, found.largest_error]) {
                *sum += of_run * error * error;
            }
        }
    }
    if samples == 0.0 {
        bail!(
            "the model can be held against none of the runs, so that no pulses are found: a validation without --frame-ms says why"
        );
    }
    let held = record.try_with_runs(runs)?;
    let found = StatedPulses {
        frame_s,
        first_pulse_s,
        rmse: squares.map(|sum| (sum / samples).sqrt()),
    };
    Ok((held, found))
}

/// The run with each command in force from the next pulse on; frame and first pulse are counted in rows.
fn with_pulses<'r>(run: &Run<'r>, [frame, first]: [f64; 2]) -> Option<Run<'r>> {
    at_pulses(run, |row| (first - row as f64).rem_euclid(frame))
}

/// The moment with which a model is closest.
#[derive(Clone, Copy)]
struct Closest {
    /// The first pulse after the first row \[s\].
    pulse_s: f64,
    error: f64,
    /// The largest error with one of the other moments.
    largest_error: f64,
}

/// Of evenly spaced moments, and then of ever closer ones beside the best.
fn closest(frame_s: f64, error: &dyn Fn(f64) -> Option<f64>) -> Option<Closest> {
    let mut step = frame_s / TRIED as f64;
    let tried = (0..TRIED).filter_map(|k| {
        let pulse_s = (k as f64 + 0.5) * step;
        error(pulse_s).map(|error| (pulse_s, error))
    });
    let tried: Vec<(f64, f64)> = tried.collect();
    let by_error = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
    let mut best = *tried.iter().min_by(by_error)?;
    let largest_error = tried.iter().max_by(by_error)?.1;
    for _ in 0..HALVED {
        step /= 2.0;
        let about = best.0;
        for pulse_s in [about - step, about + step] {
            let pulse_s = pulse_s.rem_euclid(frame_s);
            if let Some(error) = error(pulse_s).filter(|error| *error < best.1) {
                best = (pulse_s, error);
            }
        }
    }
    let (pulse_s, error) = best;
    Some(Closest {
        pulse_s,
        error,
        largest_error,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_waits_for_the_next_pulse() {
        let input = vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let run = Run::new(input, vec![0.0; 7]).unwrap();
        // Pulses at 0.5, 2.5 and 4.5 rows: each has the command of the row before it until the next.
        let held = with_pulses(&run, [2.0, 0.5]).unwrap();
        assert_eq!(held.input(), [0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    }

    #[test]
    fn the_closest_moment_is_found_to_a_part_of_a_step() {
        for truth in [0.0004, 0.0071, 0.0188] {
            let apart = |pulse_s: f64| {
                let apart = (pulse_s - truth).rem_euclid(0.02);
                apart.min(0.02 - apart)
            };
            let found = closest(0.02, &|pulse_s| Some(apart(pulse_s))).unwrap();
            assert!(
                apart(found.pulse_s) < 0.02 / 12.0 / 8.0,
                "{}",
                found.pulse_s
            );
            assert!(found.largest_error > 0.009);
        }
        assert!(closest(0.02, &|_| None).is_none());
    }

    #[test]
    fn frames_that_no_servo_has_are_refused() {
        assert_eq!(frame_s(20.0, None).unwrap(), 0.02);
        for (frame_ms, recorded_s) in [(0.02, None), (f64::NAN, None), (20.0, Some(0.02))] {
            assert!(frame_s(frame_ms, recorded_s).is_err());
        }
    }
}
