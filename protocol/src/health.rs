//! The health of a board: its chip, its supply, and the fault that led to its last start.

use crate::hello::Text16;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Conversions of the internal reference voltage in one reading.
pub const BANDGAP_CONVERSIONS: u16 = 16;

/// What a board says about itself beyond its [`Hello`](crate::Hello), which is frozen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Health {
    /// Flash of the chip (KiB), as the chip says; 0 where it is not known.
    pub flash_kib: u16,
    /// The chip's device and revision code; 0 where the chip hides it, as many do without a debugger.
    pub device: u32,
    /// The first reading of the internal reference voltage after the start, the sum of [`BANDGAP_CONVERSIONS`]; 0
    /// before it. It rises as the supply falls, since it is measured relative to it.
    pub bandgap_at_start: u16,
    /// The newest reading.
    pub bandgap: u16,
    /// Frames since the start in which the supply was too low.
    pub low_supply_frames: u32,
    /// The fault that led to the last start, if one did.
    pub last_fault: Option<LastFault>,
}

impl Health {
    /// The supply now, relative to the supply at the start; `None` where it is not measured.
    pub fn supply_ratio(&self) -> Option<f64> {
        let measured = self.bandgap != 0 && self.bandgap_at_start != 0;
        measured.then(|| f64::from(self.bandgap_at_start) / f64::from(self.bandgap))
    }
}

/// The kind of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum FaultKind {
    /// A panic of the program: `place` is the end of the file's name, `detail` the line.
    Panic,
    /// A hard fault of the processor: `detail` is the program counter, or 0 where it is not known.
    HardFault,
    /// The crystal stopped.
    CrystalStopped,
    /// An interrupt without a handler: `detail` is its number.
    StrayInterrupt,
}

/// A fault that ended the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct LastFault {
    /// Its kind.
    pub kind: FaultKind,
    /// A number, see [`FaultKind`].
    pub detail: u32,
    /// A place, see [`FaultKind`].
    pub place: Text16,
}
