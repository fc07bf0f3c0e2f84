//! Frames as they are on the wire today, byte for byte.
//!
//! The bytes were made by another implementation (a few lines of Python: varints, `zlib.crc32`, COBS by
//! its definition). If one of these tests fails, hosts and rigs in the field no longer understand each
//! other: new messages go at the end of their enum.

use servoid_protocol::framing::CRC;
use servoid_protocol::health::{FaultKind, Health, LastFault};
use servoid_protocol::hello::Text16;
use servoid_protocol::loopback::{Loopback, LoopbackFrame, Probe, Vitals};
use servoid_protocol::message::{Arm, ArmFor, Ended, Start};
use servoid_protocol::pulse_train::{PulseTrain, PulseType};
use servoid_protocol::reference::{Multisine, Prbs, Staircase, Stairs, Step, Steps, Sweep};
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
    require_request(
        1,
        4,
        Command::Health,
        &[0x00, 0x08, 0x01, 0x04, 0x09, 0x85, 0xce, 0x33, 0xe3, 0x00],
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

#[test]
fn health() {
    let fault = LastFault {
        kind: FaultKind::Panic,
        detail: 42,
        place: Text16::new("src/pulse.rs"),
    };
    let health = Health {
        flash_kib: 64,
        device: 0x2003_6410,
        bandgap_at_start: 24_000,
        bandgap: 24_100,
        low_supply_frames: 3,
        last_fault: Some(fault),
    };
    require_message(
        RigMessage::Health(health),
        &[
            0x00, 0x10, 0x06, 0x40, 0x90, 0xc8, 0x8d, 0x80, 0x02, 0xc0, 0xbb, 0x01, 0xa4, 0xbc,
            0x01, 0x03, 0x01, 0x0e, 0x2a, 0x73, 0x72, 0x63, 0x2f, 0x70, 0x75, 0x6c, 0x73, 0x65,
            0x2e, 0x72, 0x73, 0x01, 0x01, 0x01, 0x05, 0x5d, 0xe1, 0xfb, 0x70, 0x00,
        ],
    );
    let nothing = Health {
        flash_kib: 64,
        ..Health::default()
    };
    require_message(
        RigMessage::Health(nothing),
        &[
            0x00, 0x03, 0x06, 0x40, 0x01, 0x01, 0x01, 0x01, 0x05, 0x28, 0xe0, 0xe4, 0xf1, 0x00,
        ],
    );
    require_message(
        RigMessage::Reply {
            session: 1,
            id: 6,
            outcome: Outcome::Refused(Refusal::SupplyLow),
        },
        &[
            0x00, 0x0a, 0x02, 0x01, 0x06, 0x01, 0x0b, 0x63, 0x57, 0x1a, 0x8e, 0x00,
        ],
    );
}

#[test]
fn the_self_test() {
    let loopback = Loopback {
        schema_hash: 0x0123_4567_89ab_cdef,
        pulse: PulseWidth(1_500),
        probe_us: 19_980,
    };
    require_request(
        1,
        8,
        Command::Loopback(loopback),
        &[
            0x00, 0x16, 0x01, 0x08, 0x0b, 0xef, 0x9b, 0xaf, 0xcd, 0xf8, 0xac, 0xd1, 0x91, 0x01,
            0xdc, 0x0b, 0x8c, 0x9c, 0x01, 0x05, 0xc6, 0xe8, 0xb9, 0x00,
        ],
    );
    require_request(
        1,
        7,
        Command::Vitals,
        &[0x00, 0x08, 0x01, 0x07, 0x0a, 0xfc, 0xcc, 0x17, 0x51, 0x00],
    );
    let mut samples = [Counts(3); 10];
    let before = LoopbackFrame {
        number: 500,
        pulse: None,
        samples,
        sampled_us: 18_585,
        probe: None,
    };
    require_message(
        RigMessage::Loopback(before),
        &[
            0x00, 0x04, 0x08, 0xf4, 0x03, 0x0e, 0x03, 0x03, 0x03, 0x03, 0x03, 0x03, 0x03, 0x03,
            0x03, 0x03, 0x99, 0x91, 0x01, 0x05, 0x6d, 0xd5, 0x0e, 0x52, 0x00,
        ],
    );
    samples[0] = Counts(10_843);
    let frame = LoopbackFrame {
        pulse: Some(PulseWidth(1_500)),
        samples,
        probe: Some(Probe {
            at_us: 19_980,
            code: 2_712,
        }),
        ..before
    };
    require_message(
        RigMessage::Loopback(frame),
        &[
            0x00, 0x1f, 0x08, 0xf4, 0x03, 0x01, 0xdc, 0x0b, 0xdb, 0x54, 0x03, 0x03, 0x03, 0x03,
            0x03, 0x03, 0x03, 0x03, 0x03, 0x99, 0x91, 0x01, 0x01, 0x8c, 0x9c, 0x01, 0x98, 0x15,
            0xda, 0x4e, 0x97, 0x6b, 0x00,
        ],
    );
    let vitals = Vitals {
        frames: 500,
        awake_us: 123_456,
        stack_bytes: 10_240,
        stack_unused: 3_608,
    };
    require_message(
        RigMessage::Vitals(vitals),
        &[
            0x00, 0x0f, 0x07, 0xf4, 0x03, 0xc0, 0xc4, 0x07, 0x80, 0x50, 0x98, 0x1c, 0x95, 0x3d,
            0xfb, 0x9c, 0x00,
        ],
    );
}

/// One of each, with what goes over the wire for it and the CRC-32 over its offsets (each as two bytes,
/// little endian). The offsets were made by the other implementation too: of the circuit of the levels,
/// the register, and the sine by its table.
fn references() -> [(Reference, u32, &'static [u8]); 5] {
    let step = |(offset_us, hold_frames)| Step {
        offset_us,
        hold_frames,
    };
    let doublet = [(50, 20), (-50, 20), (0, 40)].map(step);
    [
        (
            Reference::Stairs(Stairs {
                amplitude_us: 50,
                levels: 5,
                hold_frames: 15,
                cycles: 2,
            }),
            0xfc5c_7134,
            &[
                0x00, 0x10, 0x01, 0x05, 0x05, 0x07, 0x28, 0x01, 0x32, 0x05, 0x0f, 0x02, 0x28, 0xf1,
                0xdb, 0x9c, 0xdb, 0x00,
            ],
        ),
        (
            Reference::Prbs(Prbs {
                amplitude_us: 50,
                register: 9,
                seed: 511,
                chip_frames: 1,
                chips: 511,
            }),
            0xd6bb_764a,
            &[
                0x00, 0x13, 0x01, 0x05, 0x05, 0x07, 0x28, 0x02, 0x32, 0x09, 0xff, 0x03, 0x01, 0xff,
                0x03, 0x28, 0xed, 0x4a, 0xd7, 0x7b, 0x00,
            ],
        ),
        (
            Reference::Sweep(Sweep {
                amplitude_us: 50,
                first_millihertz: 200,
                last_millihertz: 15_000,
                frames: 512,
            }),
            0xd051_c869,
            &[
                0x00, 0x13, 0x01, 0x05, 0x05, 0x07, 0x28, 0x03, 0x32, 0xc8, 0x01, 0x98, 0x75, 0x80,
                0x04, 0x28, 0x98, 0x2a, 0x39, 0x7b, 0x00,
            ],
        ),
        (
            Reference::Multisine(Multisine {
                amplitude_us: 50,
                tone_64ths_us: 300,
                period_frames: 256,
                first: 2,
                spacing: 1,
                tones: 75,
                periods: 2,
            }),
            0xc60a_4f17,
            &[
                0x00, 0x15, 0x01, 0x05, 0x05, 0x07, 0x28, 0x04, 0x32, 0xac, 0x02, 0x80, 0x02, 0x02,
                0x01, 0x4b, 0x02, 0x28, 0xdb, 0x21, 0x3d, 0x76, 0x00,
            ],
        ),
        (
            Reference::Steps(Steps::new(3, &doublet).unwrap()),
            0xb2e1_9e99,
            &[
                0x00, 0x0c, 0x01, 0x05, 0x05, 0x07, 0x28, 0x05, 0x03, 0x64, 0x14, 0x63, 0x14, 0x02,
                0x28, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01,
                0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01,
                0x01, 0x01, 0x06, 0x28, 0x2e, 0xae, 0xc9, 0xb5, 0x00,
            ],
        ),
    ]
}

#[test]
fn every_other_reference() {
    for (reference, crc, golden) in references() {
        let start = Start {
            run: 7,
            pre_roll_frames: 40,
            reference,
            post_roll_frames: 40,
        };
        require_request(1, 5, Command::Start(start), golden);
        let bytes: Vec<u8> = reference.offsets_us().flat_map(i16::to_le_bytes).collect();
        assert_eq!(CRC.checksum(&bytes), crc, "{}", reference.name());
    }
}

#[test]
fn arming_for_a_narrow_pulse_servo_at_560_hz() {
    let arm = Arm {
        schema_hash: 0x0123_4567_89ab_cdef,
        neutral: PulseWidth(760),
        shortest: PulseWidth(660),
        longest: PulseWidth(860),
        sensor_low: Counts(1_000),
        sensor_high: Counts(15_380),
        lease_frames: 111,
    };
    let train = PulseTrain {
        pulses: PulseType::Narrow,
        period_us: 1_786,
    };
    require_request(
        0x1234,
        301,
        Command::ArmFor(ArmFor { train, arm }),
        &[
            0x00, 0x21, 0xb4, 0x24, 0xad, 0x02, 0x0c, 0x01, 0xfa, 0x0d, 0xef, 0x9b, 0xaf, 0xcd,
            0xf8, 0xac, 0xd1, 0x91, 0x01, 0xf8, 0x05, 0x94, 0x05, 0xdc, 0x06, 0xe8, 0x07, 0x94,
            0x78, 0x6f, 0xa7, 0x59, 0x40, 0xc4, 0x00,
        ],
    );
    require_message(
        RigMessage::Reply {
            session: 1,
            id: 6,
            outcome: Outcome::Refused(Refusal::OtherPulseType),
        },
        &[
            0x00, 0x0a, 0x02, 0x01, 0x06, 0x01, 0x0e, 0xec, 0xa3, 0x70, 0xfe, 0x00,
        ],
    );
}
