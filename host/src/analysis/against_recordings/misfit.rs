//! What sets a recording apart from a model of it: spikes, an offset, a scale, a shift in time, or noise.
//!
//! A servo model begins where the first sample of a run is. Where the zero of the sensor has moved, that is not where the command holds the servo, and
//! the model moves from there first: an error that the offset does not explain. So the model is simulated again with the first samples as it would have
//! them, until offset and scale stay as they are.

use super::noise_at_rest::noise_at_rest;
use super::spikes::Spikes;
use servoid_identification::{Record, Run};

/// The farthest shift that is looked for \[s\]: servos answer sooner.
const FARTHEST_S: f64 = 0.25;

/// What a recording has that its model has not, each looked for alone. Errors that are left are rms values.
pub(crate) struct Misfit {
    /// The mean error, and what is left without it.
    pub(crate) offset: f64,
    pub(crate) left_of_offset: f64,
    /// By how much farther the recording moves than the model, where that moves.
    pub(crate) scale: Option<Scale>,
    /// The shift in time at which they agree best, where there is one.
    pub(crate) lag: Option<Lag>,
    /// The noise at rest (rms), where the recording shows it.
    pub(crate) noise: Option<f64>,
    /// Rows that stand apart from their neighbours, where there are any.
    pub(crate) spikes: Option<Spikes>,
}

/// A recording against a model of it that is scaled.
pub(crate) struct Scale {
    /// The factor at which they agree best.
    pub(crate) factor: f64,
    /// What is added to the scaled model then.
    pub(crate) offset: f64,
    /// The error that is left of both (rms).
    pub(crate) left: f64,
    /// The error that a scale alone leaves, about zero or about the middle of the motion, whichever leaves less (rms).
    pub(crate) left_of_scale_alone: f64,
}

/// A recording as a multiple of its model and an offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    factor: f64,
    offset: f64,
}

impl Line {
    /// A recording that is its model.
    const SAME: Self = Self {
        factor: 1.0,
        offset: 0.0,
    };

    /// The record as the model has it.
    pub(crate) fn undone<'r>(self, record: &Record<'r>) -> Record<'r> {
        record.with_each_output(|y| (y - self.offset) / self.factor)
    }
}

/// Simulations for a line, at the most: each leaves the share of an offset that the run takes to forget its start, and a servo at rest
/// under friction keeps it for long.
const ROUNDS: usize = 8;

/// A change of the error that is left by less than this part ends the search.
const NO_LESS: f64 = 1e-3;

/// A recording against a model of it that is shifted in time.
pub(crate) struct Lag {
    /// The shift at which they agree best \[s\]; positive where the recording is later.
    pub(crate) seconds: f64,
    /// The error that is left then, without its mean (rms).
    pub(crate) left: f64,
    /// This mean.
    pub(crate) offset: f64,
}

/// Sums over pairs of measured and simulated output that are both known.
#[derive(Default)]
struct Sums {
    count: f64,
    error: f64,
    squares: f64,
    simulated: f64,
    simulated_squares: f64,
    product: f64,
}

