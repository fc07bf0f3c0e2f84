//! Whether the servo moves before its command changes, as where a logger writes commands late.
//!
//! Just before a change of a command that was held, a servo is near its rest: what is left of the last stroke gets slower. Motion that
//! begins there and goes where the next command is answers a command that came before it was written. With the motions of the
//! servo in the last four windows of L samples before each change, the last one first,
//!
//! ```text
//! share_i = Σ Δu m_i / Σ Δu Δy,   i = 1 … 4,     Δu: change of the command,  Δy: motion of the servo from before the windows to those of the next change
//! ```
//!
//! share_1 stands out against chance and against the other three. The windows that show it best are taken. It needs no model, so it also
//! speaks of servos that are not linear. What the servo has made of its strokes by the change itself is the same share of its motion from before the windows to the row of the
//! change.

use crate::data::{EXACTLY, Hold, Record, Run, holds, usual_hold};
use crate::thresholds::{
    EARLY_CHANGES, EARLY_SHARE, EARLY_SIGNIFICANCE, EARLY_TO_EARLIER, EARLY_WHOLE,
};

/// Windows before each change.
const WINDOWS: usize = 4;

/// That the servo moves before its command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LateCommand {
    /// For how long before the change it moves at least \[s\].
    pub(crate) lead_s: f64,
    /// Share of its stroke that it has made when the command changes.
    pub(crate) share: f64,
    /// Changes of the command that show it.
    pub(crate) changes: usize,
}

/// The motion before the changes of a held command, where there is any. `settling` is that of a model of the record \[samples\]: after half of
/// it a servo is near its rest, and before, its answer to an earlier change may look like one to the next.
pub(crate) fn late_command(record: &Record, settling: usize) -> Option<LateCommand> {
    let usual = usual_hold(record);
    let mut changes: Vec<Change> = record.runs().iter().flat_map(changes_of).collect();
    // After the longer half of all holds the servo is nearest to its rest.
    let least = usual.max(settling / 2);
    changes.retain(|change| change.before.len() >= least);
    let windows = |length: &usize| (WINDOWS + 1) * length <= usual;
    let shown: Vec<(usize, Before)> = (1..)
        .take_while(windows)
        .filter_map(|length| Some((length, Before::of(&changes, length)?)))
        .collect();
    let found = shown.iter().filter(|(_, before)| before.is_early());
    let (_, clearest) = found.max_by(|(_, a), (_, b)| a.deviations.total_cmp(&b.deviations))?;
    // A window shorter than the lead has only its last part.
    let whole =
        |(_, before): &&(usize, Before)| before.shares[0] >= EARLY_WHOLE * clearest.shares[0];
    let (length, _) = shown.iter().find(whole)?;
    Some(LateCommand {
        lead_s: *length as f64 * record.sample_period_s(),
        share: clearest.made,
        changes: clearest.changes,
    })
}

/// A change of the command, and the output from the change before it up to the next one.
struct Change<'a> {
    by: f64,
    /// Of the hold before.
    before: &'a [f64],
    /// Of the hold after.
    after: &'a [f64],
}

impl Change<'_> {
    /// The output so many samples before the next change; NaN where the hold after is not as long.
    fn end_before(&self, samples: usize) -> f64 {
        let last = self.after.len().checked_sub(1 + samples);
        last.map_or(f64::NAN, |last| self.after[last])
    }
}

fn changes_of<'a>(run: &'a Run<'_>) -> Vec<Change<'a>> {
    let output = run.output();
    let holds = holds(run, EXACTLY);
    let pairs = holds.windows(2);
    let adjoining = pairs.filter(|pair| pair[1].before.is_some());
    let change = |pair: &[Hold]| Change {
        by: pair[1].level - pair[0].level,
        before: &output[pair[0].samples.clone()],
        after: &output[pair[1].samples.clone()],
    };
    adjoining.map(change).collect()
}

/// A change: by how much; the stroke from before the windows on and the part of it up to the row of the change, NaN where they are not seen; and the motions in the
/// windows.
type Moved = (f64, [f64; 2], [f64; WINDOWS]);

/// The motion in windows of one length before the changes.
struct Before {
    shares: [f64; WINDOWS],
    /// The share of the strokes that is made in the row of the change.
    made: f64,
    /// By how many standard deviations that of the last window stands out.
    deviations: f64,
    changes: usize,
}

