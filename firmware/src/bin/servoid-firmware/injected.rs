//! The one conversion in each frame that is not a sample: of the reference voltage, or in a self-test a probe.
//!
//! The reference voltage is measured when a frame's samples are complete, by software. A probe is started by channel 1 of
//! TIM2, at the instant that was asked for; the pin of that channel, PA0, stays an input. Both are injected conversions (11.3.9)
//! between two samples, and neither touches the sequence of the sensor.

use crate::{supply, timing};
use core::sync::atomic::{AtomicU16, Ordering};
use servoid_protocol::PulseTrain;
use servoid_protocol::loopback::{PROBES_AFTER_EDGE, PROBES_BEFORE_EDGE, Probe};
use servoid_protocol::pulse_train::SAMPLE_TAKES_US;
use stm32f1xx_hal::pac::{ADC1, TIM2};

/// The channel of the sensor, of samples and probes: ADC_IN4 is PA4.
pub const SENSOR_CHANNEL: u8 = 4;

/// The instant that the self-test asks for (µs after the frame edge); 0 for the reference voltage.
static ASKED: AtomicU16 = AtomicU16::new(0);

/// Calls of [`Injected::next`] after a change, until the result is that of the new instant: the compare value takes effect at
/// the frame edge, and a probe behind the samples is read in the next frame.
const SETTLED: u8 = 2;

/// A probe's conversion, with the trigger's latency and a margin (µs).
const PROBE_TAKES_US: u16 = 25;

// No probe meets a sample, and both edges of every pulse are within reach: the self-test has the usual train.
const _: () = {
    let train = PulseTrain::USUAL;
    let (first, sample_us) = (train.first_sample_us(), train.sample_us());
    let last = train.period_us - sample_us + first;
    let [shortest, longest] = train.pulses.board_limits();
    assert!(*PROBES_AFTER_EDGE.start() >= first + SAMPLE_TAKES_US);
    assert!(*PROBES_AFTER_EDGE.end() + PROBE_TAKES_US <= first + sample_us);
    assert!(*PROBES_BEFORE_EDGE.start() >= last + SAMPLE_TAKES_US + PROBE_TAKES_US);
    assert!(*PROBES_BEFORE_EDGE.end() < train.period_us);
    assert!(*PROBES_AFTER_EDGE.start() + PROBE_TAKES_US < shortest.0);
    assert!(*PROBES_AFTER_EDGE.end() > longest.0);
};

/// Asks for a probe in each frame, or for the reference voltage.
pub fn ask(at_us: Option<u16>) {
    ASKED.store(at_us.unwrap_or(0), Ordering::Relaxed);
}

/// The result of a frame.
#[derive(Clone, Copy, Default)]
pub struct Result {
    /// Of the reference voltage; 0 without one.
    pub bandgap: u16,
    /// The probe.
    pub probe: Option<Probe>,
}

/// What is being converted.
pub struct Injected {
    /// As [`ASKED`], when it was last followed.
    at_us: u16,
    /// Calls since then.
    age: u8,
}

impl Injected {
    /// The reference voltage, from the first frame on.
    pub const fn new() -> Self {
        Self { at_us: 0, age: 0 }
    }

    /// Takes the result of the last conversion, and starts or prepares the next one. The samples of the frame must be complete,
    /// so the ADC is idle.
    pub fn next(&mut self, adc: &ADC1) -> Result {
        let code = adc.jdr1().read().jdata().bits();
        let asked = ASKED.load(Ordering::Relaxed);
        let changed = asked != self.at_us;
        if changed {
            self.follow(asked, adc);
        }
        self.age = self.age.saturating_add(1);
        if asked == 0 {
            supply::start_bandgap(adc);
        }
        match asked {
            // The last conversion was a probe.
            0 if changed => Result::default(),
            0 => Result {
                bandgap: code,
                probe: None,
            },
            at_us => Result {
                bandgap: 0,
                probe: (self.age > SETTLED).then_some(Probe { at_us, code }),
            },
        }
    }

    fn follow(&mut self, asked: u16, adc: &ADC1) {
        // SAFETY: only this handler uses channel 1 of the timer. What is changed of the registers that it shares with channel 2
        // is written as it was read, and nothing else writes them in between: the fault handler does not return.
        let tim2 = unsafe { TIM2::steal() };
        match (self.at_us, asked) {
            (_, 0) => {
                timing::end_trigger(&tim2);
                supply::prepare_bandgap(adc);
            }
            (0, at_us) => {
                prepare_probe(adc);
                timing::begin_trigger(&tim2, at_us);
            }
            (_, at_us) => timing::move_trigger(&tim2, at_us),
        }
        (self.at_us, self.age) = (asked, 0);
    }
}

/// Prepares a probe: a single injected conversion of the sensor's pin, which channel 1 of TIM2 starts (11.7, table of external
/// triggers for injected channels; 11.12.12). The ADC must be idle.
fn prepare_probe(adc: &ADC1) {
    // SAFETY: channel 4 exists.
    adc.jsqr()
        .write(|w| unsafe { w.jsq4().bits(SENSOR_CHANNEL) });
    // Not with ADON alone: another bit changes, so nothing starts (11.12.3).
    adc.cr2().modify(|_, w| w.jextsel().tim2cc1());
}
