//! Whether one side is more worn than the other, by where both rest and how they answer the same strokes: no model of the servos is asked.

use super::outcome::Comparison;
use super::verdict::Verdict;

/// What the sides are called in a summary.
pub(super) const NAMES_IN_SUMMARY: [&str; 2] = ["the first", "the second"];

impl Comparison {
    /// Which side is the more worn one by what it does, whatever its model is: its rests are farther apart, and it answers the same strokes later and more slowly, each for sure. `Some(true)` of the
    /// second.
    #[must_use]
    pub fn worn_by_responses(&self) -> Option<bool> {
        let rests = self
            .rests_apart?
            .difference
            .filter(|_| self.has_verdict())?;
        let rise = (self.differences.iter()).find(|row| row.metric == "rise_time_s")?;
        let shifts = self.curves.iter().map(|curve| curve.delay_shift_s.ends());
        let all: Option<Vec<[f64; 2]>> = shifts
            .chain([
                rests.ends(),
                rise.lower.zip(rise.upper).map(<[f64; 2]>::from),
            ])
            .collect();
        let all = all?;
        let is_second = all.iter().all(|[lower, _]| *lower > 0.0);
        let is_first = all.iter().all(|[_, upper]| *upper < 0.0);
        (is_first || is_second).then_some(is_second)
    }

    /// The same in words; `sides` are the names of both.
    #[must_use]
    pub fn worn_in_words(&self, [a, b]: [&str; 2]) -> Option<String> {
        let worn = if self.worn_by_responses()? { b } else { a };
        Some(format!(
            "Unless load or supply differ, {worn} is the more worn of the two: its rests are farther apart, and it answers the same strokes later and more slowly. Replace it where that is more than \
             its use allows."
        ))
    }

    /// Whether the two differ in how far apart they rest under one command, which is a small share of a stroke. That nobody knows it is said where the rest is the same. `sides` are their
    /// names, `unit` that of the output.
    #[must_use]
    pub fn rests_in_words(&self, sides: [&str; 2], unit: &str) -> Option<String> {
        let rests = self.rests_apart?;
        match rests.difference_in_words(sides, unit) {
            Some(differ) => {
                let worn = self.worn_in_words(sides);
                let leaves_open = worn.or_else(|| rests.what_it_leaves_open().map(str::to_owned));
                Some(format!(
                    "They rest differently: {differ}. {}",
                    leaves_open.unwrap_or_default()
                ))
            }
            None if rests.is_known() || self.verdict == Verdict::Same => {
                Some(rests.nothing_sure_in_words(sides, unit))
            }
            None => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::Record;
    use crate::comparison::{ComparisonOptions, RestsApart, compare};
    use crate::results::Interval;

    /// Lags that come this part nearer to the command with each sample.
    fn lag(speed: f64, shift: usize) -> Record<'static> {
        let noise = |k: usize| 0.02 * (((k * 7919) % 101) as f64 - 50.0) / 50.0;
        let u: Vec<f64> = (0..2000).map(|k| [5.0, -5.0][k * k / 9000 % 2]).collect();
        let follow = |y: &mut f64, (k, u): (usize, &f64)| {
            *y += speed * (u - *y);
            Some(*y + noise(k + shift))
        };
        let y: Vec<f64> = u.iter().enumerate().scan(5.0, follow).collect();
        Record::of_run(0.002, u, y).unwrap()
    }

    #[test]
    fn a_servo_is_the_worn_one_where_it_is_later_and_slower_and_rests_farther_apart() {
        let options = ComparisonOptions::default();
        let worn = |speeds: [f64; 2], rests: [[f64; 2]; 2]| {
            let mut found = compare(&lag(speeds[0], 0), &lag(speeds[1], 17), &options).unwrap();
            let of = |[low, high]: [f64; 2]| Some(Interval::new((low + high) / 2.0, low, high));
            found.rests_apart = Some(RestsApart::of(rests.map(of), 0.0, 0.99));
            found.worn_by_responses()
        };
        let (near, far, wide) = ([0.1, 0.2], [0.8, 0.9], [0.1, 0.9]);
        assert_eq!(worn([0.2, 0.12], [near, far]), Some(true));
        assert_eq!(worn([0.12, 0.2], [far, near]), Some(false));
        // Its rests are nearer, or not surely farther apart, or it is as quick.
        assert_eq!(worn([0.2, 0.12], [far, near]), None);
        assert_eq!(worn([0.2, 0.12], [near, wide]), None);
        assert_eq!(worn([0.2, 0.2], [near, far]), None);
    }
}
