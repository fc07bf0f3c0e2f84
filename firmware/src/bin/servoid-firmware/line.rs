//! The pulse line, PA1, before the timer has it.

use stm32f1xx_hal::pac::{GPIOA, RCC};

/// Drives the line low. Out of reset the pin floats (9.2.1), and only the resistor at the servo's wire holds it.
///
/// Called before any variable has its value, so it uses none.
pub extern "C" fn drive_low() {
    // SAFETY: nothing else runs yet, or ever again.
    let (rcc, gpioa) = unsafe { (RCC::steal(), GPIOA::steal()) };
    rcc.apb2enr().modify(|_, w| w.iopaen().set_bit()); // 7.3.7
    // Low first: the data register is that of an output only after the next line.
    gpioa.brr().write(|w| w.br1().set_bit()); // 9.2.6
    gpioa
        .crl()
        .modify(|_, w| w.mode1().output2().cnf1().push_pull()); // 9.2.1
}
