//! The main loop: polls the program, sleeps, and measures for how long it was awake.
//!
//! As the executor's own loop, but for the clock around the sleep. Interrupts stay pending while the clock is read, so the time
//! of their handlers counts as awake.

use crate::timing;
use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::SCB;
use embassy_executor::{SpawnToken, raw};

/// SEVONPEND of the system control register: an interrupt that becomes pending ends a WFE though it is masked (PM0056,
/// 4.4.6; Armv7-M ARM, B1.5.18).
const SEV_ON_PEND: u32 = 1 << 4;

/// Time awake since the start (µs, wrapping).
static AWAKE_US: AtomicU32 = AtomicU32::new(0);

/// It is never awake for as long: the watchdog would end that. A longer stretch is one in which the instants began anew, or the
/// train of pulses changed.
const LONGEST_US: u32 = 100_000;

/// What the executor calls its thread mode (`embassy_executor`, `platform/cortex_m.rs`): waking a task sends an event, which
/// ends the next WFE if it has not begun yet.
const THREAD_MODE: usize = usize::MAX;

/// Time awake since the start, up to the last sleep (µs, wrapping).
pub fn awake_us() -> u32 {
    AWAKE_US.load(Ordering::Relaxed)
}

/// Runs the program for ever.
pub fn run<S>(program: SpawnToken<S>) -> ! {
    // SAFETY: one bit that concerns sleeping alone, before anything sleeps.
    unsafe { (*SCB::PTR).scr.modify(|scr| scr | SEV_ON_PEND) };
    let mut executor = raw::Executor::new(THREAD_MODE as *mut ());
    // SAFETY: this function never returns, so the executor lives for ever.
    let executor: &'static raw::Executor = unsafe { &*core::ptr::from_mut(&mut executor) };
    executor.spawner().spawn(program);
    // The timer has no clock yet, and begins with 0.
    let mut woken = 0;
    loop {
        // SAFETY: only here, and not within itself: the program does not poll.
        unsafe { executor.poll() };
        woken = sleep(woken);
    }
}

/// Sleeps, after being awake since the instant `woken`; returns the instant of the end of the sleep.
fn sleep(woken: u32) -> u32 {
    cortex_m::interrupt::disable();
    let awake = timing::instant_us().wrapping_sub(woken);
    if awake < LONGEST_US {
        AWAKE_US.store(awake_us().wrapping_add(awake), Ordering::Relaxed);
    }
    cortex_m::asm::wfe();
    let woken = timing::instant_us();
    // The handlers run from here on.
    // SAFETY: interrupts were on: this is no critical section of anybody.
    unsafe { cortex_m::interrupt::enable() };
    woken
}
