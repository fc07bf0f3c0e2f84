//! How far apart the rests under one command are.
//!
//! Within the play of its gears, a dead band, or what friction holds, a shaft rests where the stroke that brought it left it: at the near edge, or at the far
//! one after an overshoot. So strokes from one level to another form a cell, whose visits should rest at one place. With d the difference of the
//! means of two cells at one level, n and m their visits, s² the variance within all cells, and t Student's critical value for all such pairs
//! at once (Bonferroni),
//!
//! ```text
//! from max(|d| - h)   to max(|d| + h),   h = t s sqrt(1/n + 1/m) + |m_a| + |m_b|
//! ```
//!
//! of visits that are as long as others, and larger where they are shorter, holds the largest distance with the probability of the level, because all differences are within h of their estimates at once. m is by how much the rests of a cell still
//! move on the mean, from the first half to the second of what is taken for a rest: that does not scatter. The steps of a sensor add one
//! of them. Unlike the mean over directions of [`Hysteresis`](super::Hysteresis), strokes that overshoot and strokes that do not
//! cancel nothing. One level at least has to be reached from both sides: strokes of one direction may all end at the same edge, and their rests agree
//! whatever the play is.

use super::visits::{Visit, share_of_variance};
use crate::results::Interval;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Degrees of freedom from which the scatter within cells says anything.
const FEWEST_DEGREES: usize = 2;

/// The visits of one level from another.
struct Arrivals<'v> {
    /// The first of them.
    stroke: &'v Visit,
    visits: Vec<&'v Visit>,
}

impl Arrivals<'_> {
    fn rest(&self) -> f64 {
        self.mean(|visit| visit.rest)
    }

    /// How far these rests may be from where the servo would come to rest.
    fn still_to_go(&self) -> f64 {
        self.mean(|visit| visit.moved).abs()
    }

    fn mean(&self, of: fn(&Visit) -> f64) -> f64 {
        let sum: f64 = self.visits.iter().map(|visit| of(visit)).sum();
        sum / self.visits.len() as f64
    }
}

/// The largest distance between two rests under one command, from all `visits`, out of which so many `zeros` of runs were taken, with bounds at the `level`; `None` where no command is reached from both sides, or
/// no stroke is made again. Outputs are steps of `step` at the most.
pub(super) fn rests_apart(
    visits: &[Visit],
    zeros: usize,
    step: f64,
    level: f64,
) -> Option<Interval> {
    let cells = cells(visits);
    let pairs = pairs(&cells);
    let degrees = (visits.len() - cells.len()).saturating_sub(zeros);
    let are_of_both_sides =
        |[a, b]: &[&Arrivals; 2]| a.stroke.is_from_below() != b.stroke.is_from_below();
    if degrees < FEWEST_DEGREES || !pairs.iter().any(are_of_both_sides) {
        return None;
    }
    let square = |cell: &Arrivals| {
        let mean = cell.rest();
        let squares = cell.visits.iter().map(|of| (of.rest - mean).powi(2));
        squares.sum::<f64>()
    };
    let sd = (cells.iter().map(square).sum::<f64>() / degrees as f64).sqrt();
    let missed = (1.0 - level) / 2.0 / pairs.len() as f64;
    let critical = -StudentsT::new(0.0, 1.0, degrees as f64)
        .ok()?
        .inverse_cdf(missed);
    let ends = pairs.iter().map(|[a, b]| {
        let apart = (a.rest() - b.rest()).abs();
        let share = [a, b].map(|cell| share_of_variance(cell.visits.iter().copied(), visits));
        let share: f64 = share.iter().sum();
        let half = critical * sd * share.sqrt() + step + a.still_to_go() + b.still_to_go();
        [apart, (apart - half).max(0.0), apart + half]
    });
    let [value, lower, upper] = ends.reduce(|a, b| [0, 1, 2].map(|k: usize| a[k].max(b[k])))?;
    Some(Interval::new(value, lower, upper))
}

fn cells(visits: &[Visit]) -> Vec<Arrivals<'_>> {
    let mut cells: Vec<Arrivals> = Vec::new();
    for visit in visits {
        let is_same = |cell: &&mut Arrivals| {
            cell.stroke.command == visit.command && cell.stroke.before == visit.before
        };
        match cells.iter_mut().find(is_same) {
            Some(cell) => cell.visits.push(visit),
            None => cells.push(Arrivals {
                stroke: visit,
                visits: vec![visit],
            }),
        }
    }
    cells
}

