//! The processor against another one, instruction by instruction, on the image itself.
//!
//! Before each step of the board's core its registers go into a processor of the crate `armagnac`,
//! which executes the same instruction on a view of the same memory; then registers, flags and what
//! was written have to be equal. Two authors who misread the architecture in the same way are less
//! likely than one.
//!
//! Not compared, and counted: what touches peripherals or the core's own registers, exceptions, and
//! the instructions about them (SEV, WFE, WFI, CPS, MRS, MSR) and STREXB and STREXH, which the other
//! one does not know or would answer from a state of its own.

use armagnac::core::{ArmVersion, Config, Emulator, Event, Processor, RunError};
use armagnac::decoder::Lut16AndGrouped32InstructionDecoder;
use armagnac::memory::{Env, MemoryAccessError, MemoryInterface, MemoryReadResult};
use armagnac::registers::RegisterIndex;
use servoid_protocol::message::Command;
use servoid_test_support::stepped::{Around, Stepped};
use servoid_test_support::virtual_board::{SharedBoard, image, options, staircase};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::rc::Rc;
use std::time::Duration;
use virtual_board::VirtualBoard;
use virtual_board::cpu::rsemu::RsemuCore;
use virtual_board::cpu::{Core, Registers};
use virtual_board::memory::{FLASH_START, RAM_BYTES, RAM_START, Ram};

/// Flags N, Z, C, V, Q and the state of IT blocks.
const FLAGS_AND_IT: u32 = 0xfe00_fc00;
const EXCEPTION: u32 = 0x1ff;
/// Target of the jump at the end of a handler (Armv7-M ARM, B1.5.8), less its Thumb bit.
const EXCEPTION_RETURN: u32 = 0xffff_fff0;

/// The board's memory for the other processor; its writes are kept apart.
struct View {
    ram: Ram,
    written: Vec<(u32, u8)>,
}

impl View {
    fn read(&self, offset: u32, bytes: u32) -> MemoryReadResult<u32> {
        let value = self.ram.read(RAM_START + offset, bytes);
        value.ok_or(MemoryAccessError::InvalidAddress)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), MemoryAccessError> {
        let addresses = RAM_START + offset..;
        self.written.extend(addresses.zip(bytes.iter().copied()));
        Ok(())
    }
}

impl MemoryInterface for View {
    fn size(&self) -> u32 {
        RAM_BYTES
    }

    fn read_u8(&mut self, at: u32, _: &mut Env) -> MemoryReadResult<u8> {
        self.read(at, 1).map(|value| value as u8)
    }

    fn read_u16le(&mut self, at: u32, _: &mut Env) -> MemoryReadResult<u16> {
        self.read(at, 2).map(|value| value as u16)
    }

    fn read_u32le(&mut self, at: u32, _: &mut Env) -> MemoryReadResult<u32> {
        self.read(at, 4)
    }

    fn write_u8(&mut self, at: u32, value: u8, _: &mut Env) -> Result<(), MemoryAccessError> {
        self.write(at, &[value])
    }

    fn write_u16le(&mut self, at: u32, value: u16, _: &mut Env) -> Result<(), MemoryAccessError> {
        self.write(at, &value.to_le_bytes())
    }

    fn write_u32le(&mut self, at: u32, value: u32, _: &mut Env) -> Result<(), MemoryAccessError> {
        self.write(at, &value.to_le_bytes())
    }
}

/// How many steps of which kind.
#[derive(Debug, Default)]
struct Tally {
    compared: u64,
    peripherals: u64,
    exceptions: u64,
    special: u64,
    mnemonics: BTreeSet<String>,
    differences: Vec<String>,
}

/// The other processor, with its view of the memory.
struct SecondProcessor {
    flash: Vec<u8>,
    ram: Ram,
    view: Rc<RefCell<View>>,
    other: Processor,
    fresh: bool,
    tally: Tally,
}

impl SecondProcessor {
    fn new(flash: &[u8], ram: &Ram) -> Self {
        let view = Rc::new(RefCell::new(View {
            ram: ram.clone(),
            written: Vec::new(),
        }));
        let mut other = Processor::new(Config::v7m());
        other.instruction_decoder =
            Box::new(Lut16AndGrouped32InstructionDecoder::new(ArmVersion::V7M));
        other.map(FLASH_START, flash).unwrap();
        other.map_iface(RAM_START, view.clone()).unwrap();
        Self {
            flash: flash.to_vec(),
            ram: ram.clone(),
            view,
            other,
            fresh: true,
            tally: Tally::default(),
        }
    }

    /// Whether the instruction at `pc` is about events, exceptions or special registers.
    fn is_special(&self, pc: u32) -> bool {
        let at = (pc - FLASH_START) as usize;
        let halfword = |at: usize| u16::from_le_bytes([self.flash[at], self.flash[at + 1]]);
        match halfword(at) {
            // Hints but NOP and YIELD; IT has its low four bits set.
            0xbf20 | 0xbf30 | 0xbf40 => true,
            // CPS.
            first if first & 0xffe0 == 0xb660 => true,
            // MSR and MRS; not the barriers, which begin with 0xf3bf.
            first if first & 0xfff0 == 0xf380 => halfword(at + 2) & 0xd000 == 0x8000,
            0xf3ef => true,
            // STREXB and STREXH: the other one tags the whole word when it loads, then compares the
            // address itself, so that a byte inside a word can never be stored.
            first if first & 0xfff0 == 0xe8c0 => halfword(at + 2) & 0xe0 == 0x40,
            _ => false,
        }
    }

