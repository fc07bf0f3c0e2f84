//! The program's log: defmt frames that it leaves in memory (SEGGER RTT).

use crate::memory::Ram;
use defmt_decoder::{DecodeError, Table};

/// First channel up, from the start of the control block: name, buffer, size, write offset, read
/// offset, each a word, after 16 bytes of magic and two counts.
const BUFFER: u32 = 28;
const SIZE: u32 = 32;
const WRITE: u32 = 36;
const READ: u32 = 40;
/// The start of the control block once the program has initialised it.
const MAGIC: &[u8; 10] = b"SEGGER RTT";

/// Bytes of a defmt frame end with this one (rzCOBS).
const END_OF_FRAME: u8 = 0;

/// Reads the log.
pub struct Log {
    control_block: u32,
    table: Table,
    pending: Vec<u8>,
}

impl Log {
    /// The log of the program with this control block and this table of formats.
    pub fn new(control_block: u32, table: Table) -> Self {
        Self {
            control_block,
            table,
            pending: Vec::new(),
        }
    }

    /// Reads new data from the memory, as a debug probe does.
    pub fn drain(&mut self, ram: &Ram) -> Vec<String> {
        self.take_bytes(ram);
        let mut lines = Vec::new();
        while let Some(end) = self.pending.iter().position(|&byte| byte == END_OF_FRAME) {
            let frame: Vec<u8> = self.pending.drain(..=end).collect();
            lines.extend(self.decode(&frame));
        }
        lines
    }

    /// Drops an incomplete line, after a reset of the program.
    pub fn restart(&mut self) {
        self.pending.clear();
    }

    fn take_bytes(&mut self, ram: &Ram) -> Option<()> {
        let word = |offset| ram.read(self.control_block + offset, 4);
        let magic = (0..MAGIC.len() as u32).map(|n| ram.read(self.control_block + n, 1));
        if !magic.eq(MAGIC.iter().map(|&byte| Some(byte.into()))) {
            return None;
        }
        let (buffer, size, write) = (word(BUFFER)?, word(SIZE)?, word(WRITE)?);
        let mut read = word(READ)?;
        if size == 0 || write >= size || read >= size {
            return None;
        }
        while read != write {
            self.pending.push(ram.read(buffer + read, 1)? as u8);
            read = (read + 1) % size;
        }
        ram.write(self.control_block + READ, 4, read)
    }

    fn decode(&self, bytes: &[u8]) -> Option<String> {
        let mut decoder = self.table.new_stream_decoder();
        decoder.received(bytes);
        match decoder.decode() {
            Ok(frame) => {
                let level = frame.level().map_or("", |level| level.as_str());
                Some(format!("{level} {}", frame.display_message()))
            }
            // An empty frame only separates.
            Err(DecodeError::UnexpectedEof) => None,
            Err(DecodeError::Malformed) => Some("(a damaged line)".into()),
        }
    }
}
