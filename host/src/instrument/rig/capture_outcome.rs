//! Progress and end of a capture.

use super::talk_error::TalkError;
use crate::data::StandStill;
use crate::data::recording::{Ending, WriteError};
use servoid_protocol::Rejects;
use servoid_protocol::message::{Frame, Status};

/// How a capture is getting on.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// The newest frame that was written.
    pub frame: &'a Frame,
    /// Frames that the run will have.
    pub frames_total: u32,
    /// Messages from the rig that could not be read, by class.
    pub rejects: Rejects,
    /// Frames that had to be asked for again.
    pub asked_again: u32,
    /// Frames that have been given up.
    pub lost: u32,
    /// The newest status of the rig, which comes about twice a second.
    pub status: Option<&'a Status>,
    /// The newest stretch in which the sensor's reading stood still, though the command changed.
    pub stands_still: Option<&'a StandStill>,
}

/// Why a run is to end before its reference does.
#[derive(Clone, Debug, PartialEq)]
pub enum StopReason {
    /// The user wants it: the recording is partial.
    User,
    /// The purpose of the run has been reached, in plain words: the recording is whole as far as
    /// it goes.
    Enough(String),
}

/// How a capture ended.
#[derive(Clone, Debug, PartialEq)]
pub struct CaptureEnd {
    /// Complete, or the missing frames and the reason.
    pub ending: Ending,
    /// Rows written.
    pub rows: u64,
    /// The motion of the position as a share of that of the command; `None` where the command did not change.
    pub moved: Option<f64>,
    /// How far the position lies from the command on average (deg); `None` of no frames.
    pub apart_deg: Option<f64>,
    /// Messages from the rig that could not be read.
    pub rejects: u32,
    /// Frames that had to be asked for again.
    pub asked_again: u32,
}

/// Why a capture did not take place or broke off. Rows written before are kept in every case.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {
    /// The rig.
    #[error(transparent)]
    Talk(#[from] TalkError),
    /// The file.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The rig did not confirm that it stopped.
    #[error(
        "stopped by the user; the rig did not confirm it at once, and its lease brings the servo to neutral: check the cable"
    )]
    NotStopped,
    /// There is nothing to keep.
    #[error("stopped by the user before the run began: no file was written")]
    StoppedBefore,
}
