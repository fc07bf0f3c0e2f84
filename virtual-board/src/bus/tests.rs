use super::*;
use crate::memory::{RAM_START, Ram};
use crate::options::BoardOptions;
use crate::record::ResetReason;
use crate::time::microseconds;

const RCC: u32 = 0x4002_1000;
const TIM2: u32 = 0x4000_0000;
const TIM3: u32 = 0x4000_0400;
const GPIOA: u32 = 0x4001_0800;
const ADC1: u32 = 0x4001_2400;
const DMA1: u32 = 0x4002_0000;

struct Rig {
    shared: SharedChip,
    ram: Ram,
    now: Ticks,
}

impl Rig {
    fn new() -> Self {
        let ram = Ram::default();
        let options = BoardOptions::new("linear?noise=none&seed=7".parse().unwrap());
        let mut chip = Chip::new(&options, ram.clone(), &[]).unwrap();
        chip.reset(ResetReason::PowerOn, false, 0);
        Self {
            shared: SharedChip::new(chip),
            ram,
            now: 0,
        }
    }

    fn write(&self, address: u32, value: u32) {
        self.shared.set_now(self.now);
        self.shared.write(address, 4, value);
    }

    fn read(&self, address: u32) -> u32 {
        self.shared.set_now(self.now);
        self.shared.read(address, 4)
    }

    fn run(&mut self, us: u64) {
        self.now += microseconds(us);
        self.shared.lock().advance(self.now);
    }

    fn reported(&self) -> Vec<Irregularity> {
        let mut chip = self.shared.lock();
        chip.record.violations.drain(..).map(|v| v.what).collect()
    }
}

#[test]
fn an_address_where_nothing_is() {
    let rig = Rig::new();
    for address in [0x4000_7400, 0x4002_3000, TIM2 + 0x30, 0xe004_2008] {
        rig.shared.lock().write_word(RCC + 0x1c, 1, 0);
        assert_eq!(rig.read(address), 0);
        assert_eq!(
            rig.reported(),
            [Irregularity::Unmapped(address)],
            "{address:#x}"
        );
    }
}

#[test]
fn a_unit_without_its_clock_hears_nothing() {
    let rig = Rig::new();
    rig.write(TIM2 + 0x2c, 99);
    let address = TIM2 + 0x2c;
    assert_eq!(rig.reported(), [Irregularity::Unclocked(address)]);
    rig.write(RCC + 0x1c, 1);
    assert_eq!(rig.read(TIM2 + 0x2c), 0);
    rig.write(TIM2 + 0x2c, 99);
    assert_eq!(rig.read(TIM2 + 0x2c), 99);
    assert_eq!(rig.reported(), []);
}

#[test]
fn a_reset_bit_resets_its_unit_only() {
    let rig = Rig::new();
    rig.write(RCC + 0x1c, 3);
    rig.write(TIM2 + 0x2c, 99);
    rig.write(TIM3 + 0x2c, 99);
    rig.write(RCC + 0x10, 1);
    rig.write(RCC + 0x10, 0);
    assert_eq!((rig.read(TIM2 + 0x2c), rig.read(TIM3 + 0x2c)), (0, 99));
}

#[test]
fn less_than_a_register_is_reported() {
    let rig = Rig::new();
    rig.write(RCC + 0x1c, 1);
    // Timers have registers of half a word (15.4).
    rig.shared.write(TIM2 + 0x2c, 2, 99);
    assert_eq!(rig.shared.read(TIM2 + 0x2c, 2), 99);
    assert_eq!(rig.reported(), []);
    for (address, bytes) in [
        (RCC + 0x18, 2),
        (RCC + 1, 1),
        (TIM2 + 0x2c, 1),
        (TIM2 + 0x2e, 2),
    ] {
        rig.shared.read(address, bytes);
        assert_eq!(rig.reported(), [Irregularity::Narrow(address)]);
    }
}

#[test]
fn the_unique_number_may_be_read_by_bytes() {
    let rig = Rig::new();
    let bytes: Vec<u8> = (0..12)
        .map(|n| rig.shared.read(0x1fff_f7e8 + n, 1) as u8)
        .collect();
    // Behind the letters the gain of its sensor, 1.
    assert_eq!(bytes, b"virt\0\0\0\0\0\0\xf0\x3f");
    assert_eq!(rig.read(0x1fff_f7e8), u32::from_le_bytes(*b"virt"));
    assert_eq!(rig.reported(), []);
}

