//! Every way in which pulses stop, at any phase of a frame, on chips that differ.
//!
//! | stop                | the last pulse                           | the chip                      |
//! |---------------------|------------------------------------------|-------------------------------|
//! | by the host         | whole                                    | goes on, idle                 |
//! | panic, hard fault, stray interrupt | whole                     | restarts after the next frame edge |
//! | crystal stops       | cut, at once                             | restarts at once              |
//! | stuck processor, debugger that halts and leaves | whole pulses until the reset, which may cut one | the watchdog restarts it |
//! | brown-out, reset pin | cut, at once                            | restarts                      |

use object::{Object, ObjectSymbol};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use servoid::instrument::rig::RigClient;
use servoid_protocol::health::FaultKind;
use servoid_protocol::hello::ResetCause;
use servoid_protocol::lease::LONGEST_LEASE_S;
use servoid_protocol::message::{Arm, ArmFor, Command};
use servoid_protocol::pulse_train::PulseType;
use servoid_protocol::{PulseTrain, PulseWidth};
use servoid_test_support::stepped::{Around, Stepped};
use servoid_test_support::virtual_board::{FIRST_SAMPLE, FRAME, SharedBoard, arm, image, options};
use virtual_board::cpu::Core;
use virtual_board::cpu::rsemu::RsemuCore;
use virtual_board::fault::BROWN_OUT;
use virtual_board::memory::RAM_START;
use virtual_board::record::{Record, ResetReason};
use virtual_board::time::{Ticks, from_duration, microseconds, milliseconds};
use virtual_board::{BoardOptions, Fault, VirtualBoard};

/// A way in which pulses stop.
#[derive(Clone, Copy, Debug)]
struct Stop {
    name: &'static str,
    /// The fault at a time; `None` where the host disarms the rig.
    fault: Option<fn(Ticks) -> Fault>,
    /// Longest time from it to the last rising edge.
    last_rise: Ticks,
    /// The cause that the rig gives after it.
    cause: Option<ResetCause>,
    /// Whether the last pulse may be cut short.
    cuts: bool,
}

/// The watchdog of the slowest oscillator bites after 6.7 frames.
const WATCHDOG: Ticks = 67 * FRAME / 10;

const STOPS: [Stop; 8] = [
    Stop {
        name: "host",
        fault: None,
        // The request comes in one frame, takes effect in the next.
        last_rise: 2 * FRAME,
        cause: None,
        cuts: false,
    },
    Stop {
        name: "hard fault",
        fault: Some(Fault::HardFault),
        last_rise: 0,
        cause: Some(ResetCause::Software),
        cuts: false,
    },
    Stop {
        name: "stray interrupt",
        fault: Some(Fault::StrayInterrupt),
        last_rise: 0,
        cause: Some(ResetCause::Software),
        cuts: false,
    },
    Stop {
        name: "crystal stops (NMI)",
        fault: Some(Fault::CrystalStops),
        last_rise: 0,
        cause: Some(ResetCause::Software),
        cuts: true,
    },
    Stop {
        name: "processor stuck",
        fault: Some(Fault::CpuStuck),
        last_rise: WATCHDOG,
        cause: Some(ResetCause::Watchdog),
        cuts: true,
    },
    Stop {
        name: "debugger halts and leaves",
        fault: Some(Fault::DebuggerHalts),
        last_rise: WATCHDOG,
        cause: Some(ResetCause::Watchdog),
        cuts: true,
    },
    Stop {
        name: "brown-out",
        fault: Some(Fault::BrownOut),
        last_rise: 0,
        cause: Some(ResetCause::PowerOn),
        cuts: true,
    },
    Stop {
        name: "reset pin",
        fault: Some(Fault::ResetPin),
        last_rise: 0,
        cause: Some(ResetCause::Pin),
        cuts: true,
    },
];

/// What one stop did.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// From the stop to the last rising edge.
    last_rise: Ticks,
    /// The longest time that the line was high.
    high: Ticks,
    /// The longest time that only the resistor held the line.
    undriven: Ticks,
}

impl Seen {
    fn max(self, other: Self) -> Self {
        Self {
            last_rise: self.last_rise.max(other.last_rise),
            high: self.high.max(other.high),
            undriven: self.undriven.max(other.undriven),
        }
    }
}

/// A chip with all that the manual and the datasheet leave open drawn by chance.
fn chip(seed: u64, rng: &mut ChaCha8Rng) -> BoardOptions {
    let mut options = options(&format!("linear?seed={seed}"), &[]);
    options.lsi_hz = [30_000, 36_000, 40_000, 48_000, 60_000][rng.random_range(0..5)];
    options.hsi_error = rng.random_range(-0.02..0.025);
    options.clock_switching = rng.random_range(0..microseconds(20));
    options
}

