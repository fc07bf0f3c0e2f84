//! Which lines of the adapter set BOOT0 and reset, and in which order.

use super::error::FlashError;
use crate::instrument::port::{ControlLine, Port};
use std::str::FromStr;
use std::time::Duration;

/// A line of the adapter, and its state in which something is so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Switch {
    /// The line.
    pub line: ControlLine,
    /// Whether it is so while the line is set; while it is cleared otherwise.
    pub when_set: bool,
}

impl FromStr for Switch {
    type Err = String;

    /// ```
    /// use servoid::instrument::flash::Switch;
    ///
    /// assert!("rts".parse::<Switch>()?.when_set);
    /// assert!(!"!dtr".parse::<Switch>()?.when_set);
    /// assert!("cts".parse::<Switch>().is_err());
    /// # Ok::<(), String>(())
    /// ```
    fn from_str(text: &str) -> Result<Self, String> {
        let name = text.strip_prefix('!').unwrap_or(text);
        let line = match name {
            "rts" => ControlLine::Rts,
            "dtr" => ControlLine::Dtr,
            _ => return Err("it must be rts or dtr, or !rts or !dtr".to_owned()),
        };
        let when_set = name == text;
        Ok(Self { line, when_set })
    }
}

/// The lines that an adapter has at the board's pins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BootLines {
    /// When BOOT0 is high; without it a jumper sets it.
    pub boot0: Option<Switch>,
    /// When the board is held in reset; without it somebody presses the button.
    pub reset: Option<Switch>,
}

/// Time for a level to be there: the reset pin has 100 nF on most boards, and pull-ups of 40 kΩ (DS5319).
const SETTLED: Duration = Duration::from_millis(50);

impl BootLines {
    /// Whether a reset can be made from here.
    pub(super) fn can_reset(self) -> bool {
        self.reset.is_some()
    }

    /// Whether the program in the flash can be started by a reset from here.
    pub(super) fn can_start(self) -> bool {
        self.boot0.is_some() && self.reset.is_some()
    }

    /// Sets BOOT0 low, where a line does it.
    pub(super) fn let_go_of_boot0(self, port: &mut dyn Port) -> Result<(), FlashError> {
        put(port, self.boot0, false)
    }

    /// Resets the board with BOOT0 high or low, as far as there are lines for it.
    pub(super) fn reset_with(self, port: &mut dyn Port, boot0: bool) -> Result<(), FlashError> {
        put(port, self.boot0, boot0)?;
        if self.reset.is_some() {
            put(port, self.reset, true)?;
            put(port, self.reset, false)?;
        }
        Ok(())
    }
}

fn put(port: &mut dyn Port, switch: Option<Switch>, on: bool) -> Result<(), FlashError> {
    let Some(Switch { line, when_set }) = switch else {
        return Ok(());
    };
    let set = port.set_control_line(line, on == when_set);
    set.map_err(|error| FlashError::NoControlLine(line, error))?;
    // What comes meanwhile is of no use.
    let until = port.now() + SETTLED;
    while port.now() < until {
        let left = until.saturating_sub(port.now());
        port.read(&mut [0; 64], left)
            .map_err(|error| FlashError::NoControlLine(line, error))?;
    }
    Ok(())
}
