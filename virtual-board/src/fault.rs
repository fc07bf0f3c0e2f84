//! Injected faults.

use crate::time::{Ticks, from_duration};
use servoid_simulator::sensor::SensorFault;
use std::str::FromStr;
use std::time::Duration;
use thiserror::Error;

/// A direction on the serial line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the host to the board.
    ToBoard,
    /// From the board to the host.
    ToHost,
}

/// A disturbance of a byte on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disturbance {
    /// One of its bits is flipped.
    Flip,
    /// It is lost.
    Drop,
    /// Another byte is inserted before it.
    Inject,
    /// It comes up to half a second late, and so does what is behind it.
    Late,
}

/// An injected fault.
///
/// As text:
///
/// | text                             | fault                                                     |
/// |----------------------------------|-----------------------------------------------------------|
/// | `no-crystal`                     | the crystal never starts                                   |
/// | `no-pll`                         | the PLL never locks                                        |
/// | `crystal-stops@S`                | the crystal stops at second S, for ever                    |
/// | `sensor-open@S`, `sensor-short@S` | the sensor's wire is off, or shorted to the supply, from second S on |
/// | `sensor-open@S-T`, …             | the same, repaired at second T                             |
/// | `host-silent@S`                  | no byte from the host arrives from second S on            |
/// | `cpu-stuck@S`                    | the processor stops at second S, until the next reset      |
/// | `brown-out@S`                    | the supply is gone for 0.1 s                               |
/// | `supply-sags@S`, `supply-sags@S-T` | the 3.3 V fall to 2.6 V within 5 ms from second S on, until T |
/// | `reset-pin@S`                    | the reset pin is pulled                                    |
/// | `hard-fault@S`                   | the processor meets a hard fault                           |
/// | `stray-interrupt@S`              | an interrupt without a handler is raised                   |
/// | `debugger-halts@S`               | a debugger, attached from the beginning, halts the processor and leaves |
/// | `flip:P`, `drop:P`, `inject:P`, `late:P` | each byte, in both directions, is disturbed with probability P |
/// | `to-board-flip:P`, `to-host-drop:P`, … | the same in one direction                            |
///
/// ```
/// use virtual_board::fault::Fault;
/// assert_eq!("no-crystal".parse(), Ok(Fault::NoCrystal));
/// let fault: Fault = "to-host-drop:0.01".parse()?;
/// assert!(matches!(fault, Fault::Line { .. }));
/// # Ok::<(), virtual_board::fault::FaultError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// The crystal never starts.
    NoCrystal,
    /// The PLL never locks.
    NoPll,
    /// The crystal stops, for ever.
    CrystalStops(Ticks),
    /// The sensor breaks.
    Sensor(SensorFault),
    /// Bytes from the host no longer arrive.
    HostSilent(Ticks),
    /// The processor stops until the next reset.
    CpuStuck(Ticks),
    /// The supply drops out for [`BROWN_OUT`].
    BrownOut(Ticks),
    /// The supply falls below what the converter needs, and stays above the brown-out reset.
    SupplySags {
        /// When it begins to fall.
        from: Ticks,
        /// When it begins to rise; [`Ticks::MAX`] for never.
        to: Ticks,
    },
    /// The reset pin is pulled.
    ResetPin(Ticks),
    /// A hard fault.
    HardFault(Ticks),
    /// An interrupt that has no handler of its own.
    StrayInterrupt(Ticks),
    /// A debugger that was attached from the beginning halts the processor and leaves it.
    DebuggerHalts(Ticks),
    /// Bytes on the line are disturbed.
    Line {
        /// The direction; both where there is none.
        direction: Option<Direction>,
        /// The disturbance.
        disturbance: Disturbance,
        /// Its probability for each byte, 0 to 1.
        probability: f64,
    },
}

/// Duration of a brown-out.
pub const BROWN_OUT: Duration = Duration::from_millis(100);

