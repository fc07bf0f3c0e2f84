//! The end of the program: panics, faults and a stopped crystal.
//!
//! A pulse that is cut short would make the servo jerk. So the compare register is set to zero first of all, the present
//! pulse ends normally, and the timer makes no more pulses from the next frame edge on. Then the chip is reset, and
//! starts without pulses. Should even this hang, the watchdog resets the chip a little later.
//!
//! Nothing here logs: the log may be what has failed, and a fault in it would lead here again. What happened goes into
//! the [record](crate::last_fault), and the next start logs it.

use crate::last_fault;
use core::panic::PanicInfo;
use cortex_m::peripheral::SCB;
use cortex_m_rt::exception;
use servoid_protocol::health::FaultKind;
use servoid_protocol::hello::Text16;
use servoid_protocol::timing::FRAME_US;
use stm32f1xx_hal::pac::{RCC, TIM2};

/// Reads of the flag that a frame edge sets, before the timer is given up: each takes four cycles at the least, so this
/// is a frame or more at 72 MHz.
const POLLS: u32 = FRAME_US * 72 / 4;

/// Ends the pulses at the next frame edge, then resets the chip.
fn stop(kind: FaultKind, detail: u32, place: Text16) -> ! {
    cortex_m::interrupt::disable();
    // SAFETY: interrupts are off and the program does not go on, so nothing else uses these.
    let (rcc, tim2) = unsafe { (RCC::steal(), TIM2::steal()) };
    // Before the timer runs there is no pulse to end (7.3.8, 15.4.1).
    let runs = rcc.apb1enr().read().tim2en().bit_is_set() && tim2.cr1().read().cen().bit_is_set();
    if runs {
        tim2.ccr2().write(|w| w.ccr().set(0)); // 15.4.14
        tim2.sr().modify(|_, w| w.uif().clear()); // 15.4.5
    }
    last_fault::record(kind, detail, place);
    if runs {
        wait_for_edge(&tim2);
    }
    SCB::sys_reset()
}

/// Waits for the frame edge, or until it must have come: then the timer has failed, and the reset cuts what is on the
/// line.
fn wait_for_edge(tim2: &TIM2) {
    for _ in 0..POLLS {
        if tim2.sr().read().uif().bit_is_set() {
            return;
        }
    }
}

/// Ends a program that cannot go on.
pub fn give_up() -> ! {
    stop(FaultKind::Panic, 0, Text16::default())
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    let (line, place) = info.location().map_or((0, Text16::default()), |location| {
        // The end of the file's name says more than its beginning.
        let name = location.file().as_bytes();
        let end = name.len().saturating_sub(Text16::default().0.len());
        let mut tail = name.iter().skip(end);
        let bytes = core::array::from_fn(|_| tail.next().copied().unwrap_or(0));
        (location.line(), Text16(bytes))
    });
    stop(FaultKind::Panic, line, place)
}

/// The crystal has stopped (7.2.7). The timer counts nine times slower now, so the present pulse is cut at once: the
/// output is forced inactive, which is low. Switched off, the channel would leave the pin to itself (15.4.7, 15.4.9).
#[exception]
unsafe fn NonMaskableInt() {
    // SAFETY: this never returns, so nothing else uses it any more.
    let tim2 = unsafe { TIM2::steal() };
    tim2.ccmr1_output().modify(|_, w| w.oc2m().force_inactive());
    last_fault::record(FaultKind::CrystalStopped, 0, Text16::default());
    SCB::sys_reset()
}

// The stack may be what has failed, so the handler begins with a new one. `pc` is the stacked program counter, at offset
// 24 of the frame (Armv7-M ARM, B1.5.6), or 0 where the frame is not within the memory of the stack.
core::arch::global_asm!(
    ".section .HardFault.servoid, \"ax\"
    .global HardFault
    .type HardFault,%function
    .thumb_func
    HardFault:
        mrs r0, msp
        movw r1, #:lower16:_stack_start
        movt r1, #:upper16:_stack_start
        mov.w r2, #0x20000000
        subs r3, r1, #32
        cmp r0, r2
        blo 1f
        cmp r0, r3
        bhi 1f
        ldr r0, [r0, #24]
        b 2f
    1:  movs r0, #0
    2:  mov sp, r1
        b {hard_fault}
    .size HardFault, . - HardFault",
    hard_fault = sym hard_fault,
);

extern "C" fn hard_fault(pc: u32) -> ! {
    if crate::small_part::lacks_memory() {
        crate::small_part::blink()
    }
    stop(FaultKind::HardFault, pc, Text16::default())
}

/// Any interrupt or exception that has no handler of its own.
#[exception]
unsafe fn DefaultHandler(number: i16) {
    stop(
        FaultKind::StrayInterrupt,
        u32::from(number.unsigned_abs()),
        Text16::default(),
    )
}
