//! The end of the program: panics, faults and a stopped crystal.
//!
//! A pulse that is cut short would make the servo jerk. So the compare register is set to zero, the present pulse
//! ends normally, and the timer makes no more pulses from the next frame edge on. Then the chip is reset, and starts
//! without pulses. Should even this hang, the watchdog resets the chip a little later.
//!
//! A ready-made panic handler would stop the processor and leave the timer at the last pulse until the watchdog
//! resets the chip.

use core::panic::PanicInfo;
use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use servoid_protocol::timing::FRAME_US;
use stm32f1xx_hal::pac::{RCC, TIM2};

/// Ends the pulses at the next frame edge, then resets the chip.
pub fn stop() -> ! {
    cortex_m::interrupt::disable();
    // SAFETY: interrupts are off and the program does not go on, so nothing else uses these.
    let (rcc, tim2) = unsafe { (RCC::steal(), TIM2::steal()) };
    // Before the timer has a clock there is no pulse to end (7.3.8).
    if rcc.apb1enr().read().tim2en().bit_is_set() {
        tim2.ccr2().write(|w| w.ccr().set(0)); // 15.4.14
        // At least a whole frame at the highest clock, 72 cycles per microsecond.
        cortex_m::asm::delay(FRAME_US * 72);
    }
    SCB::sys_reset()
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    if let Some(place) = info.location() {
        defmt::error!("panic at {=str}:{=u32}", place.file(), place.line());
    }
    stop()
}

/// The crystal has stopped (7.2.7). The timer counts nine times slower now, so the present pulse is cut at once.
#[exception]
unsafe fn NonMaskableInt() {
    // SAFETY: this never returns, so nothing else uses it any more.
    let tim2 = unsafe { TIM2::steal() };
    tim2.ccer().modify(|_, w| w.cc2e().clear_bit()); // 15.4.9: off, and low
    SCB::sys_reset()
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    defmt::error!("hard fault at {=u32:#x}", frame.pc());
    stop()
}

/// Any interrupt or exception that has no handler of its own.
#[exception]
unsafe fn DefaultHandler(number: i16) {
    defmt::error!("unexpected interrupt {=i16}", number);
    stop()
}
