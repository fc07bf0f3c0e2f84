//! The processor, as the board sees it.
//!
//! A small trait, so that another core can take the place of the one in [`rsemu`]. What belongs to
//! the Cortex-M3 itself is the core's: NVIC, SCB, SysTick, and the bit-band alias (Cortex-M3 TRM,
//! "Bit-banding"), through which a program reads and writes single bits of peripherals.

pub mod rsemu;

use std::fmt::Debug;

/// Where the core's accesses to peripherals go.
pub trait Bus: Debug + Send + Sync {
    /// Reads 1, 2 or 4 bytes.
    fn read(&self, address: u32, bytes: u32) -> u32;
    /// Writes 1, 2 or 4 bytes.
    fn write(&self, address: u32, bytes: u32, value: u32);
}

/// The registers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Registers {
    /// R0 to R15, the stack pointer being the one in use.
    pub r: [u32; 16],
    /// Flags, IT state and exception number.
    pub xpsr: u32,
}

/// An interrupt line of the core.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum InterruptLine {
    /// An interrupt request, by its number.
    Irq(u32),
    /// The non-maskable interrupt.
    Nmi,
}

/// A Cortex-M3.
pub trait Core {
    /// Executes one instruction, or enters one exception; returns the cycles that it took. A core
    /// that sleeps returns one cycle and goes on sleeping, unless an interrupt wakes it.
    fn step(&mut self) -> u64;

    /// The level of an interrupt line.
    fn set_line(&mut self, line: InterruptLine, level: bool);

    /// Makes an exception pending, by its number, as an event within the core does. An interrupt is enabled first.
    fn raise(&mut self, exception: u16);

    /// Whether the core sleeps.
    fn is_asleep(&self) -> bool;

    /// Advances a sleeping core by `cycles`.
    fn skip(&mut self, cycles: u64);

    /// Cycles until the next event of the core's own timer.
    fn own_event(&self) -> Option<u64>;

    /// The registers.
    fn registers(&self) -> Registers;

    /// The program counter at a fault, if there was one since the last call.
    fn take_fault(&mut self) -> Option<u32>;

    /// Whether the program requested a reset.
    fn wants_reset(&self) -> bool;

    /// Resets the core; it starts at the reset vector with the next step.
    fn reset(&mut self);

    /// The flash has this content from the next reset or jump on.
    fn program(&mut self, flash: &[u8]);

    /// Has the core start as the bootloader starts it: with stack and start from the vector table at an address, and
    /// with the bootloader's own memory at address 0, and so its vector table.
    fn jump(&mut self, table: u32);
}
