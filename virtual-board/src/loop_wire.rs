//! The wire of the self-test: from the pulse line to the divider before PA4, in the sensor's place.

use crate::time::{TICKS_PER_SECOND, Ticks, microseconds};
use std::str::FromStr;
use thiserror::Error;

/// 10 kΩ of 5.1 kΩ + 10 kΩ.
const DIVIDER: f64 = 10.0 / 15.1;

/// What drives the divider from (Ω): the two resistors in parallel, as a capacitor at PA4 sees them.
const SOURCE_OHMS: f64 = 5_100.0 * 10_000.0 / 15_100.0;

/// Largest code of a conversion.
const FULL_SCALE: f64 = 4_095.0;

/// Where the wire comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source {
    PulseLine,
    Supply,
    Nothing,
}

/// The wire, with what may be wrong with it.
///
/// As text: `divider` as it should be, `straight` without the divider, `open` without the wire, `3v3` from the supply; then, each
/// behind a comma, `noise=MV` (mV at PA4, largest), `capacitor=NF` (nF at PA4), `falls-late=US` (µs by which falling edges come late).
///
/// ```
/// use virtual_board::LoopWire;
/// assert!("divider,noise=5".parse::<LoopWire>().is_ok());
/// assert!("string".parse::<LoopWire>().is_err());
/// ```
#[derive(Clone, Debug)]
pub struct LoopWire {
    source: Source,
    ratio: f64,
    noise_mv: f64,
    /// Time constant at PA4 (ticks).
    constant: f64,
    falls_late: Ticks,
    high: bool,
    /// Share of the supply at PA4 at the last edge, and when that came.
    from: f64,
    since: Ticks,
}

/// An error for a text that describes no wire.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "there is no wire '{0}': choose divider, straight, open or 3v3, then noise=MV, capacitor=NF or falls-late=US, each behind a comma"
)]
pub struct LoopWireError(String);

impl FromStr for LoopWire {
    type Err = LoopWireError;

    fn from_str(text: &str) -> Result<Self, LoopWireError> {
        let error = || LoopWireError(text.to_owned());
        let mut parts = text.split(',');
        let (source, ratio) = match parts.next() {
            Some("divider") => (Source::PulseLine, DIVIDER),
            Some("straight") => (Source::PulseLine, 1.0),
            Some("open") => (Source::Nothing, DIVIDER),
            Some("3v3") => (Source::Supply, DIVIDER),
            _ => return Err(error()),
        };
        let mut wire = Self {
            source,
            ratio,
            noise_mv: 0.0,
            constant: 0.0,
            falls_late: 0,
            high: false,
            from: 0.0,
            since: 0,
        };
        for part in parts {
            let (name, value) = part.split_once('=').ok_or_else(error)?;
            let value: f64 = value.parse().map_err(|_| error())?;
            match name {
                "noise" => wire.noise_mv = value,
                "capacitor" => {
                    wire.constant = SOURCE_OHMS * value * 1e-9 * TICKS_PER_SECOND as f64;
                }
                "falls-late" => wire.falls_late = microseconds(value as u64),
                _ => return Err(error()),
            }
        }
        Ok(wire)
    }
}

impl LoopWire {
    /// The pulse line has this level from `now` on.
    pub(crate) fn follow(&mut self, high: bool, now: Ticks) {
        if high != self.high {
            let at = if high { now } else { now + self.falls_late };
            self.from = self.share(at);
            (self.high, self.since) = (high, at);
        }
    }

    /// Share of the supply at PA4.
    fn share(&self, now: Ticks) -> f64 {
        let driven = |high: bool| match self.source {
            Source::PulseLine if high => self.ratio,
            Source::Supply => self.ratio,
            _ => 0.0,
        };
        let Some(passed) = now.checked_sub(self.since) else {
            return driven(!self.high);
        };
        let to = driven(self.high);
        let left = match self.constant {
            0.0 => 0.0,
            constant => (-(passed as f64) / constant).exp(),
        };
        to + (self.from - to) * left
    }

    /// The code of PA4 at `now`, with a supply of `millivolts`; `chance` is between -1 and 1.
    pub(crate) fn code(&self, now: Ticks, millivolts: u64, chance: f64) -> u16 {
        let noise = self.noise_mv * chance / millivolts as f64;
        let code = (self.share(now) + noise) * FULL_SCALE;
        code.round().clamp(0.0, FULL_SCALE) as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capacitor_takes_its_time_and_noise_stays_within_its_bound() {
        let mut wire: LoopWire = "divider,capacitor=10".parse().unwrap();
        wire.follow(true, 0);
        assert_eq!(wire.code(0, 3_300, 0.0), 0);
        // 10 nF and 3.38 kΩ: 63 % after 33.8 µs.
        assert_eq!(wire.code(microseconds(34), 3_300, 0.0), 1_721);
        assert_eq!(wire.code(microseconds(1_000), 3_300, 0.0), 2_712);
        let noisy: LoopWire = "3v3,noise=33".parse().unwrap();
        assert_eq!(noisy.code(0, 3_300, 1.0) - noisy.code(0, 3_300, -1.0), 82);
        let mut late: LoopWire = "straight,falls-late=5".parse().unwrap();
        late.follow(true, 0);
        late.follow(false, microseconds(100));
        assert_eq!(late.code(microseconds(104), 3_300, 0.0), 4_095);
        assert_eq!(late.code(microseconds(106), 3_300, 0.0), 0);
    }
}