/// All pairs of cells of one level.
fn pairs<'c, 'v>(cells: &'c [Arrivals<'v>]) -> Vec<[&'c Arrivals<'v>; 2]> {
    let with = |(place, a): (usize, &'c Arrivals<'v>)| {
        let others = cells[place + 1..].iter();
        let others = others.filter(move |b| b.stroke.command == a.stroke.command);
        others.map(move |b| (place, b)).collect::<Vec<_>>()
    };
    let all = cells.iter().enumerate().flat_map(with);
    all.map(|(place, b)| [&cells[place], b]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nonlinear::limits::visits::with_one_zero;

    /// Stairs over five levels, each stroke between neighbours twice and one of the whole range; a shaft with `play` that overshoots in strokes of more than 5 rests at
    /// the far side of it.
    fn worn(play: f64, noise: f64) -> Vec<Visit> {
        let levels = [
            -10.0, -5.0, 0.0, 5.0, 10.0, 0.0, -10.0, 0.0, 10.0, 5.0, 0.0, -5.0,
        ];
        let visit = |k: usize| {
            let (before, command) = (levels[k % 12], levels[(k + 1) % 12]);
            let stroke: f64 = command - before;
            let side = if stroke.abs() > 5.0 { 1.0 } else { -1.0 };
            let error = noise * ((k * k * 7919 % 101) as f64 / 50.0 - 1.0);
            Visit {
                command,
                before,
                rest: command + side * stroke.signum() * play / 2.0 + error,
                moved: 0.0,
                samples: 10,
                taken_out: 0.0,
            }
        };
        (0..72).map(visit).collect()
    }

    #[test]
    fn play_is_found_where_some_strokes_overshoot_and_none_is_where_there_is_none() {
        for play in [0.0, 0.2, 0.6] {
            let found = rests_apart(&worn(play, 0.01), 0, 0.0, 0.99).unwrap();
            assert!(found.contains(play), "{play}: {found:?}");
            assert!(found.upper.unwrap() < play + 0.04, "{play}: {found:?}");
        }
        let stepped = rests_apart(&worn(0.0, 0.0), 0, 0.03, 0.99).unwrap();
        assert_eq!((stepped.lower, stepped.upper), (Some(0.0), Some(0.03)));
    }

    /// Three runs of the same strokes, each of whose zeros lies elsewhere by far more than the play, and runs that share but a few of their strokes.
    #[test]
    fn play_is_found_in_runs_whose_zeros_differ() {
        let play = 0.2;
        let moved = |visits: &[Visit], by: f64| -> Vec<Visit> {
            let visit = |visit: &Visit| Visit {
                rest: visit.rest + by,
                ..*visit
            };
            visits.iter().map(visit).collect()
        };
        let all = worn(play, 0.01);
        let mut runs: Vec<Vec<Visit>> = (all.chunks(24).zip([0.0, 0.9, -0.6]))
            .map(|(run, zero)| moved(run, zero))
            .collect();
        assert!(
            rests_apart(&runs.concat(), 0, 0.0, 0.99)
                .unwrap()
                .lower
                .unwrap()
                < 0.01
        );
        assert_eq!(with_one_zero(&mut runs), Some(2));
        let found = rests_apart(&runs.concat(), 2, 0.0, 0.99).unwrap();
        assert!(
            found.contains(play) && found.lower.unwrap() > 0.9 * play,
            "{found:?}"
        );
        let mut unlike = vec![all[..24].to_vec(), moved(&all[24..40], 0.9)];
        let before = unlike.clone();
        assert_eq!(with_one_zero(&mut unlike), None);
        assert_eq!(unlike, before);
    }

    #[test]
    fn what_still_moves_is_no_rest() {
        let mut visits = worn(0.0, 0.01);
        // Strokes of the whole range have not come to rest when they are read.
        for visit in &mut visits {
            if (visit.command - visit.before).abs() > 5.0 {
                visit.rest += 0.3;
                visit.moved = -0.25;
            }
        }
        let found = rests_apart(&visits, 0, 0.0, 0.99).unwrap();
        assert!(found.contains(0.06), "{found:?}");
    }

    #[test]
    fn two_levels_and_strokes_that_are_made_once_show_nothing() {
        let all = worn(0.2, 0.01);
        assert_eq!(rests_apart(&all[..8], 0, 0.0, 0.99), None);
        let two = |from: fn(usize) -> f64| -> Vec<Visit> {
            let visit = |k: usize| Visit {
                command: [5.0, -5.0][k % 2],
                before: from(k),
                rest: 0.01 * (k * 7 % 5) as f64,
                moved: 0.0,
                samples: 10,
                taken_out: 0.0,
            };
            (0..20).map(visit).collect()
        };
        let back_and_forth = |k: usize| [-5.0, 5.0][k % 2];
        assert_eq!(rests_apart(&two(back_and_forth), 0, 0.0, 0.99), None);
        // The first stroke of each of two runs begins at a rest between the levels: two strokes to one level, of one direction.
        let from_between = |k: usize| match k % 10 {
            0 => 0.0,
            _ => [-5.0, 5.0][k % 2],
        };
        assert_eq!(rests_apart(&two(from_between), 0, 0.0, 0.99), None);
    }
}
