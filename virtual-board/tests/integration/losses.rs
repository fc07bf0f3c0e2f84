//! Frames that the board itself loses: counted, and in the log.

use crate::stepped::{Around, Stepped};
use servoid_test_support::virtual_board::{FRAME, LOST, SharedBoard, image, options};
use virtual_board::cpu::Core;
use virtual_board::cpu::rsemu::RsemuCore;
use virtual_board::time::to_duration;
use virtual_board::{BoardOptions, VirtualBoard};

/// Cycles that pass at a time in a swoon.
const A_WHILE: u64 = 100;

/// Makes a core do nothing for a while, as with its interrupts masked.
#[derive(Default)]
struct Swoon {
    cycles_left: u64,
}

impl Around for Swoon {
    fn step(&mut self, core: &mut RsemuCore) -> u64 {
        if self.cycles_left == 0 {
            return core.step();
        }
        self.cycles_left = self.cycles_left.saturating_sub(A_WHILE);
        A_WHILE
    }

    fn may_sleep(&self) -> bool {
        self.cycles_left == 0
    }
}

fn board(options: &BoardOptions) -> SharedBoard<Stepped<Swoon>> {
    let board = VirtualBoard::with_core(image(), options, |flash, ram, bus| {
        Stepped::new(RsemuCore::new(flash, ram, bus), Swoon::default())
    });
    SharedBoard::from(board.unwrap())
}

/// The lines of the log about lost frames.
fn lines(board: &SharedBoard<Stepped<Swoon>>) -> Vec<String> {
    let log = board.with(|board| board.chip().record.log.clone());
    let lines = log.into_iter().map(|line| line.text);
    lines.filter(|text| text.contains(LOST)).collect()
}

/// Lets the processor of the board do nothing for two frames and a half, which is less than the
/// watchdog waits; 72 cycles are a microsecond.
fn swoon(board: &SharedBoard<Stepped<Swoon>>) {
    let microseconds = to_duration(5 * FRAME / 2).as_micros() as u64;
    board.with(|board| board.core().around.cycles_left = 72 * microseconds);
    board.pass(to_duration(6 * FRAME));
}

#[test]
fn what_the_board_loses_is_counted_and_logged() {
    let board = board(&options("linear?seed=1", &[]));
    assert_eq!(board.connect().status().unwrap().frames_lost_on_board, 0);
    assert_eq!(lines(&board), [""; 0]);
    swoon(&board);
    let lost = board.connect().status().unwrap().frames_lost_on_board;
    assert!((1..=3).contains(&lost), "{lost}");
    let lines = lines(&board);
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!(
        lines[0].starts_with(&format!("warn {lost} {LOST} before")),
        "{lines:?}"
    );
}

#[test]
fn what_was_lost_before_a_reset_is_in_the_log_after_it() {
    let board = board(&options("linear?seed=1", &["brown-out@0.4"]));
    swoon(&board);
    board.pass(std::time::Duration::from_secs(1));
    assert_eq!(board.connect().status().unwrap().frames_lost_on_board, 0);
    assert_eq!(lines(&board).len(), 1);
}
