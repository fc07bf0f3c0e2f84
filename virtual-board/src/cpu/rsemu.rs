//! The [`Core`] of the crate `rsemu`.
//!
//! It lacks flash wait states, so its cycles are a lower bound. It also lacks an event register that exceptions set,
//! which matters only to programs that wait for events without sending one (Armv7-M ARM, B1.5.18), and the number of the
//! active exception in ICSR (B3.2.4).
//!
//! It has a fault: on entry to an exception it stacks the program status without the state of an IT block (B1.5.6
//! stacks all of it), so after the return the rest of the block runs with any condition. Therefore a line that rises
//! within an IT block is raised after it, at most four instructions later.

use super::{Bus, Core, InterruptLine, Registers};
use crate::memory::{FLASH_START, RAM_START, Ram};
use rsemu::core::space::{AddressSpace, MemAttrs, MemOps, MemResult, Region, RomStore, RomWrite};
use rsemu::cpu::arm::v7m::sys::Exception;
use rsemu::cpu::arm::v7m::{ArmV7m, Config};
use std::sync::Arc;

/// Priority bits of the STM32F1 (programming manual PM0056, 4.3).
const PRIORITY_BITS: u8 = 4;

/// Where peripherals are: APB and AHB, the electronic signature, DBGMCU.
const WINDOWS: [(u32, u64); 3] = [
    (0x4000_0000, 0x3_0000),
    (0x1fff_f000, 0x1000),
    (0xe004_2000, 0x1000),
];

/// The system memory, which has the bootloader (AN2606).
const SYSTEM_MEMORY_BYTES: usize = 2 * 1024;

/// A core, its flash and its memory.
pub struct RsemuCore {
    ram: Ram,
    bus: Arc<dyn Bus>,
    flash: Arc<RomStore>,
    space: Arc<AddressSpace>,
    core: ArmV7m,
    /// Refused accesses, and whether the core was in its fault handler or locked up, when last
    /// asked.
    seen: (u64, bool),
    /// Lines that rose within an IT block, and are raised behind it.
    waiting: Vec<InterruptLine>,
}

/// The state of an IT block in the program status register: bits 26:25 and 15:10 (B1.4.2).
const IT_STATE: u32 = 3 << 25 | 0x3f << 10;

impl RsemuCore {
    /// A core that runs `flash` out of reset.
    ///
    /// # Panics
    /// Never: the regions of the memory map do not overlap.
    pub fn new(flash: &[u8], ram: &Ram, bus: &Arc<dyn Bus>) -> Self {
        let flash = Arc::new(RomStore::from_slice(flash));
        // 3.4: the boot pins of a board in use map the flash to address 0.
        let space = space(&flash, &flash, ram, bus);
        Self {
            core: core(&space),
            ram: ram.clone(),
            bus: bus.clone(),
            flash,
            space,
            seen: (0, false),
            waiting: Vec::new(),
        }
    }

    /// Sets the stack pointer, as a program does that uses too much of the stack.
    pub fn set_stack_pointer(&mut self, address: u32) {
        self.core.set_reg(13, address);
    }

    /// Starts at the reset vector of what is at address 0.
    fn start(&mut self, boot: &Arc<RomStore>) {
        self.space = space(&self.flash, boot, &self.ram, &self.bus);
        self.core = core(&self.space);
        self.seen = (0, false);
        self.waiting.clear();
    }

    fn in_it_block(&self) -> bool {
        self.core.regs().xpsr & IT_STATE != 0
    }
}

/// The memory map, with `boot` at address 0.
fn space(
    flash: &Arc<RomStore>,
    boot: &Arc<RomStore>,
    ram: &Ram,
    bus: &Arc<dyn Bus>,
) -> Arc<AddressSpace> {
    let space = AddressSpace::new("chip", 32);
    {
        let mut map = space.topology();
        let mut add = |region: Region, base: u32| {
            let added = map.map(region, u64::from(base));
            assert!(added.is_ok(), "the memory map overlaps at {base:#x}");
        };
        let rom = |name, rom: &Arc<RomStore>| Region::rom(name, rom.clone(), RomWrite::Fault);
        add(rom("flash", flash), FLASH_START);
        add(rom("boot", boot), 0);
        add(Region::ram("sram", ram.store()), RAM_START);
        for (base, length) in WINDOWS {
            let bus = bus.clone();
            let window = Arc::new(Window { base, bus });
            add(Region::io("peripherals", length, window), base);
        }
    }
    Arc::new(space)
}

fn core(space: &Arc<AddressSpace>) -> ArmV7m {
    let core = ArmV7m::new(Config::CORTEX_M3.with_priority_bits(PRIORITY_BITS));
    core.attach_space(space.clone());
    core
}

impl Core for RsemuCore {
    fn step(&mut self) -> u64 {
        if !self.waiting.is_empty() && !self.in_it_block() {
            for line in std::mem::take(&mut self.waiting) {
                self.set_line(line, true);
            }
        }
        self.core.step()
    }

    fn set_line(&mut self, line: InterruptLine, level: bool) {
        self.waiting.retain(|other| *other != line);
        if level && self.in_it_block() {
            self.waiting.push(line);
            return;
        }
        match line {
            InterruptLine::Irq(number) => self.core.set_irq(number as u16, level),
            InterruptLine::Nmi => self.core.set_nmi(level),
        }
    }

    fn raise(&mut self, exception: u16) {
        self.core.with_sys(|sys| {
            let number = usize::from(exception);
            sys.enable[number / 32] |= 1 << (number % 32);
            sys.set_pending(Exception(exception), true);
        });
    }

    fn is_asleep(&self) -> bool {
        self.core.is_asleep()
    }

