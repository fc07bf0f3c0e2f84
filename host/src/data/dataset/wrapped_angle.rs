//! An angle that starts again at 0 after a full turn.
//!
//! Encoders and some programs write 359.97 for -0.03 degrees, or 4095 for -1 count. Taken as it is, a servo at 0 jumps by a turn.

use servoid_identification::thresholds::MOST_OUTLYING;
use std::f64::consts::TAU;
use std::iter::once;

/// The full turns that the column may have, the likeliest first. Radians are stated: a step of 6 degrees is a motion. Whole numbers
/// beyond 360 are counts of an encoder, whose number is a power of two; readings that are wrong may lie beyond its range.
fn full_turns(unit: Option<&str>, column: &[f64]) -> Vec<f64> {
    let mut known: Vec<f64> = column.iter().copied().filter(|y| y.is_finite()).collect();
    known.sort_by(f64::total_cmp);
    let few = (MOST_OUTLYING * known.len() as f64) as usize;
    let inner = known.get(few..known.len() - few).unwrap_or_default();
    match unit {
        Some("rad") => vec![TAU],
        _ => once(turn_of(&known)).chain(once(turn_of(inner))).collect(),
    }
}

/// The turn of rising numbers without a unit.
fn turn_of(rising: &[f64]) -> f64 {
    let are_counts = rising.iter().all(|y| *y >= 0.0 && y.fract() == 0.0);
    match rising.last() {
        Some(most) if are_counts && *most > 360.0 && *most < f64::from(u32::MAX) => {
            f64::from((*most as u32).saturating_add(1).next_power_of_two())
        }
        _ => 360.0,
    }
}

/// Part of a turn within which a jump of one lies, and below which motion from row to row stays.
const NEAR: f64 = 0.25;

/// Fewest jumps: a single one may be a reading that is wrong.
const FEWEST: usize = 2;

/// Rows after which readings that lie far off are where the servo is: a bus that fails is back sooner.
const LONGEST_GLITCH: usize = 10;

/// A column that was put together.
pub(super) struct WholeAngle {
    pub(super) column: Vec<f64>,
    /// What was done, for the user.
    pub(super) remark: String,
    /// Rows in which it jumped.
    pub(super) jumps: usize,
}

/// `column` put together, where it jumps by full turns.
pub(super) fn put_together(name: &str, column: &[f64], unit: Option<&str>) -> Option<WholeAngle> {
    let turns = full_turns(unit, column);
    let found = turns.into_iter().find_map(|turn| Turns::of(column, turn))?;
    let wrong = match found.wrong {
        0 => String::new(),
        1 => "; 1 reading far from those around it is left as it is".to_owned(),
        wrong => format!("; {wrong} readings far from those around them are left as they are"),
    };
    let jumps = found.jumps;
    let remark = format!(
        "column {name:?} jumps by a full turn in {jumps} rows, as an angle does that starts again at 0: it is put together{wrong}"
    );
    Some(WholeAngle {
        column: found.together,
        remark,
        jumps,
    })
}

/// Jumps for each one that readings which are wrong may hide: a servo without a turn that takes two rows for a long stroke is seen half way.
const JUMPS_FOR_A_HIDDEN_ONE: usize = 10;

/// A column that jumps by full turns.
struct Turns {
    /// Without the jumps, within half a turn of 0 at first.
    together: Vec<f64>,
    jumps: usize,
    /// Readings that are wrong.
    wrong: usize,
}

impl Turns {
    /// `None` where motion from row to row is as large as a jump, but for few readings that are wrong.
    fn of(column: &[f64], turn: f64) -> Option<Self> {
        let is_wrong = wrong_readings(column, turn)?;
        // The last right reading as it was and as it is placed, and whether wrong ones came after it.
        let (mut last, mut after_wrong) = (None, false);
        let (mut moves, mut jumps, mut hidden) = (0, 0, 0);
        let next = |(y, is_wrong): (&f64, &bool)| {
            if *is_wrong || !y.is_finite() {
                after_wrong |= *is_wrong;
                return *y;
            }
            let (before, placed) = last.unwrap_or((*y, 0.0));
            match (y - before).abs() < NEAR * turn {
                true => moves += usize::from(last.is_some()),
                false => {
                    jumps += 1;
                    hidden += usize::from(after_wrong);
                }
            }
            let together = y - turn * ((y - placed) / turn).round();
            (last, after_wrong) = (Some((*y, together)), false);
            together
        };
        let together = column.iter().zip(&is_wrong).map(next).collect();
        let wrong = is_wrong.iter().filter(|wrong| **wrong).count();
        let are_seen = jumps >= FEWEST && JUMPS_FOR_A_HIDDEN_ONE * hidden <= jumps;
        (moves > 0 && are_seen).then_some(Self {
            together,
            jumps,
            wrong,
        })
    }
}

