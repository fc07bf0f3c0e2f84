//! Debuggers: one may watch, and none may stop the hardware.

use stm32f1xx_hal::pac::DBGMCU;

/// Clears every bit by which timers or the watchdog stop while a debugger halts the processor (31.16.3). These bits
/// outlive a reset, and a halt in the middle of a pulse would hold the line high for as long as it lasts. Without
/// them a halt ends like any standstill: the watchdog restarts the chip.
///
/// The debug port stays awake while the processor sleeps; otherwise a debugger could not be attached again. Without a
/// debugger these bits cannot be written, and the chip has none of them (errata sheet ES096, debug registers).
pub fn prepare(dbgmcu: &DBGMCU) {
    dbgmcu.cr().write(|w| w.dbg_sleep().set_bit());
}
