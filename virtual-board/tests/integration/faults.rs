//! Injected faults: the final state of the rig, the time until then, its report, and the next run.
//!
//! | fault            | safe state                     | documented where                                  |
//! |------------------|--------------------------------|---------------------------------------------------|
//! | bytes disturbed  | none needed: repeated           | protocol: requests may be repeated, frames resent  |
//! | no crystal       | works, and says so              | `ClockSource::InternalRc`                          |
//! | crystal stops    | no pulses, at once              | the image's `clock` and `safety`                   |
//! | sensor broken    | neutral, within 10 ms and a frame | `limits::UNHEALTHY_SAMPLES`                      |
//! | host silent      | neutral, when the lease lapses  | `rig`, Leases                                      |
//! | processor stuck  | no pulses, within 6.7 frames    | the image's `watchdog`                             |
//! | brown-out        | no pulses, at once              | reset state of the chip                            |

use servoid::data::recording::Ending;
use servoid::instrument::rig::RigClient;
use servoid_protocol::PulseTrain;
use servoid_protocol::hello::{ClockSource, ResetCause};
use servoid_protocol::lease::LONGEST_LEASE_S;
use servoid_protocol::message::{Activity, Arm, Command, EndReason};
use servoid_test_support::virtual_board::{FRAME, SharedBoard, arm, capture, options, staircase};
use std::time::Duration;
use virtual_board::Fault;
use virtual_board::record::{Irregularity, Pulse, ResetReason, Violation};
use virtual_board::time::{Ticks, from_duration, microseconds, milliseconds, to_duration};

const NEUTRAL: Ticks = microseconds(1_500);

/// When the fault happens, some seconds into the staircase.
const FAULT: Duration = Duration::from_secs(3);

fn fault_at() -> Ticks {
    from_duration(FAULT)
}

fn pulses(board: &SharedBoard) -> Vec<Pulse> {
    board.with(|board| board.chip().record.pulses.clone())
}

fn resets(board: &SharedBoard) -> Vec<ResetReason> {
    board.with(|board| {
        board
            .chip()
            .record
            .resets
            .iter()
            .map(|reset| reset.1)
            .collect()
    })
}

/// Starts the staircase and lets time pass, without a word from the host, to `end`. Until its lease
/// is over or the board is reset, only this host may go on.
fn start_and_watch(board: &SharedBoard, lease_frames: u16, end: Duration) -> RigClient {
    let mut client = board.connect();
    start(&mut client, lease_frames);
    board.with(|board| board.run_until(from_duration(end)));
    client
}

/// Starts the staircase.
pub fn start(client: &mut RigClient, lease_frames: u16) {
    let arm = Arm {
        lease_frames,
        ..arm()
    };
    client.request(Command::Arm(arm)).unwrap();
    client.request(Command::Start(staircase().start)).unwrap();
}

/// A lease that outlasts every test.
const LONG_LEASE: u16 = PulseTrain::USUAL.frames_in(LONGEST_LEASE_S);

/// Connects anew and captures a whole staircase; returns the status of the rig before.
fn next_run_works(board: &SharedBoard) -> (ClockSource, ResetCause) {
    next_run_of_it_works(&mut board.connect())
}

/// The same with the host that has the rig.
pub fn next_run_of_it_works(client: &mut RigClient) -> (ClockSource, ResetCause) {
    let hello = *client.hello();
    let folder = tempfile::tempdir().unwrap();
    let (end, frames) = capture(client, &staircase(), &folder.path().join("next.csv"));
    let end = end.unwrap();
    assert_eq!(end.ending, Ending::Complete);
    // The message that a reset cut off may still be in the line.
    assert!(end.rejects <= 1, "{}", end.rejects);
    assert_eq!(frames.len() as u32, staircase().start.frames());
    (hello.clock, hello.reset_cause)
}

#[test]
fn flipped_bytes_cost_repeats_and_nothing_else() {
    require_repeats_alone(&["to-host-flip:0.003"]);
}

#[test]
#[ignore = "four seconds: cargo test -p virtual-board --test integration -- --ignored disturbed_bytes"]
fn disturbed_bytes_cost_repeats_and_nothing_else() {
    require_repeats_alone(&[
        "to-board-flip:0.01",
        "to-host-drop:0.003",
        "to-board-drop:0.01",
        "inject:0.003",
    ]);
}