impl Before {
    fn of(changes: &[Change<'_>], length: usize) -> Option<Self> {
        let of_change = |change: &Change<'_>| {
            let last = change.before.len().checked_sub(1 + WINDOWS * length)? + WINDOWS * length;
            let at: [f64; WINDOWS + 1] = std::array::from_fn(|i| change.before[last - i * length]);
            let moved: [f64; WINDOWS] = std::array::from_fn(|i| at[i] - at[i + 1]);
            let is_known = moved.iter().all(|moved| !moved.is_nan());
            let way = [change.end_before(WINDOWS * length), change.after[0]];
            is_known.then_some((change.by, way.map(|end| end - at[WINDOWS]), moved))
        };
        let all: Vec<Moved> = changes.iter().filter_map(of_change).collect();
        if all.len() < EARLY_CHANGES {
            return None;
        }
        let sum = |of: &dyn Fn(&Moved) -> f64| all.iter().map(of).sum::<f64>();
        let squares = sum(&|(by, ..)| by * by);
        // Short holds end in the motion to the next level: they show no stroke, and the others stand for all.
        let whole: Vec<&Moved> = (all.iter())
            .filter(|(_, [stroke, made], _)| !(stroke + made).is_nan())
            .collect();
        let of_whole = |of: &dyn Fn(&Moved) -> f64| whole.iter().map(|one| of(one)).sum::<f64>();
        let of_strokes = of_whole(&|(by, [stroke, _], _)| by * stroke);
        let strokes = of_strokes * squares / of_whole(&|(by, ..)| by * by);
        let products: [f64; WINDOWS] =
            std::array::from_fn(|i| sum(&|(by, _, moved)| by * moved[i]));
        // The scatter from change to change, whatever its cause.
        let scatter = sum(&|(by, _, moved)| (by * (moved[0] - products[0] / squares * by)).powi(2));
        Some(Self {
            shares: products.map(|product| product / strokes),
            made: of_whole(&|(by, [_, made], _)| by * made) / of_strokes,
            deviations: products[0] * strokes.signum() / scatter.sqrt(),
            changes: all.len(),
        })
    }

    fn is_early(&self) -> bool {
        let [last, earlier @ ..] = self.shares;
        let earlier = earlier
            .iter()
            .fold(0.0, |most: f64, share| most.max(share.abs()));
        self.deviations > EARLY_SIGNIFICANCE
            && last > EARLY_SHARE
            && last > EARLY_TO_EARLIER * earlier
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    /// A servo of second order (ω in rad a sample, damping ζ) that answers `delay` samples late, under levels held for 60 to 200 samples.
    fn recording(omega: f64, damping: f64, delay: usize, top: f64) -> (Vec<f64>, Vec<f64>) {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut commands = Vec::new();
        while commands.len() < 6000 {
            let level = random.random_range(-5.0..5.0);
            commands.extend(vec![level; random.random_range(60..200)]);
        }
        let (mut y, mut v) = (commands[0], 0.0);
        let output = (0..commands.len())
            .map(|k: usize| {
                let error = commands[k.saturating_sub(delay)] - y;
                v += omega * omega * error - 2.0 * damping * omega * v;
                v = f64::clamp(v, -top, top);
                y += v;
                y + 0.05 * random.sample::<f64, _>(StandardNormal)
            })
            .collect();
        (commands, output)
    }

    /// The command as a logger writes it `late` samples after it was sent.
    fn written(commands: &[f64], late: usize) -> Vec<f64> {
        let at = |k: usize| commands[k.saturating_sub(late)];
        (0..commands.len()).map(at).collect()
    }

    /// The share of its strokes that the servo has made so many samples after the commands were sent, from rest to rest.
    fn made_of_strokes(commands: &[f64], output: &[f64], later: usize) -> f64 {
        let changes = (60..commands.len() - 60).filter(|k| commands[*k] != commands[k - 1]);
        let way = |k: usize| {
            let next = (k + 1..commands.len()).find(|next| commands[*next] != commands[k]);
            let end = output[next.unwrap_or(commands.len()) - 1];
            [output[k + later] - output[k], end - output[k]]
        };
        let ways: Vec<[f64; 2]> = changes.map(way).collect();
        let square = |of: usize| ways.iter().map(|way| way[1] * way[of]).sum::<f64>();
        square(0) / square(1)
    }

    #[test]
    fn a_command_that_is_written_after_the_motion_began_is_late() {
        for (damping, top) in [(0.8, f64::INFINITY), (0.8, 0.1), (1.5, f64::INFINITY)] {
            let (commands, output) = recording(0.08, damping, 6, top);
            let late = |late: usize| {
                let input = written(&commands, late);
                late_command(&Record::of_run(0.002, &input, &output).unwrap(), 100)
            };
            for causal in [0, 3, 6] {
                assert_eq!(late(causal), None, "{damping}, {top}");
            }
            for lead in [10, 14, 20] {
                // A motion begins slowly: its first tenth may take half of its time.
                let found = late(6 + lead).unwrap();
                let expected = 0.002 * (0.5 * lead as f64)..0.002 * (lead as f64 + 3.0);
                assert!(expected.contains(&found.lead_s), "{lead}: {found:?}");
                let made = made_of_strokes(&commands, &output, 6 + lead);
                assert!((found.share - made).abs() < 0.05, "{made}: {found:?}");
            }
        }
    }

    /// Ringing goes on before each change, in any direction.
    #[test]
    fn a_servo_that_rings_or_creeps_is_not_early() {
        for damping in [0.05, 0.1, 0.3, 4.0] {
            let (commands, output) = recording(0.08, damping, 6, f64::INFINITY);
            let record = Record::of_run(0.002, &commands, &output).unwrap();
            assert_eq!(late_command(&record, 100), None, "{damping}");
        }
    }
}
