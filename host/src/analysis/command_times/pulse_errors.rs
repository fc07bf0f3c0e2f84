//! The errors of a model in a run, with pulses of one length at moments all over a frame.
//!
//! Within half a second lengths of a frame do not differ, and errors depend on the moment of the pulse alone: along another length they are looked up, block by block,
//! at the moments that it has come to.

use super::commands_at_pulses::at_pulses;
use servoid_identification::servo_model::ServoModel;
use servoid_identification::{Record, Run};

/// Moments of pulses in a frame that are tried, evenly spaced.
pub(crate) const MOMENTS: usize = 24;

/// How far a length may be from the one that a table is of, as a share of it.
pub(crate) const OF_LENGTH: f64 = 0.005;

/// Frames of a block: with each length within [`OF_LENGTH`], pulses walk by less than a seventh of a frame in it.
const FRAMES_OF_BLOCK: f64 = 25.0;

/// The time of a pulse late in a run is rounded to this part of a row at the most.
const ROUNDING: f64 = 1e-6;

/// What a model predicts of a run, which has this number, with pulses of a length and at a moment \[s\]; `None` where it cannot.
pub(crate) type Predict<'a, 'r> = &'a dyn Fn(&Run<'r>, usize, [f64; 2]) -> Option<Vec<f64>>;

/// The run with each command in force from the next pulse on. Frame and one of the pulses are counted in rows.
pub(crate) fn with_pulses<'r>(run: &Run<'r>, pulses: [f64; 2]) -> Option<Run<'r>> {
    at_pulses(run, |row| wait(row, pulses))
}

/// The run with each command in force from the moment of the next pulse on, within its row. Frame and one of the pulses are counted in rows of `period_s`. Where pulses are closer than rows, each row has its mean.
///
/// A servo answers the mean of a row in which its command changes as if it had changed twice, by parts: behind rows of 10 ms that is several times the noise of a sensor.
pub(crate) fn in_force<'r>(
    run: &Run<'r>,
    period_s: f64,
    pulses @ [frame, _]: [f64; 2],
) -> Option<Run<'r>> {
    if frame < 1.0 {
        return with_pulses(run, pulses);
    }
    let (mut levels, mut late_s) = (Vec::new(), Vec::new());
    let mut held = run.input_at_rest().or(run.input().first().copied())?;
    for (row, written) in run.input().iter().enumerate() {
        let wait = wait(row, pulses);
        if wait < 1.0 {
            held = *written;
        }
        levels.push(held);
        late_s.push(if wait < 1.0 { wait * period_s } else { 0.0 });
    }
    run.with_input(levels).ok()?.with_late_inputs(late_s).ok()
}

/// The output of a servo in one run of `record`, with such pulses \[rows\].
pub(crate) fn simulate_with_pulses(
    servo: &ServoModel,
    controllers: &[usize],
    record: &Record,
    run: &Run,
    pulses: [f64; 2],
) -> Option<Vec<f64>> {
    let run = in_force(run, record.sample_period_s(), pulses)?;
    let record = record.try_with_runs(vec![run]).ok()?;
    servo.simulate(&record, controllers).into_iter().next()
}

/// From a row to the next pulse, in rows.
fn wait(row: usize, [frame, pulse]: [f64; 2]) -> f64 {
    match (pulse - row as f64).rem_euclid(frame) {
        // A pulse at the row itself, but for rounding, is no frame away.
        whole if frame - whole < ROUNDING => 0.0,
        wait => wait,
    }
}

/// Squared errors of a run with pulses of the stated length, at moments all over a frame.
pub(crate) struct ErrorTable<'a, 'r> {
    pub(crate) run: &'a Run<'r>,
    /// Of the run in its record.
    pub(crate) number: usize,
    period_s: f64,
    stated_s: f64,
    rows_of_block: usize,
    /// Their sums in each block, one of each moment.
    blocks: Vec<[f64; MOMENTS]>,
    /// Samples that are predicted.
    pub(crate) samples: f64,
}

