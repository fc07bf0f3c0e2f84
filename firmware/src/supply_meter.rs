//! The board's own supply, by the chip's reference voltage.

use crate::board::Supply;
use servoid_protocol::health::BANDGAP_CONVERSIONS;

/// Readings of the supply since the start.
#[derive(Debug, Default)]
#[cfg_attr(test, derive(Clone))]
pub(crate) struct SupplyMeter {
    /// The first sum, and the newest; 0 before.
    pub(crate) at_start: u16,
    pub(crate) newest: u16,
    /// Frames with a low supply.
    pub(crate) low_frames: u32,
    sum: u16,
    summed: u16,
}

impl SupplyMeter {
    /// Takes the supply of a frame.
    pub(crate) fn take(&mut self, supply: Supply) {
        self.low_frames = self.low_frames.saturating_add(u32::from(supply.is_low));
        if supply.bandgap == 0 {
            return;
        }
        // Sixteen conversions of 12 bits just fit.
        self.sum = self.sum.saturating_add(supply.bandgap);
        self.summed = self.summed.saturating_add(1);
        if self.summed >= BANDGAP_CONVERSIONS {
            self.newest = self.sum;
            if self.at_start == 0 {
                self.at_start = self.sum;
            }
            (self.sum, self.summed) = (0, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_sixteen_and_low_frames() {
        let mut meter = SupplyMeter::default();
        let take = |meter: &mut SupplyMeter, bandgap, is_low| {
            for _ in 0..16 {
                meter.take(Supply { bandgap, is_low });
            }
        };
        take(&mut meter, 0, false);
        assert_eq!((meter.at_start, meter.newest), (0, 0));
        take(&mut meter, 1_500, false);
        take(&mut meter, 4_095, true);
        assert_eq!((meter.at_start, meter.newest), (24_000, 65_520));
        assert_eq!(meter.low_frames, 16);
    }
}