    fn skip(&mut self, cycles: u64) {
        const TICKINT: u32 = 1 << 1;
        self.core.with_sys(|sys| {
            if sys.tick_systick(cycles) && sys.syst_csr & TICKINT != 0 {
                sys.set_pending(Exception::SYSTICK, true);
            }
        });
    }

    fn own_event(&self) -> Option<u64> {
        self.core.with_sys(|sys| {
            let runs = sys.syst_csr & 1 != 0 && sys.syst_rvr != 0;
            runs.then(|| u64::from(sys.syst_cvr.max(1)))
        })
    }

    fn registers(&self) -> Registers {
        let regs = self.core.regs();
        Registers {
            r: regs.r,
            xpsr: regs.xpsr,
        }
    }

    fn take_fault(&mut self) -> Option<u32> {
        let (refused, _) = self.core.bus_faults();
        let fails = self.core.is_locked_up() || self.core.current_exception() == HARD_FAULT;
        let is_new = refused > self.seen.0 || fails && !self.seen.1;
        self.seen = (refused, fails);
        is_new.then(|| self.core.pc())
    }

    fn wants_reset(&self) -> bool {
        self.core.reset_requested()
    }

    fn reset(&mut self) {
        self.start(&self.flash.clone());
    }

    fn program(&mut self, flash: &[u8]) {
        if self.flash.as_bytes() != flash {
            self.flash = Arc::new(RomStore::from_slice(flash));
        }
    }

    fn jump(&mut self, table: u32) {
        let mut system = vec![0xff; SYSTEM_MEMORY_BYTES];
        let begin = table.wrapping_sub(FLASH_START) as usize;
        let vectors = self.flash.as_bytes().get(begin..begin + 8);
        // With these two words the reset of a core does what the bootloader does: it takes the stack and jumps. All other
        // vectors lead nowhere, so a program that leaves the table where it is fails at its first interrupt.
        if let (Some(start), Some(vectors)) = (system.get_mut(..8), vectors) {
            start.copy_from_slice(vectors);
        }
        self.start(&Arc::new(RomStore::from_slice(&system)));
    }
}

/// Exception number 3 (Armv7-M ARM, B1.5.2).
const HARD_FAULT: Exception = Exception(3);

/// The part of the memory map that belongs to the bus.
#[derive(Debug)]
struct Window {
    base: u32,
    bus: Arc<dyn Bus>,
}

impl MemOps for Window {
    fn read(&self, offset: u64, bytes: &mut [u8], attributes: MemAttrs) -> MemResult {
        // A read by a debugger must have no effect.
        if !attributes.debug {
            let value = self.bus.read(self.base + offset as u32, bytes.len() as u32);
            for (byte, value) in bytes.iter_mut().zip(value.to_le_bytes()) {
                *byte = value;
            }
        }
        Ok(())
    }

    fn write(&self, offset: u64, bytes: &[u8], attributes: MemAttrs) -> MemResult {
        if !attributes.debug {
            let mut value = [0; 4];
            for (value, byte) in value.iter_mut().zip(bytes) {
                *value = *byte;
            }
            let value = u32::from_le_bytes(value);
            self.bus
                .write(self.base + offset as u32, bytes.len() as u32, value);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug)]
    struct NoPeripherals;

    impl Bus for NoPeripherals {
        fn read(&self, _: u32, _: u32) -> u32 {
            0
        }
        fn write(&self, _: u32, _: u32, _: u32) {}
    }

    /// `itt eq` with a false condition, interrupted at every place: neither instruction of the block
    /// may run, and the handler has to.
    #[test]
    fn an_interrupt_in_an_it_block_does_not_change_what_the_block_does() {
        const HANDLER: u32 = 0x0800_0080;
        let program: [u16; 12] = [
            0x4804, // ldr r0, [pc, #16]: NVIC_ISER0
            0x2101, // movs r1, #1
            0x6001, // str r1, [r0]
            0x2200, // movs r2, #0
            0x2a01, // cmp r2, #1
            0xbf04, // itt eq
            0x2301, // moveq r3, #1
            0x2401, // moveq r4, #1
            0xe7fe, // b .
            0xbf00, // nop
            0xe100, 0xe000, // the address of NVIC_ISER0
        ];
        let mut flash = vec![0xff; 0x100];
        let mut put = |at: usize, bytes: &[u8]| flash[at..at + bytes.len()].copy_from_slice(bytes);
        put(0, &(RAM_START + 0x1000).to_le_bytes());
        put(4, &0x0800_0061u32.to_le_bytes());
        put(16 * 4, &(HANDLER | 1).to_le_bytes());
        for (i, half_word) in program.iter().enumerate() {
            put(0x60 + 2 * i, &half_word.to_le_bytes());
        }
        put(0x80, &0x2501u16.to_le_bytes()); // movs r5, #1
        put(0x82, &0x4770u16.to_le_bytes()); // bx lr
        for steps_before in 0..12 {
            let bus: Arc<dyn Bus> = Arc::new(NoPeripherals);
            let mut core = RsemuCore::new(&flash, &Ram::default(), &bus);
            for step in 0..40 {
                if step == steps_before {
                    core.set_line(InterruptLine::Irq(0), true);
                }
                core.step();
                if core.registers().r[5] == 1 {
                    core.set_line(InterruptLine::Irq(0), false);
                }
            }
            let registers = core.registers();
            assert_eq!(
                registers.r[5], 1,
                "raised after {steps_before} steps, never taken"
            );
            assert_eq!(
                registers.r[3..5],
                [0, 0],
                "raised after {steps_before} steps"
            );
        }
    }
}
