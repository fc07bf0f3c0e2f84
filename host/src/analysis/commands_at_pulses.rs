//! A recording whose commands are where they took effect.
//!
//! Of commands that [wait for the next pulse](super::pulse_frames), each row gets the mean of the command in force from this row to the next. Behind a linear servo,
//! what errors are left to a model of such a record are noise. A limit of the speed, play and friction stay what they are.

use servoid_identification::Run;

/// The `run`, with a change of the command at each row taking effect so many rows later as `wait_rows` says.
pub(super) fn at_pulses(run: &Run<'_>, wait_rows: impl Fn(usize) -> f64) -> Option<Run<'static>> {
    let mut input = run.input().to_vec();
    let pairs = run.input().iter().zip(run.input().iter().skip(1));
    for (row, (before, after)) in (1..).zip(pairs) {
        let change = after - before;
        if change.is_nan() || change == 0.0 {
            continue;
        }
        let mut wait = wait_rows(row);
        for value in input.iter_mut().skip(row) {
            if wait <= 0.0 {
                break;
            }
            *value -= change * wait.min(1.0);
            wait -= 1.0;
        }
    }
    let mut moved = Run::new(input, run.output().to_vec()).ok()?;
    if let Some(at_rest) = run.input_at_rest() {
        moved = moved.with_input_at_rest(at_rest);
    }
    if let Some(label) = run.label() {
        moved = moved.with_label(label);
    }
    Some(moved)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_where_they_took_effect() {
        let run = Run::new(vec![0.0, 1.0, 1.0, 1.0, 3.0, 3.0, 3.0], vec![0.0; 7]).unwrap();
        let moved = at_pulses(&run, |row| if row == 1 { 1.25 } else { 0.5 }).unwrap();
        assert_eq!(moved.input(), [0.0, 0.0, 0.75, 1.0, 2.0, 3.0, 3.0]);
    }

    /// Of two commands within a frame, the servo sees the second.
    #[test]
    fn a_command_that_another_overtakes_is_never_in_force() {
        let run = Run::new(vec![0.0, 5.0, 1.0, 1.0, 1.0], vec![0.0; 5]).unwrap();
        let moved = at_pulses(&run, |row| 3.0 - row as f64).unwrap();
        assert_eq!(moved.input(), [0.0, 0.0, 0.0, 1.0, 1.0]);
    }
}
