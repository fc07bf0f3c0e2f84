//! Whether each command waits for the next pulse of a regular frame.
//!
//! A servo sees its command with pulses, of which a receiver or a library sends one every T = 20 ms or so, whatever the rows of a recording
//! are. A command of the time t waits for the next one,
//!
//! ```text
//! w(t) = (t0 - t) mod T = T/2 + Σ_k T/(π k) sin(2π k (t - t0)/T)
//! ```
//!
//! so for each T the first harmonic of the times of the answers gives t0, and the w that explains the times best has to explain nearly all of them.
//! Under equal holds anything that alternates from stroke to stroke is such a w for some T, so they show no frame.

use std::f64::consts::TAU;

/// The time of a command, and by how much its answer is later than the others \[s\].
pub(super) struct TimedAnswer {
    pub(super) at_s: f64,
    pub(super) late_s: f64,
}

/// Frames are looked for between these parts of the length over which the answers scatter, which is known to a fifth or so.
const PARTS: [f64; 2] = [0.7, 1.4];

/// Steps of the frequency in reciprocals of the time from the first command to the last: with five, the frame is off by a twentieth of itself
/// at both ends.
const STEPS: f64 = 5.0;

/// Share of the times that the wait may leave: noise, and the row up to which a time is known.
const MOST_LEFT: f64 = 0.25;

/// Probability of such a wait by chance.
const CHANCE: f64 = 1e-4;

/// Share of the times between commands that may be the same.
const MOST_EQUAL: f64 = 0.3;

/// The length of the frames \[s\], of answers that scatter over `scatter_s`; `None` where commands do not wait so.
pub(super) fn frame_length(answers: &[TimedAnswer], scatter_s: f64) -> Option<f64> {
    if share_of_usual_hold(answers) > MOST_EQUAL {
        return None;
    }
    let count = answers.len() as f64;
    let (first, last) = (answers.first()?.at_s, answers.last()?.at_s);
    let mean = answers.iter().map(|answer| answer.late_s).sum::<f64>() / count;
    let [highest, lowest] = PARTS.map(|part| (part * scatter_s).recip());
    let step = (STEPS * (last - first)).recip();
    let tries = ((highest - lowest) / step).max(1.0);
    let frequencies = (0..tries.ceil() as usize).map(|k| lowest + k as f64 * step);
    let left = frequencies.map(|frequency| (frequency, left_by_wait(answers, mean, frequency)));
    let (frequency, left) = left.min_by(|a, b| a.1.total_cmp(&b.1))?;
    // A length, a phase, and a mean are fitted.
    let chance = tries * left.powf(0.5 * (count - 3.0));
    (left < MOST_LEFT && chance < CHANCE).then(|| frequency.recip())
}

/// Share of the holds that are as long as the most frequent one, to a microsecond.
fn share_of_usual_hold(answers: &[TimedAnswer]) -> f64 {
    let pairs = answers.iter().zip(answers.iter().skip(1));
    let mut holds: Vec<i64> = pairs
        .map(|(a, b)| (1e6 * (b.at_s - a.at_s)).round() as i64)
        .collect();
    holds.sort_unstable();
    let most = holds.chunk_by(|a, b| a == b).map(<[i64]>::len).max();
    most.unwrap_or(0) as f64 / holds.len().max(1) as f64
}

/// The share of the squared times about their `mean` that the wait for pulses of this `frequency` leaves. Commands at rows show it
/// as that of other frequencies, too, whose waits are shorter or longer: so the harmonic gives the moment of the pulses alone.
fn left_by_wait(answers: &[TimedAnswer], mean: f64, frequency: f64) -> f64 {
    let cycles = |answer: &TimedAnswer| frequency * answer.at_s;
    let harmonic = answers.iter().map(|answer| {
        let (sin, cos) = (TAU * cycles(answer)).sin_cos();
        ((answer.late_s - mean) * cos, (answer.late_s - mean) * sin)
    });
    let (cos, sin) = harmonic.fold((0.0, 0.0), |(a, b), (cos, sin)| (a + cos, b + sin));
    // cos : sin of the harmonic are those of sin(2π (t - t0)/T).
    let pulse = f64::atan2(cos, sin) / TAU;
    let wait = |answer: &TimedAnswer| (1.0 - (cycles(answer) + pulse).rem_euclid(1.0)) / frequency;
    let mean_wait = answers.iter().map(wait).sum::<f64>() / answers.len() as f64;
    let of = |part: &dyn Fn(&TimedAnswer) -> f64| -> f64 {
        answers.iter().map(|answer| part(answer).powi(2)).sum()
    };
    let of_times = of(&|answer| answer.late_s - mean);
    of(&|answer| answer.late_s - mean - (wait(answer) - mean_wait)) / of_times
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
            let found = frame_length(&late, 0.9 * frame).unwrap();
            // A step of the frequency is 1/150 s.
            assert!((found / frame - 1.0).abs() < 0.5 * found / 150.0, "{found}");
        }
    }

    #[test]
    fn waits_that_follow_no_clock_are_no_frames() {
        let late = answers(|k, _| 0.02 * random(3 * k + 1));
        assert_eq!(frame_length(&late, 0.02), None);
    }
}
