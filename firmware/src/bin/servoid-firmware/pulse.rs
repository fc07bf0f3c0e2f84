//! The pulses on the line, their train and their frame.
//!
//! The compare register is preloaded: a value written during one pulse is on the line in the next one. A frame may have
//! several pulses, all of one width. So the register is written in the last pulse of a frame; what comes earlier or later waits
//! for the next one.
//!
//! The program cannot read the value on the line. So this module keeps both values, and moves one to the other at each edge of
//! a pulse, which the timer's update flag signals.

use crate::timing;
use core::cell::Cell;
use critical_section::{CriticalSection, Mutex};
use servoid_protocol::{PulseTrain, PulseWidth};
use stm32f1xx_hal::pac::TIM2;

/// Within this time before a pulse's edge (µs), a write may fall on either side of the edge, and the flag may be
/// set while it is cleared. So the program waits for the edge, and treats the write as late. The work after that
/// takes well below a microsecond; the rest is margin.
const EDGE_GUARD_US: u16 = 10;

#[derive(Clone, Copy)]
struct Line {
    /// On the line since the last edge.
    applied: Option<PulseWidth>,
    /// In the compare register, for the next edge.
    preloaded: Option<PulseWidth>,
    /// What was asked for last.
    asked: Option<PulseWidth>,
    /// The train that the timers make.
    train: PulseTrain,
    /// The train that was asked for last.
    asked_train: PulseTrain,
}

static LINE: Mutex<Cell<Line>> = Mutex::new(Cell::new(Line {
    applied: None,
    preloaded: None,
    asked: None,
    train: PulseTrain::USUAL,
    asked_train: PulseTrain::USUAL,
}));

/// What the line is at a moment of a frame.
pub struct Now {
    /// The pulses on the line.
    pub pulse: Option<PulseWidth>,
    /// The train that the timers make.
    pub train: PulseTrain,
    /// Since the frame's edge (µs).
    pub since_edge_us: u16,
}

/// The pulses from the next frame edge on.
pub fn set(pulse: Option<PulseWidth>) {
    critical_section::with(|cs| {
        let line = LINE.borrow(cs);
        let asked = pulse;
        line.set(Line {
            asked,
            ..line.get()
        });
        let now = now(cs);
        preload(cs, &now);
    });
}

/// The train of pulses, as soon as there are none.
pub fn set_train(asked_train: PulseTrain) {
    critical_section::with(|cs| {
        let line = LINE.borrow(cs);
        line.set(Line {
            asked_train,
            ..line.get()
        });
    });
}

/// The pulses on the line in this frame. Must be called at least once in each frame.
pub fn now(cs: CriticalSection) -> Now {
    let tim2 = tim2(cs);
    let line = LINE.borrow(cs);
    let train = line.get().train;
    while tim2.cnt().read().cnt().bits() >= train.period_us - EDGE_GUARD_US {}
    if tim2.sr().read().uif().bit_is_set() {
        // 15.4.5: a flag is cleared by writing 0. The others are not used.
        tim2.sr().modify(|_, w| w.uif().clear());
        let applied = line.get().preloaded;
        line.set(Line {
            applied,
            ..line.get()
        });
    }
    let since_edge_us = timing::since_frame_edge_us(&train);
    Now {
        pulse: line.get().applied,
        train,
        // It is not that late, as the loop above says: TIM3 is a fraction of a microsecond behind TIM2.
        since_edge_us: if since_edge_us >= train.frame_us() as u16 - EDGE_GUARD_US {
            0
        } else {
            since_edge_us
        },
    }
}

/// To be called between the last sample of a frame and its end: prepares what was asked for too late for the frame before, and
/// changes the train where there are no pulses. If the frame has ended meanwhile, both wait for the end of the next one.
pub fn end_frame() {
    critical_section::with(|cs| {
        let line = LINE.borrow(cs);
        let before = line.get();
        if before.asked == before.preloaded && before.asked_train == before.train {
            return;
        }
        // Anew: some time has passed since the last look.
        let now = now(cs);
        preload(cs, &now);
        let Line {
            applied,
            preloaded,
            asked_train,
            ..
        } = line.get();
        let is_before_end = now.since_edge_us >= last_sample_us(&now.train);
        if is_before_end && applied.is_none() && preloaded.is_none() && asked_train != now.train {
            timing::change(&tim2(cs), &asked_train);
            let train = asked_train;
            line.set(Line {
                train,
                ..line.get()
            });
        }
    });
}

/// When the last sample of a frame begins (µs after its edge).
pub fn last_sample_us(train: &PulseTrain) -> u16 {
    train.frame_us() as u16 - train.sample_us() + train.first_sample_us()
}

/// Writes what was asked for into the compare register, if this is the last pulse of its frame.
fn preload(cs: CriticalSection, now: &Now) {
    let last_pulse_us = now.train.frame_us() as u16 - now.train.period_us;
    if now.since_edge_us >= last_pulse_us {
        let line = LINE.borrow(cs);
        let preloaded = line.get().asked;
        let width = preloaded.map_or(0, |pulse| pulse.0);
        // 15.4.14: with preload this takes effect at the next update event.
        tim2(cs).ccr2().write(|w| w.ccr().set(width));
        line.set(Line {
            preloaded,
            ..line.get()
        });
    }
}

fn tim2(_: CriticalSection) -> TIM2 {
    // SAFETY: once the timers run, only this module touches the timer's compare register and flags,
    // and only in critical sections.
    unsafe { TIM2::steal() }
}
