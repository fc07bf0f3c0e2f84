//! How a servo arrives at the last commands to both sides: whether it slows down, or ends at full speed as at a stop.
//!
//! Under a command of two levels the rests show no stop: two points are a line. The way there does. A servo that is free slows down before its rest,
//! or goes beyond it and comes back. One that runs into a stop does neither. For each stroke between two rests,
//!
//! ```text
//! a = v (t98 - t90) / (0.08 travel)
//! ```
//!
//! compares the time from 90 to 98 % of the travel with what the highest mean speed v over a fifth of the travel takes: 1 for a motion
//! that is cut off, 3.9 for a response like a bell curve, 8.9 for a double lag. What no record distinguishes from a stop is a servo that
//! turns at a programmed slow speed and has no overshoot.

use crate::data::{EXACTLY, Hold, Record, Run, holds, last_quarter, mean_output};
use crate::numerics::median;
use crate::results::Model;
use crate::thresholds::{CUT_OFF, MARGIN, PASSES_ITS_END, SLOWS_DOWN};

/// Strokes to an end that are needed.
const STROKES: usize = 2;

/// Samples from 10 to 90 % of a stroke that are needed: the last tenth of a servo's way then has several.
const SAMPLES_ON_THE_WAY: f64 = 8.0;

/// Largest noise, as a share of the travel (rms): it moves `a` of one stroke by 0.09.
const LARGEST_NOISE: f64 = 0.005;

/// Standard deviations of the noise by which a servo goes beyond its rest for sure, and by which means of three samples go beyond it by chance.
const OF_NOISE: f64 = 4.0;
const AT_END: f64 = 3.0;

/// What rounding leaves of a record without noise, as a share of the travel.
const ROUNDING: f64 = 1e-12;

/// How the servo comes to its rests under one command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Approach {
    /// At full speed, and no farther.
    CutOff,
    /// It slows down, or passes its rest and comes back.
    Free,
    /// The record does not show it.
    Unknown,
}

/// The arrivals at one of the two outermost commands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrival {
    /// The command \[input\].
    pub command: f64,
    /// Where the servo rests under it, the median of its strokes \[output\].
    pub rest: f64,
    /// How it gets there.
    pub approach: Approach,
}

impl Arrival {
    /// The arrivals at the lowest and the highest command; `None` where no stroke from one rest to another ends there. The N of the
    /// `model` gives the length of a response.
    ///
    /// ```
    /// use servoid_identification::diagnostics::{Approach, Arrival};
    /// use servoid_identification::{identify, Options, Record};
    /// let u: Vec<f64> = (0..4000).map(|k| if k / 250 % 2 == 0 { -20.0 } else { 20.0 }).collect();
    /// let free = |limit: f64| -> Record {
    ///     let (mut lag, mut y) = (0.0, 0.0);
    ///     let output: Vec<f64> = u.iter().map(|u| { lag += 0.04 * (u - lag); y += 0.04 * (lag - y); y.clamp(-limit, limit) }).collect();
    ///     Record::of_run(0.002, u.clone(), output).unwrap()
    /// };
    /// let approach = |record: &Record| -> Result<Option<Approach>, servoid_identification::Error> {
    ///     let model = identify(record, &Options::default())?;
    ///     Ok(Arrival::at_both_ends(record, &model)[1].map(|found| found.approach))
    /// };
    /// assert_eq!(approach(&free(30.0))?, Some(Approach::Free));
    /// assert_eq!(approach(&free(4.0))?, Some(Approach::CutOff));
    /// # Ok::<(), servoid_identification::Error>(())
    /// ```
    #[must_use]
    pub fn at_both_ends(record: &Record, model: &Model) -> [Option<Self>; 2] {
        let settling = (model.structure.settling_samples as f64 / MARGIN).ceil() as usize;
        let mut all: Vec<(f64, Way)> = Vec::new();
        for run in record.runs() {
            for pair in holds(run, EXACTLY).windows(2) {
                let is_whole = |hold: &Hold| hold.samples.len() >= settling;
                let is_stroke = pair.iter().all(is_whole) && pair[1].before.is_some();
                all.extend(
                    is_stroke
                        .then(|| Some((pair[1].level, Way::of(run, &pair[0], &pair[1])?)))
                        .flatten(),
                );
            }
        }
        let commands = || all.iter().map(|(command, _)| *command);
        let ends = [commands().reduce(f64::min), commands().reduce(f64::max)];
        ends.map(|end| {
            let command = end?;
            let at_end = all.iter().filter(|(level, _)| *level == command);
            Self::of(command, &at_end.map(|(_, way)| *way).collect::<Vec<_>>())
        })
    }

