//! The board as a serial port of this machine.
//!
//! # Simulated time and the host's clock
//!
//! A host on a real port measures its time-outs with the clock on the wall, and a lease that it
//! prolongs four times while it lasts must not lapse because simulated time ran away meanwhile. So
//!
//! 1. simulated time goes at most [`Pace::FASTEST`] times as fast as the clock on the wall, or just as
//!    fast with [`Pace::REAL_TIME`]: between two signs of life from the host, or one that is said
//!    again after a lost answer, passes less simulated time than a lease;
//! 2. it stands still while bytes wait that the host has not taken: none is lost, and the board is
//!    never ahead of its reader by more than what the system's buffer holds;
//! 3. what held it up is not made up for afterwards.
//!
//! Time also passes while no host is there, as on a real board. Bytes for a network host that has gone
//! are lost.

mod pace;
#[cfg(unix)]
mod pty;
mod tcp;

pub use pace::Pace;
#[cfg(unix)]
pub use pty::PseudoTerminal;
pub use tcp::TcpServer;

use crate::board::VirtualBoard;
use crate::time::{Ticks, milliseconds};
use std::collections::VecDeque;
use std::io;
use std::time::{Duration, Instant};

/// Something that a host can open. Neither direction ever waits.
pub trait HostEnd {
    /// Takes bytes from the host; returns how many, 0 for none.
    ///
    /// # Errors
    /// When the port is gone for good.
    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize>;

    /// Hands bytes to the host; returns how many it took. Without a host it takes all.
    ///
    /// # Errors
    /// When the port is gone for good.
    fn send(&mut self, bytes: &[u8]) -> io::Result<usize>;
}

/// Simulated time that passes at once: short enough for prompt answers.
const SLICE: Ticks = milliseconds(1);

/// How long to sleep when there is nothing to do: no answer comes later by more than this.
const NAP: Duration = Duration::from_millis(1);

/// Runs `board` behind `end` until `should_stop` says so. `after_slice` sees the board after each bit
/// of its time.
///
/// # Errors
/// When the port is gone for good.
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
        // Whole slices only: many little ones would keep this machine's processor busy.
        let until = board.now() + SLICE;
        if !waiting.is_empty() || until > allowed {
            std::thread::sleep(NAP);
            continue;
        }
        board.run_until(until);
        loop {
            let count = board.take(&mut buffer);
            waiting.extend(buffer.iter().take(count));
            if count == 0 {
                break;
            }
        }
        after_slice(board);
    }
    Ok(())
}

/// A call that would have had to wait did nothing.
fn none_if_it_would_wait(result: io::Result<usize>) -> io::Result<usize> {
    match result {
        Err(e)
            if matches!(
                e.kind(),
                io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted
            ) =>
        {
            Ok(0)
        }
        other => other,
    }
}