/// A frame has 36 bytes: at 0.3 % for each, one in ten is hit. Requests are few, so each of their
/// bytes is hit more often; all eight attempts at one of 12 bytes fail once in 10^7.
fn require_repeats_alone(ways: &[&str]) {
    for faults in ways {
        let board = SharedBoard::new(&options("linear?seed=1", &[faults]));
        let mut client = board.connect();
        let folder = tempfile::tempdir().unwrap();
        let (end, frames) = capture(&mut client, &staircase(), &folder.path().join("run.csv"));
        let end = end.unwrap();
        // The rig's check over the run agrees: not a bit of it is wrong.
        let status = client.status().unwrap();
        assert_eq!(
            end.ending,
            Ending::Complete,
            "{faults:?}: {status:?}, {:?}",
            board.violations()
        );
        assert_eq!(frames.len() as u32, staircase().start.frames());
        // Which bytes are hit depends on the session's number, which is by chance: ask until one was.
        let hit = end.rejects > 0
            || end.asked_again > 1
            || (0..200).any(|_| client.status().unwrap().rejects > 0);
        assert!(hit, "{faults:?} disturbed nothing");
        assert_eq!(board.violations(), [""; 0], "{faults:?}");
    }
}

#[test]
fn without_a_crystal_the_internal_oscillator_does_and_says_so() {
    let board = SharedBoard::new(&options("linear?seed=1", &["no-crystal"]));
    let (clock, cause) = next_run_works(&board);
    assert_eq!(
        (clock, cause),
        (ClockSource::InternalRc, ResetCause::PowerOn)
    );
    let pulses = pulses(&board);
    assert!(
        pulses
            .windows(2)
            .all(|pair| pair[1].rise - pair[0].rise == FRAME)
    );
    assert_eq!(board.violations(), [""; 0]);
}

/// A time in the middle of a pulse: 0.7 ms after its rising edge, some 3 s after the start. It is taken from a board
/// without a fault, because every board boots in the same number of ticks.
fn in_a_pulse() -> Ticks {
    let board = SharedBoard::new(&options("linear?seed=1", &[]));
    let first_sample = board.with(|board| board.chip().record.conversions[0].start);
    first_sample + 150 * FRAME + microseconds(200)
}

#[test]
fn a_crystal_that_stops_ends_the_pulses_at_once() {
    let at = in_a_pulse();
    let options = options("linear?seed=1", &[]).with_fault(Fault::CrystalStops(at));
    let board = SharedBoard::new(&options);
    start_and_watch(&board, LONG_LEASE, to_duration(at) + Duration::from_secs(1));
    let last = *pulses(&board).last().unwrap();
    // At 8 MHz the program takes some microseconds until it is there.
    let end = last.rise + last.width;
    assert!(
        last.rise < at && end > at && end < at + microseconds(20),
        "{last:?}"
    );
    assert_eq!(
        resets(&board),
        [ResetReason::PowerOn, ResetReason::Software]
    );
    let (clock, cause) = next_run_works(&board);
    assert_eq!(
        (clock, cause),
        (ClockSource::InternalRc, ResetCause::Software)
    );
    assert_eq!(board.violations(), [""; 0]);
}

#[test]
fn a_broken_sensor_ends_the_run_at_neutral() {
    for fault in ["sensor-open@3", "sensor-short@3"] {
        let board = SharedBoard::new(&options("linear?seed=1", &[fault]));
        let mut client = start_and_watch(&board, LONG_LEASE, FAULT + Duration::from_secs(1));
        let status = client.status().unwrap();
        let Activity::Ended(ended) = status.activity else {
            panic!("{fault}: {status:?}");
        };
        assert_eq!(ended.reason, EndReason::SensorOutOfRange, "{fault}");
        // Five bad samples, the rest of their frame, and the edge after it.
        let safe_from = fault_at() + milliseconds(10) + 2 * FRAME;
        let after: Vec<Pulse> = pulses(&board)
            .into_iter()
            .filter(|pulse| pulse.rise >= safe_from)
            .collect();
        assert!(
            after.len() > 40 && after.iter().all(|pulse| pulse.width == NEUTRAL),
            "{fault}"
        );
        // As long as the sensor is broken, there is no next run: it is refused.
        let refused = staircase().arm(&mut client).unwrap_err();
        assert!(refused.to_string().contains("sensor"), "{refused}");
        assert_eq!(board.violations(), [""; 0], "{fault}");
    }
}

#[test]
fn a_sensor_that_is_repaired_makes_the_next_run() {
    let board = SharedBoard::new(&options("linear?seed=1", &["sensor-open@3-5"]));
    let mut client = start_and_watch(&board, LONG_LEASE, FAULT + Duration::from_secs(1));
    let refused = staircase().arm(&mut client).unwrap_err();
    assert!(refused.to_string().contains("sensor"), "{refused}");
    board.pass(Duration::from_secs(2));
    next_run_of_it_works(&mut client);
    assert_eq!(board.violations(), [""; 0]);
}

