//! The chip around the core: the peripherals, and the wires between them.
//!
//! ```text
//!  TIM2 --TRGO--> ITR1 TIM3 --TRGO--> ADC1 --request--> DMA1 channel 1 --> memory
//!   | CH2                 `--> TIM4   ^ IN4
//!  PA1 --> servo --> shaft --> sensor --> PA4        PA9, PA10 <--> USART1 <--> line
//! ```
//!
//! Events happen at their exact times, in order. Simultaneous events happen in the order TIM2, TIM3, ADC, USART, line,
//! so a frame edge comes before the sample that it triggers.

mod pulse_line;
mod sampling_capacitor;

use crate::bootloader::{self, Bootloader, End, Memories};
use crate::fault::Fault;
use crate::flash_memory::FlashMemory;
use crate::line::{BIT, Line};
use crate::loop_wire::LoopWire;
use crate::memory::{RAM_START, Ram};
use crate::options::BoardOptions;
use crate::peripherals::Moment;
use crate::peripherals::adc::{Adc, Event};
use crate::peripherals::afio::Afio;
use crate::peripherals::dbgmcu::Dbgmcu;
use crate::peripherals::dma::{Dma, Transfer};
use crate::peripherals::exti::Exti;
use crate::peripherals::flash::Flash;
use crate::peripherals::gpio::{Gpio, Mode};
use crate::peripherals::iwdg::Iwdg;
use crate::peripherals::pwr::Pwr;
use crate::peripherals::rcc::{Rcc, Sources};
use crate::peripherals::signature::Signature;
use crate::peripherals::tim::{Tim, TriggerOutput};
use crate::peripherals::usart::{self, Usart};
use crate::plant::Plant;
use crate::record::{Irregularity, Record, ResetReason};
use crate::supply::Supply;
use crate::time::Ticks;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sampling_capacitor::SamplingCapacitor;
use servoid_simulator::OptionsError;

/// Interrupt positions (RM0008 10.1.2, vector table); the other DMA channels follow the first.
mod irq {
    pub const PVD: u32 = 1;
    pub const DMA1_CHANNEL1: u32 = 11;
    pub const ADC1_2: u32 = 18;
    pub const TIM2: u32 = 28;
    pub const TIM3: u32 = 29;
    pub const USART1: u32 = 37;
}

/// The address of ADC1's data register, the only one that is read by DMA here.
const ADC1_DR: u32 = 0x4001_244c;
/// TIM3's internal trigger input that TIM2 is connected to (15.4.3, table of internal triggers).
const TIM2_AT_TIM3: u32 = 1;
/// TIM2's and TIM4's internal trigger input that TIM3 is connected to.
const TIM3_AT_OTHERS: u32 = 2;
/// The ADC's channel of the internal reference voltage (11.10).
const VREFINT: u32 = 17;
/// The internal reference voltage of one chip (mV; DS5319: 1.16 to 1.24 V).
const BANDGAP: u64 = 1_210;
/// The voltage that the codes of the sensor refer to (mV).
const FULL_SCALE: u64 = 3_300;

/// All models that a reset resets.
#[derive(Debug)]
pub(crate) struct Peripherals {
    pub flash: Flash,
    pub afio: Afio,
    /// Ports A to E.
    pub gpio: [Gpio; 5],
    pub tim2: Tim,
    pub tim3: Tim,
    pub tim4: Tim,
    pub pwr: Pwr,
    pub exti: Exti,
    pub adc: Adc,
    pub dma: Dma,
    pub usart: Usart,
    pub iwdg: Iwdg,
    pub dbgmcu: Dbgmcu,
}

