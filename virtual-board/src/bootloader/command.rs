//! The commands (AN3155 section 3, table "USART bootloader commands").

/// Version 2.2 of the bootloader: that of the STM32F10xxx of medium density (AN2606).
pub const VERSION: u8 = 0x22;

/// A command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    Get,
    GetVersion,
    GetId,
    Read,
    Go,
    Write,
    Erase,
    WriteProtect,
    WriteUnprotect,
    ReadProtect,
    ReadUnprotect,
}

const TABLE: [(u8, Command); 11] = [
    (0x00, Command::Get),
    (0x01, Command::GetVersion),
    (0x02, Command::GetId),
    (0x11, Command::Read),
    (0x21, Command::Go),
    (0x31, Command::Write),
    (0x43, Command::Erase),
    (0x63, Command::WriteProtect),
    (0x73, Command::WriteUnprotect),
    (0x82, Command::ReadProtect),
    (0x92, Command::ReadUnprotect),
];

impl Command {
    /// All codes, in the order of the table.
    pub const CODES: [u8; TABLE.len()] = {
        let mut codes = [0; TABLE.len()];
        let mut n = 0;
        while n < TABLE.len() {
            codes[n] = TABLE[n].0;
            n += 1;
        }
        codes
    };

    /// The command of a code.
    pub fn of(code: u8) -> Option<Self> {
        let row = TABLE.iter().find(|(of, _)| *of == code)?;
        Some(row.1)
    }

    /// Whether a read-protected chip has it: a footnote of the table names three, and the last one is what removes the
    /// protection.
    pub fn is_for_protected(self) -> bool {
        matches!(
            self,
            Self::Get | Self::GetVersion | Self::GetId | Self::ReadUnprotect
        )
    }
}