/// Which readings of the column are wrong: they are neither near the last right one nor a turn away from it, and the readings are back within
/// [`LONGEST_GLITCH`] rows. `None` where they are not, or where more are wrong than the identification takes for outliers.
fn wrong_readings(column: &[f64], turn: f64) -> Option<Vec<bool>> {
    let is_near = |a: f64, b: f64| {
        let step = (b - a).abs() / turn;
        step < NEAR || (step - 1.0).abs() < NEAR
    };
    let finite = || column.iter().copied().filter(|y| y.is_finite());
    let mut pairs = finite().zip(finite().skip(1));
    let (mut last, _) = pairs.find(|(a, b)| is_near(*a, *b))?;
    let (mut all, mut in_a_row) = (Vec::with_capacity(column.len()), 0);
    for y in column.iter().copied() {
        let is_wrong = y.is_finite() && !is_near(last, y);
        if is_wrong {
            in_a_row += 1;
        } else if y.is_finite() {
            (last, in_a_row) = (y, 0);
        }
        if in_a_row > LONGEST_GLITCH {
            return None;
        }
        all.push(is_wrong);
    }
    let wrong = all.iter().filter(|wrong| **wrong).count() as f64;
    (wrong <= MOST_OUTLYING * finite().count() as f64).then_some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(column: &[f64]) -> Option<(Vec<f64>, String)> {
        put_together("y", column, None).map(|angle| (angle.column, angle.remark))
    }

    /// A servo about the end of an encoder's turn, whose readings are `wrong` in some rows, in counts and in degrees.
    fn with_wrong_readings(wrong: &[(usize, f64)]) -> [(Vec<f64>, Vec<f64>); 2] {
        [4096.0, 360.0].map(|turn| {
            let motion = (0..300).map(|k| 0.1 * turn * (f64::from(k) / 9.0).sin());
            let motion: Vec<f64> = match turn {
                360.0 => motion.collect(),
                _ => motion.map(f64::round).collect(),
            };
            let mut column: Vec<f64> = motion.iter().map(|y| y.rem_euclid(turn)).collect();
            for (row, share) in wrong {
                column[*row] = (share * turn).round();
            }
            (column, motion)
        })
    }

    #[test]
    fn a_few_wrong_readings_do_not_keep_an_angle_apart() {
        // One reading half a turn off, a burst, one beyond the encoder's range, one where none was read, the first and the last.
        let wrong = [
            (0, 0.5),
            (40, 0.48),
            (90, 0.4),
            (91, 0.55),
            (92, 0.5),
            (150, 15.5),
            (200, -0.4),
            (299, 0.52),
        ];
        for (column, motion) in with_wrong_readings(&wrong) {
            let (together, remark) = found(&column).unwrap();
            assert!(
                remark.ends_with("8 readings far from those around them are left as they are"),
                "{remark}"
            );
            for (row, (y, expected)) in together.iter().zip(&motion).enumerate() {
                if wrong.iter().all(|(wrong, _)| *wrong != row) {
                    // Rounding of numbers of 360.
                    assert!((y - expected).abs() < 1e-9, "row {row}: {y}, {expected}");
                }
            }
        }
    }

    #[test]
    fn a_column_that_is_no_angle_of_a_turn_is_left_alone_with_wrong_readings_too() {
        // Two levels more than half of the range apart, from row to row, held for so many rows.
        for hold in [2, 5, 20, 60] {
            for [low, high] in [[100.0, 700.0], [0.0, 600.0], [400.0, 1000.0]] {
                let mut column: Vec<f64> = (0..600)
                    .map(|k| if k / hold % 2 == 0 { low } else { high })
                    .collect();
                assert_eq!(found(&column), None, "{hold} {low}");
                column[33] = 1023.0;
                column[410] = 0.0;
                assert_eq!(found(&column), None, "{hold} {low}");
            }
        }
        // Strokes of most of the range that take two rows: half way, the servo is a jump from both ends.
        let in_two_rows = |k: usize| match (k % 60, k / 60 % 2) {
            (0, _) => 500.0,
            (_, 0) => 100.0,
            _ => 900.0,
        };
        let column: Vec<f64> = (1..1200).map(in_two_rows).collect();
        assert_eq!(found(&column), None);
        // More wrong readings than glitches are.
        let wrong: Vec<(usize, f64)> = (0..17).map(|k| (17 * k + 3, 0.5)).collect();
        for (column, _) in with_wrong_readings(&wrong) {
            assert_eq!(found(&column), None);
        }
    }

    #[test]
    fn an_angle_about_zero_is_put_together_and_steps_are_left_alone() {
        let motion: Vec<f64> = (0..300).map(|k| 8.0 * (f64::from(k) / 9.0).sin()).collect();
        let wrapped = |by: f64, turn: f64| -> Vec<f64> {
            motion.iter().map(|y| (by * y).rem_euclid(turn)).collect()
        };
        for (by, turn, unit) in [(1.0, 360.0, Some("deg")), (0.02, TAU, Some("rad"))] {
            let mut column = wrapped(by, turn);
            column[50] = f64::NAN;
            let found = put_together("y", &column, unit).unwrap();
            assert!(found.remark.contains("jumps by a full turn"));
            for (y, expected) in found.column.iter().zip(&motion) {
                // Rounding of numbers of 360.
                assert!(y.is_nan() || (y - by * expected).abs() < 1e-12 * turn);
            }
        }
        let counts: Vec<f64> = motion
            .iter()
            .map(|y| (40.0 * y).rem_euclid(4096.0).floor())
            .collect();
        let (together, _) = found(&counts).unwrap();
        let off = together
            .iter()
            .zip(&motion)
            .map(|(n, y)| (n + 0.5 - 40.0 * y).abs());
        assert!(off.fold(0.0, f64::max) <= 0.5, "{together:?}");
        assert_eq!(found(&motion), None);
        // Strokes of a whole turn, and one wrong reading.
        let strokes: Vec<f64> = (0..300).map(|k| f64::from(k / 100) * 200.0).collect();
        assert_eq!(found(&strokes), None);
        let steps: Vec<f64> = (0..300).map(|k| f64::from(k / 100 % 2) * 6.0).collect();
        assert_eq!(found(&steps), None);
        let mut glitch = motion.clone();
        glitch[40] = -350.0;
        assert_eq!(found(&glitch[..41]), None);
        for nothing in [&[][..], &[f64::NAN], &[0.0, 360.0, 0.0]] {
            assert_eq!(found(nothing), None);
        }
    }
}