    fn of(command: f64, ways: &[Way]) -> Option<Self> {
        let middle = |of: fn(&Way) -> f64| median(ways.iter().map(of).collect());
        let (slowness, beyond) = (middle(|way| way.slowness)?, middle(|way| way.beyond)?);
        let noise = middle(|way| way.noise)?;
        let is_known = ways.len() >= STROKES
            && middle(|way| way.samples)? >= SAMPLES_ON_THE_WAY
            && noise <= LARGEST_NOISE;
        let passes_its_end = beyond > PASSES_ITS_END.max(OF_NOISE * noise);
        let approach = match is_known {
            true if passes_its_end || slowness > SLOWS_DOWN => Approach::Free,
            true if slowness < CUT_OFF && beyond < ROUNDING + AT_END * noise => Approach::CutOff,
            _ => Approach::Unknown,
        };
        Some(Self {
            command,
            rest: middle(|way| way.rest)?,
            approach,
        })
    }
}

/// The way of one stroke from rest to rest.
#[derive(Debug, Clone, Copy)]
struct Way {
    rest: f64,
    /// What the head of this file calls a.
    slowness: f64,
    /// How far it goes beyond its rest, as a share of the travel.
    beyond: f64,
    /// Samples from 10 to 90 %.
    samples: f64,
    /// Noise at rest, as a share of the travel (rms).
    noise: f64,
}

