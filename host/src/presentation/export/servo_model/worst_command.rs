//! A search for the command in which an exported servo is farthest from the servo model.
//!
//! Where an export lacks a term, its error builds up over strokes that break off, and how far depends on how long each one lasts: one pair
//! of levels and one half-period show a part of it alone. A stroke that is broken off once has a search of its own (`broken_off_stroke`).

use super::subject::ServoExport;
use super::trial_command::{Held, Trial, finely, largest};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Half-periods that are tried, from the shortest to the longest, each so many times the last. Reversals make a servo that is hardly damped and
/// limited early swing ever farther, in a band of half-periods that is narrow: of twelve none was in it, and the difference was five times what
/// they showed.
const HALF_PERIODS: usize = 24;

/// How often the distance from the farthest half-period to the next ones is halved: they are half a hundredth apart then.
const HALVINGS: i32 = 5;

/// Strokes of reversals: where two directions differ, a load is left out or swings grow, it takes so many until the difference does not grow any more.
/// Those of long half-periods, which nearly end, are fewer: no more than last as long as so many strokes of the longest one.
const LONG_REVERSALS: usize = 48;
const LONGEST_STROKES: usize = 12;

/// Strokes of a random command.
const STROKES: usize = 16;

/// Commands of random holds between both ends, and of random levels.
const RANDOM: (u64, u64) = (64, 8);

/// So many commands that are the farthest are changed, so many times each.
const CHANGED: usize = 6;
const CHANGES: usize = 40;

/// A change makes a hold up to so many times as long, or as short.
const FACTOR: f64 = 1.6;

/// How much finer than usual the servo is computed in the search: errors are a tenth of those of the usual steps. With the usual ones, in which a
/// joint with friction errs as the servo does, 34 of 8960 other commands of MuJoCo's joints were more than a tenth farther than the search had found,
/// and with these 3. The difference that is stated is computed anew.
const FINER_IN_SEARCH: f64 = 3.0;

/// The sequence that is farthest may lose strokes at its beginning that change the difference by no more than this part.
const WITHOUT_BEGINNING: f64 = 0.01;

/// Strokes, and the largest difference in them.
pub(super) type FarStrokes = (f64, Vec<Held>);

/// The trial with the strokes in which an export, whose positions `respond` has, is farthest from the servo; they begin at rest in its middle.
pub(super) fn with_worst(
    trial: Trial,
    export: &ServoExport<'_>,
    respond: impl Fn(&[f64]) -> Vec<f64>,
) -> Trial {
    let search = StrokeSearch {
        export,
        trial: &trial,
        respond: &respond,
    };
    let broken_off = search.broken_off_once();
    let worst = search.worst(&broken_off);
    Trial {
        worst,
        worst_broken_off: broken_off.map_or_else(Vec::new, |(_, strokes)| strokes),
        ..trial
    }
}

pub(super) struct StrokeSearch<'a> {
    export: &'a ServoExport<'a>,
    pub trial: &'a Trial,
    respond: &'a dyn Fn(&[f64]) -> Vec<f64>,
}

