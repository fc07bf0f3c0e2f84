//! Events of a conversation, for its driver.

use crate::error::ClientError;
use crate::request::Answer;
use crate::run_ending::RunEnding;
use servoid_protocol::{Frame, Hello};

/// An event of the conversation.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// The session is open.
    Connected(Hello),
    /// A request has been carried out.
    Answered(Answer),
    /// The rig has begun the run of this number.
    RunBegun {
        /// The number that was asked for, or one of the next where the rig's last run had that one.
        run: u16,
    },
    /// The run's next frame. Frames come in order and once; an index that is left out is lost.
    Frame(Frame),
    /// The run is over, and every frame that can be had has come.
    RunEnded(RunEnding),
    /// The task has failed.
    Failed(ClientError),
}
