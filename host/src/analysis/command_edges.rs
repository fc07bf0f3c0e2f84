//! Whether commands take effect at moments of their own, and not at the rows at which they are written.
//!
//! Between two changes of the command, the errors e of the model and the speed s' of its output give the time by which the answer to the
//! first of them is later than the model, τ = -Σ e s' / Σ s'². Where the moments at which commands take effect have nothing to do with the
//! rows, these times fill an interval of a certain length evenly: one row where a logger with a clock of its own looks for the command, one
//! frame where pulses have frames of their own. Noise, and a servo that is not linear, scatter them in another way: their kurtosis is that
//! of a bell, 3, or more, and that of an even scatter is 1.8.

use super::duration_in_words::in_words;
use crate::data::dataset::Dataset;
use servoid_identification::results::{Advice, Check, Model};
use servoid_identification::{Identification, Run};

/// The answer to one change of the command.
struct CommandAnswer {
    /// Later than the model by \[samples\].
    late: f64,
    /// Sum of squares of the speed.
    weight: f64,
    /// Mean square of what the lag does not explain.
    noise: f64,
}

/// Fewest answers by which one scatter is distinguished from another.
const FEWEST: usize = 20;

/// Answers to small changes, in parts of the usual weight, are too noisy to count.
const SMALL: f64 = 0.25;

/// Share of the scatter that may be noise.
const MOST_NOISE: f64 = 0.25;

/// Half way, in standard deviations of few dozen numbers, between the kurtosis of an even scatter and that of a bell.
const EVEN_KURTOSIS: f64 = 2.4;

/// Scatters that are taken for one row \[rows\]: they are known to a fifth or so.
const ONE_ROW: std::ops::RangeInclusive<f64> = 0.7..=1.3;

/// The longest frame of pulses, or cycle of a controller \[s\].
const LONGEST_FRAME_S: f64 = 0.05;

/// That commands take effect between the rows of a file, or later than they are written by a frame that scatters.
pub(super) fn commands_between_rows(data: &Dataset, found: &Identification) -> Option<Advice> {
    let model = &found.model;
    // Errors of a servo that is not linear, and steps of a coarse sensor, scatter from stroke to stroke, too.
    let is_plain = model.linear && model.bounds.valid().is_some();
    if !data.about.commands_at_rows || !is_plain || found.explanation.resolution.is_some() {
        return None;
    }
    let rows = even_scatter(data.record.runs(), model)?;
    let scatter_s = rows * model.sample_period_s;
    let said = format!(
        "The answers to commands scatter evenly over {}",
        in_words(scatter_s)
    );
    let half = in_words(0.5 * model.sample_period_s);
    let mean_wait = in_words(0.5 * scatter_s);
    let (finding, remedy) = if ONE_ROW.contains(&rows) {
        (
            format!(
                "{said}, about the time between rows, as if commands changed between them. A logger with a clock of its own does that: then all \
                 times are half a row, {half}, too early, which no bound contains."
            ),
            "If such a logger wrote the file, say --polled: times are corrected, and their intervals allow for the rest. Better, record by the \
             clock of the commands.".to_owned(),
        )
    } else if rows > *ONE_ROW.end() && scatter_s <= LONGEST_FRAME_S {
        (
            format!(
                "{said}, as if each waited for a moment of its own: pulses in frames that the rows know nothing of do that, and controllers with \
                 such a cycle. All times contain the mean of this wait, {mean_wait}, and single answers are up to as much sooner or later."
            ),
            format!(
                "For a simulation that has such a frame, take {mean_wait} from the delay. Better, write each command at the pulse with which it \
                 begins."
            ),
        )
    } else {
        return None;
    };
    Some(Advice::new(
        Check::CommandEdges,
        finding,
        rows,
        *ONE_ROW.start(),
        remedy,
    ))
}

