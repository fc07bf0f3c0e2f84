//! A sensor whose reading stands still while the command changes.
//!
//! Every real reading has noise, and a servo that is commanded moves. Where neither shows for a second, the sensor is
//! frozen or disconnected within its healthy range, or the servo has no power: what was recorded is no motion.

use servoid_protocol::{Counts, PulseWidth};
use std::fmt;
use std::ops::Range;

/// The shortest stretch of equal counts (s).
const SHORTEST_S: f64 = 1.0;

/// A stretch in which the reading stood still.
#[derive(Clone, Debug, PartialEq)]
pub struct StandStill {
    /// The reading.
    pub counts: Counts,
    /// Its samples.
    pub samples: Range<u64>,
    /// Time between two of them (s).
    pub sample_s: f64,
}

impl fmt::Display for StandStill {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            counts,
            samples,
            sample_s,
        } = self;
        let seconds = |samples: u64| samples as f64 * sample_s;
        write!(
            f,
            "the sensor's reading stood still at {} counts for {:.1} s from {:.1} s on, while the command changed: check the sensor, its wires and its magnet, and the servo's power",
            counts.0,
            seconds(samples.end - samples.start),
            seconds(samples.start)
        )
    }
}

/// Looks at readings as they come.
#[derive(Clone, Debug)]
pub struct FrozenSensor {
    sample_s: f64,
    /// [`SHORTEST_S`] in samples.
    shortest: u64,
    now: Option<EqualCounts>,
    /// All stretches that are over or long enough already.
    found: Vec<StandStill>,
}

/// Equal counts so far.
#[derive(Clone, Copy, Debug)]
struct EqualCounts {
    counts: Counts,
    pulse: PulseWidth,
    begin: u64,
    /// The first change of the pulse in it.
    commanded_at: Option<u64>,
    is_found: bool,
}

impl FrozenSensor {
    /// Nothing has been read. A sample comes every `sample_s` seconds.
    pub fn new(sample_s: f64) -> Self {
        Self {
            sample_s,
            shortest: (SHORTEST_S / sample_s).round() as u64,
            now: None,
            found: Vec::new(),
        }
    }

    /// Takes the next reading: the number of the sample, the pulse of its frame, and the counts.
    pub fn take(&mut self, sample: u64, pulse: PulseWidth, counts: Counts) {
        let goes_on = self.now.filter(|now| now.counts == counts);
        let mut now = goes_on.unwrap_or(EqualCounts {
            counts,
            pulse,
            begin: sample,
            commanded_at: None,
            is_found: false,
        });
        if now.pulse != pulse {
            now.pulse = pulse;
            now.commanded_at = now.commanded_at.or(Some(sample));
        }
        let end = sample + 1;
        // Half a second, more than the delay of any servo.
        let should_have_moved = now
            .commanded_at
            .is_some_and(|at| end - at >= self.shortest / 2);
        if now.is_found {
            if let Some(last) = self.found.last_mut() {
                last.samples.end = end;
            }
        } else if should_have_moved && end - now.begin >= self.shortest {
            now.is_found = true;
            let samples = now.begin..end;
            let sample_s = self.sample_s;
            self.found.push(StandStill {
                counts,
                samples,
                sample_s,
            });
        }
        self.now = Some(now);
    }

    /// The stretch that the newest reading belongs to.
    pub fn now(&self) -> Option<&StandStill> {
        self.now.filter(|now| now.is_found).and(self.found.last())
    }

    /// The stretches so far, in order.
    pub fn found(&self) -> &[StandStill] {
        &self.found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One reading after the other, of pulses and counts; the stretches that are found.
    fn find(readings: impl IntoIterator<Item = (u16, u16)>) -> Vec<StandStill> {
        let mut sensor = FrozenSensor::new(0.002);
        for (sample, (pulse, counts)) in (0..).zip(readings) {
            sensor.take(sample, PulseWidth(pulse), Counts(counts));
        }
        sensor.found().to_vec()
    }

    fn held(readings: usize, pulse: u16, counts: u16) -> impl Iterator<Item = (u16, u16)> {
        std::iter::repeat_n((pulse, counts), readings)
    }

    fn noisy(readings: u16, pulse: u16) -> impl Iterator<Item = (u16, u16)> {
        (0..readings).map(move |k| (pulse, 8_000 + k % 2))
    }

    #[test]
    fn a_reading_that_stands_still_while_the_command_changes_is_found_from_its_beginning() {
        let frozen = noisy(100, 1_500)
            .chain(held(400, 1_500, 9_000))
            .chain(held(900, 1_550, 9_000));
        assert_eq!(
            find(frozen.chain(noisy(10, 1_500))),
            vec![StandStill {
                counts: Counts(9_000),
                samples: 100..1_400,
                sample_s: 0.002,
            }]
        );
    }

    #[test]
    fn rest_without_a_command_a_short_stretch_and_noise_are_not_found() {
        assert_eq!(find(held(5_000, 1_500, 9_000)), []);
        assert_eq!(
            find(held(300, 1_500, 9_000).chain(held(199, 1_550, 9_000))),
            []
        );
        assert_eq!(find(noisy(3_000, 1_500).chain(noisy(3_000, 1_550))), []);
        // A servo at rest whose command has changed a moment ago.
        assert_eq!(
            find(held(5_000, 1_500, 9_000).chain(held(249, 1_550, 9_000))),
            []
        );
    }
}
