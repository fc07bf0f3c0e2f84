//! Why a rig cannot be talked to.

use servoid_client::ClientError;

/// Why a rig cannot be talked to. The text names the remedy.
#[derive(Debug, thiserror::Error)]
pub enum TalkError {
    /// Not a byte came from this port.
    #[error(
        "nothing on {0} answers: check that the board has power, that 'servoid flash' has written its firmware and its BOOT0 is at 0, and that RX and TX are crossed"
    )]
    Silent(String),
    /// So many bytes came from this port, but none of them make sense.
    #[error(
        "{0} sends bytes that are not a rig's ({1} bytes, no message in them): another device, another baud rate than 115200, or a noisy line"
    )]
    Garbled(String, u64),
    /// The conversation failed.
    #[error(transparent)]
    Rig(#[from] ClientError),
    /// The stream broke.
    #[error("the connection broke: check the cable and the rig's power")]
    Broken(#[from] std::io::Error),
}
