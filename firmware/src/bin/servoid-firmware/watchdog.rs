//! The independent watchdog: no frames, no pulses.

use servoid_protocol::timing::FRAME_US;
use stm32f1xx_hal::pac::IWDG;
use stm32f1xx_hal::prelude::*;
use stm32f1xx_hal::watchdog::IndependentWatchdog;

/// Missing frames until the chip is reset, at the oscillator's nominal rate.
///
/// The oscillator has 40 kHz nominally and 30 to 60 kHz by its datasheet: 3.3 to 6.7 frames of the usual train, and 1.8 to 3.6
/// of the longest frames that another one has. With more than one, only a standstill triggers it.
const FRAMES: u32 = 5;

/// Starts the watchdog, which cannot be stopped (19.3). It comes before all that may hang, such as the clocks.
///
/// Until it is first fed it counts from its reset value: 0.27 s at the oscillator's highest rate. The start takes 0.05 s
/// at most, and the first frame 0.02 s more.
pub fn start(iwdg: IWDG) -> IndependentWatchdog {
    let mut watchdog = IndependentWatchdog::new(iwdg);
    watchdog.start((FRAMES * FRAME_US / 1_000).millis());
    watchdog
}
