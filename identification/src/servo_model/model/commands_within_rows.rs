//! Commands that change within the rows of a record.

use std::borrow::Cow;

/// The commands of the runs of a record in parts of its rows, as many of each row.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandsWithinRows {
    /// Parts of a row, at least 1.
    pub parts: usize,
    /// Of each run, the command in each part of its rows. A run without any, and a part without a number, has that of the row.
    pub of_runs: Vec<Vec<f64>>,
}

impl CommandsWithinRows {
    /// Those of `run` from its row `first` on, where the record has `rows`.
    pub(super) fn of<'a>(&self, run: usize, first: usize, rows: &'a [f64]) -> Cow<'a, [f64]> {
        let own = self.of_runs.get(run);
        if self.parts == 1 && own.is_none() {
            return Cow::Borrowed(rows);
        }
        let at = |k: usize| own.and_then(|own| own.get(first * self.parts + k)).copied();
        let of_row = rows
            .iter()
            .flat_map(|row| std::iter::repeat_n(*row, self.parts));
        let known = |(k, of_row)| at(k).filter(|u| !u.is_nan()).unwrap_or(of_row);
        Cow::Owned(of_row.enumerate().map(known).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_without_a_number_has_the_command_of_its_row() {
        let commands = CommandsWithinRows {
            parts: 2,
            of_runs: vec![vec![0.0, 0.0, 1.0, f64::NAN, 3.0, 4.0]],
        };
        assert_eq!(*commands.of(0, 1, &[7.0, 8.0]), [1.0, 7.0, 3.0, 4.0]);
        assert_eq!(*commands.of(1, 0, &[7.0]), [7.0, 7.0]);
    }
}
