use super::offset::*;
use super::*;
use crate::peripherals::testing::Bench;

/// 12 MHz.
const CLOCK: Ticks = 4_800;

struct Rig {
    adc: Adc,
    bench: Bench,
    now: Ticks,
}

impl Rig {
    fn new() -> Self {
        let mut rig = Self {
            adc: Adc::new(CLOCK),
            bench: Bench::default(),
            now: 1_000_000,
        };
        rig.bench.0.keeps_signals = true;
        rig
    }

    fn write(&mut self, offset: u32, value: u32) {
        self.adc
            .write(offset, value, &mut self.bench.at(self.now))
            .unwrap();
    }

    fn read(&mut self, offset: u32) -> u32 {
        self.adc.read(offset, self.now).unwrap()
    }

    /// On, calibrated, and listening to TIM3, with `length` conversions of channel 4.
    fn ready(length: u32) -> Self {
        let mut rig = Self::new();
        rig.write(CR2, 1);
        rig.now += STABILISATION;
        for n in [RSTCAL, CAL] {
            rig.write(CR2, 1 | 1 << n);
            assert!(bit(rig.read(CR2), n));
            rig.now += CALIBRATION * CLOCK;
            assert!(!bit(rig.read(CR2), n));
        }
        rig.write(CR1, 1 << SCAN);
        rig.write(SMPR2, 0b111 << 12);
        rig.write(SQR1, (length - 1) << 20);
        rig.write(SQR3, (0..6).fold(0, |w, n| w | 4 << (5 * n)));
        rig.write(CR2, 1 | 1 << DMA | TIM3_TRGO << 17 | 1 << EXTTRIG);
        rig.now += 1_000;
        rig
    }

    fn trigger(&mut self) {
        self.adc.trigger_by_tim3(0, &mut self.bench.at(self.now));
    }

    /// Runs until nothing is left to do; each input has the code of its number. Times of the DMA
    /// requests, with what was read.
    fn run(&mut self) -> Vec<(Ticks, u32)> {
        let (mut requests, mut code) = (Vec::new(), 0);
        while let Some(now) = self.adc.next_event() {
            self.now = now;
            match self.adc.advance(&mut self.bench.at(now)) {
                Event::None => {}
                Event::Hold { channel, index, .. } => {
                    assert_eq!((channel, index), (4, u32::from(code) % 4));
                    code += 1;
                    self.adc.hold(code);
                }
                Event::DmaRequest => requests.push((now, self.adc.read_data())),
            }
        }
        requests
    }
}

/// 11.6: a conversion takes the sampling time and 12.5 cycles; 239.5 + 12.5 = 252.
#[test]
fn a_scan_converts_one_after_the_other() {
    let mut rig = Rig::ready(4);
    let start = rig.now + TRIGGER_LATENCY * CLOCK;
    rig.trigger();
    let expected: Vec<_> = (1..=4u32)
        .map(|n| (start + Ticks::from(n) * 252 * CLOCK, n))
        .collect();
    assert_eq!(rig.run(), expected);
    let held: Vec<_> = rig
        .bench
        .0
        .conversions
        .iter()
        .map(|c| c.held - start)
        .collect();
    assert_eq!(
        held,
        [0, 1, 2, 3].map(|n| n * 252 * CLOCK + 479 * CLOCK / 2)
    );
    assert_eq!(rig.bench.reported(), []);
}

/// 11.12.4: every sampling time.
#[test]
fn sampling_times() {
    let cycles_of_14 = [14, 20, 26, 41, 54, 68, 84, 252];
    for (code, cycles) in (0..).zip(cycles_of_14) {
        let mut rig = Rig::ready(1);
        rig.write(SMPR2, code << 12);
        let start = rig.now + TRIGGER_LATENCY * CLOCK;
        rig.trigger();
        assert_eq!(rig.run(), [(start + cycles * CLOCK, 1)], "{code}");
    }
}

#[test]
fn a_trigger_while_busy_is_lost_and_reported() {
    let mut rig = Rig::ready(4);
    rig.trigger();
    rig.now += 252 * CLOCK;
    rig.trigger();
    assert_eq!(rig.bench.reported(), [Irregularity::TriggerWhileBusy]);
    assert_eq!(rig.run().len(), 4);
    rig.trigger();
    assert_eq!(rig.run().len(), 4);
}

#[test]
fn nothing_starts_without_its_trigger_being_enabled() {
    for cr2 in [
        1 | 1 << DMA | TIM3_TRGO << 17,               // EXTTRIG missing
        1 | 1 << DMA | 1 << EXTTRIG | SOFTWARE << 17, // another source
        1 << DMA | 1 << EXTTRIG | TIM3_TRGO << 17,    // off
    ] {
        let mut rig = Rig::ready(4);
        rig.write(CR2, cr2);
        rig.trigger();
        assert_eq!(rig.adc.next_event(), None, "{cr2:#x}");
    }
}

