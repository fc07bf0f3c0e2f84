//! The pulses of one run that give each change of its command the pulse that it waited for.
//!
//! A change waits w for a pulse. All pulses may come s later, in frames of T, as long as no change meets another one:
//!
//! ```text
//! -w < s < T - w
//! ```
//!
//! A delay that is as much shorter makes the same motion. So the middle of what is left is taken, and the delay is open by half of it. The length of the frame is not open where holds differ: the answers along a run show
//! when pulses come. Holds of one length end alike with several lengths.

use crate::data::dataset::command_changes;
use servoid_identification::Run;

/// A change within this part of a frame of a pulse may have met the one before it or behind it, as far as a search by the whole motion says.
const BESIDE: f64 = 0.1;

/// So many of these are tried at the most, as each takes a simulation of the run: commands that move on with every row meet each pulse within a row, and are hardly another then.
const MOST_BESIDE: usize = 200;

/// The squared errors of a run with the commands that it is given.
pub(super) type SquaresOf<'a, 'r> = &'a dyn Fn(&Run<'r>) -> Option<f64>;

/// Pulses of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PulseClock {
    /// From one to the next \[s\].
    pub(super) frame_s: f64,
    /// One of them, from the first row on \[s\].
    pub(super) first_s: f64,
}

/// A change of the command.
#[derive(Clone, Copy, Debug)]
struct Change {
    row: usize,
    at_s: f64,
    /// How long it waits \[s\].
    wait_s: f64,
}

/// Pulses with the changes that wait for them.
#[derive(Clone, Debug)]
pub(super) struct FittedPulses {
    clock: PulseClock,
    changes: Vec<Change>,
}

impl PulseClock {
    /// These pulses, with the changes of `run` that they are near to waiting for the one before or behind, where the run follows the motion better so: `squares` are its squared errors with the commands that it is given,
    /// of which those of a sample of `noise` are chance. As far as its pulses are known, they may contradict each other by `apart_s`.
    pub(super) fn fitted<'r>(
        self,
        run: &Run<'r>,
        period_s: f64,
        (squares, noise): (SquaresOf<'_, 'r>, f64),
        apart_s: f64,
    ) -> FittedPulses {
        let own = self.changes(run, period_s);
        let mut changes = own.clone();
        let with = |changes: &[Change]| squares(&with_waits(run, period_s, changes)?);
        if let Some(mut least) = with(&changes) {
            for (k, other) in self.beside_pulses(&own) {
                let mut tried = changes.clone();
                if let Some(change) = tried.get_mut(k) {
                    change.wait_s = other;
                }
                if let Some(found) = with(&tried).filter(|found| *found < least - BY_NOISE * noise)
                {
                    (changes, least) = (tried, found);
                }
            }
        }
        let fitted = |changes: Vec<Change>| FittedPulses {
            clock: self,
            changes,
        };
        // Those of no clock are those of a model that lacks something.
        let found = fitted(changes);
        match found.open_shifts(apart_s) {
            Some(_) => found,
            None => fitted(own),
        }
    }

    fn changes(&self, run: &Run, period_s: f64) -> Vec<Change> {
        let change = |row: usize| {
            let at_s = row as f64 * period_s;
            Change {
                row,
                at_s,
                wait_s: (self.first_s - at_s).rem_euclid(self.frame_s),
            }
        };
        command_changes(run.input()).map(change).collect()
    }

    /// The changes that are near a pulse, by their place, with their wait for the other one beside it; the nearest first.
    fn beside_pulses(&self, changes: &[Change]) -> Vec<(usize, f64)> {
        let near = changes.iter().enumerate();
        let mut near: Vec<(usize, f64)> = near
            .filter_map(|(k, change)| Some((k, self.beside(change)?)))
            .collect();
        let beyond = |wait_s: f64| (wait_s - self.frame_s).max(-wait_s);
        near.sort_by(|a, b| beyond(a.1).total_cmp(&beyond(b.1)));
        near.truncate(MOST_BESIDE);
        near
    }

    /// The wait of a change for the other pulse beside it, where one is near.
    fn beside(&self, change: &Change) -> Option<f64> {
        let near = BESIDE * self.frame_s;
        match change.wait_s {
            soon if soon < near => Some(soon + self.frame_s),
            late if late > self.frame_s - near => Some(late - self.frame_s),
            _ => None,
        }
    }
}

