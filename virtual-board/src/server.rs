//! The board as a serial port of this computer.
//!
//! # Simulated time and the host's clock
//!
//! A host on a real port measures its time-outs in real time. Its lease, which it renews four times while it lasts,
//! must not lapse because simulated time ran ahead. So
//!
//! 1. simulated time runs at most [`Pace::FASTEST`] times as fast as real time, or as fast with
//!    [`Pace::REAL_TIME`]: between two keep-alives, one of them repeated after a lost answer, less simulated time
//!    passes than a lease;
//! 2. it stands still while the host has unread bytes: none is lost, and the board is ahead of its reader by the
//!    system's buffer at most;
//! 3. a delay is not made up for.
//!
//! Time also passes without a host, as on a real board. Bytes for a network host that is gone are lost.

mod host_end;
mod pace;
#[cfg(unix)]
mod pty;
mod tcp;

pub use host_end::HostEnd;
pub use pace::Pace;
#[cfg(unix)]
pub use pty::PseudoTerminal;
pub use tcp::TcpServer;

use crate::board::VirtualBoard;
use crate::time::{Ticks, milliseconds};
use std::collections::VecDeque;
use std::io;
use std::time::{Duration, Instant};

/// Length of a slice of simulated time: short enough for prompt answers.
const SLICE: Ticks = milliseconds(1);

/// Sleep when there is nothing to do: delays an answer by at most this time.
const NAP: Duration = Duration::from_millis(1);

/// Runs `board` behind `end` until `should_stop` returns true. Calls `after_slice` after each slice of its time.
pub fn serve(
    board: &mut VirtualBoard,
    end: &mut dyn HostEnd,
    mut pace: Pace,
    should_stop: &dyn Fn() -> bool,
    after_slice: &mut dyn FnMut(&mut VirtualBoard),
) -> io::Result<()> {
    let mut buffer = [0; 512];
    let mut waiting = VecDeque::new();
    while !should_stop() {
        let count = end.receive(&mut buffer)?;
        board.write(buffer.get(..count).unwrap_or_default());
        while !waiting.is_empty() {
            let (bytes, _) = waiting.as_slices();
            let taken = end.send(bytes)?;
            waiting.drain(..taken);
            if taken == 0 {
                break;
            }
        }
        let allowed = pace.allowed(Instant::now(), board.now());
        // Whole slices only: many small ones would keep the processor busy.
        let until = board.now() + SLICE;
        if !waiting.is_empty() || until > allowed {
            std::thread::sleep(NAP);
            continue;
        }
        board.run_until(until);
        while let count @ 1.. = board.take(&mut buffer) {
            waiting.extend(buffer.iter().take(count));
        }
        after_slice(board);
    }
    Ok(())
}