/// 11.12.3, note at ADON: the same value once more starts a conversion; any other change does not.
#[test]
fn writing_adon_again_starts_a_conversion() {
    let mut rig = Rig::ready(1);
    let cr2 = rig.read(CR2);
    rig.write(CR2, cr2 ^ 1 << DMA);
    assert_eq!(rig.adc.next_event(), None);
    rig.write(CR2, cr2);
    assert_eq!(rig.adc.next_event(), None);
    rig.write(CR2, cr2);
    assert_eq!(rig.bench.reported(), [Irregularity::StartedBySoftware]);
    assert_eq!(rig.run().len(), 1);
}

/// The writes that begin a calibration change CAL or RSTCAL, so they start nothing.
#[test]
fn a_calibration_is_no_conversion() {
    let rig = Rig::ready(1);
    assert_eq!(rig.adc.next_event(), None);
    assert!(rig.bench.0.violations.is_empty());
}

#[test]
fn what_the_manual_forbids_is_reported() {
    let mut rig = Rig::new();
    rig.write(CR2, 1);
    rig.write(CR2, 1 | 1 << CAL); // at once
    assert_eq!(rig.bench.reported().len(), 1);
    let mut rig = Rig::new();
    rig.write(CR2, 1 | TIM3_TRGO << 17 | 1 << EXTTRIG);
    rig.trigger(); // within tSTAB, and uncalibrated
    assert_eq!(rig.bench.reported().len(), 2);
    let mut rig = Rig::ready(1);
    rig.adc.set_clock(3_600); // 16 MHz
    rig.trigger();
    assert_eq!(rig.bench.reported().len(), 1);
}

/// 11.12.1: EOC is set at the end of the group, and cleared by reading the data.
#[test]
fn end_of_conversion() {
    let mut rig = Rig::ready(1);
    rig.write(CR2, 1 | TIM3_TRGO << 17 | 1 << EXTTRIG);
    rig.write(CR1, 1 << 5);
    rig.trigger();
    assert_eq!(rig.run(), []);
    assert!(rig.adc.interrupt());
    assert_eq!(rig.read(DR), 1);
    assert!(!rig.adc.interrupt());
    for _ in 0..2 {
        rig.trigger();
        rig.run();
    }
    assert_eq!(rig.bench.reported().len(), 1, "a result that nobody read");
}

/// 11.3.9, 11.10 and 11.12.12: the internal reference voltage, started by software.
#[test]
fn an_injected_conversion_has_its_own_result() {
    let mut rig = Rig::ready(1);
    let cr2 = rig.read(CR2);
    let on = cr2 | 1 << TSVREFE | SOFTWARE << 12 | 1 << JEXTTRIG;
    rig.write(SMPR1, 0b111 << 21);
    rig.write(JSQR, 17 << 15);
    rig.write(CR2, on);
    rig.write(CR2, on | 1 << JSWSTART);
    assert_eq!(rig.read(CR2), on);
    let start = rig.now + TRIGGER_LATENCY * CLOCK;
    rig.now = rig.adc.next_event().unwrap();
    let held = rig.adc.advance(&mut rig.bench.at(rig.now));
    let expected = Event::Hold {
        channel: 17,
        index: 0,
        sampled: 479 * CLOCK / 2,
    };
    assert_eq!(held, expected);
    rig.adc.hold(1_500);
    rig.now = rig.adc.next_event().unwrap();
    assert_eq!(rig.now, start + 252 * CLOCK);
    assert_eq!(rig.adc.advance(&mut rig.bench.at(rig.now)), Event::None);
    assert_eq!((rig.read(SR) & JEOC, rig.read(JDR1)), (JEOC, 1_500));
    assert_eq!(rig.bench.reported(), []);
    // Too short, and without the reference.
    rig.write(SMPR1, 0);
    rig.write(CR2, cr2 | SOFTWARE << 12 | 1 << JEXTTRIG | 1 << JSWSTART);
    assert_eq!(rig.bench.reported().len(), 2);
}

/// 11.3.9 and 11.7: channel 1 of TIM2 starts it, and software then does not.
#[test]
fn an_injected_conversion_may_wait_for_a_timer() {
    let mut rig = Rig::ready(1);
    let cr2 = rig.read(CR2) | TIM2_CC1 << 12;
    rig.write(JSQR, 4 << 15);
    rig.write(CR2, cr2);
    rig.adc
        .trigger_by_tim2_channel_1(&mut rig.bench.at(rig.now));
    assert_eq!(rig.adc.next_event(), None, "JEXTTRIG is missing");
    let on = cr2 | 1 << JEXTTRIG;
    rig.write(CR2, on);
    rig.write(CR2, on | 1 << JSWSTART);
    assert_eq!(rig.adc.next_event(), None);
    rig.adc
        .trigger_by_tim2_channel_1(&mut rig.bench.at(rig.now));
    let held = rig.now + TRIGGER_LATENCY * CLOCK + 479 * CLOCK / 2;
    assert_eq!(rig.adc.next_event(), Some(held));
    assert_eq!(rig.bench.reported(), []);
}
