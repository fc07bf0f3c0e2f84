//! The clock tree: 72 MHz from the crystal, or 64 MHz from the internal oscillator.
//!
//! What is waited for without a limit here is ended by the watchdog, which runs already.

use servoid_protocol::hello::ClockSource;
use stm32f1xx_hal::pac::{FLASH, RCC};
use stm32f1xx_hal::prelude::*;
use stm32f1xx_hal::rcc::{Config, Rcc};

/// Polls of the crystal before it is given up: some 50 ms at 8 MHz and about 8 cycles each. A good crystal takes
/// 2 ms (datasheet, table of HSE characteristics).
const CRYSTAL_POLLS: u32 = 50_000;

/// Brings the clocks to where a reset leaves them (7.3.1, 7.3.2).
///
/// The chip's own bootloader may start this program with the PLL on and in use (stm32duino found it so, with its vector
/// table in place, which the runtime's `set-vtor` mends). The PLL must not be changed while it is on, and some clones show
/// their number at a slow clock only.
pub fn as_after_reset(rcc: &RCC) {
    rcc.cr().modify(|_, w| w.hsion().set_bit());
    while rcc.cr().read().hsirdy().bit_is_clear() {}
    rcc.cfgr().modify(|_, w| w.sw().hsi());
    while !rcc.cfgr().read().sws().is_hsi() {}
    rcc.cr().modify(|_, w| w.pllon().clear_bit());
    while rcc.cr().read().pllrdy().bit_is_set() {}
    rcc.cfgr().reset();
}

/// Starts the clocks; returns them and their source.
///
/// From both sources the timers' clock is a whole number of MHz, so they count whole microseconds, and the ADC's
/// clock divides it evenly. A crystal that stops later ends the pulses: see [`guard_the_crystal`].
pub fn start(rcc: RCC, flash: FLASH) -> (Rcc, ClockSource) {
    let (config, source) = if crystal_runs(&rcc) {
        let config = Config::hse(8.MHz())
            .sysclk(72.MHz())
            .pclk1(36.MHz())
            .adcclk(12.MHz());
        (config, ClockSource::Crystal)
    } else {
        // 8 MHz / 2 × 16 is the most that the PLL makes of the internal oscillator (7.3.2). The ADC
        // gets 64 / 6 MHz: 16 MHz would be above its limit of 14 MHz (11.1).
        let config = Config::hsi()
            .sysclk(64.MHz())
            .pclk1(32.MHz())
            .adcclk(10.MHz());
        (config, ClockSource::InternalRc)
    };
    let rcc = rcc.freeze(config, &mut flash.constrain().acr);
    prefetch();
    if source == ClockSource::Crystal {
        guard_the_crystal();
    }
    (rcc, source)
}

/// Switches the crystal on and waits for it. The HAL would wait for ever for a missing one.
fn crystal_runs(rcc: &RCC) -> bool {
    rcc.cr().modify(|_, w| w.hseon().set_bit()); // 7.3.1
    let runs = (0..CRYSTAL_POLLS).any(|_| rcc.cr().read().hserdy().bit_is_set());
    if !runs {
        rcc.cr().modify(|_, w| w.hseon().clear_bit());
    }
    runs
}

/// Switches the flash's prefetch buffer on again, which the HAL leaves off: without it every instruction would
/// take two wait states. 3.3.3 allows it only below 24 MHz, so the system clock goes
/// back to the internal oscillator (SW, 7.3.2) while the PLL keeps running.
///
/// Each switch is waited for, that of the HAL first, which does not wait: a second one before SWS follows has no certain
/// outcome, and the buffer might be switched at full speed.
fn prefetch() {
    // SAFETY: the HAL no longer uses them; nothing else runs yet.
    let (rcc, flash) = unsafe { (RCC::steal(), FLASH::steal()) };
    while !rcc.cfgr().read().sws().is_pll() {}
    rcc.cfgr().modify(|_, w| w.sw().hsi());
    while !rcc.cfgr().read().sws().is_hsi() {}
    flash.acr().modify(|_, w| w.prftbe().set_bit());
    rcc.cfgr().modify(|_, w| w.sw().pll());
    while !rcc.cfgr().read().sws().is_pll() {}
}

/// Switches the clock security system on (7.2.7). If the crystal stops, the chip goes on at 8 MHz and a pulse
/// would last nine times as long. The interrupt ends the pulse and restarts the chip, which then reports its
/// internal oscillator.
fn guard_the_crystal() {
    // SAFETY: the HAL no longer uses it, and nothing else runs yet.
    let rcc = unsafe { RCC::steal() };
    rcc.cr().modify(|_, w| w.csson().set_bit());
}
