//! A table of steps from a CSV file.

use super::error::ReferenceError;
use super::whole_frames::{LARGEST_AMPLITUDE_US, LONGEST_S, frames, repetitions, seconds};
use crate::data::table::{Table, TableError};
use servoid_protocol::PulseTrain;
use servoid_protocol::reference::{MAX_STEPS, Step, Steps};
use std::path::Path;

/// The columns: an angle, and how long it is held.
pub const COLUMNS: [&str; 2] = ["angle_deg", "hold_s"];

/// Reads the table, and plays it as often as comes nearest to `length_s`, or once.
pub(super) fn read(
    path: &Path,
    us_per_degree: f64,
    length_s: Option<f64>,
    train: PulseTrain,
    remarks: &mut Vec<String>,
) -> Result<Steps, ReferenceError> {
    let mut columns = Table::read(path)?
        .numbers(&COLUMNS)
        .map_err(TableError::at(path))?
        .into_iter();
    let mut column = || columns.next().unwrap_or_default();
    let (angles, holds) = (column(), column());
    let wrong = |row: usize, what: String| {
        ReferenceError::OutOfRange(format!("{}, row {}: {what}", path.display(), row + 1))
    };
    let mut steps = Vec::new();
    for (row, (&angle, &hold_s)) in angles.iter().zip(&holds).enumerate() {
        let offset_us = (angle * us_per_degree).round();
        // An empty cell is not a number, and within nothing.
        if !(-LARGEST_AMPLITUDE_US..=LARGEST_AMPLITUDE_US).contains(&offset_us) {
            return Err(wrong(
                row,
                format!("an angle within ±{LARGEST_AMPLITUDE_US} µs of pulse is needed"),
            ));
        }
        if hold_s.is_nan() {
            return Err(wrong(row, "a hold in seconds is needed".to_owned()));
        }
        let hold_frames =
            frames("hold", hold_s, train).map_err(|error| wrong(row, error.to_string()))?;
        let held_s = seconds(hold_frames.into(), train);
        // Far below a frame, and above the rounding of a number with a few decimals.
        if (held_s - hold_s).abs() > 1e-6 {
            remarks.push(format!(
                "{}, row {}: the command changes every {} ms, so a hold of {hold_s} s becomes {held_s} s",
                path.display(),
                row + 1,
                f64::from(train.frame_us()) / 1e3
            ));
        }
        steps.push(Step {
            offset_us: offset_us as i16,
            hold_frames,
        });
    }
    let once = Steps::new(1, &steps).ok_or_else(|| {
        ReferenceError::OutOfRange(format!(
            "{} has {} steps, and a table holds {MAX_STEPS}: shorten it, or let --length repeat a shorter one",
            path.display(),
            steps.len()
        ))
    })?;
    if !servoid_protocol::Reference::Steps(once).is_well_formed() {
        return Err(ReferenceError::OutOfRange(format!(
            "{} moves nothing: give at least one row whose {} is not 0",
            path.display(),
            COLUMNS[0]
        )));
    }
    let repeats = match length_s {
        Some(length_s) if length_s > LONGEST_S => u32::from(u16::MAX),
        Some(length_s) => repetitions(frames("length", length_s, train)?.into(), once.frames()),
        None => 1,
    };
    Ok(Steps {
        repeats: u16::try_from(repeats).unwrap_or(u16::MAX),
        ..once
    })
}
