//! A core with something done around each of its steps.

use virtual_board::cpu::rsemu::RsemuCore;
use virtual_board::cpu::{Core, InterruptLine, Registers};

/// Work around the steps of a core.
pub trait Around {
    /// Takes the core's next step, or lets time pass instead of it; returns the cycles that it took.
    fn step(&mut self, core: &mut RsemuCore) -> u64;

    /// Whether a core that sleeps may be left alone until something wakes it.
    fn may_sleep(&self) -> bool {
        true
    }

    /// Takes note of a reset.
    fn reset(&mut self) {}
}

/// The board's core, with work around its steps.
pub struct Stepped<A> {
    core: RsemuCore,
    pub around: A,
}

impl<A: Around> Stepped<A> {
    pub fn new(core: RsemuCore, around: A) -> Self {
        Self { core, around }
    }
}

impl<A: Around> Core for Stepped<A> {
    fn step(&mut self) -> u64 {
        self.around.step(&mut self.core)
    }

    fn raise(&mut self, exception: u16) {
        self.core.raise(exception);
    }

    fn is_asleep(&self) -> bool {
        self.around.may_sleep() && self.core.is_asleep()
    }

    fn reset(&mut self) {
        self.around.reset();
        self.core.reset();
    }

    fn program(&mut self, flash: &[u8]) {
        self.core.program(flash);
    }

    fn jump(&mut self, table: u32) {
        self.around.reset();
        self.core.jump(table);
    }

    fn set_line(&mut self, line: InterruptLine, level: bool) {
        self.core.set_line(line, level);
    }

    fn skip(&mut self, cycles: u64) {
        self.core.skip(cycles);
    }

    fn own_event(&self) -> Option<u64> {
        self.core.own_event()
    }

    fn registers(&self) -> Registers {
        self.core.registers()
    }

    fn take_fault(&mut self) -> Option<u32> {
        self.core.take_fault()
    }

    fn wants_reset(&self) -> bool {
        self.core.wants_reset()
    }
}
