//! Frames as they are on the wire today, byte for byte.
//!
//! The bytes were made by another implementation (a few lines of Python: varints, `zlib.crc32`, COBS by
//! its definition). If one of these tests fails, hosts and rigs in the field no longer understand each
//! other: new messages go at the end of their enum.

use servoid_protocol::message::{Arm, Ended, Start};
use servoid_protocol::reference::Staircase;
use servoid_protocol::{
    Command, Counts, Decoder, EndReason, Frame, Outcome, PulseWidth, Reference, Refusal, Request,
    RigMessage, framing,
};

fn require_request(session: u16, id: u16, command: Command, golden: &[u8]) {
    let request = Request {
        session,
        id,
        command,
    };
    let mut buffer = [0; framing::MAX_WIRE];
    assert_eq!(framing::encode(&request, &mut buffer), Ok(golden));
    let mut decoder = Decoder::new();
    let read: Vec<Request> = golden.iter().filter_map(|&b| decoder.push(b)).collect();
    assert_eq!(read, [request]);
}

fn require_message(message: RigMessage, golden: &[u8]) {
    let mut buffer = [0; framing::MAX_WIRE];
    assert_eq!(framing::encode(&message, &mut buffer), Ok(golden));
    let mut decoder = Decoder::new();
    let read: Vec<RigMessage> = golden.iter().filter_map(|&b| decoder.push(b)).collect();
    assert_eq!(read, [message]);
}

#[test]
fn requests() {
    require_request(
        1,
        3,
        Command::KeepAlive,
        &[0x00, 0x08, 0x01, 0x03, 0x07, 0x45, 0x75, 0xca, 0x4b, 0x00],
    );
    let arm = Arm {
        schema_hash: 0x0123_4567_89ab_cdef,
        neutral: PulseWidth(1_500),
        shortest: PulseWidth(1_400),
        longest: PulseWidth(1_600),
        sensor_low: Counts(1_000),
        sensor_high: Counts(15_380),
        lease_frames: 100,
    };
    require_request(
        0x1234,
        300,
        Command::Arm(arm),
        &[
            0x00, 0x1e, 0xb4, 0x24, 0xac, 0x02, 0x03, 0xef, 0x9b, 0xaf, 0xcd, 0xf8, 0xac, 0xd1,
            0x91, 0x01, 0xdc, 0x0b, 0xf8, 0x0a, 0xc0, 0x0c, 0xe8, 0x07, 0x94, 0x78, 0x64, 0x87,
            0x80, 0x51, 0x47, 0x00,
        ],
    );
    let start = Start {
        run: 7,
        pre_roll_frames: 40,
        reference: Reference::Staircase(Staircase::PAPER),
        post_roll_frames: 40,
    };
    require_request(
        1,
        5,
        Command::Start(start),
        &[
            0x00, 0x06, 0x01, 0x05, 0x05, 0x07, 0x28, 0x09, 0x32, 0x28, 0x05, 0x05, 0x28, 0xa6,
            0x6c, 0x4e, 0x01, 0x00,
        ],
    );
    let resend = Command::Resend {
        run: 7,
        first: 300,
        count: 64,
    };
    require_request(
        1,
        6,
        resend,
        &[
            0x00, 0x0c, 0x01, 0x06, 0x08, 0x07, 0xac, 0x02, 0x40, 0xb9, 0xc3, 0x6d, 0xd4, 0x00,
        ],
    );
}

#[test]
fn messages() {
    let outcome = Outcome::Refused(Refusal::UnknownRun);
    require_message(
        RigMessage::Reply {
            session: 1,
            id: 6,
            outcome,
        },
        &[
            0x00, 0x0a, 0x02, 0x01, 0x06, 0x01, 0x08, 0xd9, 0x06, 0x13, 0x17, 0x00,
        ],
    );
    let frame = Frame {
        run: 7,
        index: 300,
        pulse: PulseWidth(1_550),
        samples: std::array::from_fn(|k| Counts(8_000 + k as u16)),
    };
    require_message(
        RigMessage::Frame(frame),
        &[
            0x00, 0x1f, 0x04, 0x07, 0xac, 0x02, 0x8e, 0x0c, 0xc0, 0x3e, 0xc1, 0x3e, 0xc2, 0x3e,
            0xc3, 0x3e, 0xc4, 0x3e, 0xc5, 0x3e, 0xc6, 0x3e, 0xc7, 0x3e, 0xc8, 0x3e, 0xc9, 0x3e,
            0xb8, 0x97, 0x7a, 0xb7, 0x00,
        ],
    );
    let ended = Ended {
        run: 7,
        reason: EndReason::Complete,
        frames: 440,
        frames_lost_on_board: 0,
        check: 0xdead_beef,
    };
    require_message(
        RigMessage::Ended(ended),
        &[
            0x00, 0x03, 0x05, 0x07, 0x03, 0xb8, 0x03, 0x0a, 0xef, 0xfd, 0xb6, 0xf5, 0x0d, 0xcb,
            0xa4, 0xd6, 0xc4, 0x00,
        ],
    );
}
