//! An angle that starts again at 0 after a full turn.
//!
//! Encoders and some programs write 359.97 for -0.03 degrees, or 4095 for -1 count. Taken as it is, a servo at 0 jumps by a turn.

use std::f64::consts::TAU;

/// A full turn. Radians are stated: a step of 6 degrees is a motion. Whole numbers beyond 360 are counts of an encoder, whose number is a power
/// of two.
fn full_turn(unit: Option<&str>, column: &[f64]) -> f64 {
    let mut known = column.iter().filter(|y| y.is_finite());
    let most = known.clone().fold(0.0, |most: f64, y| most.max(*y));
    let are_counts = known.all(|y| *y >= 0.0 && y.fract() == 0.0);
    match unit {
        Some("rad") => TAU,
        _ if are_counts && most > 360.0 && most < f64::from(u32::MAX) => {
            f64::from((most as u32).saturating_add(1).next_power_of_two())
        }
        _ => 360.0,
    }
}

/// Part of a turn within which a jump of one lies, and below which motion from row to row stays.
const NEAR: f64 = 0.25;

/// Fewest jumps: a single one may be a reading that is wrong.
const FEWEST: usize = 2;

/// `column` put together, and a remark on it, where it jumps by full turns.
pub(super) fn put_together(
    name: &str,
    column: &[f64],
    unit: Option<&str>,
) -> Option<(Vec<f64>, String)> {
    let turn = full_turn(unit, column);
    let jumps = jumps(column, turn)?;
    let remark = format!(
        "column {name:?} jumps by a full turn in {jumps} rows, as an angle does that starts again at 0: it is put together"
    );
    Some((unwrapped(column, turn), remark))
}

/// How many jumps of a `turn` there are, if no other motion is as large.
fn jumps(column: &[f64], turn: f64) -> Option<usize> {
    let known: Vec<f64> = column.iter().copied().filter(|y| y.is_finite()).collect();
    let next = known.iter().skip(1);
    let steps = known.iter().zip(next).map(|(a, b)| (b - a).abs() / turn);
    let (moves, jumps): (Vec<f64>, Vec<f64>) = steps.partition(|step| *step < NEAR);
    let are_turns = jumps.iter().all(|step| (step - 1.0).abs() < NEAR);
    (!moves.is_empty() && are_turns && jumps.len() >= FEWEST).then_some(jumps.len())
}

/// `column` without its jumps, within half a `turn` of 0 at first.
fn unwrapped(column: &[f64], turn: f64) -> Vec<f64> {
    let mut last = 0.0;
    let next = |y: &f64| {
        let y = y - turn * ((y - last) / turn).round();
        if y.is_finite() {
            last = y;
        }
        y
    };
    column.iter().map(next).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(column: &[f64]) -> Option<(Vec<f64>, String)> {
        put_together("y", column, None)
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
            let (found, remark) = put_together("y", &column, unit).unwrap();
            assert!(remark.contains("jumps by a full turn"), "{remark}");
            for (y, expected) in found.iter().zip(&motion) {
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
