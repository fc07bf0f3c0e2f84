use super::offset::*;
use super::*;
use crate::peripherals::testing::Bench;

/// A cycle of 72 MHz.
const CLOCK: Ticks = 800;
/// With a prescaler of 71, a microsecond.
const US: Ticks = 72 * CLOCK;

struct Rig {
    tim: Tim,
    bench: Bench,
    now: Ticks,
}

impl Rig {
    fn new() -> Self {
        Self {
            tim: Tim::new(CLOCK),
            bench: Bench::default(),
            now: 100_000,
        }
    }

    fn write(&mut self, offset: u32, value: u32) -> bool {
        let trigger = self.tim.write(offset, value, &mut self.bench.at(self.now));
        trigger.unwrap()
    }

    fn read(&self, offset: u32) -> u32 {
        self.tim.read(offset, self.now).unwrap()
    }

    /// Runs to `now`; the times of the triggers that went out.
    fn run_to(&mut self, now: Ticks) -> Vec<Ticks> {
        let mut triggers = Vec::new();
        while let Some(event) = self.tim.next_event().filter(|&event| event <= now) {
            if self.tim.advance(event) {
                triggers.push(event);
            }
        }
        self.now = now;
        triggers
    }
}

/// 15.3.2: from 0 to the reload value, which lasts one count as well.
#[test]
fn the_period_is_reload_plus_one_times_prescaler_plus_one() {
    let mut rig = Rig::new();
    rig.write(PSC, 71);
    rig.write(ARR, 1_999);
    rig.write(EGR, 1);
    rig.write(CR2, 0b010 << 4);
    let start = rig.now;
    rig.write(CR1, 1);
    let expected: Vec<Ticks> = (1..=3).map(|n| start + n * 2_000 * US).collect();
    assert_eq!(rig.run_to(start + 7_000 * US), expected);
    assert_eq!(rig.read(CNT), 1_000);
    assert_eq!(rig.bench.reported(), []);
}

/// 15.4.11: the prescaler's shadow is loaded at each update event.
#[test]
fn a_new_prescaler_waits_for_the_update() {
    let mut rig = Rig::new();
    rig.write(ARR, 99);
    rig.write(CR1, 1);
    rig.write(PSC, 9);
    let start = rig.now;
    rig.run_to(start + 50 * CLOCK);
    assert_eq!(rig.read(CNT), 50);
    rig.run_to(start + 100 * CLOCK + 50 * 10 * CLOCK);
    assert_eq!(rig.read(CNT), 50);
}

/// 15.3.9, 15.4.7: PWM mode 1 is active while the count is below the compare value.
#[test]
fn pwm_is_high_from_the_update_to_the_match() {
    let mut rig = Rig::new();
    rig.write(ARR, 99);
    rig.write(CCMR1, 0b110 << 12 | 1 << 11);
    rig.write(CCR1 + 4, 30);
    rig.write(CCER, 1 << 4);
    rig.write(CR1, 1 << 7);
    rig.write(EGR, 1);
    let start = rig.now;
    rig.write(CR1, 1 << 7 | 1);
    let mut levels = Vec::new();
    for count in 0..200 {
        rig.run_to(start + count * CLOCK);
        levels.push(rig.tim.output(2, rig.now).unwrap());
    }
    let expected: Vec<bool> = (0..200).map(|count| count % 100 < 30).collect();
    assert_eq!(levels, expected);
    assert_eq!(rig.tim.output(1, rig.now), None, "not enabled");
}

/// 15.4.14: a preloaded compare value takes effect at the next update event, and no earlier.
#[test]
fn a_preloaded_compare_value_waits_for_the_update() {
    let mut rig = Rig::new();
    rig.write(ARR, 99);
    rig.write(CCMR1, 0b110 << 12 | 1 << 11);
    rig.write(CCER, 1 << 4);
    rig.write(CCR1 + 4, 30);
    rig.write(EGR, 1);
    let start = rig.now;
    rig.write(CR1, 1);
    rig.run_to(start + 10 * CLOCK);
    rig.write(CCR1 + 4, 60);
    assert_eq!(rig.read(CCR1 + 4), 60, "reads what was written");
    rig.run_to(start + 40 * CLOCK);
    assert_eq!(rig.tim.output(2, rig.now), Some(false));
    rig.run_to(start + 140 * CLOCK);
    assert_eq!(rig.tim.output(2, rig.now), Some(true));
    // 0 is no pulse at all.
    rig.write(CCR1 + 4, 0);
    rig.run_to(start + 200 * CLOCK);
    assert_eq!(rig.tim.output(2, rig.now), Some(false));
}

#[test]
fn a_compare_value_without_preload_may_cut_the_pulse_and_is_reported() {
    let mut rig = Rig::new();
    rig.write(ARR, 99);
    rig.write(CCMR1, 0b110 << 12);
    rig.write(CCER, 1 << 4);
    rig.write(CR1, 1);
    assert_eq!(rig.bench.reported(), []);
    rig.write(CCR1 + 4, 60);
    assert_eq!(rig.bench.reported().len(), 1);
    assert_eq!(rig.tim.output(2, rig.now), Some(true));
}

