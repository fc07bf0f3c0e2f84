//! The identity of the board, and the cause of its last reset.

use crate::{sampling, timing};
use servoid_firmware::Identity;
use servoid_protocol::hello::{ClockSource, ResetCause, Text16};
use stm32f1xx_hal::pac::RCC;
use stm32f1xx_hal::rcc::Clocks;

/// Unique device ID, 96 bits (30.2).
const UNIQUE_ID: *const [u8; 12] = 0x1FFF_F7E8 as *const _;

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

/// The identity of the board.
pub fn read(clock: ClockSource, reset_cause: ResetCause, clocks: &Clocks) -> Identity {
    Identity {
        board: Text16::new("STM32F103C8"),
        // SAFETY: every chip of the family has twelve bytes of read-only memory there.
        unique_id: unsafe { UNIQUE_ID.read_volatile() },
        clock,
        reset_cause,
        first_sample_us: timing::FIRST_SAMPLE_US,
        aperture_us: sampling::aperture_us(clocks),
        oversampling: sampling::OVERSAMPLING as u8,
        full_scale: sampling::FULL_SCALE,
    }
}
