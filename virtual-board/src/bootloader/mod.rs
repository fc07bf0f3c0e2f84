//! The bootloader in the chip's system memory, 0x1FFF F000: what it says on USART1, as a native model.
//!
//! It runs instead of the program in the flash where BOOT0 is high at a reset. Written from ST's AN3155 (USART protocol;
//! its sections beside the rules, as of rev. 14) and AN2606 (addresses); lengths of answers and the addresses of a
//! medium-density STM32F10xxx were held against the source of stm32flash 0.7 (`stm32.c`, `dev_table.c`). What neither says
//! is chosen so that a careless host fails: a first byte that is not 0x7F leaves it deaf, a byte that comes while it works
//! or sends waits only in the receiver's one register, and it acknowledges writes that the flash has refused.

mod command;

use crate::flash_memory::FlashMemory;
use crate::line::BIT;
use crate::memory::Ram;
use crate::peripherals::signature::Signature;
use crate::time::{Ticks, microseconds, milliseconds};
use command::{Command, VERSION};
use servoid_flash_image::FLASH_START;
use std::collections::VecDeque;

/// A byte on the line: start, eight bits, even parity, stop (section 1).
pub const FRAME_BITS: Ticks = 11;
const BYTE: Ticks = FRAME_BITS * BIT;

const SYNC: u8 = 0x7f;
const ACK: u8 = 0x79;
const NACK: u8 = 0x1f;

/// The longest times of DS5319's table of the flash memory.
const ERASE: Ticks = milliseconds(40);
const WRITE_HALF_WORD: Ticks = microseconds(70);

/// The bootloader has the beginning of the memory for itself (AN2606): 512 bytes.
pub const OWN_RAM: u32 = 0x2000_0200;
const SYSTEM_MEMORY: u32 = 0x1fff_f000;
const SYSTEM_MEMORY_BYTES: u32 = 0x800;
const SIGNATURE: u32 = 0x1fff_f7e0;

/// The memories that the bootloader reaches.
pub struct Memories<'a> {
    pub flash: &'a mut FlashMemory,
    pub ram: &'a Ram,
    pub signature: &'a Signature,
}

/// The end of the bootloader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// It starts the program with its vector table at this address.
    Jump(u32),
    /// It resets the chip.
    Reset,
}

/// What it waits for.
#[derive(Debug)]
enum State {
    /// The byte that shows the bit rate.
    Sync,
    /// Nothing: the bit rate was wrong.
    Deaf,
    Command,
    /// The complement of a command.
    Complement(u8),
    /// Four bytes and their checksum.
    Address(Command),
    /// A count and its complement.
    Count(u32),
    /// A count, so many bytes and one more, and their checksum.
    Data(u32),
    /// The same with the numbers of pages; or 0xFF and its complement for all.
    Pages,
}

/// The model.
#[derive(Debug)]
pub struct Bootloader {
    product_id: u16,
    state: State,
    /// What has come of the message under way.
    coming: Vec<u8>,
    /// The byte in the receiver, while nobody reads it.
    held: Option<u8>,
    /// Until then it works or sends, and reads nothing.
    busy_until: Ticks,
    sending: VecDeque<(Ticks, u8)>,
    ends: Option<(Ticks, End)>,
}

impl Bootloader {
    /// That of a chip with this product id, out of a reset.
    pub fn new(product_id: u16) -> Self {
        Self {
            product_id,
            state: State::Sync,
            coming: Vec::new(),
            held: None,
            busy_until: 0,
            sending: VecDeque::new(),
            ends: None,
        }
    }

    /// The time of the next event.
    pub fn next_event(&self) -> Option<Ticks> {
        let sent = self.sending.front().map(|(at, _)| *at);
        let reads = self.held.map(|_| self.busy_until);
        [sent, reads].into_iter().flatten().min()
    }