/// 15.4.1, 15.4.5, 15.4.6: UG reloads; with URS it sets no flag; flags are cleared by 0.
#[test]
fn flags() {
    let mut rig = Rig::new();
    rig.write(ARR, 99);
    rig.write(CR1, 1 << 2);
    rig.write(EGR, 1);
    assert_eq!(rig.read(SR) & UIF, 0);
    rig.write(CR1, 0);
    rig.write(EGR, 1);
    assert_eq!(rig.read(SR) & UIF, UIF);
    rig.write(SR, !UIF);
    assert_eq!(rig.read(SR) & UIF, 0);
    rig.write(CCR1 + 8, 10);
    rig.write(CR1, 1);
    rig.run_to(rig.now + 20 * CLOCK);
    assert_eq!(rig.read(SR) & 0x1f, 1 << 3, "channel 3 matched");
    assert!(!rig.tim.interrupt());
    rig.write(DIER, 1 << 3);
    assert!(rig.tim.interrupt());
    rig.write(SR, u32::MAX);
    assert!(rig.tim.interrupt(), "1 leaves the flag");
    rig.write(SR, 0);
    assert!(!rig.tim.interrupt());
}

/// 15.4.2: with MMS = 000 UG is the trigger output, with 001 the enable, with 010 the update event
/// (by UG as well).
#[test]
fn the_trigger_output() {
    for (mode, by_generation, by_start, by_overflow) in [
        (0b000, true, false, false),
        (0b001, false, true, false),
        (0b010, true, false, true),
    ] {
        let mut rig = Rig::new();
        rig.write(ARR, 99);
        rig.write(CR2, mode << 4);
        assert_eq!(rig.write(EGR, 1), by_generation, "{mode:03b}");
        assert_eq!(rig.write(CR1, 1), by_start, "{mode:03b}");
        assert_eq!(
            !rig.run_to(rig.now + 100 * CLOCK).is_empty(),
            by_overflow,
            "{mode:03b}"
        );
    }
}

/// 15.3.14, trigger mode: the counter starts at the trigger from where it stands.
#[test]
fn a_trigger_starts_the_slave_from_its_preset_count() {
    let mut rig = Rig::new();
    rig.write(PSC, 71);
    rig.write(ARR, 1_999);
    rig.write(EGR, 1);
    rig.write(CNT, 1_500);
    rig.write(CR2, 0b010 << 4);
    rig.write(SMCR, 0b001 << 4);
    assert!(!rig.tim.trigger(1, rig.now), "no slave mode yet");
    rig.write(SMCR, 0b001 << 4 | 0b110);
    let start = rig.now + 500_000;
    assert!(rig.run_to(start).is_empty());
    assert!(!rig.tim.trigger(0, start), "another input");
    assert_eq!(rig.tim.next_event(), None);
    assert!(!rig.tim.trigger(1, start));
    assert_eq!(rig.read(SR) & TIF, TIF);
    let triggers = rig.run_to(start + 3_000 * US);
    assert_eq!(triggers, [start + 500 * US, start + 2_500 * US]);
}

/// 15.3.1: stopping keeps the count, OPM stops at the update.
#[test]
fn stopping() {
    let mut rig = Rig::new();
    rig.write(ARR, 99);
    rig.write(CR1, 1);
    rig.run_to(rig.now + 40 * CLOCK);
    rig.write(CR1, 0);
    rig.run_to(rig.now + 1_000 * CLOCK);
    assert_eq!(rig.read(CNT), 40);
    rig.write(CR1, 1 | 1 << OPM);
    rig.run_to(rig.now + 1_000 * CLOCK);
    assert_eq!((rig.read(CNT), rig.read(CR1) & 1), (0, 0));
}

#[test]
fn what_is_not_modelled_is_reported() {
    for (offset, value) in [
        (CR1, 1 << 4),
        (CR1, 1 << 5),
        (CR2, 0b100 << 4),
        (SMCR, 0b100),
        (DIER, 1 << 8),
        (CCMR1, 0b01),
        (CCMR2, 0b011 << 4),
    ] {
        let mut rig = Rig::new();
        rig.write(offset, value);
        assert!(!rig.bench.reported().is_empty(), "{offset:#x} {value:#x}");
    }
}

/// 15.3.12, external clock mode 1.
#[test]
fn a_counter_of_triggers_counts_them_and_wraps() {
    let mut rig = Rig::new();
    rig.write(ARR, 2);
    rig.write(SMCR, 2 << 4 | 0b111);
    assert!(!rig.tim.trigger(2, rig.now), "not enabled");
    rig.write(CR1, 1);
    rig.run_to(rig.now + 1_000 * US);
    assert_eq!(rig.read(CNT), 0, "time does not count");
    let counts: Vec<u32> = (0..4)
        .map(|_| {
            rig.tim.trigger(1, rig.now);
            rig.tim.trigger(2, rig.now);
            rig.read(CNT)
        })
        .collect();
    assert_eq!(counts, [1, 2, 0, 1]);
    assert_eq!(rig.bench.reported(), []);
}

/// 31.16.2.
#[test]
fn a_timer_that_a_debugger_stops_stands_still() {
    let mut rig = Rig::new();
    rig.write(PSC, 71);
    rig.write(ARR, 1_999);
    rig.write(EGR, 1);
    rig.write(CR1, 1);
    rig.run_to(rig.now + 500 * US);
    rig.tim.freeze(rig.now);
    rig.run_to(rig.now + 5_000 * US);
    assert_eq!((rig.read(CNT), rig.tim.next_event()), (500, None));
}