/// A time some 0.6 s after the start, half of the times while a pulse of `width` is on the line. The same board without
/// the fault says where its frames are.
fn time_of_stop(options: &BoardOptions, width: Ticks, rng: &mut ChaCha8Rng) -> Ticks {
    let board = SharedBoard::new(options);
    let first_sample = board.with(|board| board.chip().record.conversions[0].start);
    let frame = first_sample - FIRST_SAMPLE + 30 * FRAME;
    let range = if rng.random_bool(0.5) { width } else { FRAME };
    frame + rng.random_range(0..range)
}

/// Stops a board in this way.
fn stop(stop: &Stop, train: PulseTrain, seed: u64) -> Seen {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut options = chip(seed, &mut rng);
    let [shortest, longest] = train.pulses.board_limits();
    let width = rng.random_range(shortest.0..=longest.0);
    let width_ticks = microseconds(u64::from(width));
    let at = time_of_stop(&options, width_ticks, &mut rng);
    options.faults.extend(stop.fault.map(|fault| fault(at)));
    let (board, mut client) = armed(&options, train, width);
    board.with(|board| board.run_until(at));
    let cause = if let Some(cause) = stop.cause {
        board.with(|board| board.run_until(at + milliseconds(700)));
        (board.connect().hello().reset_cause, cause)
    } else {
        client.request(Command::Disarm).unwrap();
        board.with(|board| board.run_until(at + milliseconds(700)));
        (client.hello().reset_cause, ResetCause::PowerOn)
    };
    assert_eq!(cause.0, cause.1, "{}, seed {seed}", stop.name);
    board.with(|board| look(stop, seed, board, at, width_ticks))
}

/// A board at neutral, with pulses of `width`, and its host.
fn armed(options: &BoardOptions, train: PulseTrain, width: u16) -> (SharedBoard, RigClient) {
    let board = SharedBoard::new(options);
    let mut client = board.connect();
    let arm = at_neutral(train, width);
    client.request(ArmFor { train, arm }.into()).unwrap();
    (board, client)
}

/// Pulses of `width` for longer than any test.
fn at_neutral(train: PulseTrain, width: u16) -> Arm {
    let [shortest, longest] = train.pulses.board_limits();
    Arm {
        neutral: PulseWidth(width),
        shortest,
        longest,
        lease_frames: train.frames_in(LONGEST_LEASE_S),
        ..arm()
    }
}

fn look(stop: &Stop, seed: u64, board: &VirtualBoard, at: Ticks, width: Ticks) -> Seen {
    let chip = board.chip();
    let record = &chip.record;
    let context = format!("{}, seed {seed}", stop.name);
    assert_eq!(chip.high_for(board.now()), None, "{context}: high for ever");
    let last = *record.pulses.last().unwrap();
    assert!(
        last.rise > at.saturating_sub(2 * FRAME),
        "{context}: no pulses before"
    );
    let last_rise = last.rise.saturating_sub(at);
    assert!(
        last_rise <= stop.last_rise,
        "{context}: a pulse {last_rise} ticks after it"
    );
    for pulse in &record.pulses {
        let whole = pulse.width == width;
        let cut = stop.cuts && *pulse == last && pulse.width < width;
        assert!(whole || cut, "{context}: {pulse:?}");
    }
    Seen {
        last_rise,
        high: record.pulses.iter().map(|p| p.width).max().unwrap_or(0),
        undriven: longest_undriven(record, &context),
    }
}

/// The line is let go by resets alone.
fn longest_undriven(record: &Record, context: &str) -> Ticks {
    let begins = |at: Ticks| {
        let off = from_duration(BROWN_OUT) + microseconds(2_500);
        let reset =
            |reset: &(Ticks, ResetReason)| reset.0 == at || reset.0.abs_diff(at + off) < 10_000;
        at == 0 || record.resets.iter().any(reset)
    };
    let spans = record.undriven.iter().skip(1).map(|undriven| {
        assert!(
            begins(undriven.from),
            "{context}: {undriven:?}, {:?}",
            record.resets
        );
        undriven.to.map_or(Ticks::MAX, |to| to - undriven.from)
    });
    spans.max().unwrap_or(0)
}

fn all_stops(train: PulseTrain, seeds: u64) {
    let [_, longest] = train.pulses.board_limits();
    println!("{train:?}");
    println!("stop, last rise (ms), longest high (µs), undriven (ms), over {seeds} seeds");
    for way in &STOPS {
        let seen = (0..seeds)
            .map(|seed| stop(way, train, seed))
            .fold(Seen::default(), Seen::max);
        let us = |ticks: Ticks| ticks as f64 / microseconds(1) as f64;
        println!(
            "{}, {:.1}, {:.0}, {:.2}",
            way.name,
            us(seen.last_rise) / 1e3,
            us(seen.high),
            us(seen.undriven) / 1e3
        );
        let widest = microseconds(longest.0.into());
        assert!(seen.high <= widest, "{}: {seen:?}", way.name);
    }
}

