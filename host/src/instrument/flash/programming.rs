//! Erases, writes and compares so that a chip never starts what is not whole.
//!
//! A chip takes its stack and its start from the first eight bytes of the flash (Armv7-M ARM, B1.5.3). While they are
//! erased no program starts there, after whatever reset. So their page is erased before all others, and they are written
//! last, when all other bytes have been read back. What a cable that is pulled half-way leaves behind is a chip that does
//! nothing.

use super::error::{FlashError, State};
use super::retries::Repeated;
use servoid_flash_image::{ERASED, FLASH_START, FlashImage, PAGE_BYTES};

/// The bootloader writes whole words.
const WORD: usize = 4;
/// Bytes without which nothing starts.
const HEAD: usize = 8;

/// Pages that are erased at once: so few that somebody who ends the program waits for a second at most.
const AT_ONCE: usize = 8;

/// How often a page is written before it does not keep what is written to it.
const PAGE_ATTEMPTS: u32 = 10;
/// How often everything is compared again, after something had to be written again.
const ROUNDS: u32 = 10;

/// Writes the image into the chip. `show` is called with the bytes that are written and compared. Returns how many pages
/// had to be written again.
pub(super) fn program(
    rom: &mut Repeated<'_>,
    image: &FlashImage,
    show: &mut dyn FnMut(usize),
) -> Result<u32, FlashError> {
    let pages = image.pages();
    rom.erase(&[0])?;
    rom.state = State::Empty;
    let others: Vec<u8> = (1..pages).filter_map(|page| page.try_into().ok()).collect();
    for some in others.chunks(AT_ONCE) {
        rom.erase(some)?;
    }
    let mut wrong: Vec<u32> = (0..pages).rev().collect();
    let mut again = 0;
    for round in 0..ROUNDS {
        let before = again;
        for (done, &page) in wrong.iter().enumerate() {
            again += put(rom, image, page, round == 0)?;
            if round == 0 {
                show(((done + 1) * PAGE_BYTES as usize).min(image.bytes().len()));
            }
        }
        // A write that has gone astray leaves its own page without it: only then others need be looked at.
        wrong = match round == 0 && again == before {
            true => Vec::new(),
            false => differing(rom, image)?,
        };
        if wrong.is_empty() {
            if put_head(rom, image)? {
                return Ok(again);
            }
            again += 1;
            rom.erase(&[0])?;
            wrong = differing(rom, image)?;
        }
    }
    Err(FlashError::BadLine {
        what: "write the program",
        state: rom.state,
    })
}

/// A page without the head.
fn body(image: &FlashImage, page: u32) -> Vec<u8> {
    let mut bytes = image.page(page);
    if page == 0 {
        bytes.iter_mut().take(HEAD).for_each(|byte| *byte = ERASED);
    }
    bytes
}

fn address(page: u32) -> u32 {
    FLASH_START + page * PAGE_BYTES
}

fn differing(rom: &mut Repeated<'_>, image: &FlashImage) -> Result<Vec<u32>, FlashError> {
    let mut wrong = Vec::new();
    for page in 0..image.pages() {
        if !rom.holds(address(page), &body(image, page))? {
            wrong.push(page);
        }
    }
    Ok(wrong)
}

/// Writes a page and compares it; returns how often it had to be written again.
fn put(
    rom: &mut Repeated<'_>,
    image: &FlashImage,
    page: u32,
    erased: bool,
) -> Result<u32, FlashError> {
    let (address, bytes) = (address(page), body(image, page));
    for attempt in 0..PAGE_ATTEMPTS {
        if attempt > 0 || !erased {
            rom.erase(&[page as u8])?;
        }
        let used = bytes.iter().rposition(|byte| *byte != ERASED);
        let used = used.map_or(0, |last| (last + 1).next_multiple_of(WORD));
        rom.write(address, bytes.get(..used).unwrap_or(&bytes))?;
        if rom.holds(address, &bytes)? {
            return Ok(attempt);
        }
    }
    Err(FlashError::DoesNotKeep { address })
}

/// Writes the head, after all else has been compared; returns whether it is there.
fn put_head(rom: &mut Repeated<'_>, image: &FlashImage) -> Result<bool, FlashError> {
    let head = image.bytes().get(..HEAD).unwrap_or_default();
    rom.write(FLASH_START, head)?;
    rom.holds(FLASH_START, head)
}
