//! The identity of the board, and the cause of its last reset.

use crate::sampling;
use servoid_firmware::{ChipIdentity, Identity};
use servoid_protocol::PulseTrain;
use servoid_protocol::health::LastFault;
use servoid_protocol::hello::{ClockSource, ResetCause, Text16};
use stm32f1xx_hal::pac::{DBGMCU, RCC};
use stm32f1xx_hal::rcc::Clocks;

/// Unique device ID, 96 bits (30.2).
const UNIQUE_ID: *const [u8; 12] = 0x1FFF_F7E8 as *const _;

/// Size of the flash in KiB (30.1.1).
const FLASH_SIZE: *const u16 = 0x1FFF_F7E0 as *const _;

/// What the chip says of itself.
pub struct Signature {
    unique_id: [u8; 12],
    chip: ChipIdentity,
}

/// Reads what the chip says of itself. It must still run at 8 MHz: some clones read as all ones at a higher clock.
pub fn read_signature(dbgmcu: &DBGMCU) -> Signature {
    // SAFETY: every chip of the family has read-only memory at both addresses.
    let (unique_id, flash_kib) = unsafe { (UNIQUE_ID.read_volatile(), FLASH_SIZE.read_volatile()) };
    Signature {
        // All ones is the number of no chip: all zeros says that it is not known.
        unique_id: if unique_id == [0xff; 12] {
            [0; 12]
        } else {
            unique_id
        },
        chip: ChipIdentity {
            flash_kib: if flash_kib == u16::MAX { 0 } else { flash_kib },
            // 0 without a debugger (errata sheet ES096).
            device: dbgmcu.idcode().read().bits(),
        },
    }
}

/// Reads the cause of the last reset, and clears the flags for the next one (7.3.10).
///
/// Every reset also pulls the reset pin (7.1.1), so that flag counts only if it is alone. A rising supply may set
/// any of the others.
pub fn take_reset_cause(rcc: &RCC) -> ResetCause {
    let flags = rcc.csr().read();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    if flags.porrstf().bit_is_set() {
        ResetCause::PowerOn
    } else if flags.iwdgrstf().bit_is_set() || flags.wwdgrstf().bit_is_set() {
        ResetCause::Watchdog
    } else if flags.sftrstf().bit_is_set() {
        ResetCause::Software
    } else if flags.lpwrrstf().bit_is_set() {
        ResetCause::LowPower
    } else if flags.pinrstf().bit_is_set() {
        ResetCause::Pin
    } else {
        ResetCause::Unknown
    }
}

/// What led to this start.
#[derive(Clone, Copy)]
pub struct Start {
    /// The cause of the reset.
    pub reset_cause: ResetCause,
    /// The fault before it, if there was one.
    pub last_fault: Option<LastFault>,
}

/// The identity of the board.
pub fn of(signature: Signature, clock: ClockSource, start: Start, clocks: &Clocks) -> Identity {
    Identity {
        board: Text16::new("STM32F103C8"),
        unique_id: signature.unique_id,
        clock,
        reset_cause: start.reset_cause,
        first_sample_us: PulseTrain::USUAL.first_sample_us(),
        aperture_us: sampling::aperture_us(clocks),
        oversampling: sampling::OVERSAMPLING as u8,
        full_scale: sampling::FULL_SCALE,
        chip: signature.chip,
        last_fault: start.last_fault,
    }
}
