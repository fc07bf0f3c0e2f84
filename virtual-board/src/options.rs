//! The options of a board.

use crate::fault::Fault;
use servoid_simulator::SimulationOptions;

/// The options of a board.
#[derive(Clone, Debug)]
pub struct BoardOptions {
    /// Servo, sensor, noise and seed. The line always has 115200 baud, and the program sets the time of the samples.
    pub simulation: SimulationOptions,
    /// The faults.
    pub faults: Vec<Fault>,
    /// Frequency of the low-speed oscillator that the watchdog runs on (Hz): 40 kHz, by the datasheet
    /// anything from 30 to 60.
    pub lsi_hz: u32,
    /// Whether pulses and conversions are recorded.
    pub keeps_signals: bool,
}

impl BoardOptions {
    /// A board without faults, with `simulation` on its wires, that records everything.
    #[must_use]
    pub fn new(simulation: SimulationOptions) -> Self {
        Self {
            simulation,
            faults: Vec::new(),
            lsi_hz: 40_000,
            keeps_signals: true,
        }
    }

    /// The same with one more fault.
    #[must_use]
    pub fn with_fault(mut self, fault: Fault) -> Self {
        self.faults.push(fault);
        self
    }
}
