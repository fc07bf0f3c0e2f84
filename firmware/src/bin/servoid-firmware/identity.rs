//! Who this board is, and why it started.

use crate::{sampling, timing};
use servoid_firmware::Identity;
use servoid_protocol::hello::{ClockSource, ResetCause, Text16};
use stm32f1xx_hal::pac::RCC;
use stm32f1xx_hal::rcc::Clocks;

/// Unique device ID, 96 bits (30.2).
const UNIQUE_ID: *const [u8; 12] = 0x1FFF_F7E8 as *const _;

/// Reads why the chip was reset, and clears the flags so that the next reset shows its own cause
/// (7.3.10).
///
/// Every reset pulls the reset pin as well (7.1.1), so that flag counts only when it is alone; a
/// supply that comes up may set any of the others.
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

/// What the board says of itself.
pub fn read(clock: ClockSource, reset_cause: ResetCause, clocks: &Clocks) -> Identity {
    Identity {
        board: Text16::new("STM32F103C8"),
        // SAFETY: twelve bytes of read-only memory that every chip of the family has there.
        unique_id: unsafe { UNIQUE_ID.read_volatile() },
        clock,
        reset_cause,
        first_sample_us: timing::FIRST_SAMPLE_US,
        aperture_us: sampling::aperture_us(clocks),
        oversampling: sampling::OVERSAMPLING as u8,
        full_scale: sampling::FULL_SCALE,
    }
}
