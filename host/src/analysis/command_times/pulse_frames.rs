//! Whether each command waits for the next pulse of a regular frame.
//!
//! A servo sees its command with pulses, of which a receiver or a library sends one every T = 20 ms or so, whatever the rows of a recording
//! are. A command of the time t waits for the next one,
//!
//! ```text
//! w(t) = (t0 - t) mod T = T/2 + Σ_k T/(π k) sin(2π k (t - t0)/T)
//! ```
//!
//! so for each T the first harmonic of the times of the answers gives a first t0, and the w that explains the times best has to explain
//! nearly all of them. Commands at rows show such a w as one of other frequencies, too, whose waits are shorter or longer: the times
//! themselves show which.
//!
//! Under equal holds too many frequencies are alike for the length to be known. What each command waited for is known nevertheless.

use servoid_identification::{Record, Run};
use std::f64::consts::TAU;

/// The time of a command, and by how much its answer is later than the others \[s\].
#[derive(Clone, Copy)]
pub(crate) struct TimedAnswer {
    pub(crate) at_s: f64,
    pub(crate) late_s: f64,
}

/// Frames are looked for between these parts of the length over which the answers scatter, which is known to a fifth or so.
const PARTS: [f64; 2] = [0.7, 1.4];

/// Steps of the frequency in reciprocals of the time from the first command to the last: with five, the frame is off by a twentieth of itself
/// at both ends.
const STEPS: f64 = 5.0;

/// So many of these are looked at more closely: where commands come at few parts of a frame, the harmonic is off by some of it.
const REFINED: usize = 10;

/// The step, in frames, by which moments of pulses are moved first.
const MOMENT: f64 = 0.1;

/// Times that both steps are halved: pulses are then known to a few thousandths of a frame.
const HALVED: usize = 6;

/// Share of the times that the wait may leave: noise, and the row up to which a time is known.
const MOST_LEFT: f64 = 0.25;

/// Probability of such a wait by chance.
const CHANCE: f64 = 1e-4;

/// Share of the times between commands that may be the same where the length of the frame is known.
const MOST_EQUAL: f64 = 0.3;

/// Part of a frame before and after a pulse in which a time of an answer shows with which pulse it came, and not the clock of the pulses.
const BESIDE_PULSE: f64 = 0.15;

/// Regular pulses that commands wait for.
pub(crate) struct PulseFrames {
    clock: Clock,
    /// By how much an answer is later than the others if its command did not wait \[s\].
    without_wait_s: f64,
    /// The length of a frame \[s\]; `None` under equal holds, which do not show it.
    pub(crate) length_s: Option<f64>,
}

impl PulseFrames {
    /// Of answers that scatter over `scatter_s`; `None` where commands do not wait so.
    pub(crate) fn of(answers: &[TimedAnswer], scatter_s: f64) -> Option<Self> {
        let (first, last) = (answers.first()?.at_s, answers.last()?.at_s);
        let [highest, lowest] = PARTS.map(|part| (part * scatter_s).recip());
        let step = (STEPS * (last - first)).recip();
        let tries = ((highest - lowest) / step).max(1.0);
        let times = Times::of(answers);
        let mut rough: Vec<(Clock, f64)> = (0..tries.ceil() as usize)
            .map(|k| times.clock_of(lowest + k as f64 * step))
            .map(|clock| (clock, times.left_by(clock)))
            .collect();
        rough.sort_by(|a, b| a.1.total_cmp(&b.1));
        let best = rough.into_iter().take(REFINED);
        let refined = best.map(|rough| times.refined(rough, [step, MOMENT]));
        let (clock, left) = refined.min_by(|a, b| a.1.total_cmp(&b.1))?;
        // A length, a moment, and a mean are fitted.
        let chance = tries * left.powf(0.5 * (answers.len() as f64 - 3.0));
        (left < MOST_LEFT && chance < CHANCE).then(|| Self {
            clock,
            without_wait_s: times.mean_without(clock),
            length_s: (share_of_usual_hold(answers) <= MOST_EQUAL).then(|| clock.frequency.recip()),
        })
    }

