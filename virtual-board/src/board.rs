//! The whole board, and the loop that lets its time pass.
//!
//! The core executes an instruction, time goes on by its cycles, and all that is due by then happens
//! in the peripherals. While the core sleeps, time goes from one event to the next at once: this is
//! what makes a second cost some hundredths of one, and changes nothing, because a sleeping core
//! does nothing.

use crate::bus::SharedChip;
use crate::chip::{Chip, Specimen, Surroundings};
use crate::cpu::rsemu::RsemuCore;
use crate::cpu::{Bus, Core};
use crate::fault::{BROWN_OUT, Fault};
use crate::image::Image;
use crate::line::Line;
use crate::memory::Ram;
use crate::plant::Plant;
use crate::record::{Irregularity, LogLine, Record, ResetReason};
use crate::rtt::Log;
use crate::time::{Ticks, from_duration, microseconds, milliseconds, to_duration};
use servoid_simulator::{OptionsError, SimulationOptions};
use std::sync::{Arc, MutexGuard};
use std::time::Duration;

/// From the supply to the first instruction (datasheet DS5319, reset temporization).
const POWER_ON_DELAY: Ticks = microseconds(2_500);
/// Steps after which the peripherals are looked at in any case, for what the core does without
/// touching them, such as asking for a reset.
const STEPS_BETWEEN_LOOKS: u32 = 1_000;
/// How often the log is read: before its buffer of a kilobyte is full.
const LOG_EVERY: Ticks = milliseconds(5);
/// How far [`VirtualBoard::read`] goes without looking for bytes: a few of them on the line.
const READ_SLICE: Ticks = microseconds(250);

/// What a board is like.
#[derive(Clone, Debug)]
pub struct BoardOptions {
    /// Servo, sensor, noise and seed. The line is always at 115200 baud, and the time of the samples
    /// is what the program makes it.
    pub simulation: SimulationOptions,
    /// What goes wrong.
    pub faults: Vec<Fault>,
    /// Frequency of the low-speed oscillator that the watchdog runs on (Hz): 40 kHz, by the datasheet
    /// anything from 30 to 60.
    pub lsi_hz: u32,
    /// Whether pulses and conversions are recorded.
    pub keeps_signals: bool,
}

impl BoardOptions {
    /// A good board with `simulation` on its wires, that records everything.
    #[must_use]
    pub fn new(simulation: SimulationOptions) -> Self {
        Self {
            simulation,
            faults: Vec::new(),
            lsi_hz: 40_000,
            keeps_signals: true,
        }
    }

    /// The same with one more fault.
    #[must_use]
    pub fn with_fault(mut self, fault: Fault) -> Self {
        self.faults.push(fault);
        self
    }
}

/// Something planned from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Plan {
    StopCrystal,
    Stick,
    SwitchOff,
    SwitchOn,
}

/// A board that runs an image, behind a serial line.
///
/// Time passes only in [`run_until`](Self::run_until) and [`read`](Self::read).
pub struct VirtualBoard<C: Core = RsemuCore> {
    core: C,
    chip: Arc<SharedChip>,
    ram: Ram,
    log: Option<Log>,
    now: Ticks,
    hclk: Ticks,
    next_event: Ticks,
    /// Interrupt lines as the core knows them.
    interrupts: u64,
    nmi: bool,
    plans: Vec<(Ticks, Plan)>,
    power: bool,
    stuck: bool,
    steps: u32,
    log_at: Ticks,
    awake_cycles: u64,
}

impl VirtualBoard {
    /// A board with `image` in its flash, switched on at time 0.
    ///
    /// # Errors
    /// [`OptionsError`] where an option of the simulation has a value that makes no sense.
    pub fn new(image: Image, options: &BoardOptions) -> Result<Self, OptionsError> {
        Self::with_core(image, options, RsemuCore::new)
    }
}