    /// Executes the instruction on the other processor.
    fn execute(&mut self, before: &Registers) -> Result<(), RunError> {
        let other = &mut self.other;
        for (index, &value) in (0..).zip(&before.r).take(15) {
            other.set(RegisterIndex::new_main(index), value);
        }
        other.set_pc(before.r[15]);
        other.registers.psr.set(before.xpsr & !EXCEPTION);
        self.view.borrow_mut().written.clear();
        if let Event::Instruction { ins } = other.next_event()? {
            self.tally.mnemonics.insert(ins.name());
        }
        Ok(())
    }

    fn compare(&mut self, before: &Registers, after: &Registers) {
        let mut differences = Vec::new();
        for (index, &value) in (0..).zip(&after.r).take(15) {
            let other = self.other[RegisterIndex::new_main(index)];
            if other != value {
                differences.push(format!("r{index} {value:#x} not {other:#x}"));
            }
        }
        if self.other.pc() & !1 != after.r[15] {
            differences.push(format!("pc {:#x} not {:#x}", after.r[15], self.other.pc()));
        }
        let flags = (after.xpsr ^ self.other.registers.psr.get()) & FLAGS_AND_IT;
        if flags != 0 {
            differences.push(format!("flags differ by {flags:#x}"));
        }
        for &(address, byte) in &self.view.borrow().written {
            if self.ram.read(address, 1) != Some(byte.into()) {
                differences.push(format!("{address:#x} is not {byte:#x}"));
            }
        }
        self.tally.compared += 1;
        if !differences.is_empty() && self.tally.differences.len() < 20 {
            let pc = before.r[15];
            self.tally
                .differences
                .push(format!("{pc:#x}: {}", differences.join(", ")));
        }
    }
}

/// A base register that points to the core's own registers: NVIC, SCB and the like.
fn touches_core(registers: &Registers) -> bool {
    registers.r[..13]
        .iter()
        .any(|r| (0xe000_0000..0xe010_0000).contains(r))
}

impl Around for SecondProcessor {
    fn step(&mut self, core: &mut RsemuCore) -> u64 {
        let before = core.registers();
        let asleep = core.is_asleep();
        if std::mem::take(&mut self.fresh) || asleep {
            return core.step();
        }
        if self.is_special(before.r[15]) || touches_core(&before) {
            self.tally.special += 1;
            return core.step();
        }
        let executed = self.execute(&before);
        let cycles = core.step();
        let after = core.registers();
        // A return that goes straight to the next handler, of the same number, shows in the address.
        let returns = executed.is_ok() && self.other.pc() >= EXCEPTION_RETURN;
        if returns || (before.xpsr ^ after.xpsr) & EXCEPTION != 0 {
            self.tally.exceptions += 1;
            self.other.clear_exclusive_local();
            return cycles;
        }
        match executed {
            Ok(()) => self.compare(&before, &after),
            Err(RunError::MemRead { address, .. } | RunError::MemWrite { address, .. })
                if address >= 0x1fff_0000
                    && !(RAM_START..RAM_START + RAM_BYTES).contains(&address) =>
            {
                self.tally.peripherals += 1;
            }
            Err(error) => {
                let pc = before.r[15];
                self.tally.differences.push(format!("{pc:#x}: {error:?}"));
            }
        }
        cycles
    }

    fn reset(&mut self) {
        self.fresh = true;
    }
}

#[test]
fn another_processor_does_the_same() {
    let options = options("linear?seed=1", &[]);
    let board = VirtualBoard::with_core(image(), &options, |flash, ram, bus| {
        Stepped::new(
            RsemuCore::new(flash, ram, bus),
            SecondProcessor::new(flash, ram),
        )
    });
    let board = SharedBoard::from(board.unwrap());
    let mut client = board.connect();
    let job = staircase();
    job.arm(&mut client).unwrap();
    client.request(Command::Start(job.start)).unwrap();
    board.pass(Duration::from_secs(2));
    client.status().unwrap();
    board.with(|board| {
        let tally = &board.core().around.tally;
        println!(
            "{} instructions compared, {} kinds; not compared: {} on peripherals, {} exceptions, {} \
             special",
            tally.compared,
            tally.mnemonics.len(),
            tally.peripherals,
            tally.exceptions,
            tally.special
        );
        assert_eq!(tally.differences, [""; 0]);
        // A check that compares nothing finds nothing.
        assert!(tally.compared > 100_000 && tally.mnemonics.len() > 30, "{tally:?}");
        assert!(tally.exceptions > 100, "{tally:?}");
    });
}