impl Peripherals {
    fn new(rcc: &Rcc, lsi_hz: u32, dbgmcu: Dbgmcu) -> Self {
        let clocks = rcc.clocks();
        Self {
            flash: Flash::default(),
            afio: Afio::default(),
            gpio: Default::default(),
            tim2: Tim::new(clocks.timers),
            tim3: Tim::new(clocks.timers),
            tim4: Tim::new(clocks.timers),
            pwr: Pwr::default(),
            exti: Exti::default(),
            adc: Adc::new(clocks.adc),
            dma: Dma::default(),
            usart: Usart::new(clocks.pclk2),
            iwdg: Iwdg::new(lsi_hz),
            dbgmcu,
        }
    }
}

/// The chip and its surroundings.
#[derive(Debug)]
pub struct Chip {
    lsi_hz: u32,
    debugger: bool,
    pub(crate) rcc: Rcc,
    pub(crate) p: Peripherals,
    pub(crate) signature: Signature,
    ram: Ram,
    /// The main memory.
    pub(crate) flash: FlashMemory,
    product_id: u16,
    /// The bootloader, while it runs.
    bootloader: Option<Bootloader>,
    /// Servo and sensor.
    plant: Plant,
    /// The line to the host.
    pub(crate) line: Line,
    /// The record of its events.
    pub record: Record,
    /// The 3.3 V.
    pub(crate) supply: Supply,
    /// Output of the voltage detector, and the time of its next change.
    detector: bool,
    detector_at: Option<Ticks>,
    /// When the level of PA1 last rose, if it is high.
    high_since: Option<Ticks>,
    pull_down: bool,
    sensor_supply_error: f64,
    /// The wire of the self-test, in the sensor's place.
    loop_wire: Option<LoopWire>,
    samples_late: Ticks,
    /// Level of the reference of TIM2's channel 1, which starts injected conversions.
    probe: bool,
    capacitor: SamplingCapacitor,
    /// Level of PA1 while nothing drives it and no resistor pulls it.
    floating: bool,
    chance: ChaCha8Rng,
}

impl Chip {
    /// A chip without supply; [`reset`](Self::reset) switches it on.
    pub fn new(options: &BoardOptions, ram: Ram, program: &[u8]) -> Result<Self, OptionsError> {
        let (mut simulation, faults) = (options.simulation.clone(), &options.faults);
        simulation
            .faults
            .extend(faults.iter().filter_map(|fault| match fault {
                Fault::Sensor(fault) => Some(*fault),
                _ => None,
            }));
        let mut unique_id = *b"virt        ";
        unique_id[4..].copy_from_slice(&simulation.conditions.sensor_gain.to_le_bytes());
        let sources = Sources::new(
            !faults.contains(&Fault::NoCrystal),
            !faults.contains(&Fault::NoPll),
            options.hsi_error,
            options.clock_switching,
        );
        let rcc = Rcc::new(sources.with_crystal(options.crystal_error));
        let debugger = faults.iter().any(|f| matches!(f, Fault::DebuggerHalts(_)));
        Ok(Self {
            lsi_hz: options.lsi_hz,
            debugger,
            p: Peripherals::new(&rcc, options.lsi_hz, Dbgmcu::new(debugger)),
            rcc,
            signature: Signature::new(unique_id, options.flash_kib, options.identity_at_any_clock),
            ram,
            flash: FlashMemory::new(program, options.flash_kib, options.read_protected),
            product_id: options.product_id,
            bootloader: None,
            plant: Plant::new(&simulation)?,
            line: Line::new(faults, simulation.seed),
            record: Record {
                keeps_signals: options.keeps_signals,
                ..Record::default()
            },
            supply: Supply::new(options.supply_millivolts, faults),
            detector: false,
            detector_at: None,
            high_since: None,
            pull_down: options.pull_down,
            sensor_supply_error: options.sensor_supply_error,
            loop_wire: options.loop_wire.clone(),
            samples_late: options.samples_late,
            probe: false,
            capacitor: SamplingCapacitor::new(options.source_ohms),
            floating: false,
            chance: ChaCha8Rng::seed_from_u64(simulation.seed),
        })
    }