impl Way {
    fn of(run: &Run, before: &Hold, after: &Hold) -> Option<Self> {
        let start = mean_output(run, last_quarter(&before.samples))?;
        let at_rest = last_quarter(&after.samples);
        let rest = mean_output(run, at_rest.clone())?;
        let share = |y: &f64| (y - start) / (rest - start);
        let way: Vec<f64> = run.output()[after.samples.start - 1..after.samples.end]
            .iter()
            .map(share)
            .collect();
        let crossing = |level: f64| {
            let k = way.iter().position(|share| *share >= level)?;
            let (low, high) = (*way.get(k.checked_sub(1)?)?, way[k]);
            let time = (k - 1) as f64 + (level - low) / (high - low);
            // A missing sample on the way makes this NaN.
            time.is_finite().then_some(time)
        };
        let tenths: Vec<f64> = (1..10)
            .map(|k| crossing(0.1 * f64::from(k)))
            .collect::<Option<_>>()?;
        let fifths = tenths.windows(3).map(|tenths| tenths[2] - tenths[0]);
        let shortest_fifth = fifths.reduce(f64::min)?;
        let errors = run.output()[at_rest].iter().map(|y| share(y) - 1.0);
        let squares: Vec<f64> = errors
            .filter(|error| error.is_finite())
            .map(|error| error * error)
            .collect();
        let noise = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        Some(Self {
            rest,
            slowness: (crossing(0.98)? - tenths[8]) / shortest_fifth * 0.2 / 0.08,
            // Of three samples, of which noise moves the mean less.
            beyond: way
                .windows(3)
                .map(|three| three.iter().sum::<f64>() / 3.0 - 1.0)
                .fold(0.0, f64::max),
            samples: tenths[8] - tenths[0],
            noise,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};

    /// Holds of half a second at -20 and 20, every 2 ms.
    const HOLD: usize = 250;

    /// A servo of second order, delay apart, whose drive turns it no faster than `speed` and brakes it with `brake` at most, between stops at
    /// -`stop` and `stop`; 0.05 of noise.
    fn approaches(zeta: f64, omega: f64, limits: [f64; 3], seed: u64) -> Option<[Approach; 2]> {
        let [speed, brake, stop] = limits;
        let noise = Normal::new(0.0, 0.05).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let level = |k: usize| {
            if (k / HOLD).is_multiple_of(2) {
                -20.0
            } else {
                20.0
            }
        };
        let (mut angle, mut rate) = (f64::max(-20.0, -stop), 0.0);
        let output: Vec<f64> = (0..10 * HOLD)
            .map(|k| {
                for _ in 0..40 {
                    let drive = omega * omega * (level(k) - angle) - 2.0 * zeta * omega * rate;
                    rate = (rate + 5e-5 * drive.clamp(-brake, brake)).clamp(-speed, speed);
                    angle += 5e-5 * rate;
                    if angle.abs() > stop {
                        (angle, rate) = (stop.copysign(angle), 0.0);
                    }
                }
                angle + noise.sample(&mut random)
            })
            .collect();
        let input: Vec<f64> = (0..10 * HOLD).map(level).collect();
        let of_run = Run::new(input, output).ok()?;
        let holds = holds(&of_run, EXACTLY);
        let ways = holds
            .windows(2)
            .map(|pair| (pair[1].level, Way::of(&of_run, &pair[0], &pair[1])));
        let ways: Vec<(f64, Way)> = ways
            .filter_map(|(level, way)| Some((level, way?)))
            .collect();
        let at = |end: f64| {
            let at_end = ways.iter().filter(|(level, _)| *level == end);
            Arrival::of(end, &at_end.map(|(_, way)| *way).collect::<Vec<_>>())
        };
        Some([at(-20.0)?.approach, at(20.0)?.approach])
    }

    const FREE: f64 = f64::INFINITY;

    /// Of all damping ratios, and of drives that turn the servo at one speed for most of the way: none is cut off.
    #[test]
    fn a_servo_without_stops_is_not_cut_off() {
        for seed in 0..4 {
            for zeta in [0.4, 0.6, 0.7, 0.8, 1.0, 1.5] {
                for omega in [25.0, 40.0, 70.0] {
                    for limits in [[FREE; 3], [400.0, FREE, FREE], [400.0, 8000.0, FREE]] {
                        let found = approaches(zeta, omega, limits, seed).unwrap();
                        let is_cut_off = found.contains(&Approach::CutOff);
                        assert!(!is_cut_off, "{zeta} {omega} {limits:?} {seed}");
                    }
                }
            }
        }
    }

    /// Half way to its command and earlier. Later a servo that is well damped has slowed down by itself.
    #[test]
    fn a_servo_that_meets_its_stops_is_cut_off() {
        for seed in 0..4 {
            for omega in [25.0, 40.0] {
                for stop in [6.0, 10.0] {
                    for speed in [FREE, 400.0] {
                        let found = approaches(0.6, omega, [speed, FREE, stop], seed);
                        let stopped = Some([Approach::CutOff; 2]);
                        assert_eq!(found, stopped, "{omega} {stop} {speed} {seed}");
                    }
                }
            }
        }
    }

    /// Well damped, and slow where it meets them: the record does not show it, which is not that there are none.
    #[test]
    fn a_stop_that_is_met_slowly_is_not_known() {
        for seed in 0..4 {
            for omega in [25.0, 40.0] {
                let found = approaches(0.8, omega, [FREE, FREE, 12.0], seed);
                assert_eq!(found, Some([Approach::Unknown; 2]), "{omega} {seed}");
            }
        }
    }
}
