//! The board's own supply: the voltage detector, and the chip's reference voltage against the supply.
//!
//! The readings of the converter are relative to the supply. A supply that sags below 2.9 V, and stays above the 2 V at
//! which the chip resets itself, would make them wrong without any other sign.

use servoid_firmware::Supply;
use stm32f1xx_hal::pac::{ADC1, EXTI, PWR};
use stm32f1xx_hal::rcc::{Enable, Rcc};

/// The highest threshold, 2.9 V (5.4.1): 2.66 to 2.9 V as the supply falls (datasheet, table of the power control
/// block).
const THRESHOLD: u8 = 0b111;

/// The ADC's channel of the internal reference voltage (11.10).
const VREFINT: u8 = 17;

/// Switches the voltage detector on. Its output is line 16 of the external interrupts, whose pending bit holds on to the
/// shortest sag until the next frame is taken (10.2.5, 10.3.6). It stays masked in the NVIC: nothing is interrupted.
pub fn watch(pwr: &PWR, exti: &EXTI, rcc: &mut Rcc) {
    PWR::enable(rcc);
    // SAFETY: three bits, and all values are thresholds.
    pwr.cr()
        .write(|w| unsafe { w.pls().bits(THRESHOLD) }.pvde().set_bit());
    exti.rtsr().write(|w| w.tr16().set_bit());
    exti.imr().write(|w| w.mr16().set_bit());
}

/// Whether the supply was too low since the last call, or is now.
pub fn take_low() -> bool {
    // SAFETY: only the handler that calls this uses them after the start.
    let (pwr, exti) = unsafe { (PWR::steal(), EXTI::steal()) };
    let sagged = exti.pr().read().pr16().bit_is_set();
    exti.pr().write(|w| w.pr16().clear_bit_by_one()); // 10.3.6
    sagged || pwr.csr().read().pvdo().bit_is_set() // 5.4.2
}

/// Prepares the conversion of the reference voltage, as a single injected one that software starts (11.3.9, 11.12.12).
/// It does not touch the sequence of the sensor. The ADC must be idle.
pub fn prepare_bandgap(adc: &ADC1) {
    // The longest sampling time, 20 µs; the reference voltage needs 17.1 µs at most (datasheet).
    adc.smpr1().write(|w| w.smp17().cycles239_5());
    // SAFETY: channel 17 exists.
    adc.jsqr().write(|w| unsafe { w.jsq4().bits(VREFINT) });
    // Always with another bit: a write that leaves all as it is would start a conversion of the sensor (11.12.3).
    if !adc.cr2().read().jextsel().is_jswstart() {
        adc.cr2().modify(|_, w| w.jextsel().jswstart());
    }
}

/// Starts the conversion. It takes 21 µs.
pub fn start_bandgap(adc: &ADC1) {
    adc.cr2().modify(|_, w| w.jswstart().set_bit());
}

/// The supply in a frame.
pub fn of_frame(bandgap: u16) -> Supply {
    Supply {
        bandgap,
        is_low: take_low(),
    }
}
