//! One board that is kept on while everything goes wrong with it, one capture after the other.
//!
//! ```text
//! host's capture <--> ChaosPort (frames) <--> line with disturbed bytes <--> image on the board
//!                                                          brown-outs and sags of the supply, a stuck processor, hard faults,
//!                                                          the reset pin, a sensor that breaks and is repaired
//! ```
//!
//! Each capture is judged against what the models of ADC and servo output saw; each reset and each
//! irregularity must be one that a fault explains.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use servoid_protocol::message::Start;
use servoid_protocol::reference::{Reference, Staircase};
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_protocol::{Counts, PulseWidth};
use servoid_simulator::SimulatedFrame;
use servoid_test_support::bad_line::{ChaosPort, Faults};
use servoid_test_support::trials::judge::{Outcome, capture_to_disk, check};
use servoid_test_support::virtual_board::{
    FIRST_SAMPLE, FRAME, LOST, OVERSAMPLING, SharedBoard, options, staircase,
};
use std::time::Duration;
use virtual_board::Fault;
use virtual_board::fault::BROWN_OUT;
use virtual_board::record::{Conversion, Irregularity, Pulse, Record, ResetReason};
use virtual_board::time::{TICKS_PER_MICROSECOND, Ticks, from_duration, milliseconds, to_duration};

/// The outcomes of the captures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Tally {
    /// Every sample.
    complete: u32,
    /// Some samples, with the missing ones listed.
    partial: u32,
    /// No recording, with the reason.
    refused: u32,
    /// Those of them that neither a fault of the board nor the user fell into.
    undisturbed: u32,
    /// Those of the undisturbed that were complete.
    undisturbed_complete: u32,
    /// Faults of the board that have happened.
    faults: u32,
}

/// Something that the board has to survive.
#[derive(Clone, Copy, Debug)]
struct Trouble {
    fault: Fault,
    at: Ticks,
    /// From here on the board is as it was, armed no more.
    over: Ticks,
    reset: Option<ResetReason>,
}

/// Mean time between two troubles, beyond the time that one takes.
const BETWEEN_TROUBLES: Duration = Duration::from_secs(15);
/// A trouble is over and the board heard of it before the next one comes.
const APART: Duration = Duration::from_secs(5);
/// The watchdog bites 6.7 frames after it was last fed at the latest, and the board has then to boot.
const STUCK_FOR: Duration = Duration::from_millis(400);

/// Keeps a board on for `length` of its time, with everything drawn from `seed`.
///
/// # Errors
/// The first thing that is silently wrong, in words.
fn soak(length: Duration, seed: u64) -> Result<Tally, String> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let troubles = troubles(length, &mut rng);
    // A frame has 36 bytes: at 0.02 % for each, 0.7 % of the frames are hit, beside what ChaosPort does.
    let line = ["flip:0.0002", "drop:0.0001", "inject:0.0001"];
    let mut options = options(&format!("bench?seed={seed}"), &line);
    options.faults.extend(troubles.iter().map(|t| t.fault));
    let board = SharedBoard::new(&options);
    let mut tally = Tally::default();
    let mut run = 0;
    while board.time() < from_duration(length) {
        run += 1;
        let from = board.time();
        let (outcome, stopped) = one_capture(&board, run, &mut rng)?;
        let until = board.time();
        let in_trouble = troubles.iter().any(|t| t.at < until && t.over > from);
        tally.count(outcome, in_trouble || stopped);
    }
    let end = board.time();
    let lost = board
        .connect()
        .status()
        .map_err(|e| e.to_string())?
        .frames_lost_on_board;
    if lost > 0 {
        return Err(format!(
            "the board says that it lost {lost} frames since its last start"
        ));
    }
    tally.faults = troubles.iter().filter(|t| t.at < end).count() as u32;
    board.with(|board| require_explained(&board.chip().record, &troubles, end))?;
    Ok(tally)
}

impl Tally {
    fn count(&mut self, outcome: Outcome, disturbed: bool) {
        *match outcome {
            Outcome::Complete => &mut self.complete,
            Outcome::Partial => &mut self.partial,
            Outcome::Refused => &mut self.refused,
        } += 1;
        if !disturbed {
            self.undisturbed += 1;
            self.undisturbed_complete += u32::from(outcome == Outcome::Complete);
        }
    }
}