/// An error for a text that names no fault.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "there is no fault '{0}': choose no-crystal, no-pll, crystal-stops@S, sensor-open@S, sensor-short@S, \
     host-silent@S, cpu-stuck@S, brown-out@S, supply-sags@S, reset-pin@S, hard-fault@S, stray-interrupt@S or \
     debugger-halts@S with S in seconds (sensor-open@S-T or supply-sags@S-T if it is repaired at T), or flip:P, drop:P, inject:P or late:P with P from 0 to 1, \
     each with to-board- or to-host- before it if it is one direction only"
)]
pub struct FaultError(String);

impl FromStr for Fault {
    type Err = FaultError;

    fn from_str(text: &str) -> Result<Self, FaultError> {
        let fault = if let Some(sensor) = text.strip_prefix("sensor-") {
            sensor.parse().ok().map(Self::Sensor)
        } else if let Some((name, at)) = text.split_once('@') {
            timed(name, at)
        } else if let Some((name, probability)) = text.split_once(':') {
            on_the_line(name, probability)
        } else {
            match text {
                "no-crystal" => Some(Self::NoCrystal),
                "no-pll" => Some(Self::NoPll),
                _ => None,
            }
        };
        fault.ok_or_else(|| FaultError(text.into()))
    }
}

fn timed(name: &str, at: &str) -> Option<Fault> {
    let seconds = |text: &str| {
        let duration = Duration::try_from_secs_f64(text.parse().ok()?).ok()?;
        Some(from_duration(duration))
    };
    if name == "supply-sags" {
        let (from, to) = at.split_once('-').map_or((at, None), |(f, t)| (f, Some(t)));
        let to = to.map_or(Some(Ticks::MAX), seconds)?;
        return Some(Fault::SupplySags {
            from: seconds(from)?,
            to,
        });
    }
    let at = seconds(at)?;
    Some(match name {
        "crystal-stops" => Fault::CrystalStops(at),
        "host-silent" => Fault::HostSilent(at),
        "cpu-stuck" => Fault::CpuStuck(at),
        "brown-out" => Fault::BrownOut(at),
        "reset-pin" => Fault::ResetPin(at),
        "hard-fault" => Fault::HardFault(at),
        "stray-interrupt" => Fault::StrayInterrupt(at),
        "debugger-halts" => Fault::DebuggerHalts(at),
        _ => return None,
    })
}

fn on_the_line(name: &str, probability: &str) -> Option<Fault> {
    let probability = probability.parse().ok()?;
    let prefixed = |prefix| name.strip_prefix(prefix);
    let (direction, name) = match (prefixed("to-board-"), prefixed("to-host-")) {
        (Some(name), _) => (Some(Direction::ToBoard), name),
        (_, Some(name)) => (Some(Direction::ToHost), name),
        _ => (None, name),
    };
    let disturbance = match name {
        "flip" => Disturbance::Flip,
        "drop" => Disturbance::Drop,
        "inject" => Disturbance::Inject,
        "late" => Disturbance::Late,
        _ => return None,
    };
    (0.0..=1.0).contains(&probability).then_some(Fault::Line {
        direction,
        disturbance,
        probability,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::milliseconds;

    #[test]
    fn texts() {
        assert_eq!(
            "cpu-stuck@3.5".parse(),
            Ok(Fault::CpuStuck(milliseconds(3_500)))
        );
        assert_eq!(
            "to-board-flip:0.5".parse(),
            Ok(Fault::Line {
                direction: Some(Direction::ToBoard),
                disturbance: Disturbance::Flip,
                probability: 0.5
            })
        );
        for bad in [
            "",
            "no-crystal@1",
            "cpu-stuck",
            "cpu-stuck@-1",
            "flip:2",
            "flip:x",
            "melt:0.1",
        ] {
            assert_eq!(bad.parse::<Fault>(), Err(FaultError(bad.into())));
        }
    }
}
