//! Where a servo rests, against its command.
//!
//! Friction and a dead band hold a servo on the side that it comes from, so what they leave changes its sign with the direction of the
//! stroke. A zero that is off, or a load, does not. The errors of all rests are split into the two:
//!
//! ```text
//! y - u = c + f s        s = 1 after a stroke upwards, -1 downwards
//! ```

use super::statistics::{mean, span};
use servoid_identification::results::{Advice, Check};
use servoid_identification::{Record, Run};

/// The shortest hold in which a servo may come to rest (s), and its samples.
const SHORTEST_S: f64 = 0.3;
const SHORTEST_SAMPLES: usize = 8;
/// Rests that are needed to distinguish the two parts.
const RESTS: usize = 4;
/// A part of the travel that matters.
const MATTERS: f64 = 0.01;
/// A slope of the rests over their commands from which on both columns are one angle.
const ONE_ANGLE: std::ops::RangeInclusive<f64> = 0.8..=1.25;
/// Standard deviations of the mean beyond which it is not chance.
const BEYOND_CHANCE: f64 = 4.0;

/// A rest under a held command.
struct CommandedRest {
    command: f64,
    position: f64,
    upwards: bool,
}

/// Advice where the servo rests off its command by more than its friction explains.
pub(super) fn advice(record: &Record, unit: Option<&str>) -> Option<Advice> {
    let hold = (SHORTEST_S / record.sample_period_s()).ceil() as usize;
    let hold = hold.max(SHORTEST_SAMPLES);
    let travel = span(record.runs().iter().flat_map(Run::output).copied())?;
    let all: Vec<CommandedRest> = record
        .runs()
        .iter()
        .flat_map(|run| rests(run, hold, MATTERS * travel))
        .collect();
    let (up, down): (Vec<&CommandedRest>, Vec<&CommandedRest>) =
        all.iter().partition(|rest| rest.upwards);
    if all.len() < RESTS || up.len().min(down.len()) < 2 || !ONE_ANGLE.contains(&slope(&all)?) {
        return None;
    }
    let (up, up_variance) = errors(&up);
    let (down, down_variance) = errors(&down);
    let (off, friction) = ((up + down) / 2.0, (up - down).abs() / 2.0);
    let sd = (up_variance + down_variance).sqrt() / 2.0;
    let is_off = off.abs() > friction.max(MATTERS * travel).max(BEYOND_CHANCE * sd);
    let unit = unit.map_or_else(String::new, |unit| format!(" {unit}"));
    is_off.then(|| {
        Advice::new(
            Check::Zeros,
            format!(
                "The servo rests {off:+.2}{unit} from its command (mean of {} rests); what changes with the direction of the stroke, as friction \
                 does, is {friction:.2}{unit} to each side.",
                all.len()
            ),
            off,
            friction,
            "Look at the zero of the sensor, at the horn on its spline and at a load that pulls to one side. The step response does not \
             depend on it.",
        )
    })
}

/// The rests of a run: holds whose last quarter has one mean in both of its halves, to within `still`.
fn rests(run: &Run<'_>, hold: usize, still: f64) -> Vec<CommandedRest> {
    let (input, output) = (run.input(), run.output());
    let mut found = Vec::new();
    let mut begin = 0;
    for stretch in input.chunk_by(|a, b| a == b) {
        let end = begin + stretch.len();
        let before = begin.checked_sub(1).and_then(|k| input.get(k)).copied();
        let before = before.or(run.input_at_rest());
        let command = stretch.first().copied().unwrap_or(f64::NAN);
        let quarter = stretch.len() / 4;
        let halves = [end - quarter..end - quarter / 2, end - quarter / 2..end];
        let means =
            halves.map(|half| mean(output.get(half).unwrap_or_default()).unwrap_or(f64::NAN));
        begin = end;
        let Some(before) = before.filter(|before| *before != command) else {
            continue;
        };
        if stretch.len() >= hold && (means[0] - means[1]).abs() < still {
            found.push(CommandedRest {
                command,
                position: (means[0] + means[1]) / 2.0,
                upwards: command > before,
            });
        }
    }
    found
}

/// Mean error of some rests, and the variance of that mean.
fn errors(rests: &[&CommandedRest]) -> (f64, f64) {
    let errors: Vec<f64> = rests
        .iter()
        .map(|rest| rest.position - rest.command)
        .collect();
    let centre = mean(&errors).unwrap_or(f64::NAN);
    let squares: f64 = errors.iter().map(|error| (error - centre).powi(2)).sum();
    let count = errors.len() as f64;
    (centre, squares / (count - 1.0) / count)
}

/// Slope of the positions over the commands; `None` of one command.
fn slope(rests: &[CommandedRest]) -> Option<f64> {
    let commands: Vec<f64> = rests.iter().map(|rest| rest.command).collect();
    let positions: Vec<f64> = rests.iter().map(|rest| rest.position).collect();
    let (u, y) = (mean(&commands)?, mean(&positions)?);
    let product: f64 = rests
        .iter()
        .map(|rest| (rest.command - u) * (rest.position - y))
        .sum();
    let square: f64 = commands.iter().map(|command| (command - u).powi(2)).sum();
    (square > 0.0).then(|| product / square)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A servo that rests `off` its command and is held back by `friction`, under steps of this travel to each side.
    fn record(off: f64, friction: f64) -> Record<'static> {
        let command = |k: usize| {
            if (k / 50).is_multiple_of(2) {
                -100.0
            } else {
                100.0
            }
        };
        let input: Vec<f64> = (0..600).map(command).collect();
        let output = (0..600).map(|k| {
            let noise = ((k * k * 7919) % 101) as f64 / 1000.0;
            let target = command(k) + off - friction * command(k).signum();
            match k % 50 {
                0..5 => 0.0,
                _ => target + noise,
            }
        });
        let output: Vec<f64> = output.collect();
        Record::of_run(0.02, input, output).unwrap()
    }

    #[test]
    fn an_offset_is_distinguished_from_friction() {
        let found = advice(&record(3.0, 1.0), Some("deg")).unwrap();
        assert!((found.value - 3.05).abs() < 0.1, "{}", found.value);
        assert!((found.threshold - 1.0).abs() < 0.1, "{}", found.threshold);
        assert!(found.finding.contains("rests +3.0"), "{}", found.finding);
        assert_eq!(advice(&record(1.0, 0.0), None), None);
        assert_eq!(advice(&record(3.0, 4.0), None), None);
    }
}
