//! The independent watchdog (RM0008 chapter 19).

use super::Moment;
use crate::time::{TICKS_PER_SECOND, Ticks};

/// Cycles of the low-speed oscillator until a new prescaler or reload value counts (19.4.4).
const UPDATE_CYCLES: Ticks = 5;
/// The counter's value when it is started, and out of reset that of RLR (19.3, 19.4.3).
const FULL: u32 = 0xfff;

/// A register that is updated in another clock domain.
#[derive(Clone, Copy, Debug)]
struct Slow {
    value: u32,
    /// The next value and its time; `Ticks::MAX` while the oscillator stands still.
    next: Option<(u32, Ticks)>,
}

impl Slow {
    fn new(value: u32) -> Self {
        Self { value, next: None }
    }

    fn at(&self, now: Ticks) -> u32 {
        match self.next {
            Some((value, at)) if now >= at => value,
            _ => self.value,
        }
    }

    fn updates(&self, now: Ticks) -> bool {
        self.next.is_some_and(|(_, at)| now < at)
    }

    fn write(&mut self, value: u32, now: Ticks, effective: Ticks) {
        self.value = self.at(now);
        self.next = Some((value, effective));
    }

    fn start(&mut self, effective: Ticks) {
        if let Some((_, at)) = &mut self.next {
            *at = (*at).min(effective);
        }
    }
}

#[derive(Debug)]
pub struct Iwdg {
    /// Ticks of one cycle of the low-speed oscillator.
    cycle: Ticks,
    unlocked: bool,
    prescaler: Slow,
    reload: Slow,
    /// Time and value of the last load of the counter; `None` before it is started.
    loaded: Option<(Ticks, u32)>,
    /// A debugger has stopped it (31.16.2).
    frozen: bool,
}

impl Iwdg {
    /// A watchdog out of reset; its oscillator has `lsi_hz`, nominally 40 kHz, and anything between
    /// 30 and 60 kHz within the datasheet.
    pub fn new(lsi_hz: u32) -> Self {
        Self {
            cycle: TICKS_PER_SECOND / Ticks::from(lsi_hz.max(1)),
            unlocked: false,
            prescaler: Slow::new(0),
            reload: Slow::new(FULL),
            loaded: None,
            frozen: false,
        }
    }

    /// Stops the counter.
    pub fn freeze(&mut self) {
        self.frozen = true;
    }

    /// The time at which the chip is reset, unless the counter is reloaded.
    pub fn expires(&self) -> Option<Ticks> {
        let (at, count) = self.loaded.filter(|_| !self.frozen)?;
        // 19.4.2: 4 to 256. A prescaler that is being updated is taken as updated: the difference
        // is below its update time.
        let code = self.prescaler.next.map_or(self.prescaler.value, |n| n.0);
        let divider: Ticks = 4 << code.min(6);
        Some(at + Ticks::from(count + 1) * divider * self.cycle)
    }

    pub fn read(&self, offset: u32, now: Ticks) -> Option<u32> {
        Some(match offset {
            0x00 => 0,
            0x04 => self.prescaler.at(now),
            0x08 => self.reload.at(now),
            0x0c => {
                u32::from(self.prescaler.updates(now)) | u32::from(self.reload.updates(now)) << 1
            }
            _ => return None,
        })
    }

    pub fn write(&mut self, offset: u32, value: u32, m: &mut Moment<'_>) -> Option<()> {
        let now = m.now;
        let effective = match self.loaded {
            Some(_) => now + UPDATE_CYCLES * self.cycle,
            None => Ticks::MAX,
        };
        match offset {
            // 19.4.1: any other key than 0x5555 locks again.
            0x00 => {
                self.unlocked = value == 0x5555;
                match value {
                    0xaaaa if self.loaded.is_some() => {
                        self.loaded = Some((now, self.reload.at(now)));
                    }
                    // The oscillator is forced on (7.2.5); started again it only goes on.
                    0xcccc if self.loaded.is_none() => {
                        self.loaded = Some((now, FULL));
                        let effective = now + UPDATE_CYCLES * self.cycle;
                        self.prescaler.start(effective);
                        self.reload.start(effective);
                    }
                    _ => {}
                }
            }
            0x04 if self.unlocked => self.prescaler.write(value & 7, now, effective),
            0x08 if self.unlocked => self.reload.write(value & FULL, now, effective),
            0x04 | 0x08 | 0x0c => {}
            _ => return None,
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peripherals::testing::Bench;
    use crate::time::milliseconds;

    const LSI: u32 = 40_000;

    fn started(prescaler: u32, reload: u32) -> (Iwdg, Bench, Ticks) {
        let (mut iwdg, mut bench) = (Iwdg::new(LSI), Bench::default());
        for (offset, value) in [(0, 0x5555), (4, prescaler), (8, reload), (0, 0xcccc)] {
            iwdg.write(offset, value, &mut bench.at(0));
        }
        let now = milliseconds(1);
        iwdg.write(0, 0xaaaa, &mut bench.at(now));
        (iwdg, bench, now)
    }

    /// 19.3, table of time-outs at 40 kHz: PR 0 0.1 to 409.6 ms, PR 6 6.4 to 26214.4 ms.
    #[test]
    fn the_time_outs_are_the_tables() {
        for (prescaler, reload, microseconds) in [
            (0, 0, 100),
            (0, 0xfff, 409_600),
            (3, 0, 800),
            (3, 0xfff, 3_276_800),
            (6, 0, 6_400),
            (6, 0xfff, 26_214_400),
            (7, 0xfff, 26_214_400),
        ] {
            let (iwdg, _, now) = started(prescaler, reload);
            let expected = now + crate::time::microseconds(microseconds);
            assert_eq!(iwdg.expires(), Some(expected), "{prescaler} {reload}");
        }
    }

    #[test]
    fn the_first_period_is_the_longest_whatever_the_reload_value() {
        let (mut iwdg, mut bench) = (Iwdg::new(LSI), Bench::default());
        assert_eq!(iwdg.expires(), None);
        for (offset, value) in [(0, 0x5555), (8, 999), (0, 0xaaaa), (0, 0xcccc)] {
            iwdg.write(offset, value, &mut bench.at(0));
        }
        assert_eq!(iwdg.expires(), Some(crate::time::microseconds(409_600)));
    }

    #[test]
    fn reloading_begins_a_new_period() {
        let (mut iwdg, mut bench, _) = started(0, 999);
        let now = milliseconds(70);
        iwdg.write(0, 0xaaaa, &mut bench.at(now));
        assert_eq!(iwdg.expires(), Some(now + milliseconds(100)));
    }

    #[test]
    fn locked_registers_keep_their_values() {
        let (mut iwdg, mut bench, now) = started(0, 999);
        iwdg.write(8, 0xfff, &mut bench.at(now));
        iwdg.write(4, 6, &mut bench.at(now));
        let now = now + milliseconds(1);
        assert_eq!((iwdg.read(4, now), iwdg.read(8, now)), (Some(0), Some(999)));
    }

    #[test]
    fn an_update_takes_its_time() {
        let (mut iwdg, mut bench, now) = started(0, 999);
        iwdg.write(0, 0x5555, &mut bench.at(now));
        iwdg.write(8, 500, &mut bench.at(now));
        assert_eq!(
            (iwdg.read(0xc, now), iwdg.read(8, now)),
            (Some(2), Some(999))
        );
        let later = now + milliseconds(1);
        assert_eq!(
            (iwdg.read(0xc, later), iwdg.read(8, later)),
            (Some(0), Some(500))
        );
    }
}
