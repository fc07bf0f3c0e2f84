//! The motion that a record has: beyond it, no model of the record is known to hold.

use super::command_range::CommandRange;
use super::reached_speeds::ReachedSpeeds;
use super::simulated_motion::commands;
use crate::data::Record;
use crate::servo_model::stretches::stretches;
use serde::{Deserialize, Serialize};

/// The commands of a record, and how fast the servo moved under them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedMotion {
    /// The least and the largest command.
    pub commands: CommandRange,
    /// The speeds that were measured.
    pub reached: ReachedSpeeds,
}

impl RecordedMotion {
    /// That of a record; `None` of one in which no command is known for long enough.
    ///
    /// ```
    /// use servoid_identification::Record;
    /// use servoid_identification::servo_model::RecordedMotion;
    /// let u: Vec<f64> = (0..400).map(|k| if k < 200 { -3.0 } else { 2.0 }).collect();
    /// let y: Vec<f64> = (0..400).map(|k| f64::from((k - 200).clamp(0, 50)) * 0.1).collect();
    /// let found = RecordedMotion::of(&Record::of_run(0.002, &u, &y)?).unwrap();
    /// assert_eq!((found.commands.least, found.commands.largest), (-3.0, 2.0));
    /// assert!((45.0..=50.0).contains(&found.reached.upwards));
    /// # Ok::<(), servoid_identification::Error>(())
    /// ```
    #[must_use]
    pub fn of(record: &Record) -> Option<Self> {
        let (stretches, _) = stretches(record, &[]);
        (!stretches.is_empty()).then(|| Self {
            commands: commands(&stretches),
            reached: ReachedSpeeds::of(&stretches, record.sample_period_s()),
        })
    }
}
