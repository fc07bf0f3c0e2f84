//! The last line of a recording: whether it is complete, and why not.

use super::capture_outcome::StopReason;
use crate::data::StandStill;
use crate::data::recording::Ending;
use servoid_client::{Arrived, RunEnding};
use servoid_protocol::lease::LEASE;
use servoid_protocol::message::EndReason;
use std::ops::Range;

/// The ending of a run that was followed to its end, or that never began; `stopped` is why it was
/// stopped, if it was, and `still` where the sensor's reading stood still.
pub(super) fn recording_ending(
    run: Option<&RunEnding>,
    stopped: Option<&StopReason>,
    still: Option<&StandStill>,
    lost_frames: Vec<Range<u32>>,
) -> Ending {
    let enough = match stopped {
        Some(StopReason::Enough(reason)) => Some(reason.clone()),
        Some(StopReason::User) | None => None,
    };
    let reason = match (run.map(|run| (run.reason, run.arrived)), enough) {
        (None, _) => "stopped by the user before the run began".to_owned(),
        (Some((EndReason::Complete, Arrived::Whole)), _) if still.is_none() => {
            return Ending::Complete;
        }
        (Some((EndReason::Stopped, Arrived::Whole)), Some(reason)) if still.is_none() => {
            return Ending::Early { reason };
        }
        (Some((reason, arrived)), enough) => {
            let still = still.map(ToString::to_string);
            let parts = [stopped_by(reason, enough), missing(arrived), still];
            parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
        }
    };
    Ending::Partial {
        reason,
        lost_frames,
    }
}

fn stopped_by(reason: EndReason, enough: Option<String>) -> Option<String> {
    Some(match reason {
        EndReason::Complete => return None,
        EndReason::Stopped => enough.unwrap_or_else(|| "stopped by the user".to_owned()),
        EndReason::Disarmed => "the rig was disarmed".to_owned(),
        EndReason::LeaseLapsed => format!(
            "the rig heard nothing from the host for {} s",
            LEASE.as_secs()
        ),
        EndReason::SensorOutOfRange => {
            "the sensor read outside its healthy range: check its wiring".to_owned()
        }
        EndReason::SupplyLow => {
            "the board's own 3.3 V fell too low: feed its 5V pin with 4.75 to 5.25 V".to_owned()
        }
    })
}

fn missing(arrived: Arrived) -> Option<String> {
    let text = match arrived {
        Arrived::Whole => return None,
        Arrived::LostOnBoard => "the board could not keep up and lost frames",
        Arrived::CheckDiffers => {
            "the rig's check over the run differs from what arrived: do not trust the rows"
        }
        Arrived::LostOnLine => {
            "frames were lost on the line, and the board no longer had them when asked again"
        }
    };
    Some(text.to_owned())
}
