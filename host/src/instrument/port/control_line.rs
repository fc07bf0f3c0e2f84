//! The two lines of a serial adapter that a program sets beside the data.

use std::fmt;

/// A line of a serial adapter that a program sets beside the data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlLine {
    /// Request to send.
    Rts,
    /// Data terminal ready.
    Dtr,
}

impl fmt::Display for ControlLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rts => "RTS",
            Self::Dtr => "DTR",
        })
    }
}