impl FittedPulses {
    /// How much later all pulses may come, from the least to the most \[s\]: the most may be sooner than the least by `apart_s`, as far as pulses are known. `None` where no shift gives each change its pulse.
    pub(super) fn open_shifts(&self, apart_s: f64) -> Option<[f64; 2]> {
        let waits = || self.changes.iter().map(|change| change.wait_s);
        let least = -waits().reduce(f64::min)?;
        let most = self.clock.frame_s - waits().reduce(f64::max)?;
        (least < most + apart_s).then_some([least, most])
    }

    pub(super) fn frame_s(&self) -> f64 {
        self.clock.frame_s
    }

    /// The `run` with each command in force from its pulse on, where all come so much later than they were taken to.
    pub(super) fn in_force<'r>(
        &self,
        run: &Run<'r>,
        period_s: f64,
        later_s: f64,
    ) -> Option<Run<'r>> {
        let later = |change: &Change| Change {
            wait_s: change.wait_s + later_s,
            ..*change
        };
        let changes: Vec<Change> = self.changes.iter().map(later).collect();
        with_waits(run, period_s, &changes)
    }
}

/// Squared errors of so many samples of noise that a change of pulse takes away at the least: less is chance.
const BY_NOISE: f64 = 10.0;

/// The run with each change of the command so long after its row as it waits.
fn with_waits<'r>(run: &Run<'r>, period_s: f64, changes: &[Change]) -> Option<Run<'r>> {
    let mut levels = vec![run.input_at_rest().or(run.input().first().copied())?; run.len()];
    let mut late_s = vec![0.0; run.len()];
    for change in changes {
        let at_s = (change.at_s + change.wait_s).max(0.0);
        // Rounding keeps none in the row before.
        let row = (at_s / period_s + 1e-9).floor() as usize;
        let level = *run.input().get(change.row)?;
        if let Some(from_here) = levels.get_mut(row..) {
            from_here.fill(level);
        }
        if let Some(late_s) = late_s.get_mut(row) {
            *late_s = (at_s - row as f64 * period_s).clamp(0.0, period_s);
        }
    }
    run.with_input(levels).ok()?.with_late_inputs(late_s).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten rows of 2 ms between changes of one unit at times that are spread over frames of 20 ms.
    fn run() -> Run<'static> {
        let command = |row: u32| f64::from(row / 17);
        Run::new((0..1700).map(command).collect::<Vec<_>>(), vec![0.0; 1700]).unwrap()
    }

    /// Squared errors as if the recorded motion were the command in force with these pulses.
    fn squares(truth: PulseClock) -> impl Fn(&Run<'static>) -> Option<f64> {
        let of = |run: &Run<'static>, clock: PulseClock| {
            with_waits(run, 0.002, &clock.changes(run, 0.002))
        };
        let in_truth = of(&run(), truth).unwrap();
        move |tried: &Run<'static>| {
            let pairs = tried.input().iter().zip(in_truth.input());
            Some(pairs.map(|(a, b)| (a - b).powi(2)).sum())
        }
    }

    #[test]
    fn changes_beside_pulses_move_the_clock_to_theirs() {
        let clock = |first_s: f64| PulseClock {
            frame_s: 0.02,
            first_s,
        };
        let truth = clock(0.0131);
        for off in [-0.0012, 0.0, 0.0012] {
            let fitted = clock(0.0131 + off).fitted(&run(), 0.002, (&squares(truth), 0.0), 0.0);
            let [least, most] = fitted.open_shifts(0.0).unwrap();
            let open_s = 0.5 * (most - least);
            let found_s = fitted.clock.first_s + f64::midpoint(least, most);
            // Rows are 2 ms, so that changes at all of them leave that much.
            let apart = (found_s - truth.first_s + 0.01).rem_euclid(truth.frame_s) - 0.01;
            assert!(
                apart.abs() <= open_s + 1e-9 && open_s < 0.0021,
                "{off}: {found_s} {open_s}"
            );
        }
    }
}