    /// Everything but the memory goes to its reset state (7.1.1). All pins float, so a pulse under
    /// way ends. Where BOOT0 is high, the bootloader runs next (3.4).
    pub fn reset(&mut self, reason: ResetReason, boot0: bool, now: Ticks) {
        let mut dbgmcu = std::mem::take(&mut self.p.dbgmcu);
        if reason == ResetReason::PowerOn {
            self.ram.forget();
            dbgmcu = Dbgmcu::new(self.debugger);
        }
        self.rcc.reset(reason);
        self.p = Peripherals::new(&self.rcc, self.lsi_hz, dbgmcu);
        self.bootloader = boot0.then(|| Bootloader::new(self.product_id));
        self.line.set_frame_bits(match boot0 {
            true => bootloader::FRAME_BITS,
            false => usart::FRAME_BITS,
        });
        self.advance_detector(now);
        self.follow_pulse(now);
        self.record.resets.push((now, reason));
    }

    /// The supply is gone: the peripherals stand still and all pins float.
    pub fn switch_off(&mut self, now: Ticks) {
        self.rcc.switch_off();
        self.bootloader = None;
        self.p = Peripherals::new(&self.rcc, self.lsi_hz, Dbgmcu::default());
        self.follow_pulse(now);
    }

    /// A debugger has halted the processor: what its bits say stands still (31.16.2).
    pub fn halt(&mut self, now: Ticks) {
        let p = &mut self.p;
        let timers = [(2, &mut p.tim2), (3, &mut p.tim3), (4, &mut p.tim4)];
        for (number, timer) in timers {
            if p.dbgmcu.stops_timer(number) {
                timer.freeze(now);
            }
        }
        if p.dbgmcu.stops_watchdog() {
            p.iwdg.freeze();
        }
    }

    /// The crystal stops for ever.
    pub fn stop_crystal(&mut self, now: Ticks) {
        let record = &mut self.record;
        self.rcc.stop_crystal(&mut Moment { now, record });
        self.distribute_clocks(now);
    }

    /// Updates the clocks of all models.
    pub(crate) fn distribute_clocks(&mut self, now: Ticks) {
        let clocks = self.rcc.clocks();
        self.p.tim2.set_clock(clocks.timers, now);
        self.p.tim3.set_clock(clocks.timers, now);
        self.p.tim4.set_clock(clocks.timers, now);
        self.p.adc.set_clock(clocks.adc);
        self.p.usart.set_clock(clocks.pclk2);
    }

    /// Whether the LED at PC13, to the supply, is on.
    pub fn led(&self) -> bool {
        let [_, _, port_c, ..] = &self.p.gpio;
        port_c.mode(13) == Mode::Output && !port_c.level(13)
    }

    /// The levels of the interrupt request lines, one bit each.
    pub fn interrupts(&self) -> u64 {
        let dma = (1..=7).map(|n| (irq::DMA1_CHANNEL1 + n - 1, self.p.dma.interrupt(n)));
        let others = [
            (irq::PVD, self.p.exti.interrupt()),
            (irq::ADC1_2, self.p.adc.interrupt()),
            (irq::TIM2, self.p.tim2.interrupt()),
            (irq::TIM3, self.p.tim3.interrupt()),
            (irq::USART1, self.p.usart.interrupt()),
        ];
        dma.chain(others).fold(0, |lines, (number, level)| {
            lines | u64::from(level) << number
        })
    }

    /// The time of the next event.
    pub fn next_event(&self) -> Option<Ticks> {
        [
            self.rcc.next_event(),
            self.detector_at,
            self.p.tim2.next_event(),
            self.p.tim3.next_event(),
            self.p.tim4.next_event(),
            self.p.adc.next_event(),
            self.p.usart.next_event(),
            self.line.next_event(),
            self.bootloader.as_ref().and_then(Bootloader::next_event),
        ]
        .into_iter()
        .flatten()
        .min()
    }

