//! Runs of other programs, heard on the line.

use crate::instrument::port::Port;
use servoid_protocol::Decoder;
use servoid_protocol::message::RigMessage;
use std::time::Duration;

/// A run sends a frame every 20 ms: three times that lets one be lost.
const FRAMES_COME: Duration = Duration::from_millis(60);

/// A run whose frames have come does not come to its end before this much silence.
const FRAMES_STOP: Duration = Duration::from_millis(200);

/// Longer than the two seconds for which a run goes on that nobody follows.
pub(super) const RUN_IS_FOLLOWED: Duration = Duration::from_millis(2_500);

/// Whether frames of a run come, and go on coming for longer than a lease: a run that nobody follows
/// any more ends by itself.
pub(super) fn hears_a_run(port: &mut dyn Port) -> std::io::Result<bool> {
    let (mut decoder, mut buffer) = (Decoder::new(), [0; 512]);
    let begin = port.now();
    let mut quiet_at = begin + FRAMES_COME;
    while port.now() < quiet_at {
        if port.now() >= begin + RUN_IS_FOLLOWED {
            return Ok(true);
        }
        let count = port.read(&mut buffer, quiet_at.saturating_sub(port.now()))?;
        let messages = buffer.iter().take(count);
        for message in messages.filter_map(|&byte| decoder.push::<RigMessage>(byte)) {
            if matches!(message, RigMessage::Frame(_)) {
                quiet_at = port.now() + FRAMES_STOP;
            }
        }
    }
    Ok(false)
}
