//! Stretches of outlying samples that belong to strokes of another size.
//!
//! A servo whose speed is limited answers all strokes of one size alike, and a linear model describes that without an error. The few strokes of another
//! size in such a recording, as the half ones from rest and back to it, are then outlying from their beginning on. Glitches of the sensor begin
//! anywhere, so stretches that begin with these few strokes are no glitches: the servo answers strokes of that size differently, and is not linear.

use std::ops::Range;

use statrs::distribution::{Binomial, DiscreteCDF};

use super::taken_out::TakenOut;
use crate::data::{EXACTLY, holds};
use crate::diagnostics::residuals::simulation_error::Simulated;
use crate::numerics::median;
use crate::thresholds::{EQUALLY_LARGE, OTHER_STROKES_ALONE, RESIDUAL_SIGNIFICANCE};

/// Samples in a row of which glitches are seldom made.
pub(crate) const LASTING: usize = 3;

/// A hold, and where the servo is half way through its answer to the stroke that leads into it.
struct Answer {
    run: usize,
    samples: Range<usize>,
    half: usize,
    size: f64,
    /// The first sample with an error, where the history of the model hides the beginning of the answer.
    first_seen: Option<usize>,
}

impl Answer {
    /// Whether these samples begin with the answer, as far as that is seen.
    fn begins_with(&self, found: &TakenOut) -> bool {
        let begins = (self.samples.start..=self.half).contains(&found.sample)
            || self.first_seen == Some(found.sample);
        found.samples >= LASTING && found.run == self.run + 1 && begins
    }

    fn contains(&self, found: &TakenOut) -> bool {
        found.run == self.run + 1 && self.samples.contains(&found.sample)
    }
}

/// Marks what of `found` belongs to strokes of a size that few others have, where chance would not put as many lasting stretches at their
/// beginnings; with the q of each sample, which is above `moving` in motion.
pub(super) fn mark_other_strokes(
    found: &mut [TakenOut],
    runs: &[Simulated<'_>],
    motions: &[Vec<f64>],
    moving: f64,
) {
    let answers = answers(runs, motions, moving);
    let Some(usual) = median(answers.iter().map(|answer| answer.size).collect()) else {
        return;
    };
    let unlike =
        |answer: &&Answer| (answer.size - usual).abs() > EQUALLY_LARGE * answer.size.max(usual);
    let others: Vec<&Answer> = answers.iter().filter(unlike).collect();
    let is_met = |answer: &&Answer| found.iter().any(|found| answer.begins_with(found));
    let met: Vec<&Answer> = others.iter().copied().filter(is_met).collect();
    // Those of one answer are one event.
    let lasting_in = |answer: &&Answer| {
        let mut lasting = found.iter().filter(|found| found.samples >= LASTING);
        lasting.any(|found| answer.contains(found))
    };
    let events = answers.iter().filter(lasting_in).count() as u64;
    let samples: usize = motions.iter().map(Vec::len).sum();
    let beginnings: usize = (others.iter())
        .map(|answer| answer.half + 1 - answer.samples.start)
        .sum();
    let chance = Binomial::new(beginnings as f64 / samples.max(1) as f64, events);
    let (Some(least), Ok(chance)) = ((met.len() as u64).checked_sub(1), chance) else {
        return;
    };
    // Where all that lasts begins with them, nothing else speaks of glitches.
    let significance = match met.len() as u64 == events {
        true => OTHER_STROKES_ALONE,
        false => RESIDUAL_SIGNIFICANCE,
    };
    if chance.sf(least) > significance {
        return;
    }
    for found in found.iter_mut() {
        found.other_stroke = met.iter().any(|answer| answer.contains(found));
    }
}

/// The answers to all strokes in which the servo moves, or of which the history of the model leaves the end alone, and which are over when the next begins: those of a
/// motion that goes on are answered together.
fn answers(runs: &[Simulated<'_>], motions: &[Vec<f64>], moving: f64) -> Vec<Answer> {
    let mut answers = Vec::new();
    for (index, (simulated, motion)) in runs.iter().zip(motions).enumerate() {
        let errors = simulated.own_errors();
        let first = errors.iter().position(|error| !error.is_nan());
        for hold in holds(&simulated.run, EXACTLY) {
            let Some(before) = hold.before else {
                continue;
            };
            let is_moving = |k: &usize| motion.get(*k).is_some_and(|q| *q > moving);
            if is_moving(&(hold.samples.end - 1)) {
                continue;
            }
            let first_seen = first.filter(|first| hold.samples.contains(first));
            let in_motion: Vec<usize> = hold.samples.clone().filter(is_moving).collect();
            if let Some(half) = in_motion.get(in_motion.len() / 2).copied().or(first_seen) {
                answers.push(Answer {
                    run: index,
                    half,
                    size: (hold.level - before).abs(),
                    first_seen,
                    samples: hold.samples,
                });
            }
        }
    }
    answers
}