    /// Handles all events up to `to`.
    pub fn advance(&mut self, to: Ticks) {
        while let Some(now) = self.next_event().filter(|&event| event <= to) {
            if self.rcc.advance(now) {
                self.distribute_clocks(now);
            }
            self.advance_detector(now);
            let trigger = self.p.tim2.advance(now);
            self.on_tim2_trigger(trigger, now);
            self.follow_probe(now);
            self.follow_pulse(now);
            let trigger = self.p.tim3.advance(now);
            self.on_tim3_trigger(trigger, now);
            self.p.tim4.advance(now);
            self.advance_adc(now);
            self.advance_usart(now);
        }
    }

    pub(crate) fn on_tim2_trigger(&mut self, trigger: TriggerOutput, now: Ticks) {
        if trigger {
            let trigger = self.p.tim3.trigger(TIM2_AT_TIM3, now);
            self.on_tim3_trigger(trigger, now);
        }
    }

    /// A rise of the reference of TIM2's channel 1 starts an injected conversion (11.7).
    pub(crate) fn follow_probe(&mut self, now: Ticks) {
        let level = self.p.tim2.output(1, now).unwrap_or(false);
        if level && !self.probe {
            let record = &mut self.record;
            let m = &mut Moment { now, record };
            self.p.adc.trigger_by_tim2_channel_1(m);
        }
        self.probe = level;
    }

    pub(crate) fn on_tim3_trigger(&mut self, trigger: TriggerOutput, now: Ticks) {
        if trigger {
            let record = &mut self.record;
            let m = &mut Moment { now, record };
            self.p.adc.trigger_by_tim3(self.samples_late, m);
            let answered = self.p.tim4.trigger(TIM3_AT_OTHERS, now);
            self.moment(now)
                .not_modelled(answered, "the trigger output of TIM4");
            // A ring of triggers is no chain: TIM2 does not answer TIM3 here.
            let answered = self.p.tim2.trigger(TIM3_AT_OTHERS, now);
            self.moment(now)
                .not_modelled(answered, "two timers that trigger each other");
        }
    }