#[test]
fn every_stop_ends_the_pulses_at_any_phase() {
    all_stops(PulseTrain::USUAL, 1);
}

#[test]
#[ignore = "ten seconds: cargo test -p virtual-board --test integration -- --ignored on_some_chips"]
fn every_stop_ends_the_pulses_on_some_chips() {
    all_stops(PulseTrain::USUAL, 4);
}

#[test]
#[ignore = "minutes: cargo test -p virtual-board --test integration -- --ignored --nocapture two_hundred"]
fn every_stop_on_two_hundred_chips() {
    all_stops(PulseTrain::USUAL, 200);
}

#[test]
fn every_stop_ends_the_pulses_of_other_trains() {
    for (pulses, hz) in [(PulseType::Wide, 333.0), (PulseType::Narrow, 560.0)] {
        all_stops(PulseTrain::at_rate(pulses, hz).unwrap(), 1);
    }
}

/// A board whose processor can be disturbed.
fn disturbed() -> (SharedBoard<Stepped<Disturbed>>, RigClient) {
    let options = options("linear?seed=1", &[]);
    let board = VirtualBoard::with_core(image(), &options, |flash, ram, bus| {
        Stepped::new(RsemuCore::new(flash, ram, bus), Disturbed::default())
    });
    let board = SharedBoard::from(board.unwrap());
    let mut client = board.connect();
    let arm = at_neutral(PulseTrain::USUAL, 1_500);
    client.request(Command::Arm(arm)).unwrap();
    board.with(|board| board.run_until(milliseconds(600)));
    (board, client)
}

/// Loses frames, or its stack.
#[derive(Default)]
struct Disturbed {
    /// Cycles for which it does nothing.
    absent: u64,
    stack_pointer: Option<u32>,
}

impl Around for Disturbed {
    fn step(&mut self, core: &mut RsemuCore) -> u64 {
        const A_WHILE: u64 = 100;
        if let Some(address) = self.stack_pointer.take() {
            core.set_stack_pointer(address);
        }
        if self.absent == 0 {
            return core.step();
        }
        self.absent = self.absent.saturating_sub(A_WHILE);
        A_WHILE
    }

    fn may_sleep(&self) -> bool {
        self.absent == 0
    }
}

/// The board stopped by itself: no watchdog was needed, and every pulse is whole.
fn assert_stopped_at_once(board: &SharedBoard<Stepped<Disturbed>>, from: Ticks) {
    board.with(|board| {
        let chip = board.chip();
        let resets = &chip.record.resets;
        assert_eq!(resets.len(), 2, "{resets:?}");
        let (at, reason) = resets[1];
        assert_eq!(reason, ResetReason::Software);
        assert!(at - from < 3 * FRAME / 2 + milliseconds(1), "{}", at - from);
        let pulses = &chip.record.pulses;
        assert!(
            pulses
                .iter()
                .all(|pulse| pulse.width == microseconds(1_500))
        );
        assert!(pulses.iter().all(|pulse| pulse.rise < at));
    });
}

/// The logger panics when it is entered twice, and a handler that logs would enter it again, without end.
#[test]
fn a_panic_within_the_log_stops_like_any_other() {
    let (board, _) = disturbed();
    let path = servoid_firmware_image::build().unwrap();
    let elf = std::fs::read(path).unwrap();
    let elf = object::File::parse(&*elf).unwrap();
    let mut symbols = elf.symbols();
    let logger = symbols
        .find(|symbol| symbol.name().is_ok_and(|name| name.contains("RTT_ENCODER")))
        .unwrap();
    // Lost frames are logged.
    board.with(|board| board.core().around.absent = 72 * 50_000);
    board.pass(std::time::Duration::from_millis(45));
    board.with(|board| {
        for byte in 0..logger.size() {
            board.ram().write((logger.address() + byte) as u32, 1, 1);
        }
    });
    let from = board.time();
    board.pass(std::time::Duration::from_millis(300));
    assert_stopped_at_once(&board, from);
    let mut client = board.connect();
    assert_eq!(client.hello().reset_cause, ResetCause::Software);
    let fault = client.health().unwrap().last_fault.unwrap();
    assert_eq!(fault.kind, FaultKind::Panic);
    assert!(fault.place.as_str().ends_with("src/lib.rs"), "{fault:?}");
}

/// The stack lies below all variables: beyond its end there is no memory, so the next push is a fault and not a changed
/// variable.
#[test]
fn a_stack_that_is_full_stops_the_board() {
    let (board, _) = disturbed();
    let from = board.time();
    board.with(|board| board.core().around.stack_pointer = Some(RAM_START + 16));
    board.pass(std::time::Duration::from_millis(300));
    assert_stopped_at_once(&board, from);
}