    /// A byte from the line is complete.
    pub fn receive(&mut self, byte: u8, now: Ticks, memories: &mut Memories<'_>) {
        if now < self.busy_until {
            // The receiver has one register: what is in it stays (RM0008 27.6.1, ORE).
            self.held.get_or_insert(byte);
        } else {
            self.take(byte, now, memories);
        }
    }

    /// Handles the events up to `now`; returns a byte that has left.
    pub fn advance(&mut self, now: Ticks, memories: &mut Memories<'_>) -> Option<u8> {
        if now >= self.busy_until
            && let Some(byte) = self.held.take()
        {
            self.take(byte, now, memories);
        }
        let (_, byte) = self.sending.pop_front_if(|(at, _)| *at <= now)?;
        Some(byte)
    }

    /// What comes after the bootloader, where it has ended by `now`: with its last byte.
    pub fn end(&self, now: Ticks) -> Option<End> {
        let (_, end) = self.ends.filter(|(at, _)| *at <= now)?;
        Some(end)
    }

    fn take(&mut self, byte: u8, now: Ticks, memories: &mut Memories<'_>) {
        self.busy_until = now;
        match self.state {
            State::Sync if byte == SYNC => self.go_on(State::Command, &[ACK]),
            State::Sync => self.state = State::Deaf,
            State::Deaf => {}
            State::Command => self.state = State::Complement(byte),
            State::Complement(code) => match Command::of(code) {
                Some(command) if byte == !code => self.begin(command, memories),
                _ => self.refuse(),
            },
            State::Address(_) | State::Count(_) | State::Data(_) | State::Pages => {
                self.coming.push(byte);
                if self.coming.len() >= self.expected() {
                    let message = std::mem::take(&mut self.coming);
                    self.complete(&message, memories);
                }
            }
        }
    }

    /// The length of the message under way.
    fn expected(&self) -> usize {
        let count = self.coming.first().copied().unwrap_or_default();
        match self.state {
            State::Address(_) => 5,
            State::Pages if count == 0xff => 2,
            State::Data(_) | State::Pages => usize::from(count) + 3,
            _ => 2,
        }
    }

    /// Sends, one byte after the other, and then waits for something else.
    fn go_on(&mut self, state: State, answer: &[u8]) {
        self.state = state;
        for &byte in answer {
            self.busy_until += BYTE;
            self.sending.push_back((self.busy_until, byte));
        }
    }

    /// Section 3: after an error it goes back to the check of commands.
    fn refuse(&mut self) {
        self.go_on(State::Command, &[NACK]);
    }

    fn begin(&mut self, command: Command, memories: &mut Memories<'_>) {
        if memories.flash.protected && !command.is_for_protected() {
            return self.refuse();
        }
        let [high, low] = self.product_id.to_be_bytes();
        match command {
            Command::Get => {
                let commands = Command::CODES;
                let mut answer = vec![ACK, commands.len() as u8, VERSION];
                answer.extend(commands);
                answer.push(ACK);
                self.go_on(State::Command, &answer);
            }
            Command::GetVersion => self.go_on(State::Command, &[ACK, VERSION, 0, 0, ACK]),
            Command::GetId => self.go_on(State::Command, &[ACK, 1, high, low, ACK]),
            Command::Read | Command::Go | Command::Write => {
                self.go_on(State::Address(command), &[ACK]);
            }
            Command::Erase => self.go_on(State::Pages, &[ACK]),
            // The option bytes of write protection are not modelled.
            Command::WriteProtect | Command::WriteUnprotect => self.refuse(),
            Command::ReadProtect => {
                memories.flash.protected = true;
                self.end_by(End::Reset, &[ACK, ACK]);
            }
            // 3.12: everything is erased, then the protection goes.
            Command::ReadUnprotect => {
                self.go_on(State::Command, &[ACK]);
                self.busy_until += ERASE;
                memories.flash.erase();
                memories.flash.protected = false;
                self.end_by(End::Reset, &[ACK]);
            }
        }
    }

