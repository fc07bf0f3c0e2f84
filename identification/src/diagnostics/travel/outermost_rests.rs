//! Where the output is under the outermost commands that are held, whether that is a stop or not.

use crate::data::column::extent;
use crate::data::{EXACTLY, Hold, Record, Run, holds, last_quarter, mean_output};
use crate::numerics::median;

/// The lowest and the highest command that are held, each with the output at the end of its holds, a median. `None` where nothing is held.
pub(crate) fn outermost_rests(record: &Record) -> Option<[[f64; 2]; 2]> {
    let of_run = |run: &Run<'_>| {
        let end = |hold: Hold| Some((hold.level, mean_output(run, last_quarter(&hold.samples))?));
        let ends = holds(run, EXACTLY).into_iter().filter_map(end);
        ends.collect::<Vec<(f64, f64)>>()
    };
    let ends: Vec<(f64, f64)> = record.runs().iter().flat_map(of_run).collect();
    let (low, high) = extent(ends.iter().map(|(command, _)| *command))?;
    let at = |level: f64| {
        let of_level = ends.iter().filter(|(command, _)| *command == level);
        let output = median(of_level.map(|(_, output)| *output).collect())?;
        Some([level, output])
    };
    Some([at(low)?, at(high)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_the_median_of_the_ends_of_holds() {
        // Rests at 1 under a command of 0, at 5 under 4 but once, and moves in between.
        let hold = |command: f64, from: f64, rest: f64| {
            let way = move |k: u32| if k < 4 { from } else { rest };
            (0..8).map(move |k| (command, way(k)))
        };
        let all = [
            (0.0, 9.0, 1.0),
            (4.0, 1.0, 5.0),
            (2.0, 5.0, 3.0),
            (4.0, 3.0, 5.0),
            (4.0, 3.0, 4.0),
        ];
        let samples = all
            .into_iter()
            .flat_map(|(command, from, rest)| hold(command, from, rest));
        let (input, output): (Vec<f64>, Vec<f64>) = samples.unzip();
        let record = Record::of_run(0.01, input, output).unwrap();
        assert_eq!(outermost_rests(&record), Some([[0.0, 1.0], [4.0, 5.0]]));
    }
}