    /// How long a command of the time `at_s` waits \[s\]. One beside a pulse came with this or the next, whichever its answer of `late_s` says, where there is one.
    pub(crate) fn wait_s(&self, at_s: f64, late_s: Option<f64>) -> f64 {
        let wait = self.clock.wait_s(at_s);
        let frames = wait * self.clock.frequency;
        let other = match frames {
            soon if soon < BESIDE_PULSE => wait + self.clock.frequency.recip(),
            late if late > 1.0 - BESIDE_PULSE => wait - self.clock.frequency.recip(),
            _ => return wait,
        };
        let apart =
            |wait: f64| late_s.map_or(0.0, |late| (late - self.without_wait_s - wait).abs());
        if apart(other) < apart(wait) {
            other.max(0.0)
        } else {
            wait
        }
    }
}

/// Pulses of a `frequency` \[1/s\], the first after time 0 when a share `pulse` of a frame is left of 1.
#[derive(Clone, Copy)]
struct Clock {
    frequency: f64,
    pulse: f64,
}

impl Clock {
    /// From the time `at_s` to the next pulse \[s\].
    fn wait_s(&self, at_s: f64) -> f64 {
        (1.0 - (self.frequency * at_s + self.pulse).rem_euclid(1.0)) / self.frequency
    }
}

/// The times of answers about their mean.
struct Times<'a> {
    answers: &'a [TimedAnswer],
    mean: f64,
    /// Sum of their squares.
    square: f64,
}

impl<'a> Times<'a> {
    fn of(answers: &'a [TimedAnswer]) -> Self {
        let late = answers.iter().map(|answer| answer.late_s);
        let mean = late.clone().sum::<f64>() / answers.len() as f64;
        Self {
            answers,
            mean,
            square: late.map(|late| (late - mean).powi(2)).sum(),
        }
    }

    /// That of a `frequency` by the first harmonic of the times.
    fn clock_of(&self, frequency: f64) -> Clock {
        let harmonic = self.answers.iter().map(|answer| {
            let (sin, cos) = (TAU * frequency * answer.at_s).sin_cos();
            let late = answer.late_s - self.mean;
            (late * cos, late * sin)
        });
        let (cos, sin) = harmonic.fold((0.0, 0.0), |(a, b), (cos, sin)| (a + cos, b + sin));
        // cos : sin of the harmonic are those of sin(2π (t - t0)/T).
        Clock {
            frequency,
            pulse: f64::atan2(cos, sin) / TAU,
        }
    }

    /// The mean of what the wait for `clock` leaves.
    fn mean_without(&self, clock: Clock) -> f64 {
        let waits = self.answers.iter().map(|answer| clock.wait_s(answer.at_s));
        self.mean - waits.sum::<f64>() / self.answers.len() as f64
    }

    /// The share of the squares that the wait for `clock` leaves.
    fn left_by(&self, clock: Clock) -> f64 {
        let without = self.mean_without(clock);
        let left = |answer: &TimedAnswer| answer.late_s - clock.wait_s(answer.at_s) - without;
        let square = self.answers.iter().map(|answer| left(answer).powi(2));
        square.sum::<f64>() / self.square
    }

    /// The best clock about a `rough` one with the share that it leaves, from steps of frequency and moment on.
    fn refined(&self, rough: (Clock, f64), steps: [f64; 2]) -> (Clock, f64) {
        let mut best = rough;
        for halved in 1..=HALVED {
            let [of_frequency, of_pulse] = steps.map(|step| step / f64::from(1 << halved));
            let (about, _) = best;
            for (i, j) in (-2..=2).flat_map(|i| (-2..=2).map(move |j| (i, j))) {
                let clock = Clock {
                    frequency: about.frequency + f64::from(i) * of_frequency,
                    pulse: about.pulse + f64::from(j) * of_pulse,
                };
                let left = self.left_by(clock);
                if left < best.1 {
                    best = (clock, left);
                }
            }
        }
        best
    }
}

