//! What sets a recording apart from a model of it: an offset, a scale, a shift in time, or noise.

use super::noise_at_rest::noise_at_rest;
use servoid_identification::Run;

/// The farthest shift that is looked for \[s\]: servos answer sooner.
const FARTHEST_S: f64 = 0.25;

/// What a recording has that its model has not, each looked for alone. Errors that are left are rms values.
pub(super) struct Misfit {
    /// The mean error, and what is left without it.
    pub(super) offset: f64,
    pub(super) left_of_offset: f64,
    /// By how much farther the recording moves than the model, where that moves.
    pub(super) scale: Option<Scale>,
    /// The shift in time at which they agree best, where there is one.
    pub(super) lag: Option<Lag>,
    /// The noise at rest (rms), where the recording shows it.
    pub(super) noise: Option<f64>,
}

/// A recording against a model of it that is scaled.
pub(super) struct Scale {
    /// The factor at which they agree best.
    pub(super) factor: f64,
    /// What is added to the scaled model then.
    pub(super) offset: f64,
    /// The error that is left of both (rms).
    pub(super) left: f64,
    /// The error that a scale alone leaves, about zero or about the middle of the motion, whichever leaves less (rms).
    pub(super) left_of_scale_alone: f64,
}

/// A recording against a model of it that is shifted in time.
pub(super) struct Lag {
    /// The shift at which they agree best \[s\]; positive where the recording is later.
    pub(super) seconds: f64,
    /// The error that is left then, without its mean (rms).
    pub(super) left: f64,
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

impl Misfit {
    /// Of the runs of a recording, and what a model simulates for each.
    pub(super) fn of(runs: &[Run<'_>], simulated: &[Vec<f64>], period_s: f64) -> Self {
        let unshifted = Sums::at(runs, simulated, 0);
        let (covariance, spread) = unshifted.with_simulated();
        let variance = unshifted.variance();
        let offset = unshifted.error / unshifted.count;
        let left = (variance - covariance * covariance / spread)
            .max(0.0)
            .sqrt();
        let scale = Scale {
            factor: 1.0 + covariance / spread,
            offset: offset - covariance / spread * unshifted.simulated / unshifted.count,
            left,
            left_of_scale_alone: unshifted.left_of_scale_about_zero().min(left.hypot(offset)),
        };
        Self {
            offset,
            left_of_offset: variance.max(0.0).sqrt(),
            scale: scale.factor.is_finite().then_some(scale),
            lag: Lag::of(runs, simulated, period_s),
            noise: noise_at_rest(runs, simulated),
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
        Some(Self {
            seconds: (shift as f64 + between) * period_s,
            left: left.max(0.0).sqrt(),
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
            let found = Misfit::of(&[run], &simulated, 0.002).lag.unwrap();
            assert!((found.seconds - 0.002 * later).abs() < 2e-5);
            assert!(found.left < 1e-2);
        }
    }

    #[test]
    fn an_offset_and_a_scale_are_what_they_are() {
        let simulated: Vec<f64> = (0..400).map(|k| (0.1 * f64::from(k)).sin()).collect();
        let measured: Vec<f64> = simulated.iter().map(|y| 2.0 - 0.8 * y).collect();
        let run = Run::new(vec![0.0; 400], measured).unwrap();
        let found = Misfit::of(&[run], &[simulated], 0.002);
        let scale = found.scale.unwrap();
        assert!((scale.factor + 0.8).abs() < 1e-9 && scale.left < 1e-6);
        assert!((found.offset - 2.0).abs() < 0.1 && found.left_of_offset > 1.0);
        assert!((scale.offset - 2.0).abs() < 1e-9 && scale.left_of_scale_alone > 1.0);
        let still = Run::new(vec![0.0; 3], vec![1.0, 2.0, 1.0]).unwrap();
        assert!(Misfit::of(&[still], &[vec![0.0; 3]], 0.002).scale.is_none());
    }
}
