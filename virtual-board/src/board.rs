//! The whole board, and the loop that advances its time.
//!
//! The core executes an instruction, time advances by its cycles, and the peripherals handle all events up to then.
//! While the core sleeps, time jumps from event to event. This makes a simulated second cost some hundredths of a
//! second, and changes nothing, because a sleeping core does nothing.

use crate::bootloader::End;
use crate::bus::SharedChip;
use crate::chip::Chip;
use crate::cpu::rsemu::RsemuCore;
use crate::cpu::{Bus, Core, InterruptLine};
use crate::fault::{BROWN_OUT, Fault};
use crate::image::Image;
use crate::memory::Ram;
use crate::options::BoardOptions;
use crate::record::{Irregularity, LogLine, ResetReason};
use crate::rtt::Log;
use crate::time::{Ticks, from_duration, microseconds, milliseconds};
use servoid_simulator::OptionsError;
use std::sync::{Arc, MutexGuard};
use std::time::Duration;

/// From the supply to the first instruction (datasheet DS5319, reset temporization).
const POWER_ON_DELAY: Ticks = microseconds(2_500);
/// Steps after which the peripherals are checked in any case, for effects of the core that do not touch them, such
/// as a reset.
const STEPS_BETWEEN_LOOKS: u32 = 1_000;
/// Time between two reads of the log: its buffer of a kilobyte must not fill up.
const LOG_EVERY: Ticks = milliseconds(5);
/// Time that [`VirtualBoard::read`] advances between two checks for bytes: a few bytes on the line.
const READ_SLICE: Ticks = microseconds(250);

/// A scheduled event from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Plan {
    StopCrystal,
    Stick,
    SwitchOff,
    SwitchOn,
    PullReset,
    Raise(u16),
    Halt,
}

/// The exception of a hard fault (Armv7-M ARM, B1.5.2).
const HARD_FAULT: u16 = 3;
/// An interrupt that no peripheral here has: that of the real-time clock (RM0008 10.1.2, position 3).
const STRAY: u16 = 16 + 3;

/// A board that runs an image, behind a serial line.
///
/// Time passes only in [`run_until`](Self::run_until) and [`read`](Self::read).
pub struct VirtualBoard<C: Core = RsemuCore> {
    core: C,
    chip: Arc<SharedChip>,
    ram: Ram,
    log: Option<Log>,
    drains_log: bool,
    /// Cycles that each instruction waits for the flash, beyond those of the core.
    waits: u64,
    slow_flash: bool,
    now: Ticks,
    hclk: Ticks,
    next_event: Ticks,
    /// Interrupt lines as last passed to the core.
    interrupts: u64,
    nmi: bool,
    plans: Vec<(Ticks, Plan)>,
    power: bool,
    stuck: bool,
    steps: u32,
    log_at: Ticks,
    awake_cycles: u64,
    /// The level of BOOT0, and whether the reset pin is held low.
    boot0: bool,
    held_in_reset: bool,
    /// Whether the bootloader runs.
    in_bootloader: bool,
}

impl VirtualBoard {
    /// A board with `image` in its flash, switched on at time 0.
    pub fn new(image: Image, options: &BoardOptions) -> Result<Self, OptionsError> {
        Self::with_core(image, options, RsemuCore::new)
    }
}

