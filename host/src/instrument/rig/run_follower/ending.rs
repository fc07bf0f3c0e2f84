//! How a run ended, in words.

use super::super::capture::{CaptureError, StopReason};
use super::{RunFollower, Stop};
use crate::data::recording::Ending;
use servoid_protocol::message::EndReason;

impl RunFollower<'_> {
    /// How a run ended that was followed to its end.
    pub(in crate::instrument::rig) fn ending(&self) -> Ending {
        let Some(ended) = &self.ended else {
            return self.partial("stopped by the user before the run began".to_owned());
        };
        if ended.reason == EndReason::Complete && self.assembly.is_whole(ended) {
            return Ending::Complete;
        }
        if let Some(reason) = self.enough()
            && ended.reason == EndReason::Stopped
            && self.assembly.is_whole(ended)
        {
            return Ending::Early {
                reason: reason.to_owned(),
            };
        }
        let mut reason = match ended.reason {
            EndReason::Complete => String::new(),
            EndReason::Stopped => self.enough().unwrap_or("stopped by the user").to_owned(),
            EndReason::Disarmed => "the rig was disarmed".to_owned(),
            EndReason::LeaseLapsed => {
                "the rig heard nothing from the host for two seconds".to_owned()
            }
            EndReason::SensorOutOfRange => {
                "the sensor read outside its healthy range: check its wiring".to_owned()
            }
        };
        let missing = if self.assembly.lacks_only_what_the_board_lost(ended) {
            (ended.frames_lost_on_board > 0)
                .then_some("the board could not keep up and lost frames")
        } else if self.assembly.lost().is_empty() {
            Some("the rig's check over the run differs from what arrived: do not trust the rows")
        } else {
            Some("frames were lost on the line, and the board no longer had them when asked again")
        };
        if let Some(missing) = missing {
            if !reason.is_empty() {
                reason.push_str("; ");
            }
            reason.push_str(missing);
        }
        self.partial(reason)
    }

    /// What has been reached, if the run was ended for that.
    fn enough(&self) -> Option<&str> {
        match &self.stop {
            Stop::Wanted(StopReason::Enough(reason)) | Stop::Done(StopReason::Enough(reason)) => {
                Some(reason)
            }
            _ => None,
        }
    }

    /// How a run ended of which the end is not known.
    pub(in crate::instrument::rig) fn broken_off(&self, error: &CaptureError) -> Ending {
        self.partial(error.to_string())
    }

    fn partial(&self, reason: String) -> Ending {
        let mut lost_frames = self.assembly.lost().to_vec();
        // What could not be written, and what the run would still have had, is missing as well.
        let end = self.start.frames();
        match lost_frames.last_mut() {
            Some(last) if last.end >= self.written => last.end = end,
            _ if self.written < end => lost_frames.push(self.written..end),
            _ => {}
        }
        Ending::Partial {
            reason,
            lost_frames,
        }
    }
}
