//! The board's 3.3 V, which are the ADC's reference as well.

use crate::fault::Fault;
use crate::time::{Ticks, milliseconds};

/// The supply as it should be (mV).
pub(crate) const NOMINAL: u64 = 3_300;
/// The supply while it sags (mV): above the brown-out reset (DS5319: 1.8 to 2.0 V), and more than the converter needs.
const SAGGED: u64 = 2_600;
/// Time that it takes to fall or to rise.
const RAMP: Ticks = milliseconds(5);

/// The supply, with its sags.
#[derive(Clone, Debug)]
pub struct Supply {
    /// When each begins to fall, and when it begins to rise.
    sags: Vec<(Ticks, Ticks)>,
    /// Without a sag (mV).
    usual: u64,
}

impl Supply {
    /// A supply of `usual` mV, with the sags among `faults`.
    pub fn new(usual: u64, faults: &[Fault]) -> Self {
        let sags = faults.iter().filter_map(|fault| match *fault {
            Fault::SupplySags { from, to } => Some((from, to)),
            _ => None,
        });
        Self {
            sags: sags.collect(),
            usual,
        }
    }

    /// The voltage at `now` (mV).
    pub fn millivolts(&self, now: Ticks) -> u64 {
        let fallen = self.sags.iter().map(|(from, to)| {
            let fall = now.saturating_sub(*from).min(RAMP);
            let rise = now.saturating_sub(*to).min(RAMP);
            fall.saturating_sub(rise)
        });
        let fallen = fallen.max().unwrap_or(0);
        self.usual - ((self.usual - SAGGED) * fallen).div_ceil(RAMP)
    }

    /// The first time after `now` at which the voltage falls below or rises to `threshold` (mV).
    pub fn crosses(&self, threshold: u64, now: Ticks) -> Option<Ticks> {
        let part = RAMP * self.usual.saturating_sub(threshold) / (self.usual - SAGGED) + 1;
        let crossings = self.sags.iter().flat_map(|(from, to)| {
            [
                from.checked_add(part),
                to.checked_add(RAMP.saturating_sub(part) + 1),
            ]
        });
        crossings.flatten().filter(|&at| at > now).min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sag_falls_stays_and_rises() {
        let sag = "supply-sags@1-2".parse().unwrap();
        let supply = Supply::new(NOMINAL, &[sag]);
        for (ms, millivolts) in [
            (0, 3_300),
            (1_000, 3_300),
            (1_005, 2_600),
            (2_000, 2_600),
            (2_005, 3_300),
        ] {
            assert_eq!(supply.millivolts(milliseconds(ms)), millivolts, "{ms} ms");
        }
        let below = supply.crosses(2_800, 0).unwrap();
        assert!(supply.millivolts(below - 10) >= 2_800 && supply.millivolts(below) < 2_800);
        let above = supply.crosses(2_800, below).unwrap();
        assert!(supply.millivolts(above - 10) < 2_800 && supply.millivolts(above) >= 2_800);
        assert_eq!(supply.crosses(2_800, above), None);
        assert_eq!(Supply::new(NOMINAL, &[]).crosses(2_800, 0), None);
    }
}
