//! How large the strokes of a command are, whatever levels they go between.
//!
//! Strokes of several sizes in one record show whether the servo answers them alike: a servo that is limited in speed, or has play or friction, does
//! not, and does not look linear then. Strokes of one size show nothing of this.

use crate::data::{Record, measured_within, stroke_sizes};
use crate::thresholds::{FEWEST_STROKES, HELD_WITHIN, SEVERAL_SIZES, SIZES_COMPARED};

/// The strokes of one side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StrokeSizes {
    /// Number of strokes.
    count: usize,
    /// Quartiles of their sizes \[input\].
    quartiles: [f64; 2],
    /// Root mean square of their sizes \[input\].
    typical: f64,
}

impl StrokeSizes {
    /// Those of a record, with the noise of an input that was measured left out.
    pub(super) fn of(record: &Record) -> Self {
        let tolerance = measured_within(record);
        let sizes = stroke_sizes(record, tolerance);
        let mut sizes: Vec<f64> = sizes.filter(|size| *size > tolerance).collect();
        sizes.sort_by(f64::total_cmp);
        let count = sizes.len();
        let square = sizes.iter().map(|size| size * size).sum::<f64>();
        let at = |place: usize| sizes.get(place).copied().unwrap_or_default();
        Self {
            count,
            quartiles: [at(count / 4), at(count.saturating_sub(1 + count / 4))],
            typical: (square / count as f64).sqrt(),
        }
    }

    /// Whether the middle half of them has several sizes: a first stroke from neutral alone makes none.
    fn are_several(&self) -> bool {
        let [low, high] = self.quartiles;
        self.count >= FEWEST_STROKES && high >= SEVERAL_SIZES * low
    }

    /// Whether these and the other are strokes of several sizes, drawn anew: under one reference the two have the same sizes.
    pub(super) fn are_another_draw(&self, other: &Self) -> bool {
        let sizes = |of: &Self| [of.quartiles[0], of.quartiles[1], of.typical];
        let mut both = sizes(self).into_iter().zip(sizes(other));
        self.are_several()
            && other.are_several()
            && both.any(|(a, b)| a.max(b) > (1.0 + HELD_WITHIN) * a.min(b))
    }

    /// Whether both sides have strokes of several sizes, which are about as large.
    pub(super) fn show_linearity_alike(&self, other: &Self) -> bool {
        let larger = self.typical.max(other.typical);
        self.are_several()
            && other.are_several()
            && larger <= SIZES_COMPARED * self.typical.min(other.typical)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(levels: impl IntoIterator<Item = f64>) -> StrokeSizes {
        let input: Vec<f64> = levels.into_iter().flat_map(|level| [level; 20]).collect();
        StrokeSizes::of(&Record::of_run(0.01, input.clone(), input).unwrap())
    }

    /// From squares modulo a prime number, within ±`size`.
    fn random(factor: u64, size: f64) -> StrokeSizes {
        let level = |k: u64| size * ((k + 1).pow(2) * factor % 9973) as f64 / 4986.5 - size;
        of((0..40).map(level))
    }

    #[test]
    fn random_levels_have_several_sizes_whatever_the_draw() {
        for factor in [3001, 4096, 2111, 777] {
            assert!(random(factor, 10.0).show_linearity_alike(&random(4817, 10.0)));
            assert!(random(factor, 7.0).show_linearity_alike(&random(4817, 10.0)));
            assert!(!random(factor, 3.0).show_linearity_alike(&random(4817, 10.0)));
            assert!(random(factor, 10.0).are_another_draw(&random(4817, 10.0)));
            assert!(!random(factor, 10.0).are_another_draw(&random(factor, 10.1)));
        }
    }

    #[test]
    fn a_square_wave_and_stairs_of_equal_steps_have_one_size() {
        let random = random(3001, 10.0);
        let square = |k: i32| {
            if k == 0 {
                0.0
            } else {
                f64::from(10 - 20 * (k % 2))
            }
        };
        assert!(!of((0..40).map(square)).show_linearity_alike(&random));
        let stairs = |k: i32| f64::from((k % 16 - 8).abs() * 2);
        assert!(!of((0..40).map(stairs)).show_linearity_alike(&random));
        // Few strokes show little.
        let few = of([0.0, 9.0, 1.0, 6.0, 5.0]);
        assert!(!few.show_linearity_alike(&random) && !random.show_linearity_alike(&few));
    }
}
