//! Models of the chip's peripherals, each written from the reference manual RM0008 (rev. 21).
//!
//! Section numbers stand beside the rules. A model knows registers and times and nothing of the
//! other models; what goes from one to the other goes through the [`chip`](crate::chip). What a model
//! does not do it reports, see [`Irregularity`].

pub mod adc;
pub mod afio;
pub mod dbgmcu;
pub mod dma;
pub mod flash;
pub mod gpio;
pub mod iwdg;
pub mod rcc;
pub mod signature;
pub mod tim;
pub mod usart;

use crate::record::{Irregularity, Record};
use crate::time::Ticks;

/// When something happens, and where what is irregular about it goes.
pub struct Moment<'a> {
    /// The time.
    pub now: Ticks,
    /// What happened so far.
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

        /// What was reported since the last call.
        pub(crate) fn reported(&mut self) -> Vec<Irregularity> {
            self.0.violations.drain(..).map(|v| v.what).collect()
        }
    }
}
