//! The pulse on the line, and its frame.
//!
//! The compare register is preloaded: a value written in one frame is on the line in the next one. The program
//! cannot read the value on the line. So this module keeps both values, and moves one to the other at each frame
//! edge, which the timer's update flag signals.

use core::cell::Cell;
use critical_section::{CriticalSection, Mutex};
use servoid_protocol::PulseWidth;
use servoid_protocol::timing::FRAME_US;
use stm32f1xx_hal::pac::TIM2;

/// Within this time before the frame edge (µs), a write may fall on either side of the edge, and the flag may be
/// set while it is cleared. So the program waits for the edge, and treats the write as late. The work after that
/// takes well below a microsecond; the rest is margin.
const EDGE_GUARD_US: u16 = 10;

#[derive(Clone, Copy)]
struct Line {
    /// On the line since the last frame edge.
    applied: Option<PulseWidth>,
    /// In the compare register, for the next frame edge.
    preloaded: Option<PulseWidth>,
}

static LINE: Mutex<Cell<Line>> = Mutex::new(Cell::new(Line {
    applied: None,
    preloaded: None,
}));

/// The pulse from the next frame edge on.
pub fn set(pulse: Option<PulseWidth>) {
    critical_section::with(|cs| {
        let applied = on_line(cs);
        let width = pulse.map_or(0, |pulse| pulse.0);
        // 15.4.14: with preload this takes effect at the next update event.
        tim2(cs).ccr2().write(|w| w.ccr().set(width));
        let preloaded = pulse;
        LINE.borrow(cs).set(Line { applied, preloaded });
    });
}

/// The pulse on the line in this frame. Must be called at least once in each frame.
pub fn on_line(cs: CriticalSection) -> Option<PulseWidth> {
    let tim2 = tim2(cs);
    let line = LINE.borrow(cs);
    while since_edge_us(cs) >= FRAME_US as u16 - EDGE_GUARD_US {}
    if tim2.sr().read().uif().bit_is_set() {
        // 15.4.5: a flag is cleared by writing 0. The others are not used.
        tim2.sr().modify(|_, w| w.uif().clear());
        let Line { preloaded, .. } = line.get();
        let applied = preloaded;
        line.set(Line { applied, preloaded });
    }
    line.get().applied
}

/// Microseconds since the last frame edge.
pub fn since_edge_us(cs: CriticalSection) -> u16 {
    tim2(cs).cnt().read().cnt().bits()
}

fn tim2(_: CriticalSection) -> TIM2 {
    // SAFETY: once the timers run, only this module touches the timer's compare register and flags,
    // and only in critical sections.
    unsafe { TIM2::steal() }
}
