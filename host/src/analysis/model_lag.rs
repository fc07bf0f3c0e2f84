//! By how much a recording is later than a model of it.

use servoid_identification::Run;

/// The farthest that is looked for \[s\]: servos answer sooner.
const FARTHEST_S: f64 = 0.25;

/// A recording against a model of it that is shifted in time.
pub(super) struct Lag {
    /// The shift at which they agree best \[s\]; positive where the recording is later.
    pub(super) seconds: f64,
    /// The error that is left then, without its mean (rms).
    pub(super) left: f64,
}

impl Lag {
    /// The best shift by whole samples, and by the parabola through the squares beside it. `None` where no shift within a quarter of a second
    /// is best.
    pub(super) fn of(runs: &[Run<'_>], simulated: &[Vec<f64>], period_s: f64) -> Option<Self> {
        let farthest = (FARTHEST_S / period_s).ceil() as isize;
        let square = |shift: isize| {
            let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
            for (run, simulated) in runs.iter().zip(simulated) {
                for (k, measured) in run.output().iter().enumerate() {
                    let other = k.checked_add_signed(-shift).and_then(|k| simulated.get(k));
                    let error = measured - other.copied().unwrap_or(f64::NAN);
                    if !error.is_nan() {
                        count += 1.0;
                        sum += error;
                        squares += error * error;
                    }
                }
            }
            squares / count - (sum / count).powi(2)
        };
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
            let found = Lag::of(&[run], &simulated, 0.002).unwrap();
            assert!((found.seconds - 0.002 * later).abs() < 2e-5);
            assert!(found.left < 1e-2);
        }
    }
}