impl<'a, 'r> ErrorTable<'a, 'r> {
    /// `None` where the run cannot be predicted.
    pub(crate) fn of(
        run: &'a Run<'r>,
        number: usize,
        [stated_s, period_s]: [f64; 2],
        predict: Predict<'_, 'r>,
    ) -> Option<Self> {
        let rows_of_block = (FRAMES_OF_BLOCK * stated_s / period_s).ceil() as usize;
        let mut table = Self {
            run,
            number,
            period_s,
            stated_s,
            rows_of_block,
            blocks: vec![[0.0; MOMENTS]; run.len().div_ceil(rows_of_block)],
            samples: 0.0,
        };
        for moment in 0..MOMENTS {
            let pulses = [stated_s, table.moment_s(moment)];
            let errors = table.errors(&predict(run, number, pulses)?);
            table.samples = errors.iter().flatten().count() as f64;
            for (block, errors) in table.blocks.iter_mut().zip(errors.chunks(rows_of_block)) {
                if let Some(sum) = block.get_mut(moment) {
                    *sum = errors.iter().flatten().sum();
                }
            }
        }
        (table.samples > 0.0).then_some(table)
    }

    fn moment_s(&self, moment: usize) -> f64 {
        (moment as f64 + 0.5) * self.stated_s / MOMENTS as f64
    }

    pub(crate) fn seconds(&self) -> f64 {
        self.run.len() as f64 * self.period_s
    }

    /// The squared error of each sample, where there is one.
    fn errors(&self, predicted: &[f64]) -> Vec<Option<f64>> {
        let errors = self.run.output().iter().zip(predicted);
        errors
            .map(|(measured, predicted)| {
                Some((measured - predicted).powi(2)).filter(|square| square.is_finite())
            })
            .collect()
    }

    pub(crate) fn squares(&self, predicted: &[f64]) -> f64 {
        self.errors(predicted).iter().flatten().sum()
    }

    /// A pulse near the middle of the run with which frames of this length have the least squared errors, and their sum.
    pub(crate) fn closest(&self, frame_s: f64) -> (f64, f64) {
        let half = 0.5 * self.seconds();
        let block_s = self.rows_of_block as f64 * self.period_s;
        let walk = (frame_s - self.stated_s) / frame_s;
        let along = |moment: usize| {
            let middle_s = (half / self.stated_s).floor() * self.stated_s + self.moment_s(moment);
            let of_block = |(number, sums): (usize, &[f64; MOMENTS])| {
                let at_s = (number as f64 + 0.5) * block_s;
                let moment_s = (middle_s + walk * (at_s - middle_s)).rem_euclid(self.stated_s);
                let index = (moment_s / self.stated_s * MOMENTS as f64) as usize;
                sums.get(index.min(MOMENTS - 1)).copied().unwrap_or(0.0)
            };
            let sum: f64 = self.blocks.iter().enumerate().map(of_block).sum();
            (middle_s, sum)
        };
        let tried = (0..MOMENTS).map(along);
        tried
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((half, f64::INFINITY))
    }

    /// The largest sum of squared errors with one moment.
    pub(crate) fn largest(&self) -> f64 {
        let of_moment = |moment: usize| {
            self.blocks
                .iter()
                .filter_map(|block| block.get(moment))
                .sum()
        };
        (0..MOMENTS).map(of_moment).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_waits_for_the_next_pulse() {
        let input = vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let run = Run::new(input, vec![0.0; 7]).unwrap();
        // Pulses at 0.5, 2.5 and 4.5 rows: each has the command of the row before it until the next.
        let held = with_pulses(&run, [2.0, 0.5]).unwrap();
        assert_eq!(held.input(), [0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    }

    #[test]
    fn a_command_is_in_force_from_its_pulse_on() {
        let run = Run::new(vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0], vec![0.0; 7]).unwrap();
        // Pulses at 0.5, 2.75 and 5 rows of 10 ms.
        let found = in_force(&run, 0.01, [2.25, 0.5]).unwrap();
        assert_eq!(found.input(), [0.0, 0.0, 2.0, 2.0, 2.0, 5.0, 5.0]);
        let late = found.late_inputs().unwrap();
        for (row, at) in [(0, 0.005), (1, 0.0), (2, 0.0075), (5, 0.0)] {
            assert!((late[row] - at).abs() < 1e-12, "{row}: {late:?}");
        }
    }

    #[test]
    fn a_command_at_its_pulse_does_not_wait_for_the_next_one_by_rounding() {
        let input: Vec<f64> = (0..20).map(|row| f64::from(row / 5)).collect();
        let run = Run::new(input.clone(), vec![0.0; 20]).unwrap();
        for pulse in [10.0 - 1e-12, 10.0, 10.0 + 1e-12] {
            let held = with_pulses(&run, [5.0, pulse]).unwrap();
            for (held, sent) in held.input().iter().zip(&input) {
                assert!((held - sent).abs() < 1e-9, "{pulse}");
            }
        }
    }
}