/// The whole chain at 8 MHz, set up register by register: TIM2 at 1 MHz with a period of 200 µs and
/// a pulse of 30, TIM3 started by it with a period of 100 and a head start of 50, one conversion of
/// channel 4 each, DMA into a ring of four.
fn chain(rig: &mut Rig) {
    rig.write(RCC + 0x14, 0x15);
    rig.write(RCC + 0x18, 1 << 9 | 1 << 2 | 1);
    rig.write(RCC + 0x1c, 3);
    for (tim, arr) in [(TIM2, 199), (TIM3, 99)] {
        rig.write(tim + 0x28, 7);
        rig.write(tim + 0x2c, arr);
    }
    rig.write(TIM2 + 0x18, 0b110 << 12 | 1 << 11);
    rig.write(TIM2 + 0x20, 1 << 4);
    for tim in [TIM2, TIM3] {
        rig.write(tim + 0x14, 1);
    }
    // Preloaded: or the line would be high as soon as the pin is the timer's.
    rig.write(TIM2 + 0x38, 30);
    rig.write(TIM2 + 0x04, 1 << 4);
    rig.write(TIM3 + 0x24, 50);
    rig.write(TIM3 + 0x04, 2 << 4);
    rig.write(TIM3 + 0x08, 1 << 4);
    rig.write(TIM3 + 0x08, 1 << 4 | 6);
    rig.write(GPIOA, 0x4440_44a4 | 1 << 4);
    rig.write(ADC1 + 0x08, 1);
    rig.run(2);
    for calibration in [1 | 1 << 3, 1 | 1 << 2] {
        rig.write(ADC1 + 0x08, calibration);
        rig.run(100);
        assert_eq!(rig.read(ADC1 + 0x08), 1);
    }
    rig.write(ADC1 + 0x34, 4);
    rig.write(DMA1 + 0x0c, 4);
    rig.write(DMA1 + 0x10, ADC1 + 0x4c);
    rig.write(DMA1 + 0x14, RAM_START + 0x100);
    rig.write(DMA1 + 0x08, 1 << 10 | 1 << 8 | 1 << 7 | 1 << 5 | 1);
    rig.write(ADC1 + 0x08, 1 | 1 << 8 | 4 << 17 | 1 << 20);
}

#[test]
fn one_write_starts_pulses_and_samples_in_step() {
    let mut rig = Rig::new();
    chain(&mut rig);
    rig.run(1_000);
    assert!(rig.shared.lock().record.pulses.is_empty());
    let start = rig.now;
    rig.write(TIM2, 1 << 7 | 1);
    rig.run(600);
    let chip = rig.shared.lock();
    let rises: Vec<Ticks> = chip.record.pulses.iter().map(|p| p.rise - start).collect();
    assert_eq!(rises, [200, 400].map(microseconds));
    assert!(
        chip.record
            .pulses
            .iter()
            .all(|p| p.width == microseconds(30))
    );
    let starts: Vec<Ticks> = chip
        .record
        .conversions
        .iter()
        .map(|c| c.start - start)
        .collect();
    // Three cycles of the ADC, which has half of 8 MHz.
    let expected = [50, 150, 250, 350, 450, 550].map(|us| microseconds(us) + microseconds(3) / 4);
    assert_eq!(starts, expected);
    // Six conversions into a ring of four: the memory holds the third to the sixth.
    let codes: Vec<u32> = chip
        .record
        .conversions
        .iter()
        .map(|c| c.code.into())
        .collect();
    let ring: Vec<u32> = (0..4)
        .map(|n| rig.ram.read(RAM_START + 0x100 + 2 * n, 2).unwrap())
        .collect();
    assert_eq!(ring, [codes[4], codes[5], codes[2], codes[3]]);
    drop(chip);
    assert_eq!(rig.reported(), []);
}

#[test]
fn a_pin_that_is_not_the_timers_makes_no_pulse() {
    let mut rig = Rig::new();
    chain(&mut rig);
    rig.write(GPIOA, 0x4440_4414); // an output of the port
    rig.write(TIM2, 1 << 7 | 1);
    rig.run(1_000);
    assert_eq!(rig.shared.lock().record.pulses, []);
    // And the ADC's pin is still analog.
    assert_eq!(rig.reported(), []);
}

#[test]
fn a_reset_cuts_the_pulse_and_stops_everything() {
    let mut rig = Rig::new();
    chain(&mut rig);
    rig.write(TIM2, 1 << 7 | 1);
    let start = rig.now;
    rig.run(210);
    let now = rig.now;
    rig.shared.lock().reset(ResetReason::Watchdog, false, now);
    rig.run(1_000);
    let chip = rig.shared.lock();
    let last = chip.record.pulses.last().unwrap();
    assert_eq!(
        (last.rise - start, last.width),
        (microseconds(200), microseconds(10))
    );
    assert_eq!(chip.next_event(), None);
}

/// A program that switches the channel off and leaves the pin to it does not know what the pin does.
#[test]
fn a_pin_that_its_timer_lets_go_is_reported() {
    let mut rig = Rig::new();
    chain(&mut rig);
    rig.write(TIM2, 1 << 7 | 1);
    rig.run(210);
    rig.write(TIM2 + 0x18, 0b100 << 12 | 1 << 11); // forced inactive: low, and driven
    assert_eq!(rig.shared.lock().high_for(rig.now), None);
    assert_eq!(rig.reported(), []);
    rig.write(TIM2 + 0x20, 0);
    assert_eq!(rig.reported().len(), 1);
}

#[test]
fn a_line_without_its_resistor_floats_by_chance() {
    let high = |pull_down: bool| {
        (0..20).filter(move |seed| {
            let servo = format!("linear?noise=none&seed={seed}");
            let mut options = BoardOptions::new(servo.parse().unwrap());
            options.pull_down = pull_down;
            let mut chip = Chip::new(&options, Ram::default(), &[]).unwrap();
            chip.reset(ResetReason::PowerOn, false, 0);
            chip.high_for(0).is_some()
        })
    };
    assert_eq!(high(true).count(), 0);
    assert!((1..20).contains(&high(false).count()));
}
