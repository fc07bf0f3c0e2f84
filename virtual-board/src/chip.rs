//! The chip around the core: the peripherals, and the wires between them.
//!
//! ```text
//!  TIM2 --TRGO--> ITR1 TIM3 --TRGO--> ADC1 --request--> DMA1 channel 1 --> memory
//!   | CH2                             ^ IN4
//!  PA1 --> servo --> shaft --> sensor --> PA4        PA9, PA10 <--> USART1 <--> line
//! ```
//!
//! Events happen at their exact times, in order. Simultaneous events happen in the order TIM2, TIM3, ADC, USART, line,
//! so a frame edge comes before the sample that it triggers.

use crate::fault::Fault;
use crate::line::Line;
use crate::memory::Ram;
use crate::options::BoardOptions;
use crate::peripherals::Moment;
use crate::peripherals::adc::{Adc, Event};
use crate::peripherals::afio::Afio;
use crate::peripherals::dbgmcu::Dbgmcu;
use crate::peripherals::dma::{Dma, Transfer};
use crate::peripherals::flash::Flash;
use crate::peripherals::gpio::{Gpio, Mode};
use crate::peripherals::iwdg::Iwdg;
use crate::peripherals::rcc::Rcc;
use crate::peripherals::signature::Signature;
use crate::peripherals::tim::{Tim, TriggerOutput};
use crate::peripherals::usart::Usart;
use crate::plant::Plant;
use crate::record::{Irregularity, Pulse, Record, ResetReason};
use crate::time::Ticks;
use servoid_simulator::OptionsError;

/// Interrupt positions (RM0008 10.1.2, vector table); the other DMA channels follow the first.
mod irq {
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
/// TIM2's internal trigger input that TIM3 is connected to.
const TIM3_AT_TIM2: u32 = 2;

/// All models that a reset resets.
#[derive(Debug)]
pub(crate) struct Peripherals {
    pub flash: Flash,
    pub afio: Afio,
    /// Ports A to E.
    pub gpio: [Gpio; 5],
    pub tim2: Tim,
    pub tim3: Tim,
    pub adc: Adc,
    pub dma: Dma,
    pub usart: Usart,
    pub iwdg: Iwdg,
    pub dbgmcu: Dbgmcu,
}

impl Peripherals {
    fn new(rcc: &Rcc, lsi_hz: u32) -> Self {
        let clocks = rcc.clocks();
        Self {
            flash: Flash::default(),
            afio: Afio::default(),
            gpio: Default::default(),
            tim2: Tim::new(clocks.timers),
            tim3: Tim::new(clocks.timers),
            adc: Adc::new(clocks.adc),
            dma: Dma::default(),
            usart: Usart::new(clocks.pclk2),
            iwdg: Iwdg::new(lsi_hz),
            dbgmcu: Dbgmcu::default(),
        }
    }
}

/// The chip and its surroundings.
#[derive(Debug)]
pub struct Chip {
    lsi_hz: u32,
    pub(crate) rcc: Rcc,
    pub(crate) p: Peripherals,
    pub(crate) signature: Signature,
    ram: Ram,
    /// Servo and sensor.
    plant: Plant,
    /// The line to the host.
    pub(crate) line: Line,
    /// The record of its events.
    pub record: Record,
    /// When the level of PA1 last rose, if it is high.
    high_since: Option<Ticks>,
}

impl Chip {
    /// A chip without supply; [`reset`](Self::reset) switches it on.
    pub fn new(options: &BoardOptions, ram: Ram) -> Result<Self, OptionsError> {
        let (mut simulation, faults) = (options.simulation.clone(), &options.faults);
        simulation
            .faults
            .extend(faults.iter().filter_map(|fault| match fault {
                Fault::Sensor(fault) => Some(*fault),
                _ => None,
            }));
        let mut unique_id = *b"virt        ";
        unique_id[4..].copy_from_slice(&simulation.seed.to_le_bytes());
        let rcc = Rcc::new(!faults.contains(&Fault::NoCrystal));
        Ok(Self {
            lsi_hz: options.lsi_hz,
            p: Peripherals::new(&rcc, options.lsi_hz),
            rcc,
            signature: Signature::new(unique_id),
            ram,
            plant: Plant::new(&simulation)?,
            line: Line::new(faults, simulation.seed),
            record: Record {
                keeps_signals: options.keeps_signals,
                ..Record::default()
            },
            high_since: None,
        })
    }

