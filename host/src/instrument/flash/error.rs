//! Why a board was not flashed, and the remedy.

use crate::instrument::port::ControlLine;
use std::fmt;

/// What the board holds after a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// What it held before.
    Untouched,
    /// No program that starts: its first bytes are written last.
    Empty,
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Untouched => "the board holds what it held before",
            Self::Empty => {
                "the board holds no program that starts, and moves nothing until it is flashed"
            }
        })
    }
}

/// Why a board was not flashed. The text names the remedy.
#[derive(Debug, thiserror::Error)]
pub enum FlashError {
    /// Nobody answers to the first byte.
    #[error(
        "no bootloader answers: set the board's BOOT0 to 1, press its reset, and start again; if that is done, check that the adapter's TX goes to PA10 and its RX to PA9"
    )]
    NoAnswer,
    /// The adapter has no such line.
    #[error(
        "{0} cannot be set at this port ({1}): leave out --boot0 and --reset, set BOOT0 by its jumper, and press reset"
    )]
    NoControlLine(ControlLine, std::io::Error),
    /// The chip says that it is another one.
    #[error(
        "this is no STM32F103C8 but {name} (product id {id:#05x}): the program is for the STM32F103C8 alone, so take a board with that chip; {state}",
        state = State::Untouched
    )]
    OtherChip {
        /// Its product id.
        id: u16,
        /// What it is, as far as it is known.
        name: &'static str,
    },
    /// The flash has no room.
    #[error(
        "the program needs {needed} KiB of flash, and this chip has {kib} KiB: take a board with an STM32F103C8; {state}",
        state = State::Untouched
    )]
    TooSmall {
        /// Flash of the chip (KiB).
        kib: u16,
        /// Flash of the program (KiB).
        needed: u32,
    },
    /// The chip is read-protected.
    #[error(
        "the chip is read-protected, so nothing can be written to it: '--unlock' removes that, and erases all that it holds"
    )]
    ReadProtected,
    /// It refuses a command again and again.
    #[error(
        "the bootloader refuses to {what}: the chip may be write-protected or no STM32F103C8; {state}"
    )]
    Refused {
        /// The command.
        what: &'static str,
        /// What the board holds.
        state: State,
    },
    /// It no longer answers.
    #[error(
        "the board has fallen silent: check cable and supply, press reset with BOOT0 at 1, and start again; {0}"
    )]
    FellSilent(State),
    /// The port is gone.
    #[error(
        "the connection broke ({1}): check the cable, press reset with BOOT0 at 1, and start again; {0}"
    )]
    Broken(State, std::io::Error),
    /// Answers come, and are wrong again and again.
    #[error(
        "the line is too bad to {what}: shorten the wires, give adapter and board a common ground, and start again; {state}"
    )]
    BadLine {
        /// What failed.
        what: &'static str,
        /// What the board holds.
        state: State,
    },
    /// A page is not what was written to it.
    #[error(
        "the flash at {address:#010x} does not keep what is written to it: the chip is worn out or not what it says, so take another board; {state}",
        state = State::Empty
    )]
    DoesNotKeep {
        /// The page's address.
        address: u32,
    },
    /// Somebody ended it.
    #[error("ended before the board was flashed: {0}")]
    Stopped(State),
}