impl<C: Core> VirtualBoard<C> {
    /// A board with a core of the caller's.
    ///
    /// # Errors
    /// [`OptionsError`] where an option of the simulation has a value that makes no sense.
    pub fn with_core(
        image: Image,
        options: &BoardOptions,
        core: impl FnOnce(&[u8], &Ram, &Arc<dyn Bus>) -> C,
    ) -> Result<Self, OptionsError> {
        let mut simulation = options.simulation.clone();
        let mut plans = vec![(POWER_ON_DELAY, Plan::SwitchOn)];
        for fault in &options.faults {
            match *fault {
                Fault::Sensor(fault) => simulation.faults.push(fault),
                Fault::CrystalStops { at } => plans.push((at, Plan::StopCrystal)),
                Fault::CpuStuck { at } => plans.push((at, Plan::Stick)),
                Fault::BrownOut { at } => {
                    let back = at + from_duration(BROWN_OUT) + POWER_ON_DELAY;
                    plans.extend([(at, Plan::SwitchOff), (back, Plan::SwitchOn)]);
                }
                Fault::NoCrystal | Fault::HostSilent { .. } | Fault::Line { .. } => {}
            }
        }
        plans.sort_by_key(|&(at, _)| at);
        let surroundings = Surroundings {
            plant: Plant::new(&simulation)?,
            line: Line::new(&options.faults, simulation.seed),
        };
        let record = Record {
            keeps_signals: options.keeps_signals,
            ..Record::default()
        };
        let specimen = Specimen::new(&options.faults, options.lsi_hz, simulation.seed);
        let ram = Ram::default();
        let chip = Chip::new(specimen, ram.clone(), surroundings, record);
        let chip = Arc::new(SharedChip::new(chip));
        let bus: Arc<dyn Bus> = chip.clone();
        Ok(Self {
            core: core(image.flash(), &ram, &bus),
            chip,
            log: Log::of(image),
            ram,
            now: 0,
            hclk: 1,
            next_event: 0,
            interrupts: 0,
            nmi: false,
            plans,
            power: false,
            stuck: false,
            steps: 0,
            log_at: 0,
            awake_cycles: 0,
        })
    }

    /// Simulated time since the board was switched on.
    #[must_use]
    pub fn now(&self) -> Ticks {
        self.now
    }

    /// Cycles in which the core was awake.
    #[must_use]
    pub fn awake_cycles(&self) -> u64 {
        self.awake_cycles
    }

    /// The core, for whoever looks over its shoulder.
    #[must_use]
    pub fn core(&mut self) -> &mut C {
        &mut self.core
    }

    /// The static memory.
    #[must_use]
    pub fn ram(&self) -> &Ram {
        &self.ram
    }

