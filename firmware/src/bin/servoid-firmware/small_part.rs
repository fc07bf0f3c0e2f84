//! Chips with 10 KiB of memory that are sold as an STM32F103C8. The program cannot run there, and blinks.
//!
//! They are found before the first variable is written, in `__pre_init`: the last word of the memory is read, which is a
//! fault where there is none, and then written and read back. Where all is well the pulse line comes next: it must not
//! float while the variables get their values.

use crate::line;
use cortex_m::peripheral::SCB;
use stm32f1xx_hal::pac::{GPIOC, RCC};

/// The upper half of the memory, where the variables are.
const UPPER_HALF: core::ops::Range<u32> = 0x2000_2800..0x2000_5000;

/// BFARVALID of the configurable fault status register (PM0056, 4.4.10).
const ADDRESS_VALID: u32 = 1 << 15;

/// Half a period of the blinking, in cycles of the 8 MHz that the chip has out of reset; a cycle of the delay takes about
/// three of them.
const HALF_PERIOD: u32 = 8_000_000 / 10;

core::arch::global_asm!(
    ".section .text.__pre_init, \"ax\"
    .global __pre_init
    .type __pre_init,%function
    .thumb_func
    __pre_init:
        movw r0, #0x4ffc
        movt r0, #0x2000
        ldr r1, [r0]
        mvns r2, r1
        str r2, [r0]
        ldr r3, [r0]
        str r1, [r0]
        cmp r2, r3
        bne 1f
        b {drive_low}
    1:  b {blink}
    .size __pre_init, . - __pre_init",
    drive_low = sym line::drive_low,
    blink = sym blink,
);

/// Whether a fault came of reading memory that a whole chip has.
pub fn lacks_memory() -> bool {
    // SAFETY: reading the fault registers has no effect (PM0056, 4.4.10, 4.4.14).
    let (status, address) = unsafe {
        let scb = &*SCB::PTR;
        (scb.cfsr.read(), scb.bfar.read())
    };
    status & ADDRESS_VALID != 0 && UPPER_HALF.contains(&address)
}

/// Blinks, with the pulse line low, until the supply goes.
pub extern "C" fn blink() -> ! {
    // SAFETY: the program does not go on, so nothing else uses these.
    let (rcc, gpioc) = unsafe { (RCC::steal(), GPIOC::steal()) };
    line::drive_low();
    rcc.apb2enr().modify(|_, w| w.iopcen().set_bit()); // 7.3.7
    gpioc
        .crh()
        .modify(|_, w| w.mode13().output2().cnf13().push_pull()); // 9.2.2
    loop {
        gpioc
            .odr()
            .modify(|r, w| w.odr13().bit(r.odr13().bit_is_clear()));
        cortex_m::asm::delay(HALF_PERIOD);
    }
}