/// Share of the holds that are as long as the most frequent one, to a microsecond.
fn share_of_usual_hold(answers: &[TimedAnswer]) -> f64 {
    let pairs = answers.iter().zip(answers.iter().skip(1));
    let holds = pairs.map(|(a, b)| (1e6 * (b.at_s - a.at_s)).round() as i64);
    share_of_most_frequent(holds.collect())
}

/// Whether so many holds of `record` are of one length that it shows no frame of pulses.
pub(crate) fn has_equal_holds(record: &Record<'_>) -> bool {
    equal_hold(record).is_some()
}

/// That length \[samples\].
pub(crate) fn equal_hold(record: &Record<'_>) -> Option<usize> {
    let inputs = record.runs().iter().map(Run::input);
    let holds = inputs.flat_map(|input| input.chunk_by(|a, b| a == b));
    let (length, share) = most_frequent(holds.map(|hold| hold.len() as i64).collect())?;
    (share > MOST_EQUAL).then_some(length as usize)
}

fn share_of_most_frequent(lengths: Vec<i64>) -> f64 {
    most_frequent(lengths).map_or(0.0, |(_, share)| share)
}

/// The most frequent of these lengths, and its share.
fn most_frequent(mut lengths: Vec<i64>) -> Option<(i64, f64)> {
    lengths.sort_unstable();
    let all = lengths.len() as f64;
    let most = lengths
        .chunk_by(|a, b| a == b)
        .max_by_key(|alike| alike.len())?;
    Some((*most.first()?, most.len() as f64 / all))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(k: u32) -> f64 {
        (f64::from(k) * f64::from(k) * 0.754_877_666_2).fract()
    }

    /// Commands of 60 times over 30 s that wait for pulses of this length, known to a row of 4 ms.
    fn answers(wait: impl Fn(u32, f64) -> f64) -> Vec<TimedAnswer> {
        let at = |k: u32| 0.004 * (125.0 * (f64::from(k) + 0.5 * random(7 * k))).round();
        let answer = |k: u32| TimedAnswer {
            at_s: at(k),
            late_s: wait(k, at(k)) + 0.002 * random(11 * k + 3),
        };
        (0..60).map(answer).collect()
    }

    #[test]
    fn the_length_of_a_frame_is_found() {
        for frame in [0.02, 0.022, 0.0111] {
            let late = answers(|_, at| frame - (at + 0.0073).rem_euclid(frame));
            let found = PulseFrames::of(&late, 0.9 * frame).unwrap();
            let length = found.length_s.unwrap();
            // A step of the frequency is 1/150 s.
            assert!(
                (length / frame - 1.0).abs() < 0.5 * length / 150.0,
                "{length}"
            );
            // To a tenth of a frame, with the row of a time and the wait of one row.
            for answer in &late {
                let wait = frame - (answer.at_s + 0.0073).rem_euclid(frame);
                let off = found.wait_s(answer.at_s, Some(answer.late_s)) - wait;
                assert!(off.abs() < 0.1 * frame, "{off}");
            }
        }
    }

    #[test]
    fn waits_that_follow_no_clock_are_no_frames() {
        let late = answers(|k, _| 0.02 * random(3 * k + 1));
        assert!(PulseFrames::of(&late, 0.02).is_none());
    }

    #[test]
    fn equal_holds_show_waits_and_not_how_long_frames_are() {
        let wait = |at: f64| 0.02 - (at + 0.0073).rem_euclid(0.02);
        let late: Vec<TimedAnswer> = (0..60u32)
            .map(|k| {
                let at_s = 0.247 * f64::from(k);
                let late_s = wait(at_s) + 0.002 * random(11 * k + 3);
                TimedAnswer { at_s, late_s }
            })
            .collect();
        let found = PulseFrames::of(&late, 0.018).unwrap();
        assert_eq!(found.length_s, None);
    }
}