    /// The chip, with the record of what happened.
    pub fn chip(&self) -> MutexGuard<'_, Chip> {
        self.chip.lock()
    }

    /// Hands `bytes` to the line; they take their time.
    pub fn write(&mut self, bytes: &[u8]) {
        self.chip
            .lock()
            .surroundings
            .line
            .host_writes(bytes, self.now);
        self.next_event = self.now;
    }

    /// Copies what has arrived at the host; returns how many bytes. No time passes.
    pub fn take(&mut self, buffer: &mut [u8]) -> usize {
        self.chip.lock().surroundings.line.host_reads(buffer)
    }

    /// Waits until bytes have come and copies them to `buffer`; returns how many, or 0 when at least
    /// `timeout` of simulated time has passed without any.
    pub fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> usize {
        // Durations are rounded down here and where the host looks at the time. A tick for each, and
        // who waits for a moment until it is there does get there.
        let roundings = if timeout.is_zero() { 0 } else { 2 };
        let wait = from_duration(timeout).saturating_add(roundings);
        let deadline = self.now.saturating_add(wait);
        loop {
            let count = self.take(buffer);
            if count > 0 || self.now >= deadline {
                return count;
            }
            self.run_until(deadline.min(self.now + READ_SLICE));
        }
    }

    /// Lets time pass until `end`, or an instruction beyond it.
    pub fn run_until(&mut self, end: Ticks) {
        while self.now < end {
            if self.steps == 0 || self.now >= self.next_event || self.chip.take_touched() {
                self.look_around();
            }
            if self.power && !self.stuck {
                self.step(end);
            } else {
                self.now = self.next_event.max(self.now + 1).min(end);
            }
        }
        self.look_around();
    }

    fn step(&mut self, end: Ticks) {
        self.steps -= 1;
        self.chip.set_now(self.now);
        let cycles = self.core.step();
        self.now += cycles * self.hclk;
        self.awake_cycles += cycles;
        // A core that sleeps says one cycle, and asking it costs as much as a step.
        if cycles == 1 && self.core.is_asleep() {
            self.look_around();
            if self.interrupts == 0 && !self.nmi {
                self.sleep(end);
            }
        }
    }

    /// Lets a sleeping core sleep until the next event.
    fn sleep(&mut self, end: Ticks) {
        let own = self
            .core
            .own_event()
            .map(|cycles| self.now + cycles * self.hclk);
        let until = self.next_event.min(end).min(own.unwrap_or(Ticks::MAX));
        let cycles = until.saturating_sub(self.now).div_ceil(self.hclk);
        self.core.skip(cycles);
        self.now += cycles * self.hclk;
    }

    /// Lets everything happen that is due, and tells the core of it.
    fn look_around(&mut self) {
        self.steps = STEPS_BETWEEN_LOOKS;
        self.follow_plans();
        if self.now >= self.log_at {
            self.drain_log();
            self.log_at = self.now + LOG_EVERY;
        }
        if let Some(pc) = self.core.take_fault() {
            let now = self.now;
            self.chip
                .lock()
                .moment(now)
                .report(Irregularity::Fault { pc });
        }
        let mut chip = self.chip.lock();
        chip.advance(self.now);
        let expired = chip.watchdog_expires().is_some_and(|at| self.now >= at);
        let asked = self.power && self.core.wants_reset();
        drop(chip);
        if expired {
            self.reset(ResetReason::Watchdog);
        } else if asked {
            self.reset(ResetReason::Software);
        }
        self.tell_core();
    }

    fn tell_core(&mut self) {
        let chip = self.chip.lock();
        self.hclk = chip.hclk();
        let plan = self.plans.first().map(|&(at, _)| at);
        self.next_event = [
            chip.next_event(),
            chip.watchdog_expires(),
            plan,
            Some(self.log_at),
        ]
        .into_iter()
        .flatten()
        .min()
        .unwrap_or(Ticks::MAX);
        self.nmi = chip.nmi();
        self.core.set_nmi(self.nmi);
        let interrupts = chip.interrupts();
        let mut changed = interrupts ^ self.interrupts;
        while changed != 0 {
            let number = changed.trailing_zeros();
            self.core.set_irq(number, interrupts >> number & 1 != 0);
            changed &= changed - 1;
        }
        self.interrupts = interrupts;
    }

    fn follow_plans(&mut self) {
        while let Some(&(at, plan)) = self.plans.first()
            && at <= self.now
        {
            self.plans.remove(0);
            match plan {
                Plan::StopCrystal => self.chip.lock().stop_crystal(self.now),
                Plan::Stick => self.stuck = true,
                Plan::SwitchOff => {
                    self.power = false;
                    self.chip.lock().switch_off(self.now);
                }
                Plan::SwitchOn => {
                    self.power = true;
                    self.reset(ResetReason::PowerOn);
                }
            }
        }
    }

    fn reset(&mut self, reason: ResetReason) {
        // What the program said last, before it is overwritten.
        self.drain_log();
        if let Some(log) = &mut self.log {
            log.restart();
        }
        self.stuck = false;
        self.chip.lock().reset(reason, self.now);
        self.core.reset();
        self.interrupts = 0;
    }

    fn drain_log(&mut self) {
        let Some(log) = &mut self.log else { return };
        let lines = log.drain(&self.ram);
        if !lines.is_empty() {
            let at = self.now;
            let lines = lines.into_iter().map(|text| LogLine { at, text });
            self.chip.lock().record.log.extend(lines);
        }
    }
}

impl<C: Core> std::fmt::Debug for VirtualBoard<C> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("VirtualBoard")
            .field("now", &to_duration(self.now))
            .finish_non_exhaustive()
    }
}
