//! The pulses that a servo is made for: how wide they are, and how often they come.
//!
//! An analogue servo takes 50 pulses in a second, a digital one up to 333, and the narrow-pulse servos of helicopter
//! tails up to 560. The unit of time of a run stays one *frame*: 1, 2, 5 or 10 equal pulses, in which ten samples are
//! taken. So a frame is never far from 20 ms, and neither the messages nor the memory of the board depend on the
//! train.
//!
//! ```text
//!  50 Hz   |_______________________________________|      1 pulse in 20 ms, a sample every 2 ms
//! 100 Hz   |___________________|___________________|      2 in 20 ms
//! 333 Hz   |_____|_____|_____|_____|_____|                5 in 15.02 ms, a sample every 1.502 ms
//! ```

use crate::units::PulseWidth;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Samples in one frame, whatever its length.
pub const SAMPLES_PER_FRAME: usize = 10;

/// The kind of pulses that a servo understands. The wrong kind drives it against a stop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum PulseType {
    /// Neutral at about 1500 or 1520 µs: nearly all servos.
    #[default]
    Wide,
    /// Neutral at about 760 µs: servos for the tails of helicopters.
    Narrow,
}

impl PulseType {
    /// The shortest and the longest pulse that a board ever makes for such a servo.
    ///
    /// Wide-pulse servos take 1-2 ms, many of them 0.8-2.2 ms as extended travel; longer or shorter pulses drive most of
    /// them against a stop. Narrow ones take half of that.
    pub const fn board_limits(self) -> [PulseWidth; 2] {
        match self {
            Self::Wide => [PulseWidth(800), PulseWidth(2_200)],
            Self::Narrow => [PulseWidth(400), PulseWidth(1_100)],
        }
    }

    /// The shortest period (µs): 333 Hz, or 560 Hz for narrow pulses.
    pub const fn shortest_period_us(self) -> u16 {
        match self {
            Self::Wide => 3_000,
            Self::Narrow => 1_785,
        }
    }

    /// The highest rate (Hz), as it is usually given.
    pub const fn highest_hz(self) -> u16 {
        match self {
            Self::Wide => 333,
            Self::Narrow => 560,
        }
    }
}

/// The longest period (µs): 50 Hz.
pub const LONGEST_PERIOD_US: u16 = 20_000;

/// The longest time that a sample takes, from its trigger to its end (µs): four conversions of 21 µs, and a margin.
pub const SAMPLE_TAKES_US: u16 = 100;

/// The shortest frame (µs). With one sample in 1.5 ms or more, no sample meets an edge of a pulse within
/// [`PulseType::board_limits`], and the board has time between a frame's last sample and its end.
const SHORTEST_FRAME_US: u32 = 15_000;

/// The train of pulses that a servo gets.
///
/// ```
/// use servoid_protocol::{PulseTrain, pulse_train::PulseType};
/// let rates = [50.0, 100.0, 250.0, 333.0].map(|hz| PulseTrain::at_rate(PulseType::Wide, hz).unwrap());
/// assert_eq!(rates.map(|train| train.period_us), [20_000, 10_000, 4_000, 3_004]);
/// assert_eq!(rates.map(|train| train.sample_us()), [2_000, 2_000, 2_000, 1_502]);
/// let narrow = PulseTrain::at_rate(PulseType::Narrow, 560.0).unwrap();
/// assert_eq!((narrow.period_us, narrow.sample_us()), (1_786, 1_786));
/// assert_eq!(PulseTrain::at_rate(PulseType::Wide, 560.0), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct PulseTrain {
    /// The kind of pulses.
    pub pulses: PulseType,
    /// From one rising edge to the next (µs).
    pub period_us: u16,
}

impl Default for PulseTrain {
    /// [`PulseTrain::USUAL`].
    fn default() -> Self {
        Self::USUAL
    }
}

impl PulseTrain {
    /// Wide pulses at 50 Hz: what every wide-pulse servo understands, and the paper's (§4).
    pub const USUAL: Self = Self {
        pulses: PulseType::Wide,
        period_us: LONGEST_PERIOD_US,
    };

    /// The train that comes nearest to `hz` pulses in a second; `None` where servos of that type take no such rate.
    pub fn at_rate(pulses: PulseType, hz: f64) -> Option<Self> {
        // The lowest rate and the highest are written in whole numbers.
        let within = (50.0..=f64::from(pulses.highest_hz()) + 0.5).contains(&hz);
        let exact_us = 1e6 / hz;
        let coarse = Self {
            pulses,
            period_us: if within { exact_us as u16 } else { return None },
        };
        // Whole microseconds between samples.
        let step = coarse.samples_per_pulse();
        let sample_us = (exact_us / f64::from(step) + 0.5) as u16;
        let train = Self {
            pulses,
            period_us: sample_us.saturating_mul(step),
        };
        train.is_sound().then_some(train)
    }

    /// Whether a board can make it: a period within the limits of its type, and whole microseconds between samples.
    #[inline(never)] // one copy in the image
    pub const fn is_sound(&self) -> bool {
        self.pulses.shortest_period_us() <= self.period_us
            && self.period_us <= LONGEST_PERIOD_US
            && self.period_us.is_multiple_of(self.samples_per_pulse())
    }

    /// Pulses in a second (Hz).
    pub fn rate_hz(&self) -> f64 {
        1e6 / f64::from(self.period_us)
    }