    pub(crate) fn moment(&mut self, now: Ticks) -> Moment<'_> {
        Moment {
            now,
            record: &mut self.record,
        }
    }

    pub(crate) fn unmapped(&mut self, address: u32, now: Ticks) {
        self.moment(now).report(Irregularity::Unmapped(address));
    }

    /// Passes the output of the voltage detector to its external line, and finds its next change.
    pub(crate) fn advance_detector(&mut self, now: Ticks) {
        let threshold = self.p.pwr.threshold();
        let low = threshold.is_some_and(|limit| self.supply.millivolts(now) < limit);
        if low != self.detector {
            self.detector = low;
            self.p.exti.detector(low);
        }
        self.detector_at = threshold.and_then(|limit| self.supply.crosses(limit, now));
    }

    fn advance_adc(&mut self, now: Ticks) {
        let record = &mut self.record;
        match self.p.adc.advance(&mut Moment { now, record }) {
            Event::None => {}
            Event::Hold {
                channel,
                index,
                sampled,
            } => {
                let input = self.input(channel, index, now);
                let code = self.capacitor.sample(channel, input, sampled);
                self.p.adc.hold(code);
            }
            Event::DmaRequest => {
                let record = &mut self.record;
                if let Some(transfer) = self.p.dma.request(1, &mut Moment { now, record }) {
                    self.transfer(&transfer, now);
                }
            }
        }
    }

    /// The input of the ADC: ADC_IN4 is PA4, 17 is the internal reference voltage, and nothing else is connected. A code
    /// is the input relative to the supply.
    fn input(&mut self, channel: u32, index: u32, now: Ticks) -> u16 {
        let millivolts = self.supply.millivolts(now);
        let code = |at_3_3_v: u64| (at_3_3_v * FULL_SCALE / millivolts).min(0xfff) as u16;
        match channel {
            4 => {
                let [port_a, ..] = &self.p.gpio;
                let analog = port_a.mode(4) == Mode::Analog;
                self.moment(now)
                    .against_manual(!analog, "an ADC input that is not analog (9.1.12)");
                if let Some(wire) = &self.loop_wire {
                    let chance = self.chance.random_range(-1.0..=1.0);
                    return wire.code(now, millivolts, chance);
                }
                let at_5_v = f64::from(self.plant.code(now, index));
                code((at_5_v * (1.0 + self.sensor_supply_error)).round() as u64)
            }
            VREFINT => code(BANDGAP * 0xfff / FULL_SCALE),
            _ => {
                self.moment(now)
                    .not_modelled(true, "another ADC input than PA4 and the reference voltage");
                0
            }
        }
    }

    fn transfer(&mut self, transfer: &Transfer, now: Ticks) {
        let &Transfer {
            peripheral,
            memory,
            bytes,
        } = transfer;
        let value = if peripheral == ADC1_DR {
            self.p.adc.read_data()
        } else {
            self.unmapped(peripheral, now);
            0
        };
        if self.ram.write(memory, bytes, value).is_none() {
            self.unmapped(memory, now);
            self.p.dma.fail(1);
        }
    }

    /// The content of the main memory.
    pub fn flash(&self) -> &[u8] {
        self.flash.bytes()
    }

    /// Whether the bootloader runs, and not the program.
    pub fn in_bootloader(&self) -> bool {
        self.bootloader.is_some()
    }

    /// What comes after the bootloader, where it has just ended: the program with its vector table at an address, or a
    /// reset. The bootloader leaves the PLL in use, and its variables in the memory.
    pub(crate) fn leave_bootloader(&mut self, now: Ticks) -> Option<End> {
        let end = self.bootloader.as_ref()?.end(now)?;
        self.bootloader = None;
        self.line.set_frame_bits(usart::FRAME_BITS);
        if let End::Jump(_) = end {
            self.rcc.leave_bootloader(now);
            self.distribute_clocks(now);
            for word in (RAM_START..bootloader::OWN_RAM).step_by(4) {
                // The range is the memory's own.
                let _ = self.ram.write(word, 4, 0xb007_10ad);
            }
        }
        Some(end)
    }

    /// The bootloader finds the bit rate of the host.
    fn advance_bootloader(&mut self, now: Ticks) {
        let Some(bootloader) = &mut self.bootloader else {
            return;
        };
        let memories = &mut Memories {
            flash: &mut self.flash,
            ram: &self.ram,
            signature: &self.signature,
        };
        if let Some(byte) = bootloader.advance(now, memories) {
            self.line.board_writes(byte, BIT, now);
        }
        if let Some((byte, _)) = self.line.arrive(now, BIT) {
            bootloader.receive(byte, now, memories);
        }
    }

    /// TX is PA9, RX is PA10.
    fn advance_usart(&mut self, now: Ticks) {
        if self.bootloader.is_some() {
            return self.advance_bootloader(now);
        }
        let [port_a, ..] = &self.p.gpio;
        let transmits = port_a.mode(9) == Mode::AlternatePushPull;
        let receives = port_a.mode(10) == Mode::Input;
        let floats = port_a.floats(10) && self.p.usart.listens();
        let bit_time = self.p.usart.bit_time();
        if let Some(byte) = self.p.usart.advance(now) {
            self.moment(now)
                .against_manual(!transmits, "TX is not an alternate output (9.1.11)");
            if transmits {
                self.line.board_writes(byte, bit_time, now);
            }
        }
        if let Some((byte, damaged)) = self.line.arrive(now, bit_time)
            && receives
        {
            let record = &mut self.record;
            let m = &mut Moment { now, record };
            m.not_modelled(floats, "what a floating RX receives without a cable");
            self.p.usart.receive(byte, damaged, m);
        }
    }
}