/// Everything that a board has to survive, in turn by chance, apart from each other.
fn troubles(length: Duration, rng: &mut ChaCha8Rng) -> Vec<Trouble> {
    let mut troubles = Vec::new();
    let mut last = Duration::ZERO;
    loop {
        let at = last + APART + BETWEEN_TROUBLES.mul_f64(-(1.0 - rng.random::<f64>()).ln());
        if at >= length {
            return troubles;
        }
        let broken_for = Duration::from_millis(rng.random_range(200..3_000));
        let ticks = from_duration(at);
        let until = at + broken_for;
        let (text, takes, reset) = match rng.random_range(0..8) {
            0 => (
                format!("brown-out@{}", at.as_secs_f64()),
                BROWN_OUT + STUCK_FOR,
                Some(ResetReason::PowerOn),
            ),
            1 => (
                format!("cpu-stuck@{}", at.as_secs_f64()),
                STUCK_FOR,
                Some(ResetReason::Watchdog),
            ),
            2 => (
                format!("reset-pin@{}", at.as_secs_f64()),
                STUCK_FOR,
                Some(ResetReason::Pin),
            ),
            kind @ 3..5 => {
                let kind = ["hard-fault", "stray-interrupt"][kind - 3];
                let text = format!("{kind}@{}", at.as_secs_f64());
                (text, STUCK_FOR, Some(ResetReason::Software))
            }
            kind => {
                let kind = ["sensor-open", "sensor-short", "supply-sags"][kind - 5];
                let text = format!("{kind}@{}-{}", at.as_secs_f64(), until.as_secs_f64());
                (text, broken_for + STUCK_FOR, None)
            }
        };
        let fault = text.parse().expect("it is spelt as the faults are");
        last = at + takes;
        troubles.push(Trouble {
            fault,
            at: ticks,
            over: from_duration(last),
            reset,
        });
    }
}

/// The outcome of a capture, and whether its user may have stopped it.
fn one_capture(
    board: &SharedBoard,
    run: u16,
    rng: &mut ChaCha8Rng,
) -> Result<(Outcome, bool), String> {
    let faults = Faults::of_rate(0.01);
    let port = ChaosPort::new(board.port(), rng.random(), faults, faults);
    let start = Start {
        run,
        ..if rng.random_bool(0.5) {
            staircase().start
        } else {
            short()
        }
    };
    // One in ten is stopped by its user.
    let stop_at = rng
        .random_bool(0.1)
        .then(|| board.time() + milliseconds(rng.random_range(0..5_000)));
    let stopped = || stop_at.is_some_and(|at| board.time() > at);
    let from = board.time();
    let (end, bytes) = capture_to_disk(Box::new(port), start, &stopped, 1 << 22);
    let outcome = match bytes {
        None => Outcome::Refused,
        Some(bytes) => {
            let log = board.with(|board| frames(&board.chip().record, from));
            check(&bytes, start.frames(), end.as_ref().ok(), &log)
                .map_err(|how| format!("run {run}, {:?}: {how}", to_duration(board.time())))?
        }
    };
    // A user takes a moment, too.
    board.pass(Duration::from_millis(rng.random_range(0..1_000)));
    Ok((outcome, stop_at.is_some()))
}

/// The frames that the models saw from `since` on, as a simulated rig would log them.
fn frames(record: &Record, since: Ticks) -> Vec<SimulatedFrame> {
    let ends = record.resets.iter().skip(1).map(|reset| reset.0);
    let lives = record
        .resets
        .iter()
        .map(|reset| reset.0)
        .zip(ends.chain([Ticks::MAX]));
    let mut frames = Vec::new();
    for (from, until) in lives {
        // The chain of timers starts anew with each life: the first conversion begins a frame.
        let place = |at| record.conversions.partition_point(|c| c.start < at);
        let conversions = &record.conversions[place(from)..place(until)];
        for conversions in conversions.chunks_exact(SAMPLES_PER_FRAME * OVERSAMPLING) {
            let start = conversions[0].start - FIRST_SAMPLE;
            if start + FRAME >= since {
                frames.push(frame(
                    frames.len() as u64,
                    conversions,
                    pulse_at(record, start),
                ));
            }
        }
    }
    frames
}

fn frame(number: u64, conversions: &[Conversion], pulse: Option<PulseWidth>) -> SimulatedFrame {
    let mut sums = conversions
        .chunks(OVERSAMPLING)
        .map(|c| c.iter().map(|c| c.code).sum());
    SimulatedFrame {
        train: servoid_protocol::PulseTrain::USUAL,
        number,
        pulse,
        samples: std::array::from_fn(|_| Counts(sums.next().unwrap_or_default())),
        // Not needed: what counts is what the ADC gave.
        angles: [f64::NAN; SAMPLES_PER_FRAME],
    }
}

