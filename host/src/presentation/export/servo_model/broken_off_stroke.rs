//! A search for the stroke, held or broken off once, in which an exported servo is farthest from the servo model.
//!
//! A servo that must first build up its speed, or brake, has hardly set off when a short stroke ends, and one with a rate limit is on its way at
//! once: how far they are apart depends on when the stroke ends, and a staircase has one such time.

use super::trial_command::Held;
use super::worst_command::{FarStrokes, StrokeSearch};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Where the servo rests, where the stroke goes, and where it is sent in the middle of that, as parts of the amplitude.
const COURSES: [[f64; 3]; 8] = [
    [-1.0, 1.0, -1.0],
    [1.0, -1.0, 1.0],
    [-1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [0.0, 1.0, -1.0],
    [0.0, -1.0, 1.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
];

/// Times until a stroke is broken off, before those around the farthest are tried: the difference has one hill or two over them.
const TIMES: usize = 12;

/// So many courses that are the farthest are changed, so many times each.
const CHANGED: usize = 3;
const CHANGES: usize = 24;

/// A change makes the time up to so many times as long, or as short.
const FACTOR: f64 = 1.5;

/// A change moves a level by up to this part of the amplitude.
const MOVED: f64 = 0.5;

impl StrokeSearch<'_> {
    /// The stroke with the largest difference. Before it the servo comes to rest.
    pub fn broken_off_once(&self) -> Option<FarStrokes> {
        let of_course = |course: [f64; 3]| self.farthest(TIMES, |share| self.stroke(course, share));
        let mut found: Vec<_> = COURSES.into_iter().filter_map(of_course).collect();
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let best = found.into_iter().take(CHANGED);
        let changed = best.map(|far| self.changed_once(far));
        changed.max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// A stroke that is broken off after the time at this share of the way to the longest, at which it is held.
    fn stroke(&self, [from, to, then]: [f64; 3], share: f64) -> Vec<Held> {
        let held = |part: f64, steps: usize| Held {
            level: self.trial.level(part),
            steps,
        };
        let rest = self.trial.steps_per_level;
        vec![
            held(from, rest),
            held(to, self.steps_at(share)),
            held(then, rest),
        ]
    }

    /// The same or one that is farther, with other levels or another time.
    fn changed_once(&self, farthest: FarStrokes) -> FarStrokes {
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let [least, largest] = self.trial.ends();
        let part = |level: f64| 2.0 * (level - least) / (largest - least) - 1.0;
        (0..CHANGES).fold(farthest, |farthest, change| {
            let by: f64 = random.random_range(-1.0..=1.0);
            // Of four changes one is of the time, and one of each level.
            let other_level = (change % 4).checked_sub(1);
            let mut strokes = farthest.1.clone();
            for (place, held) in strokes.iter_mut().enumerate() {
                if other_level == Some(place) {
                    let moved = part(held.level) + MOVED * by;
                    held.level = self.trial.level(moved.clamp(-1.0, 1.0));
                } else if other_level.is_none() && place == 1 {
                    self.lengthen(held, FACTOR.powf(by));
                }
            }
            let other = self.until_largest(strokes);
            match other.0 > farthest.0 {
                true => other,
                false => farthest,
            }
        })
    }
}
