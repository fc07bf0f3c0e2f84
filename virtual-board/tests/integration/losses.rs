//! Frames that the board itself loses: counted, and in the log.

use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_test_support::stepped::{Around, Stepped};
use servoid_test_support::virtual_board::{FRAME, LOST, OVERSAMPLING, SharedBoard, image, options};
use virtual_board::cpu::Core;
use virtual_board::cpu::rsemu::RsemuCore;
use virtual_board::time::{Ticks, to_duration};
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

/// Lets the processor of the board do nothing for two frames and a half.
fn swoon(board: &SharedBoard<Stepped<Swoon>>) {
    swoon_for(board, 5 * FRAME / 2);
}

/// Lets the processor of the board do nothing for `time`, which is less than the watchdog waits; 72 cycles are a
/// microsecond.
fn swoon_for(board: &SharedBoard<Stepped<Swoon>>, time: Ticks) {
    let microseconds = to_duration(time).as_micros() as u64;
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
    // The ends of two frames or of three lie in that time.
    assert!((2..=3).contains(&lost), "{lost}");
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

/// Conversions since the board was switched on.
fn conversions(board: &SharedBoard<Stepped<Swoon>>) -> usize {
    board.with(|board| board.chip().record.conversions.len())
}

/// Frames that the ADC has sampled whole since the board was switched on. Afterwards the present frame has room for a
/// request and its answer.
fn sampled(board: &SharedBoard<Stepped<Swoon>>) -> usize {
    let per_frame = SAMPLES_PER_FRAME * OVERSAMPLING;
    while conversions(board) % per_frame > 2 * OVERSAMPLING {
        board.pass(to_duration(FRAME / 20));
    }
    conversions(board) / per_frame
}

#[test]
fn the_numbers_of_frames_are_exact_however_long_the_processor_was_away() {
    let board = board(&options("linear?seed=1", &[]));
    let mut lost = 0;
    // From a fifth of a frame to a frame less than the watchdog waits, at every phase of a frame.
    for fifths in 1..=19 {
        let before = board.connect().status().unwrap();
        swoon_for(&board, fifths * FRAME / 5);
        let mut client = board.connect();
        let sampled = sampled(&board);
        let status = client.status().unwrap();
        assert_eq!(status.frames_since_start as usize, sampled, "{fifths}");
        lost = status.frames_lost_on_board;
        let more = lost - before.frames_lost_on_board;
        assert!(u64::from(more) <= fifths.div_ceil(5), "{fifths}: {more}");
    }
    assert!(lost > 15, "{lost}");
}

/// Where nobody reads the log its memory is full after some fifty lines: it must hold up nothing.
#[test]
fn a_log_that_nobody_reads_holds_up_nothing() {
    let mut options = options("linear?seed=1", &[]);
    options.drains_log = false;
    let board = board(&options);
    let mut client = board.connect();
    for _ in 0..60 {
        swoon(&board);
    }
    let status = client.status().unwrap();
    assert!(status.frames_lost_on_board >= 120, "{status:?}");
    let resets = board.with(|board| board.chip().record.resets.len());
    assert_eq!((resets, lines(&board)), (1, vec![]));
}