/// The pulse that rises at `start`, to a microsecond.
fn pulse_at(record: &Record, start: Ticks) -> Option<PulseWidth> {
    let place = record
        .pulses
        .partition_point(|pulse| pulse.rise + TICKS_PER_MICROSECOND < start);
    let pulse: &Pulse = record.pulses.get(place)?;
    let width = (pulse.width + TICKS_PER_MICROSECOND / 2) / TICKS_PER_MICROSECOND;
    (pulse.rise <= start + TICKS_PER_MICROSECOND).then_some(PulseWidth(width as u16))
}

/// Every reset, and whatever a good program does not do, has its cause among `troubles`.
fn require_explained(record: &Record, troubles: &[Trouble], end: Ticks) -> Result<(), String> {
    let mut provoked: Vec<&Trouble> = troubles.iter().filter(|t| t.reset.is_some()).collect();
    for (at, reason) in record.resets.iter().skip(1) {
        let cause = |t: &&Trouble| t.reset == Some(*reason) && (t.at..=t.over).contains(at);
        match provoked.iter().position(cause) {
            // One trouble is one reset.
            Some(place) => drop(provoked.remove(place)),
            None => {
                let at = to_duration(*at);
                return Err(format!("nothing explains the reset at {at:?} ({reason:?})"));
            }
        }
    }
    // A reset that is due just now may not be there yet.
    if let Some(trouble) = provoked.iter().find(|t| t.over < end) {
        return Err(format!("no reset came of {trouble:?}"));
    }
    // Written down by the board when it happens: a reset clears the count, and not the log.
    if let Some(line) = record.log.iter().find(|l| l.text.contains(LOST)) {
        return Err(format!("the board lost frames: {line}"));
    }
    for violation in &record.violations {
        // A processor that is stuck, or at the end of its program waits for the last pulse to end, takes neither what
        // the DMA brings nor what the line does, and nothing else may go wrong.
        let untaken = Irregularity::ReceiverOverrun == violation.what
            || matches!(violation.what, Irregularity::DmaOverrun(_));
        let fault = matches!(violation.what, Irregularity::Fault(_));
        let explained = troubles.iter().any(|t| {
            let explains = match t.fault {
                Fault::CpuStuck(_) | Fault::StrayInterrupt(_) => untaken,
                Fault::HardFault(_) => untaken || fault,
                _ => false,
            };
            explains && (t.at..t.over).contains(&violation.at)
        });
        if !explained {
            return Err(violation.to_string());
        }
    }
    Ok(())
}

/// A second of run, a fifth of it rest.
fn short() -> Start {
    Start {
        pre_roll_frames: 5,
        reference: Reference::Staircase(Staircase {
            longest_hold_frames: 10,
            shortest_hold_frames: 5,
            hold_step_frames: 5,
            ..Staircase::PAPER
        }),
        post_roll_frames: 5,
        ..staircase().start
    }
}

fn survive(length: Duration, seed: u64) -> Tally {
    let tally = soak(length, seed).unwrap_or_else(|how| panic!("seed {seed}: {how}"));
    println!("{} s: {tally:?}", length.as_secs());
    // 99.9 % are promised at this rate, of captures that no fault of the board falls into.
    assert!(
        tally.undisturbed_complete * 1_000 >= tally.undisturbed * 999,
        "{tally:?}"
    );
    tally
}

#[test]
fn a_quarter_of_a_minute_of_everything_at_once() {
    let tally = survive(Duration::from_secs(15), 1);
    assert!(tally.faults >= 1 && tally.complete > 0, "{tally:?}");
}

#[test]
#[ignore = "five seconds: cargo test -p virtual-board --test integration -- --ignored a_minute"]
fn a_minute_of_everything_at_once() {
    let tally = survive(Duration::from_secs(60), 1);
    assert!(tally.faults >= 2 && tally.complete > 0, "{tally:?}");
}

#[test]
#[ignore = "minutes: cargo test --release -p virtual-board --test integration -- --ignored --nocapture an_hour"]
fn an_hour_of_everything_at_once() {
    let tally = survive(Duration::from_secs(3_600), 2);
    assert!(tally.faults >= 100, "{tally:?}");
}