impl Sums {
    /// The simulated output shifted by so many samples.
    fn at(runs: &[Run<'_>], simulated: &[Vec<f64>], shift: isize) -> Self {
        let mut sums = Self::default();
        for (run, simulated) in runs.iter().zip(simulated) {
            for (k, measured) in run.output().iter().enumerate() {
                let other = k.checked_add_signed(-shift).and_then(|k| simulated.get(k));
                sums.add(
                    measured - other.unwrap_or(&f64::NAN),
                    other.unwrap_or(&f64::NAN),
                );
            }
        }
        sums
    }

    fn add(&mut self, error: f64, simulated: &f64) {
        if !error.is_nan() {
            self.count += 1.0;
            self.error += error;
            self.squares += error * error;
            self.simulated += simulated;
            self.simulated_squares += simulated * simulated;
            self.product += error * simulated;
        }
    }

    /// Mean square of the error without its mean.
    fn variance(&self) -> f64 {
        self.squares / self.count - (self.error / self.count).powi(2)
    }

    /// The offset alone, and the error that it leaves (rms).
    fn offset(&self) -> (Line, f64) {
        let offset = self.error / self.count;
        let line = Line {
            offset,
            ..Line::SAME
        };
        (line, self.variance().max(0.0).sqrt())
    }

    /// The best line, and the error that it leaves (rms).
    fn line(&self) -> (Line, f64) {
        let (covariance, spread) = self.with_simulated();
        let steeper = covariance / spread;
        let line = Line {
            factor: 1.0 + steeper,
            offset: (self.error - steeper * self.simulated) / self.count,
        };
        let left = (self.variance() - covariance * steeper).max(0.0);
        (line, left.sqrt())
    }

    /// The error that the best factor leaves, with nothing added (rms).
    fn left_of_scale_about_zero(&self) -> f64 {
        let explained = self.product * self.product / self.simulated_squares;
        ((self.squares - explained) / self.count).max(0.0).sqrt()
    }

    /// Covariance of error and simulated output, and the variance of the latter.
    fn with_simulated(&self) -> (f64, f64) {
        let mean = self.simulated / self.count;
        (
            self.product / self.count - self.error / self.count * mean,
            self.simulated_squares / self.count - mean * mean,
        )
    }
}

/// What a line leaves of the error of one simulation.
struct Explained {
    simulated: Vec<Vec<f64>>,
    sums: Sums,
    line: Line,
    left: f64,
}

impl Explained {
    /// The simulation that the line of its own explains best, by rounds: each is simulated with the record as the line before has it.
    fn best(
        runs: &[Run<'_>],
        simulate: &dyn Fn(Line) -> Vec<Vec<f64>>,
        line_of: fn(&Sums) -> (Line, f64),
    ) -> Self {
        let at = |line: Line| {
            let simulated = simulate(line);
            let sums = Sums::at(runs, &simulated, 0);
            let (line, left) = line_of(&sums);
            Self {
                simulated,
                sums,
                line,
                left,
            }
        };
        let mut best = at(Line::SAME);
        for _ in 1..ROUNDS {
            let again = at(best.line);
            if again.left >= best.left || again.left.is_nan() {
                break;
            }
            let gained = best.left - again.left;
            best = again;
            if gained < NO_LESS * best.left {
                break;
            }
        }
        best
    }
}

impl Misfit {
    /// Of the runs of a recording, and what a model simulates for each where they are read as a line says.
    pub(crate) fn of(
        runs: &[Run<'_>],
        simulate: &dyn Fn(Line) -> Vec<Vec<f64>>,
        period_s: f64,
    ) -> Self {
        let moved = Explained::best(runs, simulate, Sums::offset);
        let scaled = Explained::best(runs, simulate, Sums::line);
        let Line { factor, offset } = scaled.line;
        let mean = scaled.sums.error / scaled.sums.count;
        let scale = Scale {
            factor,
            offset,
            left: scaled.left,
            left_of_scale_alone: (scaled.sums.left_of_scale_about_zero())
                .min(scaled.left.hypot(mean)),
        };
        Self {
            offset: moved.line.offset,
            left_of_offset: moved.left,
            scale: factor.is_finite().then_some(scale),
            lag: Lag::of(runs, &moved.simulated, period_s),
            noise: noise_at_rest(runs, &moved.simulated),
            spikes: Spikes::of(runs, &moved.simulated, period_s),
        }
    }
}

impl Lag {
    /// The best shift by whole samples, and by the parabola through the squares beside it. `None` where no shift within a quarter of a second
    /// is best.
    fn of(runs: &[Run<'_>], simulated: &[Vec<f64>], period_s: f64) -> Option<Self> {
        let farthest = (FARTHEST_S / period_s).ceil() as isize;
        let square = |shift: isize| Sums::at(runs, simulated, shift).variance();
        let shifts = -farthest..=farthest;
        let squares: Vec<f64> = shifts.map(square).collect();
        let beside = squares.windows(3).zip(1 - farthest..);
        let lowest = beside.filter_map(|(beside, shift)| match *beside {
            [before, least, after] if least <= before.min(after) => {
                Some((before, least, after, shift))
            }
            _ => None,
        });
        let (before, least, after, shift) = lowest.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let bend = before + after - 2.0 * least;
        let between = match bend > 0.0 {
            true => 0.5 * (before - after) / bend,
            false => 0.0,
        };
        let left = least - 0.25 * (before - after) * between;
        let shifted = Sums::at(runs, simulated, shift);
        Some(Self {
            seconds: (shift as f64 + between) * period_s,
            left: left.max(0.0).sqrt(),
            offset: shifted.error / shifted.count,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recording_that_is_later_by_parts_of_a_sample_is_later_by_that() {
        let position = |k: f64| (0.05 * k).sin() + (0.013 * k).cos();
        let of = |later: f64| -> Vec<f64> {
            (0..2000)
                .map(|k| position(f64::from(k) - later) + 0.3)
                .collect()
        };
        let simulated = vec![(0..2000).map(|k| position(f64::from(k))).collect()];
        for later in [7.4, -3.25, 0.0] {
            let run = Run::new(vec![0.0; 2000], of(later)).unwrap();
            let found = Misfit::of(&[run], &|_| simulated.clone(), 0.002);
            let found = found.lag.unwrap();
            assert!((found.seconds - 0.002 * later).abs() < 2e-5);
            assert!(found.left < 1e-2);
        }
    }

    #[test]
    fn an_offset_and_a_scale_are_what_they_are() {
        let simulated: Vec<f64> = (0..400).map(|k| (0.1 * f64::from(k)).sin()).collect();
        let measured: Vec<f64> = simulated.iter().map(|y| 2.0 - 0.8 * y).collect();
        let run = Run::new(vec![0.0; 400], measured).unwrap();
        let simulated = vec![simulated];
        let found = Misfit::of(&[run], &|_| simulated.clone(), 0.002);
        let scale = found.scale.unwrap();
        assert!((scale.factor + 0.8).abs() < 1e-9 && scale.left < 1e-6);
        assert!((found.offset - 2.0).abs() < 0.1 && found.left_of_offset > 1.0);
        assert!((scale.offset - 2.0).abs() < 1e-9 && scale.left_of_scale_alone > 1.0);
        let still = Run::new(vec![0.0; 3], vec![1.0, 2.0, 1.0]).unwrap();
        let none = Misfit::of(&[still], &|_| vec![vec![0.0; 3]], 0.002);
        assert!(none.scale.is_none());
    }

    /// The model begins where the recording does, and forgets that by a tenth a sample.
    #[test]
    fn a_start_that_an_offset_moved_does_not_hide_the_offset() {
        let follows = |start: f64| -> Vec<f64> {
            let mut y = start;
            let step = |k: i32| {
                let before = y;
                y += 0.1 * (f64::from(k / 100 % 2) - y);
                before
            };
            (0..400).map(step).collect()
        };
        for (factor, offset) in [(1.0, 7.0), (1.0, -0.3), (0.9, 7.0), (-1.0, 7.0)] {
            let measured: Vec<f64> = follows(0.0).iter().map(|y| offset + factor * y).collect();
            let command: Vec<f64> = (0..400).map(|k| f64::from(k / 100 % 2)).collect();
            let run = Run::new(command, measured).unwrap();
            let record = Record::new(0.002, vec![run]).unwrap();
            let simulate = |line: Line| vec![follows(line.undone(&record).runs()[0].output()[0])];
            let found = Misfit::of(record.runs(), &simulate, 0.002);
            if factor == 1.0 {
                // One part in a thousand is where the search ends.
                assert!((found.offset - offset).abs() < 1e-3 * offset.abs());
                assert!(found.left_of_offset < 1e-3 * offset.abs());
            }
            let scale = found.scale.unwrap();
            assert!((scale.factor - factor).abs() < 1e-2, "{}", scale.factor);
            assert!((scale.offset - offset).abs() < 1e-2, "{}", scale.offset);
        }
    }
}
