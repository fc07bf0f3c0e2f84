//! The flash interface: wait states and prefetch (RM0008 3.3.3).

use super::{Moment, bit, field};

/// The model. Programming the flash is not modelled.
#[derive(Debug)]
pub struct Flash {
    acr: u32,
}

impl Default for Flash {
    /// Out of reset: no wait state, prefetch on.
    fn default() -> Self {
        Self { acr: 0x30 }
    }
}

const PREFETCH: u32 = 4;
const SWITCHED: &str = "the prefetch buffer was switched at 24 MHz or more (3.3.3)";

impl Flash {
    pub fn read(&self, offset: u32) -> Option<u32> {
        (offset == 0).then_some(self.acr)
    }

    pub fn write(
        &mut self,
        offset: u32,
        value: u32,
        sysclk_mhz: u64,
        m: &mut Moment<'_>,
    ) -> Option<()> {
        if offset != 0 {
            return None;
        }
        let switched = sysclk_mhz >= 24 && bit(self.acr ^ value, PREFETCH);
        m.against_manual(switched, SWITCHED);
        // PRFTBS follows PRFTBE. Half cycle access only below 8 MHz.
        self.acr = value & 0x1f | u32::from(bit(value, PREFETCH)) << 5;
        m.not_modelled(bit(value, 3), "half cycle access");
        self.check(sysclk_mhz, m);
        Some(())
    }

    /// Wait states of each access (LATENCY).
    pub fn wait_states(&self) -> u64 {
        field(self.acr, 0, 3).into()
    }

    /// Whether the wait states suffice: 0 to 24 MHz, 1 to 48 MHz, 2 above.
    pub fn check(&self, sysclk_mhz: u64, m: &mut Moment<'_>) {
        let needed = match sysclk_mhz {
            0..=24 => 0,
            25..=48 => 1,
            _ => 2,
        };
        let few = field(self.acr, 0, 3) < needed;
        m.against_manual(few, "too few wait states for the system clock (3.3.3)");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peripherals::testing::Bench;
    use crate::record::Irregularity;

    #[test]
    fn wait_states_have_to_fit_the_clock() {
        let (mut flash, mut bench) = (Flash::default(), Bench::default());
        for (latency, mhz, good) in [
            (0, 24, true),
            (0, 25, false),
            (1, 48, true),
            (1, 49, false),
            (2, 72, true),
        ] {
            flash.write(0, 0x10 | latency, 8, &mut bench.at(0));
            flash.check(mhz, &mut bench.at(0));
            assert_eq!(bench.reported().is_empty(), good, "{latency} at {mhz} MHz");
        }
    }

    #[test]
    fn prefetch_is_switched_below_24_mhz_only() {
        let (mut flash, mut bench) = (Flash::default(), Bench::default());
        assert_eq!(flash.read(0), Some(0x30));
        flash.write(0, 0x02, 8, &mut bench.at(0));
        assert_eq!(flash.read(0), Some(0x02));
        assert_eq!(bench.reported(), []);
        flash.write(0, 0x12, 72, &mut bench.at(0));
        assert_eq!(bench.reported(), [Irregularity::AgainstTheManual(SWITCHED)]);
    }
}