    fn end_by(&mut self, end: End, answer: &[u8]) {
        self.go_on(State::Deaf, answer);
        self.ends = Some((self.busy_until, end));
    }

    fn complete(&mut self, message: &[u8], memories: &mut Memories<'_>) {
        let sum = message.iter().fold(0, |sum, byte| sum ^ byte);
        match (&self.state, message) {
            (State::Count(at), &[count, complement]) if count == !complement => {
                self.read(*at, usize::from(count) + 1, memories);
            }
            // 3.7: the complement of 0xFF.
            (State::Pages, [0xff, 0]) => {
                self.busy_until += ERASE;
                memories.flash.erase();
                self.go_on(State::Command, &[ACK]);
            }
            (State::Address(command), [address @ .., _]) if sum == 0 => {
                let address = address
                    .iter()
                    .fold(0, |at, byte| at << 8 | u32::from(*byte));
                self.address(*command, address, memories);
            }
            (State::Data(at), [_, data @ .., _]) if sum == 0 => self.write(*at, data, memories),
            (State::Pages, [_, pages @ .., _]) if sum == 0 => {
                // One after the other, as they were sent; a page that is not there takes no time.
                for &page in pages {
                    if memories.flash.erase_page(page.into()) {
                        self.busy_until += ERASE;
                    }
                }
                self.go_on(State::Command, &[ACK]);
            }
            _ => self.refuse(),
        }
    }

    fn address(&mut self, command: Command, address: u32, memories: &Memories<'_>) {
        let is_flash = memories.flash.read(address, 1).is_some();
        let is_ram = address >= OWN_RAM && memories.ram.read(address, 1).is_some();
        let is_system = address.wrapping_sub(SYSTEM_MEMORY) < SYSTEM_MEMORY_BYTES;
        match command {
            Command::Read if is_flash || is_ram || is_system => {
                self.go_on(State::Count(address), &[ACK]);
            }
            Command::Write if is_flash || is_ram => self.go_on(State::Data(address), &[ACK]),
            Command::Go if is_flash || is_ram => self.end_by(End::Jump(address), &[ACK]),
            _ => self.refuse(),
        }
    }

    fn read(&mut self, address: u32, length: usize, memories: &Memories<'_>) {
        let byte = |address: u32| match memories.flash.read(address, 1) {
            Some(byte) => byte.first().copied(),
            None if address.wrapping_sub(SYSTEM_MEMORY) < SYSTEM_MEMORY_BYTES => {
                let offset = address.checked_sub(SIGNATURE);
                // The code of the bootloader is not modelled; at 24 MHz every chip shows its number.
                let known = offset.and_then(|offset| memories.signature.read_byte(offset, 24));
                Some(known.unwrap_or(0xff))
            }
            None => memories.ram.read(address, 1).map(|byte| byte as u8),
        };
        let bytes = (address..).take(length).map(byte);
        match bytes.collect::<Option<Vec<u8>>>() {
            Some(mut bytes) => {
                bytes.insert(0, ACK);
                self.go_on(State::Command, &bytes);
            }
            None => self.refuse(),
        }
    }

    /// 3.6: no error is returned for what the memory refuses.
    fn write(&mut self, address: u32, data: &[u8], memories: &mut Memories<'_>) {
        let aligned = address.is_multiple_of(4) && data.len().is_multiple_of(2);
        if !aligned {
            return self.refuse();
        }
        if (FLASH_START..SYSTEM_MEMORY).contains(&address) {
            self.busy_until += WRITE_HALF_WORD * (data.len() as Ticks / 2);
            memories.flash.write(address, data);
        } else {
            for (at, byte) in (address..).zip(data) {
                // Beyond its end there is nothing to write to.
                let _ = memories.ram.write(at, 1, (*byte).into());
            }
        }
        self.go_on(State::Command, &[ACK]);
    }
}

#[cfg(test)]
mod tests;
