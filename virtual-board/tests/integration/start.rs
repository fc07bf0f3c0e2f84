//! The first milliseconds: the pulse line, the watchdog, the clocks, and parts that are not what they are sold as.

use servoid_protocol::hello::ResetCause;
use servoid_test_support::virtual_board::{SharedBoard, image, options};
use virtual_board::record::ResetReason;
use virtual_board::time::{Ticks, microseconds, milliseconds};
use virtual_board::{BoardOptions, VirtualBoard};

/// From the supply to the first instruction.
const POWER_ON: Ticks = microseconds(2_500);

fn resets(board: &VirtualBoard) -> Vec<ResetReason> {
    let chip = board.chip();
    chip.record.resets.iter().map(|reset| reset.1).collect()
}

fn board_of(options: &BoardOptions) -> VirtualBoard {
    VirtualBoard::new(image(), options).unwrap()
}

/// Until the program drives it, only the resistor beside it holds the line: not while a crystal is waited for.
#[test]
fn the_pulse_line_is_driven_low_a_moment_after_the_first_instruction() {
    for faults in [&[] as &[&str], &["no-crystal"]] {
        let mut board = board_of(&options("linear?seed=1", faults));
        board.run_until(milliseconds(200));
        let chip = board.chip();
        let [undriven] = chip.record.undriven[..] else {
            panic!("{:?}", chip.record.undriven);
        };
        let driven = undriven.to.unwrap() - POWER_ON;
        assert!(driven < microseconds(1_000), "{faults:?}: {driven}");
        assert_eq!(chip.record.pulses, []);
    }
}

/// The watchdog's oscillator has 30 to 60 kHz; the wait for a missing crystal is the longest start.
#[test]
fn the_longest_start_does_not_trip_the_watchdog() {
    for lsi_hz in [30_000, 60_000] {
        let mut options = options("linear?seed=1", &["no-crystal"]);
        options.lsi_hz = lsi_hz;
        let mut board = board_of(&options);
        board.run_until(milliseconds(1_000));
        assert_eq!(resets(&board), [ResetReason::PowerOn]);
        assert_eq!(board.chip().record.violations, []);
    }
}

#[test]
#[ignore = "three seconds: cargo test -p virtual-board --test integration -- --ignored a_start_that_hangs"]
fn a_start_that_hangs_is_ended_by_the_watchdog() {
    let mut board = board_of(&options("linear?seed=1", &["no-pll"]));
    board.run_until(milliseconds(3_000));
    let resets = resets(&board);
    assert!(resets.len() > 3, "{resets:?}");
    assert!(resets[1..].iter().all(|r| *r == ResetReason::Watchdog));
    assert_eq!(board.chip().record.pulses, []);
}

/// SWS follows SW after a time that the manual does not give.
#[test]
fn the_clocks_are_switched_one_after_the_other_however_long_it_takes() {
    for us in [0, 1, 5, 20, 100] {
        let mut options = options("linear?seed=1", &[]);
        options.clock_switching = microseconds(us);
        let mut board = board_of(&options);
        board.run_until(milliseconds(100));
        assert_eq!(board.chip().record.violations, [], "{us} µs");
        assert!(!board.chip().record.conversions.is_empty());
    }
}

#[test]
fn a_clone_whose_number_is_hidden_at_full_speed_has_its_number() {
    let mut options = options("linear?seed=7", &[]);
    options.identity_at_any_clock = false;
    let board = SharedBoard::new(&options);
    let hello = *board.connect().hello();
    assert_eq!(&hello.unique_id[..4], b"virt");
    assert_eq!(hello.reset_cause, ResetCause::PowerOn);
}

/// Some chips that are sold as an STM32F103C8 have 10 KiB of memory. The program cannot run there: the LED says so by
/// blinking, and there are no pulses.
#[test]
fn a_part_with_half_the_memory_blinks_and_makes_no_pulse() {
    let mut options = options("linear?seed=1", &[]);
    options.ram_bytes = 10 * 1024;
    let mut board = board_of(&options);
    let mut changes = 0;
    let mut before = false;
    for ms in 1..3_000 {
        board.run_until(milliseconds(ms));
        let lit = board.chip().led();
        changes += u32::from(lit != before);
        before = lit;
    }
    assert!((6..60).contains(&changes), "{changes}");
    assert_eq!(board.chip().record.pulses, []);
    assert_eq!(resets(&board), [ResetReason::PowerOn]);
}