impl StrokeSearch<'_> {
    /// The strokes of any kind in which the difference is largest; `broken_off` is the best of one kind.
    fn worst(&self, broken_off: &Option<FarStrokes>) -> Vec<Held> {
        let random = self.random().map(|strokes| self.until_largest(strokes));
        let repeated = self.reversals().chain(random);
        let mut found: Vec<_> = repeated.chain(broken_off.clone()).collect();
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let changed = found.into_iter().take(CHANGED).map(|far| self.changed(far));
        let farthest = changed.max_by(|a, b| a.0.total_cmp(&b.0));
        farthest.map_or_else(Vec::new, |(difference, strokes)| {
            self.without_beginning(strokes, difference)
        })
    }

    /// Those between both ends, beginning upwards and downwards, each with the half-period in which it is farthest.
    fn reversals(&self) -> impl Iterator<Item = FarStrokes> {
        let first = [1.0, -1.0].into_iter();
        first.filter_map(|part| self.farthest(HALF_PERIODS, |share| self.even(part, share)))
    }

    /// The farthest of strokes that depend on one time, which is at a share of the way from the shortest to the longest: `places` are tried, and
    /// those around the farthest ever closer.
    pub fn farthest(
        &self,
        places: usize,
        strokes: impl Fn(f64) -> Vec<Held>,
    ) -> Option<FarStrokes> {
        let tried = |share: f64| (share, self.until_largest(strokes(share)));
        let farther = |a: &(f64, FarStrokes), b: &(f64, FarStrokes)| a.1.0.total_cmp(&b.1.0);
        let apart = 1.0 / (places - 1) as f64;
        let first = (0..places).map(|place| tried(place as f64 * apart));
        let halved = (1..=HALVINGS).map(|halving| apart * 0.5f64.powi(halving));
        let farthest = halved.fold(first.max_by(farther), |farthest, apart| {
            let (share, _) = farthest.as_ref()?;
            let both = [share - apart, share + apart].map(|share| tried(share.clamp(0.0, 1.0)));
            farthest.into_iter().chain(both).max_by(farther)
        });
        farthest.map(|(_, found)| found)
    }

    /// Even reversals with the half-period at this share of the way from the shortest to the longest.
    fn even(&self, part: f64, share: f64) -> Vec<Held> {
        let steps = self.steps_at(share);
        let level = |stroke: usize| match stroke % 2 {
            0 => self.trial.level(part),
            _ => self.trial.level(-part),
        };
        let held = |stroke| Held {
            level: level(stroke),
            steps,
        };
        let most = LONGEST_STROKES * self.trial.steps_per_level / steps;
        (0..most.min(LONG_REVERSALS)).map(held).collect()
    }

    /// The steps of a hold at this share of the way from the shortest to the longest.
    pub fn steps_at(&self, share: f64) -> usize {
        self.trial.steps_between(self.export, share)
    }

    /// Random holds between both ends, and random levels.
    fn random(&self) -> impl Iterator<Item = Vec<Held>> {
        let (holds, levels) = RANDOM;
        (0..holds + levels).map(move |seed| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let between_ends = seed < holds;
            let mut held = |stroke: usize| {
                let part = match (between_ends, stroke % 2) {
                    (true, 0) => 1.0,
                    (true, _) => -1.0,
                    (false, _) => random.random_range(-1.0..=1.0),
                };
                let share = random.random_range(0.0..=1.0);
                Held {
                    level: self.trial.level(part),
                    steps: self.steps_at(share),
                }
            };
            (0..STROKES).map(&mut held).collect()
        })
    }

    /// The same or one that is farther, with other holds or more strokes.
    fn changed(&self, farthest: FarStrokes) -> FarStrokes {
        let mut random = ChaCha8Rng::seed_from_u64(0);
        (0..CHANGES).fold(farthest, |farthest, change| {
            let factor = FACTOR.powf(random.random_range(-1.0..=1.0));
            let place = random.random_range(0..farthest.1.len().max(1));
            let mut strokes = farthest.1.clone();
            match change % 4 {
                0 => strokes
                    .iter_mut()
                    .for_each(|held| self.lengthen(held, factor)),
                1 if strokes.len() + 2 <= LONG_REVERSALS => {
                    let first: Vec<Held> = strokes.iter().take(2).copied().collect();
                    strokes.splice(0..0, first);
                }
                _ => strokes
                    .iter_mut()
                    .skip(place)
                    .take(1)
                    .for_each(|held| self.lengthen(held, factor)),
            }
            let other = self.until_largest(strokes);
            match other.0 > farthest.0 {
                true => other,
                false => farthest,
            }
        })
    }

    /// A hold so many times as long, by a pulse frame or a step at least.
    pub fn lengthen(&self, held: &mut Held, factor: f64) {
        let unit = (self.export.frame_s() / self.trial.step_s).max(1.0);
        let units = held.steps as f64 / unit;
        let changed = match factor > 1.0 {
            true => (units * factor).round().max(units + 1.0),
            false => (units * factor).round().min(units - 1.0).max(1.0),
        };
        held.steps = (changed * unit).round().max(1.0) as usize;
    }

    /// The largest difference, and the strokes up to the one in which it is.
    pub fn until_largest(&self, mut strokes: Vec<Held>) -> FarStrokes {
        let commands = self.trial.begun_at_rest(&strokes);
        let positions = (self.respond)(&commands);
        let exact = finely(
            &self.export.parameters,
            self.trial.step_s,
            &commands,
            FINER_IN_SEARCH,
        );
        let after = |course: &[f64]| {
            course
                .get(self.trial.steps_per_level..)
                .unwrap_or_default()
                .to_vec()
        };
        let (difference, at) = largest(&after(&positions), &after(&exact));
        let mut end = 0;
        let needed = strokes.iter().take_while(|held| {
            let begins = end;
            end += held.steps;
            begins <= at
        });
        let needed = needed.count();
        strokes.truncate(needed);
        (difference, strokes)
    }

    /// The shortest end of the strokes in which the difference is about as large.
    fn without_beginning(&self, strokes: Vec<Held>, difference: f64) -> Vec<Held> {
        let least = (1.0 - WITHOUT_BEGINNING) * difference;
        let ends = (1..strokes.len()).rev();
        let ends = ends.filter_map(|place| strokes.get(place..));
        let mut shorter = ends.map(|end| self.until_largest(end.to_vec()));
        shorter
            .find(|(found, _)| *found >= least)
            .map_or(strokes, |(_, end)| end)
    }
}