impl<C: Core> VirtualBoard<C> {
    /// A board with another core.
    pub fn with_core(
        image: Image,
        options: &BoardOptions,
        core: impl FnOnce(&[u8], &Ram, &Arc<dyn Bus>) -> C,
    ) -> Result<Self, OptionsError> {
        let mut plans = vec![(POWER_ON_DELAY, Plan::SwitchOn)];
        for fault in &options.faults {
            match *fault {
                Fault::CrystalStops(at) => plans.push((at, Plan::StopCrystal)),
                Fault::CpuStuck(at) => plans.push((at, Plan::Stick)),
                Fault::BrownOut(at) => {
                    let back = at + from_duration(BROWN_OUT) + POWER_ON_DELAY;
                    plans.extend([(at, Plan::SwitchOff), (back, Plan::SwitchOn)]);
                }
                Fault::ResetPin(at) => plans.push((at, Plan::PullReset)),
                Fault::HardFault(at) => plans.push((at, Plan::Raise(HARD_FAULT))),
                Fault::StrayInterrupt(at) => plans.push((at, Plan::Raise(STRAY))),
                Fault::DebuggerHalts(at) => plans.push((at, Plan::Halt)),
                // Those of the chip and the line.
                _ => {}
            }
        }
        plans.sort_by_key(|&(at, _)| at);
        let ram = Ram::new(options.ram_bytes);
        let chip = Chip::new(options, ram.clone(), &image.flash)?;
        let program = chip.flash.bytes().to_vec();
        let chip = Arc::new(SharedChip::new(chip));
        let bus: Arc<dyn Bus> = chip.clone();
        Ok(Self {
            core: core(&program, &ram, &bus),
            chip,
            log: image.log,
            drains_log: options.drains_log,
            waits: 0,
            slow_flash: options.slow_flash,
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
            boot0: options.boot0,
            held_in_reset: false,
            in_bootloader: false,
        })
    }

    /// Simulated time since the board was switched on.
    pub fn now(&self) -> Ticks {
        self.now
    }

    /// Cycles in which the core was awake.
    pub fn awake_cycles(&self) -> u64 {
        self.awake_cycles
    }

    /// The core.
    pub fn core(&mut self) -> &mut C {
        &mut self.core
    }

    /// The static memory.
    pub fn ram(&self) -> &Ram {
        &self.ram
    }