    /// Everything but the memory goes to its reset state (7.1.1). All pins float, so a pulse under
    /// way ends.
    pub fn reset(&mut self, reason: ResetReason, now: Ticks) {
        if reason == ResetReason::PowerOn {
            self.ram.forget();
        }
        self.rcc.reset(reason);
        self.p = Peripherals::new(&self.rcc, self.lsi_hz);
        self.follow_pulse(now);
        self.record.resets.push((now, reason));
    }

    /// The supply is gone: the peripherals stand still and all pins float.
    pub fn switch_off(&mut self, now: Ticks) {
        self.rcc = Rcc::new(self.rcc.crystal);
        self.p = Peripherals::new(&self.rcc, self.lsi_hz);
        self.follow_pulse(now);
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
            self.p.tim2.next_event(),
            self.p.tim3.next_event(),
            self.p.adc.next_event(),
            self.p.usart.next_event(),
            self.line.next_event(),
        ]
        .into_iter()
        .flatten()
        .min()
    }

    /// Handles all events up to `to`.
    pub fn advance(&mut self, to: Ticks) {
        while let Some(now) = self.next_event().filter(|&event| event <= to) {
            let trigger = self.p.tim2.advance(now);
            self.on_tim2_trigger(trigger, now);
            self.follow_pulse(now);
            let trigger = self.p.tim3.advance(now);
            self.on_tim3_trigger(trigger, now);
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

    pub(crate) fn on_tim3_trigger(&mut self, trigger: TriggerOutput, now: Ticks) {
        if trigger {
            let record = &mut self.record;
            self.p.adc.trigger_by_tim3(&mut Moment { now, record });
            // A ring of triggers is no chain: TIM2 does not answer TIM3 here.
            let answered = self.p.tim2.trigger(TIM3_AT_TIM2, now);
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

    /// Updates PA1: TIM2's channel 2 where pin and mapping make it so, its own data otherwise.
    pub(crate) fn follow_pulse(&mut self, now: Ticks) {
        let [port_a, ..] = &self.p.gpio;
        let level = match port_a.mode(1) {
            Mode::AlternatePushPull if self.p.afio.tim2_channel_2_is_on_pa1() => {
                self.p.tim2.output(2, now).unwrap_or(false)
            }
            Mode::Output => port_a.level(1),
            // The input of a servo has a pull-down.
            _ => false,
        };
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

    fn advance_adc(&mut self, now: Ticks) {
        let record = &mut self.record;
        match self.p.adc.advance(&mut Moment { now, record }) {
            Event::None => {}
            Event::Hold { channel, index } => {
                let code = self.input(channel, index, now);
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

    /// The input of the ADC: ADC_IN4 is PA4, and nothing else is connected.
    fn input(&mut self, channel: u32, index: u32, now: Ticks) -> u16 {
        let [port_a, ..] = &self.p.gpio;
        let analog = port_a.mode(4) == Mode::Analog;
        let mut moment = self.moment(now);
        moment.not_modelled(channel != 4, "another ADC input than PA4");
        moment.against_manual(!analog, "an ADC input that is not analog (9.1.12)");
        if channel == 4 {
            self.plant.code(now, index)
        } else {
            0
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

    /// TX is PA9, RX is PA10.
    fn advance_usart(&mut self, now: Ticks) {
        let [port_a, ..] = &self.p.gpio;
        let transmits = port_a.mode(9) == Mode::AlternatePushPull;
        let receives = port_a.mode(10) == Mode::Input;
        let bit_time = self.p.usart.bit_time();
        if let Some(byte) = self.p.usart.advance(now) {
            self.moment(now)
                .against_manual(!transmits, "TX is not an alternate output (9.1.11)");
            if transmits {
                self.line.board_writes(byte, bit_time);
            }
        }
        if let Some((byte, damaged)) = self.line.arrive(now, bit_time)
            && receives
        {
            let record = &mut self.record;
            let m = &mut Moment { now, record };
            self.p.usart.receive(byte, damaged, m);
        }
    }
}
