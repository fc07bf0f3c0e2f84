//! Commands that move on with every row, as those of a stick or a sweep.
//!
//! A row's command is taken to act until the next row. Whether the servo was sent it so, or the motion between the rows too, is not in the
//! column: in the second case it answers half a row later than is seen. A command that is held over rows and then jumps leaves no such doubt.

use super::about::About;
use super::time_column::shown;
use servoid_identification::Run;

/// How much earlier or later than its rows say such a command may have been sent \[rows\]: half a row, and a tenth for what a model of a held
/// command makes of one that moves on. A stick in rows of 10 ms, sent between them too, was followed 5.4 ms later than was seen.
const OPEN_ROWS: f64 = 0.6;

/// The tenth, which each model has by itself: two recordings that were made alike share the half \[rows\].
const OWN_ROWS: f64 = 0.1;

/// Correlation of the changes of two neighbouring rows from which on a command moves on between them. That of jumps between holds is 0, that
/// of levels drawn anew in every row -0.5, and that of a sine 0.1 at 4.3 rows a period, faster than any servo is driven in rows that show it.
const MOVES_ON: f64 = 0.1;

/// Whether the command moves on between the rows of these runs.
pub(super) fn moves_between_rows<'a>(runs: impl Iterator<Item = &'a [f64]>) -> bool {
    let (mut square, mut product) = (0.0, 0.0);
    for run in runs {
        let mut before = f64::NAN;
        for (a, b) in run.iter().zip(run.iter().skip(1)) {
            let change = b - a;
            if change.is_finite() {
                square += change * change;
            }
            let both = change * before;
            if both.is_finite() {
                product += both;
            }
            before = change;
        }
    }
    product > MOVES_ON * square
}

/// How much earlier or later than its rows say the servo may have been sent the command of these `runs` (s), 0 where it does not move on between
/// them; `about` gets to know it.
pub(super) fn unseen_within_rows(
    runs: &[Run<'_>],
    period_s: f64,
    about: &mut About,
    place: &str,
) -> f64 {
    about.moving_command = moves_between_rows(runs.iter().map(Run::input));
    if !about.moving_command {
        return 0.0;
    }
    about.remarks.push(format!(
        "{place}the command moves on with every row, and whether the servo was sent it in steps of {} is not in the file: intervals of times allow for {} to each side, and for no wait for a pulse, which is in the delay where none are found (--exact-command states that it was, --polled that the servo followed it between them)",
        shown(period_s),
        shown(OPEN_ROWS * period_s)
    ));
    OPEN_ROWS * period_s
}

/// The part of such a time of which each recording has its own (s).
pub(crate) fn own_part_s(open_s: f64) -> f64 {
    open_s * OWN_ROWS / OPEN_ROWS
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moves(command: impl Fn(usize) -> f64) -> bool {
        let column: Vec<f64> = (0..2000).map(command).collect();
        moves_between_rows([&*column].into_iter())
    }

    #[test]
    fn sines_move_on_and_holds_and_levels_of_each_row_do_not() {
        assert!(moves(|k| (0.02 * k as f64).sin()));
        // A sweep up to 12 Hz in rows of 20 ms, with a missing row.
        let sweep = |k: usize| (0.003 * k as f64 + 0.000_37 * (k * k) as f64).sin();
        assert!(moves(|k| if k == 700 { f64::NAN } else { sweep(k) }));
        let level = |k: usize| ((k * 7919) % 13) as f64;
        assert!(!moves(|k| level(k / 25)));
        assert!(!moves(level));
        // A stick that was sent with the frames of 20 ms, in rows of 2 ms.
        assert!(!moves(|k| (0.2 * (k / 10) as f64).sin()));
        assert!(!moves(|_| 1.0));
    }
}
