//! Where the output rests under the outermost commands that are held until it does, whether that is a stop or not.

use super::rests::rests;
use crate::data::Record;
use crate::numerics::median;

/// The lowest and the highest command under which the output of `record` comes to rest, each with the output there, a median. `None` where it rests under none.
pub(crate) fn outermost_rests(record: &Record) -> Option<[[f64; 2]; 2]> {
    let rests = rests(record);
    let at = |level: f64| {
        let of_level = rests.iter().filter(|rest| rest.command == level);
        let output = median(of_level.map(|rest| rest.output).collect())?;
        Some([level, output])
    };
    Some([at(rests.first()?.command)?, at(rests.last()?.command)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_the_median_of_the_ends_of_holds() {
        // Rests at 1 under a command of 0, at 5 under 4 but once, and moves in between. What led to the first hold is not known.
        let hold = |command: f64, from: f64, rest: f64| {
            let way = move |k: u32| if k < 4 { from } else { rest };
            (0..8).map(move |k| (command, way(k)))
        };
        let all = [
            (3.0, 9.0, 4.0),
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