    /// Equal pulses in one frame: the fewest with which it is long enough, so that the sample period comes nearest to 2 ms.
    #[inline(never)] // one copy in the image
    pub const fn pulses_per_frame(&self) -> u16 {
        let period_us = self.period_us as u32;
        if period_us >= SHORTEST_FRAME_US {
            1
        } else if 2 * period_us >= SHORTEST_FRAME_US {
            2
        } else if 5 * period_us >= SHORTEST_FRAME_US {
            5
        } else {
            10
        }
    }

    /// Samples from one rising edge to the next.
    pub const fn samples_per_pulse(&self) -> u16 {
        SAMPLES_PER_FRAME as u16 / self.pulses_per_frame()
    }

    /// Length of a frame (µs): 15 to 37.5 ms.
    pub const fn frame_us(&self) -> u32 {
        self.period_us as u32 * self.pulses_per_frame() as u32
    }

    /// Time between two samples (µs).
    pub const fn sample_us(&self) -> u16 {
        self.period_us / self.samples_per_pulse()
    }

    /// Length of a frame (s).
    pub fn frame_s(&self) -> f64 {
        f64::from(self.frame_us()) / 1e6
    }

    /// Time between two samples (s).
    pub fn sample_s(&self) -> f64 {
        f64::from(self.sample_us()) / 1e6
    }

    /// From a pulse's rising edge to the start of the next sample (µs): away from both edges of every pulse within
    /// [`PulseType::board_limits`], and from the disturbance that the servo's own electronics makes at them.
    #[inline(never)] // one copy in the image
    pub const fn first_sample_us(&self) -> u16 {
        match self.pulses {
            // Before the shortest pulse ends. The next sample begins after the longest one has.
            PulseType::Narrow => 300,
            // At 2 ms half a millisecond does the same. A shorter sample period leaves less room, so the range of falling
            // edges, around 1.5 ms, lies in the middle between two samples.
            PulseType::Wide => {
                let middle = 1_500 - SAMPLE_TAKES_US / 2;
                let centred = middle.saturating_sub(self.sample_us() / 2);
                if centred > 500 { centred } else { 500 }
            }
        }
    }

    /// Whole frames in so many seconds.
    pub const fn frames_in(&self, seconds: u32) -> u16 {
        // A frame has 15 ms or more where the train is sound; another one has at least a microsecond.
        let frame_us = if self.frame_us() == 0 {
            1
        } else {
            self.frame_us()
        };
        let frames = seconds.saturating_mul(1_000_000) / frame_us;
        if frames > u16::MAX as u32 {
            u16::MAX
        } else {
            frames as u16
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(pulses: PulseType) -> impl Iterator<Item = PulseTrain> {
        let trains = (0..=u16::MAX).map(move |period_us| PulseTrain { pulses, period_us });
        trains.filter(PulseTrain::is_sound)
    }

    #[test]
    fn every_train_has_whole_samples_away_from_every_edge() {
        for pulses in [PulseType::Wide, PulseType::Narrow] {
            let [shortest, longest] = pulses.board_limits();
            let mut trains = 0;
            for train in all(pulses) {
                trains += 1;
                let sample_us = train.sample_us();
                assert_eq!(u32::from(sample_us) * 10, train.frame_us(), "{train:?}");
                assert!((15_000..=37_500).contains(&train.frame_us()), "{train:?}");
                assert!(longest.0 < train.period_us, "{train:?}");
                let first = train.first_sample_us();
                assert!(first < sample_us, "{train:?}");
                for sample in 0..train.samples_per_pulse() {
                    let at = first + sample * sample_us;
                    let before = at + SAMPLE_TAKES_US <= shortest.0;
                    let after = longest.0 <= at && at + SAMPLE_TAKES_US <= train.period_us;
                    assert!(before || after, "{train:?}: a sample at {at} us");
                }
            }
            assert!(trains > 1_000);
        }
    }

    #[test]
    fn the_usual_train_is_one_pulse_in_20_ms_and_a_sample_every_2_ms() {
        let usual = PulseTrain::USUAL;
        assert_eq!(
            (usual.frame_us(), usual.sample_us(), usual.first_sample_us()),
            (20_000, 2_000, 500)
        );
        assert_eq!((usual.frames_in(2), usual.frames_in(5)), (100, 250));
    }

    #[test]
    fn every_whole_rate_within_the_limits_is_met_to_one_in_a_thousand() {
        for (pulses, highest) in [(PulseType::Wide, 333), (PulseType::Narrow, 560)] {
            for hz in 50..=highest {
                let train = PulseTrain::at_rate(pulses, f64::from(hz)).unwrap();
                assert!((train.rate_hz() / f64::from(hz) - 1.0).abs() < 1e-3, "{hz}");
            }
            for hz in [49.0, f64::from(highest) + 1.0, 0.0, -1.0, f64::NAN] {
                assert_eq!(PulseTrain::at_rate(pulses, hz), None, "{hz}");
            }
        }
    }

    #[test]
    fn what_comes_over_the_wire_is_judged_without_a_panic() {
        for pulses in [PulseType::Wide, PulseType::Narrow] {
            for period_us in 0..=u16::MAX {
                let train = PulseTrain { pulses, period_us };
                let _ = (
                    train.is_sound(),
                    train.frames_in(5),
                    train.first_sample_us(),
                );
            }
        }
    }
}