    /// The chip, with its record.
    pub fn chip(&self) -> MutexGuard<'_, Chip> {
        self.chip.lock()
    }

    /// Sets the level of BOOT0, which the next reset looks at.
    pub fn set_boot0(&mut self, high: bool) {
        self.boot0 = high;
    }

    /// Holds the reset pin low, or lets it go.
    pub fn hold_reset(&mut self, low: bool) {
        if std::mem::replace(&mut self.held_in_reset, low) && !low && self.power {
            self.reset(ResetReason::Pin);
            self.update_core();
        }
    }

    /// Sends `bytes`; they take their time on the line.
    pub fn write(&mut self, bytes: &[u8]) {
        self.chip.lock().line.host_writes(bytes, self.now);
        self.next_event = self.now;
    }

    /// Copies the bytes received at the host; returns how many. No time passes.
    pub fn take(&mut self, buffer: &mut [u8]) -> usize {
        self.chip.lock().line.host_reads(buffer, self.now)
    }

    /// Waits until bytes have come and copies them to `buffer`; returns how many, or 0 when at least
    /// `timeout` of simulated time has passed without any.
    pub fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> usize {
        // Durations are rounded down here and in the host's clock. A tick for each lets a wait for a moment end.
        let roundings = if timeout.is_zero() { 0 } else { 2 };
        let wait = from_duration(timeout).saturating_add(roundings);
        let deadline = self.now.saturating_add(wait);
        loop {
            let count = self.take(buffer);
            if count > 0 || self.now >= deadline {
                return count;
            }
            // In the bootloader no instruction is executed that could bring an event forward.
            let slice = match self.in_bootloader {
                true => self.next_event.max(self.now + 1),
                false => self.now + READ_SLICE,
            };
            self.run_until(deadline.min(slice));
        }
    }

    /// Advances time to `end`, or an instruction beyond it.
    pub fn run_until(&mut self, end: Ticks) {
        while self.now < end {
            if self.steps == 0 || self.now >= self.next_event || self.chip.take_touched() {
                self.look_around();
            }
            if self.power && !self.stuck && !self.held_in_reset && !self.in_bootloader {
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
        self.now += (cycles + self.waits) * self.hclk;
        self.awake_cycles += cycles + self.waits;
        // A sleeping core returns one cycle, and the query costs as much as a step.
        if cycles == 1 && self.core.is_asleep() {
            self.look_around();
            if self.interrupts == 0 && !self.nmi {
                self.sleep(end);
            }
        }
    }

    /// Advances a sleeping core to the next event.
    fn sleep(&mut self, end: Ticks) {
        let own = self.core.own_event();
        let own = own.map_or(Ticks::MAX, |cycles| self.now + cycles * self.hclk);
        let until = self.next_event.min(end).min(own);
        let cycles = until.saturating_sub(self.now).div_ceil(self.hclk);
        self.core.skip(cycles);
        self.now += cycles * self.hclk;
    }

    /// Handles all events that are due, and passes their interrupts to the core.
    fn look_around(&mut self) {
        self.steps = STEPS_BETWEEN_LOOKS;
        self.follow_plans();
        if self.now >= self.log_at {
            self.drain_log();
            self.log_at = self.now + LOG_EVERY;
        }
        if let Some(pc) = self.core.take_fault() {
            let mut chip = self.chip.lock();
            chip.record.violation(self.now, Irregularity::Fault(pc));
        }
        let mut chip = self.chip.lock();
        chip.advance(self.now);
        let expired = chip.p.iwdg.expires().is_some_and(|at| self.now >= at);
        let asked = self.power && !self.in_bootloader && self.core.wants_reset();
        let left = chip.leave_bootloader(self.now);
        drop(chip);
        match left {
            Some(End::Jump(table)) => {
                let flash = self.chip.lock().flash.bytes().to_vec();
                self.core.program(&flash);
                self.core.jump(table);
            }
            Some(End::Reset) => self.reset(ResetReason::Software),
            None => {}
        }
        if expired {
            self.reset(ResetReason::Watchdog);
        } else if asked {
            self.reset(ResetReason::Software);
        }
        self.update_core();
    }

    fn update_core(&mut self) {
        let chip = self.chip.lock();
        self.hclk = chip.rcc.clocks().hclk;
        self.waits = if self.slow_flash {
            2 * chip.p.flash.wait_states()
        } else {
            0
        };
        let plan = self.plans.first().map(|&(at, _)| at);
        let events = [chip.next_event(), chip.p.iwdg.expires(), plan];
        let next = events.into_iter().flatten().min();
        self.next_event = next.map_or(self.log_at, |next| next.min(self.log_at));
        self.in_bootloader = chip.in_bootloader();
        self.nmi = chip.rcc.nmi();
        self.core.set_line(InterruptLine::Nmi, self.nmi);
        let interrupts = chip.interrupts();
        let mut changed = interrupts ^ self.interrupts;
        while changed != 0 {
            let number = changed.trailing_zeros();
            let level = interrupts >> number & 1 != 0;
            self.core.set_line(InterruptLine::Irq(number), level);
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
                Plan::PullReset => self.reset(ResetReason::Pin),
                Plan::Raise(exception) => self.core.raise(exception),
                // It stands as if it was stuck.
                Plan::Halt => {
                    self.stuck = true;
                    self.chip.lock().halt(self.now);
                }
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

    /// Resets the chip. A processor that a debugger has halted runs again: the halt is not kept (Armv7-M ARM, C1.6.2).
    fn reset(&mut self, reason: ResetReason) {
        // The last lines of the log, before they are overwritten.
        self.drain_log();
        if let Some(log) = &mut self.log {
            log.restart();
        }
        self.stuck = false;
        let mut chip = self.chip.lock();
        chip.reset(reason, self.boot0, self.now);
        self.core.program(chip.flash.bytes());
        drop(chip);
        self.core.reset();
        self.interrupts = 0;
    }

    fn drain_log(&mut self) {
        let Some(log) = self.log.as_mut().filter(|_| self.drains_log) else {
            return;
        };
        let lines = log.drain(&self.ram);
        if !lines.is_empty() {
            let at = self.now;
            let lines = lines.into_iter().map(|text| LogLine { at, text });
            self.chip.lock().record.log.extend(lines);
        }
    }
}
