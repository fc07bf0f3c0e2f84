//! Whether this chip can have the program.

use super::bootloader::code;
use super::error::FlashError;
use super::retries::Repeated;
use serde::Serialize;
use servoid_flash_image::{FLASH_START, FlashImage};

/// The chip at the other end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct ChipFound {
    /// Product id: 0x410 is an STM32F10xxx of medium density.
    pub product_id: u16,
    /// Version of its bootloader, in binary-coded decimals: 0x22 is 2.2.
    pub bootloader: u8,
    /// Flash that it says it has (KiB); some clones do not say it.
    pub flash_kib: Option<u16>,
}

/// STM32F10xxx of medium density, such as the STM32F103C8 (AN2606; `dev_table.c` of stm32flash).
const STM32F103C8: u16 = 0x410;

/// Others that are on boards of the same form (`dev_table.c` of stm32flash).
const OTHERS: [(u16, &str); 10] = [
    (0x411, "an STM32F2"),
    (0x412, "an STM32F10xxx of low density"),
    (0x413, "an STM32F405 or STM32F407"),
    (0x414, "an STM32F10xxx of high density"),
    (0x418, "an STM32F105 or STM32F107"),
    (0x420, "an STM32F100"),
    (0x423, "an STM32F401"),
    (0x431, "an STM32F411"),
    (0x433, "an STM32F401"),
    (0x440, "an STM32F030 or STM32F051"),
];

/// Size of the flash in KiB (RM0008 30.1.1), in the system memory.
const FLASH_SIZE: u32 = 0x1fff_f7e0;

/// A look at the flash, which a protected chip refuses (bytes).
const WORD: usize = 4;

/// What there is at the other end.
pub(super) enum Look {
    /// The program can be written.
    Ready(ChipFound),
    /// It is read-protected.
    Protected(ChipFound),
}

/// Looks at the chip, which changes nothing.
pub(super) fn look(rom: &mut Repeated<'_>, image: &FlashImage) -> Result<Look, FlashError> {
    let id = rom.product_id()?.unwrap_or_default();
    let version = rom.version()?;
    let used = [code::READ, code::GO, code::WRITE, code::ERASE];
    let has_all = |commands: &[u8]| used.iter().all(|code| commands.contains(code));
    let version = version.filter(|version| id == STM32F103C8 && has_all(&version.commands));
    let Some(version) = version else {
        let known = OTHERS.iter().find(|(other, _)| *other == id);
        let name = known.map_or("another chip", |(_, name)| *name);
        return Err(FlashError::OtherChip { id, name });
    };
    let mut chip = ChipFound {
        product_id: id,
        bootloader: version.version,
        flash_kib: None,
    };
    if rom.read(FLASH_START, WORD)?.is_none() {
        return Ok(Look::Protected(chip));
    }
    chip.flash_kib = flash_kib(rom)?;
    let needed = image.pages();
    match chip.flash_kib {
        Some(kib) if u32::from(kib) < needed => Err(FlashError::TooSmall { kib, needed }),
        _ => Ok(Look::Ready(chip)),
    }
}

/// Size of the flash, where the chip shows it: not every clone does.
fn flash_kib(rom: &mut Repeated<'_>) -> Result<Option<u16>, FlashError> {
    let size = match rom.read(FLASH_SIZE, 2) {
        Err(FlashError::BadLine { .. }) => None,
        other => other?,
    };
    let bytes = size.and_then(|size| <[u8; 2]>::try_from(size).ok());
    let kib = bytes.map(u16::from_le_bytes);
    Ok(kib.filter(|kib| *kib != u16::MAX && *kib != 0))
}
