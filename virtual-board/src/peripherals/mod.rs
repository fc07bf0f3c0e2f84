//! Models of the chip's peripherals, each written from the reference manual RM0008 (rev. 21).
//!
//! Section numbers stand beside the rules. A model has registers and times, and no access to other models; signals
//! between models go through the [`chip`](crate::chip). A model reports the functions that it does not have, see
//! [`Irregularity`]. Reading or writing a register gives `None` where there is no register at that offset.

pub mod adc;
pub mod afio;
pub mod dbgmcu;
pub mod dma;
pub mod exti;
pub mod flash;
pub mod gpio;
pub mod iwdg;
pub mod pwr;
pub mod rcc;
pub mod signature;
pub mod tim;
pub mod usart;

use crate::record::{Irregularity, Record};
use crate::time::Ticks;

/// The time of an event, and the record of its irregularities.
pub struct Moment<'a> {
    /// The time.
    pub now: Ticks,
    /// The record so far.
    pub record: &'a mut Record,
}

impl Moment<'_> {
    pub(crate) fn report(&mut self, what: Irregularity) {
        self.record.violation(self.now, what);
    }

    /// Reports `what` where `is_so`.
    pub(crate) fn report_if(&mut self, is_so: bool, what: Irregularity) {
        if is_so {
            self.report(what);
        }
    }

    /// Reports the use of a function that is not modelled, where `is_so`.
    pub(crate) fn not_modelled(&mut self, is_so: bool, function: &'static str) {
        self.report_if(is_so, Irregularity::NotModelled(function));
    }

    /// Reports an act against a rule of the reference manual, where `is_so`.
    pub(crate) fn against_manual(&mut self, is_so: bool, act: &'static str) {
        self.report_if(is_so, Irregularity::AgainstTheManual(act));
    }
}

/// Bit `n` of `word`.
pub(crate) const fn bit(word: u32, n: u32) -> bool {
    word >> n & 1 != 0
}

/// `width` bits of `word` from bit `n` on.
pub(crate) const fn field(word: u32, n: u32, width: u32) -> u32 {
    word >> n & ((1 << width) - 1)
}

#[cfg(test)]
pub(crate) mod testing {
    use super::Moment;
    use crate::record::{Irregularity, Record};
    use crate::time::Ticks;

    /// A record to test a model with.
    #[derive(Default)]
    pub(crate) struct Bench(pub Record);

    impl Bench {
        pub(crate) fn at(&mut self, now: Ticks) -> Moment<'_> {
            Moment {
                now,
                record: &mut self.0,
            }
        }

        /// The reports since the last call.
        pub(crate) fn reported(&mut self) -> Vec<Irregularity> {
            self.0.violations.drain(..).map(|v| v.what).collect()
        }
    }
}