/// The length of the interval over which the answers scatter evenly \[samples\]; `None` where they do not.
fn even_scatter(runs: &[Run<'_>], model: &Model) -> Option<f64> {
    let mut answers: Vec<CommandAnswer> = runs.iter().flat_map(|run| answers(run, model)).collect();
    answers.sort_by(|a, b| a.weight.total_cmp(&b.weight));
    let usual = answers.get(answers.len() / 2)?.weight;
    answers.retain(|answer| answer.weight > SMALL * usual);
    if answers.len() < FEWEST {
        return None;
    }
    let mean = |of: &dyn Fn(&CommandAnswer) -> f64| -> f64 {
        answers.iter().map(of).sum::<f64>() / answers.len() as f64
    };
    let middle = mean(&|answer| answer.late);
    let moment = |power: i32| mean(&|answer| (answer.late - middle).powi(power));
    let (variance, fourth) = (moment(2), moment(4));
    let of_noise = mean(&|answer| answer.noise) * mean(&|answer| answer.weight.recip());
    let is_even = of_noise < MOST_NOISE * variance && fourth < EVEN_KURTOSIS * variance * variance;
    // An interval of length 1 has the variance 1/12.
    is_even.then(|| (12.0 * (variance - of_noise)).sqrt())
}

/// The answers of a run, each from one change of the command to the next.
fn answers(run: &Run<'_>, model: &Model) -> Vec<CommandAnswer> {
    let simulated = model.simulate(run);
    let speed = |beside: &[f64]| match beside {
        [before, _, after] => 0.5 * (after - before),
        _ => f64::NAN,
    };
    let speeds = std::iter::once(f64::NAN).chain(simulated.windows(3).map(speed));
    let both = run.output().iter().zip(&simulated);
    let errors = both.map(|(measured, simulated)| measured - simulated);
    let rows: Vec<(f64, (f64, f64))> =
        (run.input().iter().copied().zip(errors.zip(speeds))).collect();
    // The first hold answers what was before the run.
    let holds = rows.chunk_by(|(a, _), (b, _)| a == b).skip(1);
    holds.filter_map(answer).collect()
}

/// The answer within a hold, by its rows of command, error and speed.
fn answer(hold: &[(f64, (f64, f64))]) -> Option<CommandAnswer> {
    let pairs = || {
        let known = hold.iter().map(|(_, pair)| *pair);
        known.filter(|(error, speed)| !(error * speed).is_nan())
    };
    let weight: f64 = pairs().map(|(_, speed)| speed * speed).sum();
    let late = -pairs().map(|(error, speed)| error * speed).sum::<f64>() / weight;
    let left = pairs().map(|(error, speed)| (error + late * speed).powi(2));
    let noise = left.sum::<f64>() / pairs().count() as f64;
    (weight > 0.0).then_some(CommandAnswer {
        late,
        weight,
        noise,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_identification::{Options, Record, identify};

    /// A lag of 30 ms under levels of 0.2 to 0.4 s, in rows of 10 ms; a command takes effect up to `wait` rows after its row, or before where
    /// that is negative.
    fn scatter(wait: f64, noise: f64) -> Option<f64> {
        let random = |k: u32| (f64::from(k) * f64::from(k) * 0.7548776662).fract();
        let (mut input, mut output) = (Vec::new(), Vec::new());
        let (mut angle, mut before) = (0.0, 0.0);
        for stroke in 0..100 {
            let level = 10.0 * random(7 * stroke + 1) - 5.0;
            let late = 100.0 * wait * random(3 * stroke + 2);
            for row in 0..20 + stroke % 21 {
                input.push(level);
                output.push(angle + noise * (random(91 * stroke + row) - 0.5));
                for step in 0..100 {
                    let at = f64::from(100 * row + step);
                    let command = if at < late { before } else { level };
                    angle += (command - angle) / 300.0;
                }
            }
            before = level;
        }
        let record = Record::of_run(0.01, &input, &output).unwrap();
        let model = identify(&record, &Options::default()).unwrap();
        even_scatter(record.runs(), &model)
    }

    #[test]
    fn commands_that_wait_for_a_row_or_a_frame_are_seen_and_noise_is_not() {
        let row = scatter(1.0, 0.05).unwrap();
        assert!(ONE_ROW.contains(&row), "{row}");
        let frame = scatter(3.0, 0.05).unwrap();
        assert!((frame - 3.0).abs() < 0.6, "{frame}");
        assert_eq!(scatter(0.0, 0.05), None);
        assert_eq!(scatter(0.0, 1.0), None);
    }
}
