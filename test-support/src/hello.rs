//! The answer of a rig that has just been started.

use servoid_protocol::Hello;
use servoid_protocol::hello::{ClockSource, ResetCause, Text16};
use servoid_protocol::schema::{PROTOCOL_VERSION, SCHEMA_HASH};

/// Of a board with this program's own protocol. A test that needs another fact puts it in its place.
#[must_use]
pub fn hello() -> Hello {
    Hello {
        protocol_version: PROTOCOL_VERSION,
        schema_hash: SCHEMA_HASH,
        board: Text16::new("bench"),
        build: Text16::new("0"),
        unique_id: [7; 12],
        clock: ClockSource::Crystal,
        reset_cause: ResetCause::PowerOn,
        frame_us: 20_000,
        sample_us: 2_000,
        first_sample_us: 500,
        aperture_us: 84,
        oversampling: 4,
        full_scale_counts: 16_380,
        shortest_pulse_us: 800,
        longest_pulse_us: 2_200,
        history_frames: 256,
    }
}
