//! Writes the program into a board, by the bootloader that every STM32F103 has in its ROM.
//!
//! The bootloader speaks on USART1, so the two wires of the rig do, and the adapter that is there. It runs where BOOT0 is
//! high at a reset: a jumper, or a line of the adapter.
//!
//! | module        | what it does                                                                     |
//! |---------------|----------------------------------------------------------------------------------|
//! | `embedded`    | the image inside this program                                                    |
//! | `error`       | why a board was not flashed, with what to do                                     |
//! | `boot_lines`  | which lines of the adapter set BOOT0 and reset, and their order                  |
//! | `exchange`    | bytes out, an acknowledgement in; the way back to a common beginning after a loss |
//! | `bootloader`  | the commands of AN3155, each as one exchange                                     |
//! | `repeated`    | the same, repeated until they succeed                                            |
//! | `chip`        | whether this chip can have the program                                           |
//! | `programming` | erases, writes and compares so that a chip never starts what is not whole        |
//! | `session`     | all of it in order                                                               |
//!
//! A [`Port`](super::port::Port) has its own clock, so tests on a simulated chip wait for nothing.

mod boot_lines;
mod bootloader;
mod chip;
mod embedded;
mod error;
mod exchange;
mod programming;
mod retries;
mod session;

pub use boot_lines::{BootLines, Switch};
pub use chip::ChipFound;
pub use embedded::embedded_image;
pub use error::{FlashError, State};
pub use session::{FlashProgress, Flashed, Hand, Start, flash};
