//! Settings that let a debugger stop the program together with the hardware.

use cortex_m::peripheral::DCB;
use stm32f1xx_hal::pac::DBGMCU;

/// With a debugger attached, timers and watchdog stop when it stops the processor (31.16.3). The debug port stays
/// awake while the processor sleeps; otherwise a debugger could not be attached again.
pub fn prepare(dbgmcu: &DBGMCU) {
    if DCB::is_debugger_attached() {
        dbgmcu.cr().modify(|_, w| {
            w.dbg_tim2_stop().set_bit();
            w.dbg_tim3_stop().set_bit();
            w.dbg_iwdg_stop().set_bit();
            w.dbg_sleep().set_bit()
        });
    }
}
