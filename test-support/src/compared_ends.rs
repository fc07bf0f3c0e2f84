//! Comparisons of two servos whose responses have slow ends, held against the formulas of both.

use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use servoid_identification::comparison::{Comparison, ComparisonOptions, Verdict, compare};
use servoid_identification::{Record, Run};

use crate::hard_lines::{Drive, HardLine, Hardship};
use crate::plants::{Noise, PERIOD, Plant, random};
use crate::trial::Trial;

/// Time constant of the difference between strokes up and down \[samples\].
const LEAN_SAMPLES: f64 = 10.0;

/// Seed of the first pair.
const FIRST_SEED: u64 = 1000;

/// Margin of a verdict, as a share.
const MARGIN: f64 = 0.05;

/// Two servos, each recorded once.
#[derive(Debug, Clone, Copy)]
pub struct ComparedEnds {
    pub drive: Drive,
    pub plant: Plant,
    pub noise: Noise,
    /// Factor on the noise.
    pub scale: f64,
    /// Share and time constant \[s\] of the slow end of each.
    pub ends: [(f64, f64); 2],
    /// Gain of the second servo; that of the first is one.
    pub gain: f64,
    /// Largest difference between strokes up and down of both, as a share.
    pub lean: f64,
}

/// What came out of many pairs, as counts.
#[derive(Debug, Clone, Copy, Default)]
pub struct Outcome {
    /// Pairs with bounds. All that follow are about these.
    pub claimed: usize,
    /// Pairs that are compared by strokes up and down.
    pub split: usize,
    /// Pairs whose difference curves are inside their bounds everywhere.
    pub whole: usize,
    /// Pairs whose interval of the difference of the gains holds it.
    pub gain: usize,
    /// Pairs whose `at_least` .. `at_most` holds the largest difference.
    pub largest: usize,
    pub different: usize,
    pub same: usize,
    /// Verdicts that are not true: different within the margin, the same beyond it.
    pub wrong: usize,
    /// Mean of half the width of the difference curves and of `at_most` \[%\].
    pub half_percent: f64,
    pub at_most_percent: f64,
}

/// Difference curves of strokes up and down, or of both.
type Truth = Vec<Vec<f64>>;

impl ComparedEnds {
    fn side(&self, side: usize, random: &mut ChaCha8Rng) -> Trial {
        let gain = [1.0, self.gain][side];
        let (share, seconds) = self.ends[side];
        let line = HardLine {
            drive: self.drive,
            plant: self.plant,
            noise: self.noise,
            scale: self.scale / gain,
            hardship: Hardship::SlowEnd { share, seconds },
        };
        let Trial { record, truth } = line.trial(random);
        let run = &record.runs()[0];
        let keep = (-1.0 / LEAN_SAMPLES).exp();
        let (mut before, mut lean) = (run.input()[0], 0.0);
        let output = run.input().iter().zip(run.output()).map(|(u, y)| {
            lean = keep * lean + (u - before).abs();
            before = *u;
            gain * (y + self.lean * lean)
        });
        let output: Vec<f64> = output.collect();
        let run = Run::new(run.input().to_vec(), output).expect("one length");
        Trial {
            record: Record::new(PERIOD, vec![run]).expect("a simulated record is sound"),
            truth: truth.iter().map(|g| gain * g).collect(),
        }
    }

    /// Second less first, relative to the gain of the first, for as many points as `found` has.
    fn truth(&self, found: &Comparison, sides: &[Trial; 2]) -> Truth {
        let points = found.curves[0].time_s.len();
        let apart = |m: usize, sign: f64| {
            let lean = sign * self.lean * (-(m as f64) / LEAN_SAMPLES).exp();
            match m + 1 < points {
                true => sides[1].truth[m] - sides[0].truth[m] + (self.gain - 1.0) * lean,
                // The last point is the final value.
                false => self.gain - 1.0,
            }
        };
        let signs: &[f64] = match found.curves.len() {
            1 => &[0.0],
            _ => &[1.0, -1.0],
        };
        let curve = |sign: &f64| (0..points).map(|m| apart(m, *sign)).collect();
        signs.iter().map(curve).collect()
    }

    fn pair(&self, seed: u64, options: &ComparisonOptions) -> Option<Outcome> {
        let mut random = random(seed);
        let sides = [0, 1].map(|side| self.side(side, &mut random));
        let found = compare(&sides[0].record, &sides[1].record, options).expect("well excited");
        let bounds = found.bounds.valid()?.difference_percent;
        let truth = self.truth(&found, &sides);
        let largest = truth
            .iter()
            .flatten()
            .fold(0.0f64, |most, d| most.max(d.abs()));
        let (mut inside, mut width, mut points) = (true, 0.0, 0.0);
        for (curve, truth) in found.curves.iter().zip(&truth) {
            let known = curve.bounds.valid()?;
            for ((low, high), d) in known.lower.iter().zip(&known.upper).zip(truth) {
                inside &= (*low..=*high).contains(&(100.0 * d));
                width += (high - low) / 2.0;
                points += 1.0;
            }
        }
        let gain = found.differences.iter().find(|d| d.metric == "dc_gain")?;
        let gain = (gain.lower?..=gain.upper?).contains(&(self.gain - 1.0));
        let count = usize::from;
        let (different, same) = (
            found.verdict == Verdict::Different,
            found.verdict == Verdict::Same,
        );
        Some(Outcome {
            claimed: 1,
            split: usize::from(found.split),
            whole: count(inside),
            gain: count(gain),
            largest: count((bounds.at_least..=bounds.at_most).contains(&(100.0 * largest))),
            different: count(different),
            same: count(same),
            wrong: count((different && largest <= MARGIN) || (same && largest > MARGIN)),
            half_percent: width / points,
            at_most_percent: bounds.at_most,
        })
    }

    /// Compares as many pairs, each with a seed of its own.
    #[must_use]
    pub fn compare(&self, pairs: u64, options: &ComparisonOptions) -> Outcome {
        let pair = |seed| self.pair(seed, options);
        let found: Vec<Outcome> = (FIRST_SEED..FIRST_SEED + pairs)
            .into_par_iter()
            .filter_map(pair)
            .collect();
        let count = |of: fn(&Outcome) -> usize| found.iter().map(of).sum();
        let mean = |of: fn(&Outcome) -> f64| found.iter().map(of).sum::<f64>() / found.len() as f64;
        Outcome {
            claimed: count(|o| o.claimed),
            split: count(|o| o.split),
            whole: count(|o| o.whole),
            gain: count(|o| o.gain),
            largest: count(|o| o.largest),
            different: count(|o| o.different),
            same: count(|o| o.same),
            wrong: count(|o| o.wrong),
            half_percent: mean(|o| o.half_percent),
            at_most_percent: mean(|o| o.at_most_percent),
        }
    }
}
