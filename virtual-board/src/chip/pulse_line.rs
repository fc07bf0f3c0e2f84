//! The pulse line, PA1: what drives it, and what holds it while nothing does.

use super::Chip;
use crate::peripherals::gpio::Mode;
use crate::record::{Pulse, Undriven};
use crate::time::Ticks;
use rand::RngExt;

impl Chip {
    /// How long PA1 has been high, if it is.
    pub fn high_for(&self, now: Ticks) -> Option<Ticks> {
        self.high_since.map(|rise| now - rise)
    }

    /// What drives PA1: TIM2's channel 2 where pin and mapping make it so, or the pin's own data; `None` for nothing.
    fn pulse_line(&mut self, now: Ticks) -> Option<bool> {
        let [port_a, ..] = &self.p.gpio;
        match port_a.mode(1) {
            Mode::AlternatePushPull if self.p.afio.tim2_channel_2_is_on_pa1() => {
                let level = self.p.tim2.output(2, now);
                let released = level.is_none() && self.is_driven();
                // What it then does is nowhere said.
                self.moment(now)
                    .against_manual(released, "PA1 as the output of a channel that is off");
                level
            }
            Mode::Output => Some(port_a.level(1)),
            _ => None,
        }
    }

    /// Whether something drove PA1 until now.
    fn is_driven(&self) -> bool {
        let last = self.record.undriven.last();
        last.is_some_and(|undriven| undriven.to.is_some())
    }

    /// Updates PA1.
    pub(crate) fn follow_pulse(&mut self, now: Ticks) {
        let line = self.pulse_line(now);
        match line {
            None if self.record.undriven.is_empty() || self.is_driven() => {
                self.floating = !self.pull_down && self.chance.random_bool(0.5);
                let begins = Undriven {
                    from: now,
                    to: None,
                };
                self.record.undriven.push(begins);
            }
            Some(_) => {
                if let Some(last) = self.record.undriven.last_mut() {
                    last.to.get_or_insert(now);
                }
            }
            None => {}
        }
        let level = line.unwrap_or(self.floating);
        if let Some(wire) = &mut self.loop_wire {
            wire.follow(level, now);
        }
        match (level, self.high_since) {
            (true, None) => self.high_since = Some(now),
            (false, Some(rise)) => {
                self.high_since = None;
                let pulse = Pulse {
                    rise,
                    width: now - rise,
                };
                self.plant.pulse(pulse);
                self.record.pulse(pulse);
            }
            _ => {}
        }
    }
}
