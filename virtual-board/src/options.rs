//! The options of a board.

use crate::fault::Fault;
use crate::loop_wire::LoopWire;
use crate::memory::{FLASH_BYTES, RAM_BYTES};
use crate::supply::NOMINAL;
use crate::time::{Ticks, microseconds};
use servoid_simulator::SimulationOptions;

/// 5.1 kΩ parallel to 10 kΩ: the divider of the wiring.
const DIVIDER_OHMS: f64 = 3_377.0;

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
    /// Error of the internal oscillator's 8 MHz, relative: -0.02 to 0.025 by the datasheet.
    pub hsi_error: f64,
    /// Error of the crystal's 8 MHz, relative.
    pub crystal_error: f64,
    /// Time from a write of SW in RCC_CFGR to the switch of the system clock, for which the manual gives none.
    pub clock_switching: Ticks,
    /// Whether a resistor pulls PA1 to ground. Without it, the level of the line while nothing drives it is by chance.
    pub pull_down: bool,
    /// Static memory of the chip (bytes): some that are sold as an STM32F103C8 have half of its 20 KiB.
    pub ram_bytes: u32,
    /// Flash of the chip (KiB).
    pub flash_kib: u16,
    /// What the bootloader answers when it is asked for the chip: 0x410 is an STM32F10xxx of medium density (AN2606).
    pub product_id: u16,
    /// Whether the flash is protected against reading it out.
    pub read_protected: bool,
    /// Whether BOOT0 is high: a reset then starts the bootloader.
    pub boot0: bool,
    /// Whether the unique number can be read at any clock: on some clones it reads as all ones above 24 MHz.
    pub identity_at_any_clock: bool,
    /// Whether every access to the flash waits, as if there was no prefetch buffer: two for each instruction, one for
    /// itself and one for data beside it. A chip is faster than that, and slower than with no wait at all.
    pub slow_flash: bool,
    /// Whether somebody reads the program's log.
    pub drains_log: bool,
    /// Impedance of what is at PA4 (Ω): the ADC's sampling capacitor charges through it.
    pub source_ohms: f64,
    /// Error of the sensor's 5 V, relative: USB allows -0.05 to 0.05. The sensor's output is proportional to it.
    pub sensor_supply_error: f64,
    /// The wire of the self-test, in the sensor's place.
    pub loop_wire: Option<LoopWire>,
    /// The 3.3 V, as they are (mV).
    pub supply_millivolts: u64,
    /// Time by which the samples are late.
    pub samples_late: Ticks,
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
            hsi_error: 0.0,
            crystal_error: 0.0,
            clock_switching: microseconds(5),
            pull_down: true,
            ram_bytes: RAM_BYTES,
            flash_kib: (FLASH_BYTES / 1024) as u16,
            product_id: 0x410,
            read_protected: false,
            boot0: false,
            identity_at_any_clock: true,
            slow_flash: false,
            drains_log: true,
            source_ohms: DIVIDER_OHMS,
            sensor_supply_error: 0.0,
            loop_wire: None,
            supply_millivolts: NOMINAL,
            samples_late: 0,
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
