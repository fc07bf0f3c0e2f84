//! The rows at which a command changes.

/// Those of a run, each the first row with its level. Rows without a command change nothing.
pub(crate) fn command_changes(command: &[f64]) -> impl Iterator<Item = usize> {
    let pairs = command.iter().zip(command.iter().skip(1));
    let changed = (1..)
        .zip(pairs)
        .filter(|(_, (before, after))| (*after - *before).abs() > 0.0);
    changed.map(|(row, _)| row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_the_first_row_of_its_level() {
        let command = [1.0, 1.0, 2.0, 2.0, f64::NAN, 2.0, 1.0];
        let rows: Vec<usize> = command_changes(&command).collect();
        assert_eq!(rows, [2, 6]);
        assert_eq!(command_changes(&[1.0; 9]).count(), 0);
    }
}
