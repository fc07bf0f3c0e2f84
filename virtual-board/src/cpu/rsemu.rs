//! The [`Core`] that is made of the crate `rsemu`.
//!
//! What it lacks, and why that is no harm here: flash wait states (its cycles are a lower bound), and
//! an event register that exceptions set, which matters only to programs that wait for events
//! without sending one (Armv7-M ARM, B1.5.18).

use super::{Bus, Core, Registers};
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

/// A core, its flash and its memory.
pub struct RsemuCore {
    space: Arc<AddressSpace>,
    core: ArmV7m,
    /// Refused accesses, and whether the core was in its fault handler or locked up, when last
    /// asked.
    seen: (u64, bool),
}

impl RsemuCore {
    /// A core that runs `flash` out of reset.
    ///
    /// # Panics
    /// Never: the regions of the memory map do not overlap.
    #[must_use]
    pub fn new(flash: &[u8], ram: &Ram, bus: &Arc<dyn Bus>) -> Self {
        let rom = Arc::new(RomStore::from_slice(flash));
        let space = AddressSpace::new("chip", 32);
        {
            let mut map = space.topology();
            let mut add = |region: Region, base: u32| {
                let added = map.map(region, u64::from(base));
                assert!(added.is_ok(), "the memory map overlaps at {base:#x}");
            };
            let flash = |name| Region::rom(name, rom.clone(), RomWrite::Fault);
            add(flash("flash"), FLASH_START);
            // 3.4: the boot pins of a board in use map the flash to address 0.
            add(flash("boot"), 0);
            add(Region::ram("sram", ram.store()), RAM_START);
            for (base, length) in WINDOWS {
                let bus = bus.clone();
                add(
                    Region::io("peripherals", length, Arc::new(Window { base, bus })),
                    base,
                );
            }
        }
        let space = Arc::new(space);
        Self {
            core: core(&space),
            space,
            seen: (0, false),
        }
    }
}

fn core(space: &Arc<AddressSpace>) -> ArmV7m {
    let core = ArmV7m::new(Config::CORTEX_M3.with_priority_bits(PRIORITY_BITS));
    core.attach_space(space.clone());
    core
}

impl Core for RsemuCore {
    fn step(&mut self) -> u64 {
        self.core.step()
    }

    fn set_irq(&mut self, number: u32, level: bool) {
        self.core.set_irq(number as u16, level);
    }

    fn set_nmi(&mut self, level: bool) {
        self.core.set_nmi(level);
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
        self.core = core(&self.space);
        self.seen = (0, false);
    }
}

/// Exception number 3 (Armv7-M ARM, B1.5.2).
const HARD_FAULT: Exception = Exception(3);

/// A part of the memory map that is the bus's.
#[derive(Debug)]
struct Window {
    base: u32,
    bus: Arc<dyn Bus>,
}

impl MemOps for Window {
    fn read(&self, offset: u64, bytes: &mut [u8], attributes: MemAttrs) -> MemResult {
        // A look by a debugger must have no effect.
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