#[test]
fn a_silent_host_ends_the_run_at_neutral_when_its_lease_lapses() {
    let board = SharedBoard::new(&options("linear?seed=1", &["host-silent@3"]));
    let lease = 50;
    let mut client = board.connect();
    start(&mut client, lease);
    let mut last_heard = 0;
    while board.with(|board| board.now()) < fault_at() {
        last_heard = board.with(|board| board.now());
        client.request(Command::KeepAlive).unwrap();
        board.pass(Duration::from_millis(400));
    }
    board.pass(Duration::from_secs(3));
    // A lease after the last sign of life, and the edge after that.
    let lapsed = last_heard + (Ticks::from(lease) + 3) * FRAME;
    let pulses = pulses(&board);
    let after = pulses.iter().filter(|pulse| pulse.rise >= lapsed);
    assert!(after.clone().count() > 40);
    assert!(after.clone().all(|pulse| pulse.width == NEUTRAL));
    // Not before its time either: the reference went on until shortly before.
    let moving = pulses
        .iter()
        .rev()
        .find(|pulse| pulse.width != NEUTRAL)
        .unwrap();
    assert!(moving.rise >= lapsed - 6 * FRAME, "{moving:?}");
    assert_eq!(board.violations(), [""; 0]);
}

#[test]
fn a_host_that_comes_back_after_its_lease_makes_the_next_run() {
    let board = SharedBoard::new(&options("linear?seed=1", &[]));
    start_and_watch(&board, 50, FAULT);
    let Activity::Ended(ended) = board.connect().status().unwrap().activity else {
        panic!("still running");
    };
    assert_eq!(ended.reason, EndReason::LeaseLapsed);
    next_run_works(&board);
    assert_eq!(board.violations(), [""; 0]);
}

#[test]
fn a_stuck_processor_is_reset_by_the_watchdog() {
    require_watchdog(&[40_000]);
}

#[test]
#[ignore = "two seconds: cargo test -p virtual-board --test integration -- --ignored any_watchdog"]
fn a_stuck_processor_is_reset_by_any_watchdog() {
    require_watchdog(&[30_000, 60_000]);
}

/// The oscillator of the watchdog has 30 to 60 kHz, so it bites after 3.3 to 6.7 frames.
fn require_watchdog(oscillators_hz: &[u32]) {
    for &lsi_hz in oscillators_hz {
        let mut options = options("linear?seed=1", &["cpu-stuck@3"]);
        options.lsi_hz = lsi_hz;
        let board = SharedBoard::new(&options);
        start_and_watch(&board, LONG_LEASE, FAULT + Duration::from_secs(1));
        let bites = board.with(|board| board.chip().record.resets[1].0);
        // It was last fed in the frame before the fault.
        let (soonest, latest) = (fault_at() + 2 * FRAME, fault_at() + 67 * FRAME / 10);
        assert!((soonest..latest).contains(&bites), "{lsi_hz} Hz: {bites}");
        let last = *pulses(&board).last().unwrap();
        assert!(last.rise < bites, "{lsi_hz} Hz");
        assert_eq!(
            resets(&board),
            [ResetReason::PowerOn, ResetReason::Watchdog]
        );
        let (clock, cause) = next_run_works(&board);
        assert_eq!((clock, cause), (ClockSource::Crystal, ResetCause::Watchdog));
        // The frames that nobody took are what is to be seen of it, and nothing else.
        board.with(|board| {
            let chip = board.chip();
            let overran = |v: &Violation| matches!(v.what, Irregularity::DmaOverrun(_));
            let violations = &chip.record.violations;
            assert!(
                !violations.is_empty() && violations.iter().all(overran),
                "{violations:?}"
            );
        });
    }
}

#[test]
fn a_brown_out_ends_the_pulses_and_is_reported() {
    let at = in_a_pulse();
    let options = options("linear?seed=1", &[]).with_fault(Fault::BrownOut(at));
    let board = SharedBoard::new(&options);
    start_and_watch(&board, LONG_LEASE, to_duration(at) + Duration::from_secs(1));
    let last = *pulses(&board).last().unwrap();
    // Cut short, an instruction later at most.
    let end = last.rise + last.width;
    assert!(
        last.rise < at && (at..at + microseconds(1)).contains(&end),
        "{last:?}"
    );
    assert_eq!(resets(&board), [ResetReason::PowerOn; 2]);
    let (clock, cause) = next_run_works(&board);
    assert_eq!((clock, cause), (ClockSource::Crystal, ResetCause::PowerOn));
    assert_eq!(board.violations(), [""; 0]);
}
