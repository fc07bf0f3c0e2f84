//! All of it in order: find the bootloader, look at the chip, write, compare, start.

use super::boot_lines::BootLines;
use super::chip::{ChipFound, Look, look};
use super::error::{FlashError, State};
use super::exchange::Exchange;
use super::programming::program;
use super::retries::Repeated;
use crate::instrument::port::Port;
use serde::Serialize;
use servoid_flash_image::{FLASH_START, FlashImage};
use std::time::Duration;

/// The wait for somebody to press reset.
const PATIENCE: Duration = Duration::from_secs(12);
/// The wait for a board that has just been reset, and how often it is reset again: the first byte after a reset shows the
/// bit rate, and a disturbed one leaves the bootloader deaf.
const AFTER_RESET: Duration = Duration::from_secs(2);
const RESETS: u32 = 4;

/// What goes on, for whoever looks on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashProgress {
    /// Nobody has answered yet.
    Waiting,
    /// The bootloader has answered, and this is the chip.
    Found(ChipFound),
    /// The protection is being removed.
    Unlocking,
    /// So many bytes are written and compared.
    Written(usize),
    /// Everything is compared, and the program is being started.
    Starting,
}

/// Whoever looks on, and may end it.
pub struct Hand<'h> {
    /// Is called with what goes on.
    pub show: &'h mut dyn FnMut(FlashProgress),
    /// Whether it is to end.
    pub stop: &'h dyn Fn() -> bool,
}

/// How the program was started.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// By the bootloader, at a word of ours.
    ByBootloader,
    /// By a reset with BOOT0 low.
    ByReset,
    /// By the bootloader, whose last acknowledgement was lost.
    Unconfirmed,
}

/// What was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Flashed {
    /// The chip.
    pub chip: ChipFound,
    /// Pages that had to be written again.
    pub written_again: u32,
    /// How the program was started.
    pub start: Start,
}

/// Writes `image` into the board at `port`, compares every byte, and starts it. The port is one of a rig again when this
/// returns: without parity.
///
/// With `unlock`, a protected chip is erased and unlocked first.
///
/// # Errors
/// Those of [`FlashError`]; none leaves a chip that starts anything but what it had before, or the whole program.
pub fn flash(
    port: &mut dyn Port,
    image: &FlashImage,
    lines: BootLines,
    unlock: bool,
    hand: &mut Hand<'_>,
) -> Result<Flashed, FlashError> {
    let broken = |error| FlashError::Broken(State::Untouched, error);
    port.set_even_parity(true).map_err(broken)?;
    let (chip, written_again, start) = with_parity(port, image, lines, unlock, hand)?;
    port.set_even_parity(false).map_err(broken)?;
    // From now on a reset starts the program, where a line decides.
    lines.let_go_of_boot0(port)?;
    if lines.can_start() {
        lines.reset_with(port, false)?;
    }
    Ok(Flashed {
        chip,
        written_again,
        start,
    })
}

fn with_parity(
    port: &mut dyn Port,
    image: &FlashImage,
    lines: BootLines,
    unlock: bool,
    hand: &mut Hand<'_>,
) -> Result<(ChipFound, u32, Start), FlashError> {
    let Hand { show, stop } = hand;
    let mut rom = Repeated::new(Exchange::new(port, *stop));
    begin(&mut rom, lines, show)?;
    let mut found = look(&mut rom, image)?;
    if let Look::Protected(chip) = found
        && unlock
    {
        show(FlashProgress::Found(chip));
        show(FlashProgress::Unlocking);
        rom.read_unprotect()?;
        begin(&mut rom, lines, show)?;
        found = look(&mut rom, image)?;
    }
    let Look::Ready(chip) = found else {
        return Err(FlashError::ReadProtected);
    };
    show(FlashProgress::Found(chip));
    let written_again = program(&mut rom, image, &mut |bytes| {
        show(FlashProgress::Written(bytes))
    })?;
    show(FlashProgress::Starting);
    let start = match lines.can_start() {
        true => Start::ByReset,
        false if rom.go(FLASH_START)? => Start::ByBootloader,
        false => Start::Unconfirmed,
    };
    Ok((chip, written_again, start))
}

/// Finds the bootloader.
fn begin(
    rom: &mut Repeated<'_>,
    lines: BootLines,
    show: &mut dyn FnMut(FlashProgress),
) -> Result<(), FlashError> {
    let waiting = &mut || show(FlashProgress::Waiting);
    if !lines.can_reset() {
        lines.reset_with(rom.exchange.port, true)?;
        return rom.synchronise(PATIENCE, waiting);
    }
    for _ in 1..RESETS {
        lines.reset_with(rom.exchange.port, true)?;
        match rom.synchronise(AFTER_RESET, waiting) {
            Err(FlashError::NoAnswer | FlashError::FellSilent(_)) => {}
            other => return other,
        }
    }
    lines.reset_with(rom.exchange.port, true)?;
    rom.synchronise(AFTER_RESET, waiting)
}
