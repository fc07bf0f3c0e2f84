//! Whether commands take effect at moments of their own, and not at the rows at which they are written.
//!
//! Each change of the command is answered [later or sooner](super::command_answers) than the model says. Where the moments at which commands take effect have nothing to do with the
//! rows, these times fill an interval of a certain length evenly: one row where a logger with a clock of its own looks for the command, one
//! frame where pulses have frames of their own. Noise, and a servo that is not linear, scatter them in another way: their kurtosis is that
//! of a bell, 3, or more, and that of an even scatter is 1.8. A servo that is limited in its speed is later by more the longer the stroke: an
//! even choice of strokes scatters its answers evenly, too, so times that follow the stroke do not count. Behind a dead band, strokes are shorter or longer, by which side of it
//! they begin and end at: so times only count that are the same beside the size of each stroke.
//!
//! Where that is the time of one row, a logger polled the command: every answer is up to a row later than its row says, so no time holds, and
//! errors that follow the motion are its consequence. That is a reason to have no bounds. A frame of pulses is part of what a simulation needs.
//! Where frames are regular, [each command waits for the next](super::pulse_frames). Errors that follow the motion are that wait where a model of the
//! [commands at their pulses](super::commands_at_pulses) has none.

use super::command_answers::{CommandAnswer, answers, of_noise};
use super::commands_at_pulses::{RunInFrames, is_linear_at_pulses};
use super::pulse_frames::{PulseFrames, TimedAnswer};
use crate::analysis::duration_in_words::in_words;
use crate::data::dataset::Dataset;
use servoid_identification::results::{Advice, Check, Model, Reason};
use servoid_identification::{Identification, Options, Run};
use std::collections::{BTreeMap, BTreeSet};

/// Fewest answers, beside those of which means are taken out, by which one scatter is distinguished from another.
const FEWEST: usize = 5;

/// Answers to small changes, in parts of the usual weight, are too noisy to count.
const SMALL: f64 = 0.25;

/// Share of the scatter that may be noise.
const MOST_NOISE: f64 = 0.25;

/// Kurtosis of a scatter that counts as even: 1.8 is that of one, 3 that of a bell, 1 that of two times alone, as of a servo that changes. The ends are half way
/// to these.
const EVEN_KURTOSIS: std::ops::Range<f64> = 1.4..2.4;

/// Scatters that are taken for one row \[rows\]: of ten answers they are known to a sixth.
const ONE_ROW: std::ops::RangeInclusive<f64> = 0.6..=1.3;

/// The longest frame of pulses, or cycle of a controller \[s\].
const LONGEST_FRAME_S: f64 = 0.05;

/// Share of the scatter that may follow the size or the direction of the strokes: of ten answers to a clock, a third by chance.
const MOST_BY_STROKE: f64 = 0.5;

/// Share of the scatter that equal strokes have among themselves, below which it is of the strokes: moments of a clock of its own are others each time.
const LEAST_AMONG_EQUAL: f64 = 0.5;

/// Squared correlation of the times with those beside the size of the stroke, below which they are of its size: of commands between rows it is 0.94 or more, behind a
/// dead band and with friction mostly less than 0.5.
const SAME_TIMES: f64 = 0.8;

/// When commands take effect, where that is not at their rows.
pub(crate) enum CommandEdges {
    /// Between the rows: no time of the model holds.
    BetweenRows(Advice),
    /// Between the rows, as was said with the recording: that is what errors follow.
    AsStated,
    /// At moments of a frame of their own.
    InFrames(Advice),
    /// With the next of regular pulses: that is what errors follow.
    WithPulses(Advice),
}

/// That commands take effect between the rows of a file, or later than they are written by a frame that scatters.
pub(crate) fn command_edges(
    data: &Dataset,
    found: &Identification,
    options: &Options,
) -> Option<CommandEdges> {
    let model = &found.model;
    let (at_rows, polled) = (data.about.commands_at_rows, data.about.polled);
    // Where a gain changes, strokes pass where the model does sooner and later; steps of a coarse sensor scatter from stroke to stroke, too.
    let gain_changes = model.bounds.withdrawn() == Some(Reason::GainDrift);
    if !(at_rows || polled) || gain_changes || found.explanation.resolution.is_some() {
        return None;
    }
    let scatter = Scatter::of(data.record.runs(), model)?;
    let rows = scatter.rows();
    let scatter_s = rows * model.sample_period_s;
    let is_longer = rows > *ONE_ROW.end() && scatter_s <= LONGEST_FRAME_S;
    if at_rows
        && is_longer
        && let Some(advice) = scatter.explained_by_pulses(data, found, options)
    {
        return Some(CommandEdges::WithPulses(advice));
    }
    // Answers that come later and later scatter evenly about their means, too.
    let drifts = model.bounds.withdrawn() == Some(Reason::LagDrift);
    if drifts || !scatter.is_even() {
        return None;
    }
    // Errors of a servo that is not linear scatter over any time, and one row is little of that.
    let is_plain = model.linear && model.bounds.valid().is_some();
    let is_frame = at_rows && is_plain && is_longer;
    match ONE_ROW.contains(&rows) {
        true if polled => Some(CommandEdges::AsStated),
        true => Some(CommandEdges::BetweenRows(between_rows(rows, model))),
        false => is_frame.then(|| CommandEdges::InFrames(in_frames(rows, scatter_s))),
    }
}

fn scatter_in_words(scatter_s: f64) -> String {
    format!(
        "The answers to commands scatter evenly over {}",
        in_words(scatter_s)
    )
}

fn between_rows(rows: f64, model: &Model) -> Advice {
    let period_s = model.sample_period_s;
    Advice::new(
        Check::CommandsBetweenRows,
        format!(
            "{}, about the time between rows, as if commands changed between them. A logger with a clock of its own does that, and friction does in some recordings: by \
             such a logger all times are half a row, {}, too early, which no bound contains, and errors follow the motion of a linear servo, too.",
            scatter_in_words(rows * period_s),
            in_words(0.5 * period_s)
        ),
        rows,
        *ONE_ROW.start(),
        "If such a logger wrote the file, say --polled: times are corrected, and their intervals allow for the rest. If each command was written when it changed, another recording \
         of the kind may have bounds. If the pulses of the servo are as far apart as the rows, do not: then all times contain the mean wait for a pulse, half a row. Better, record by the clock \
         of the commands.",
    )
}

fn in_frames(rows: f64, scatter_s: f64) -> Advice {
    let finding = format!(
        "{}, as if each waited for a moment of its own: pulses in frames that the rows know nothing of do that, and controllers with \
         such a cycle. All times contain the mean of this wait",
        scatter_in_words(scatter_s)
    );
    of_wait(rows, &finding, scatter_s)
}

/// Of frames whose length is known, or of those over whose length answers scatter.
fn with_pulses(rows: f64, length_s: Option<f64>, scatter_s: f64) -> Advice {
    let frame = match length_s {
        Some(length_s) => format!("a frame of {}", in_words(length_s)),
        None => format!(
            "a frame of its own, of about {} (equal holds do not show it exactly)",
            in_words(scatter_s)
        ),
    };
    let finding = format!(
        "Each command waits for the next pulse of {frame}, and errors that follow the motion are taken for these waits. All times contain the mean of them"
    );
    of_wait(rows, &finding, length_s.unwrap_or(scatter_s))
}

/// A `finding` that goes on with the mean of a wait of up to `longest_s`.
fn of_wait(rows: f64, finding: &str, longest_s: f64) -> Advice {
    let mean_wait = in_words(0.5 * longest_s);
    Advice::new(
        Check::CommandEdges,
        format!("{finding}, {mean_wait}, and single answers are up to as much sooner or later."),
        rows,
        *ONE_ROW.start(),
        format!(
            "For a simulation that has such a frame, take {mean_wait} from the delay. Better, write each command at the pulse with which it \
             begins. If a logger with a clock of its own wrote the file, say --polled: else all times are half a row too early."
        ),
    )
}

/// By how much the answers to commands are later than the model, one by one, where that is more than noise.
struct Scatter {
    /// Those to changes that are not small, by time.
    answers: Vec<CommandAnswer>,
    /// Their variance beyond noise \[samples²\].
    variance: f64,
    kurtosis: f64,
}

impl Scatter {
    fn of(runs: &[Run<'_>], model: &Model) -> Option<Self> {
        let runs = runs.iter().enumerate();
        let mut answers: Vec<CommandAnswer> = runs
            .flat_map(|(index, run)| answers(index, run, model))
            .collect();
        let mut weights: Vec<f64> = answers.iter().map(|answer| answer.weight).collect();
        weights.sort_by(f64::total_cmp);
        let usual = *weights.get(weights.len() / 2)?;
        answers.retain(|answer| answer.weight > SMALL * usual);
        let means = halves(&answers).count();
        if answers.len() < means + FEWEST {
            return None;
        }
        let deviations = deviations(&answers);
        let moment = |power: i32| {
            let powers = deviations.iter().map(|late| late.powi(power));
            powers.sum::<f64>() / answers.len() as f64
        };
        let (variance, fourth) = (moment(2), moment(4));
        let of_noise = of_noise(&answers);
        let free = 1.0 - means as f64 / answers.len() as f64;
        (of_noise < MOST_NOISE * variance).then(|| Self {
            answers,
            variance: (variance - of_noise) / free,
            kurtosis: fourth / (variance * variance),
        })
    }

    /// The length of the interval over which they scatter, where they do so evenly \[samples\].
    fn rows(&self) -> f64 {
        // An interval of length 1 has the variance 1/12.
        (12.0 * self.variance).sqrt()
    }

    fn is_even(&self) -> bool {
        EVEN_KURTOSIS.contains(&self.kurtosis)
            && self.is_free_of_strokes()
            && self
                .share_among_equal_strokes()
                .is_none_or(|share| share > LEAST_AMONG_EQUAL)
    }

    /// The part of the squares of the times about their mean that is left about the means of equal strokes; `None` where most strokes are there once.
    fn share_among_equal_strokes(&self) -> Option<f64> {
        let late = self.answers.iter().zip(deviations(&self.answers));
        let mut of_stroke: BTreeMap<[u64; 2], Vec<f64>> = BTreeMap::new();
        for (answer, late) in late {
            let stroke = answer.levels.map(f64::to_bits);
            of_stroke.entry(stroke).or_default().push(late);
        }
        let repeated = || of_stroke.values().filter(|late| late.len() > 1);
        let count: usize = repeated().map(Vec::len).sum();
        let free: usize = repeated().map(|late| late.len() - 1).sum();
        let square = |late: &Vec<f64>, about: f64| -> f64 {
            late.iter().map(|late| (late - about).powi(2)).sum()
        };
        let all: f64 = repeated().map(|late| square(late, 0.0)).sum();
        let about_own_mean =
            |late: &Vec<f64>| square(late, late.iter().sum::<f64>() / late.len() as f64);
        let among: f64 = repeated().map(about_own_mean).sum();
        let are_most = 2 * count > self.answers.len();
        (are_most && all > 0.0).then(|| among / free as f64 / (all / count as f64))
    }

    fn is_free_of_strokes(&self) -> bool {
        let by_stroke: [fn(&CommandAnswer) -> f64; 2] =
            [CommandAnswer::stroke, |answer| answer.stroke().abs()];
        let mut by_stroke = by_stroke.into_iter();
        let beside_size = |answer: &CommandAnswer| answer.late_beside_size;
        by_stroke.all(|of| squared_correlation(&self.answers, of) < MOST_BY_STROKE)
            && squared_correlation(&self.answers, beside_size) > SAME_TIMES
    }

    /// Whether most strokes are others than those before. Where they repeat themselves under equal holds, a servo that is not linear answers each in its own time,
    /// and any clock may have such times.
    fn strokes_are_different(&self) -> bool {
        let strokes = self.answers.iter().map(|answer| answer.levels);
        let strokes: BTreeSet<[u64; 2]> = strokes.map(|levels| levels.map(f64::to_bits)).collect();
        2 * strokes.len() > self.answers.len()
    }

    /// That commands wait for regular pulses, where no error in motion is left to a model of the commands at their pulses.
    fn explained_by_pulses(
        &self,
        data: &Dataset,
        found: &Identification,
        options: &Options,
    ) -> Option<Advice> {
        if !self.is_free_of_strokes() {
            return None;
        }
        let scatter_s = self.rows() * data.record.sample_period_s();
        let runs = self.runs_in_frames(data.record.sample_period_s());
        let most = runs.iter().max_by_key(|run| run.answers.len())?;
        let in_frames: usize = runs.iter().map(|run| run.answers.len()).sum();
        let are_most = 2 * in_frames > self.answers.len();
        if most.frames.length_s.is_none() && !self.strokes_are_different() {
            return None;
        }
        let is_explained =
            || found.model.linear || is_linear_at_pulses(&data.record, &runs, options);
        (are_most && is_explained())
            .then(|| with_pulses(self.rows(), most.frames.length_s, scatter_s))
    }

    /// The runs that show regular pulses.
    fn runs_in_frames(&self, period_s: f64) -> Vec<RunInFrames> {
        let scatter_s = self.rows() * period_s;
        let of_run = |answers: &[CommandAnswer]| {
            let run = answers.first()?.at.0;
            let timed = answers.iter().map(|answer| TimedAnswer {
                at_s: answer.at.1 as f64 * period_s,
                late_s: answer.late * period_s,
            });
            let answers: Vec<TimedAnswer> = timed.collect();
            let frames = PulseFrames::of(&answers, scatter_s)?;
            Some(RunInFrames {
                run,
                answers,
                frames,
            })
        };
        of_runs(&self.answers).filter_map(of_run).collect()
    }
}

fn halves(answers: &[CommandAnswer]) -> impl Iterator<Item = &[CommandAnswer]> {
    of_runs(answers).flat_map(|run| run.chunks(run.len().div_ceil(2)))
}

fn of_runs(answers: &[CommandAnswer]) -> impl Iterator<Item = &[CommandAnswer]> {
    answers.chunk_by(|a, b| a.at.0 == b.at.0)
}

/// The times of the answers about their mean in each half of each run \[samples\]: where runs differ, or a servo changes, its answers to all commands
/// are later, and no moment of a command is.
fn deviations(answers: &[CommandAnswer]) -> Vec<f64> {
    let about_mean = |half: &[CommandAnswer]| {
        let middle = half.iter().map(|answer| answer.late).sum::<f64>() / half.len() as f64;
        let late = half.iter().map(|answer| answer.late - middle);
        late.collect::<Vec<f64>>()
    };
    halves(answers).flat_map(about_mean).collect()
}

/// Of the times of the answers with a property of their strokes.
fn squared_correlation(answers: &[CommandAnswer], of: fn(&CommandAnswer) -> f64) -> f64 {
    let count = answers.len() as f64;
    let mean = |of: &dyn Fn(&CommandAnswer) -> f64| answers.iter().map(of).sum::<f64>() / count;
    let (late, size) = (mean(&|answer| answer.late), mean(&|answer| of(answer)));
    let product = mean(&|answer| (answer.late - late) * (of(answer) - size));
    let squares = mean(&|answer| (answer.late - late).powi(2)) * mean(&|a| (of(a) - size).powi(2));
    match squares > 0.0 {
        true => product * product / squares,
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::{Identified, IdentifyRequest, compared, identified};
    use crate::data::dataset::{ArrayRun, Arrays, of_arrays};
    use servoid_identification::comparison::ComparisonOptions;
    use servoid_identification::results::Withheld;
    use servoid_identification::{Options, Record, identify};

    /// A lag of 30 ms under levels of 0.2 to 0.4 s, in rows of 10 ms; a command takes effect up to `wait` rows after its row, or before where
    /// that is negative. The servo is no faster than `top` a step of 0.1 ms.
    fn record(wait: f64, noise: f64, top: f64) -> Record<'static> {
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
                    angle += f64::clamp((command - angle) / 300.0, -top, top);
                }
            }
            before = level;
        }
        Record::of_run(0.01, input, output).unwrap()
    }

    fn scatter(wait: f64, noise: f64) -> Option<f64> {
        let record = record(wait, noise, f64::INFINITY);
        let model = identify(&record, &Options::default()).unwrap();
        let found = Scatter::of(record.runs(), &model)?;
        found.is_even().then(|| found.rows())
    }

    /// Pieces of 4 s, with some 13 commands each.
    #[test]
    fn a_dozen_commands_show_a_logger_with_a_clock_of_its_own() {
        let found = |wait: f64| {
            let record = record(wait, 0.02, f64::INFINITY);
            let run = &record.runs()[0];
            let pieces = run.input().chunks_exact(400);
            let pieces = pieces.zip(run.output().chunks_exact(400));
            let is_found = |(input, output): &(&[f64], &[f64])| {
                let piece = Record::of_run(0.01, input.to_vec(), output.to_vec()).unwrap();
                let model = identify(&piece, &Options::default()).unwrap();
                Scatter::of(piece.runs(), &model)
                    .is_some_and(|found| found.is_even() && ONE_ROW.contains(&found.rows()))
            };
            (pieces.len(), pieces.filter(is_found).count())
        };
        assert_eq!(found(0.0).1, 0);
        let (all, polled) = found(1.0);
        assert!(4 * polled >= 3 * all, "{polled} of {all}");
    }

    /// Runs of one order in which each stroke waits as long in every run, as where a servo that is not linear answers it so.
    #[test]
    fn answers_that_repeat_with_their_strokes_are_of_no_clock() {
        let one = record(1.0, 0.05, f64::INFINITY);
        for (runs, is_even) in [(1, true), (3, false)] {
            let runs = vec![one.runs()[0].clone(); runs];
            let record = Record::new(0.01, runs).unwrap();
            let model = identify(&record, &Options::default()).unwrap();
            let found = Scatter::of(record.runs(), &model).unwrap();
            assert_eq!(found.is_even(), is_even);
        }
    }

    #[test]
    fn a_limit_of_speed_is_no_wait() {
        // 100 a second: some 4 rows later where strokes are large, by the length of the stroke.
        for top in [0.01, 0.015, 0.02, 0.03] {
            let record = record(0.0, 0.05, top);
            let model = identify(&record, &Options::default()).unwrap();
            let found = Scatter::of(record.runs(), &model);
            assert!(
                found.is_none_or(|found| !found.is_even() || !ONE_ROW.contains(&found.rows())),
                "{top}"
            );
        }
    }

    /// Two lags of 20 ms behind a dead band of 0.9 to each side, under levels of 300 to 900 ms in rows of 10 ms: how far the servo goes depends on the direction of the
    /// stroke before.
    #[test]
    fn a_dead_band_is_no_wait() {
        for seed in 0..12 {
            let random = |k: u32| {
                let k = f64::from(k + 1000 * seed);
                (k * k * 0.7548776662).fract()
            };
            let (mut input, mut output) = (Vec::new(), Vec::new());
            let (mut angle, mut speed) = (0.0, 0.0);
            for stroke in 0..50 {
                let level = 5.0 * (7.0 * random(7 * stroke + 1)).floor() - 15.0;
                for row in 0..30 + (60.0 * random(3 * stroke + 2)) as u32 {
                    input.push(level);
                    output.push(angle + 0.1 * (random(91 * stroke + row) - 0.5));
                    for _ in 0..100 {
                        let error: f64 = level - angle;
                        let beyond = error - error.clamp(-0.9, 0.9);
                        speed += 1e-4 * (2500.0 * beyond - 100.0 * speed);
                        angle += 1e-4 * speed;
                    }
                }
            }
            let record = Record::of_run(0.01, input, output).unwrap();
            let model = identify(&record, &Options::default()).unwrap();
            let found = Scatter::of(record.runs(), &model);
            assert!(found.is_none_or(|found| !found.is_even()), "{seed}");
        }
    }

    /// Equal steps up and down behind a lag, while the sensor drifts: each answer is then off by as much as the drift was at its time.
    #[test]
    fn a_drift_is_no_wait() {
        let random = |k: u32| (f64::from(k) * f64::from(k) * 0.7548776662).fract();
        let (mut input, mut output) = (Vec::new(), Vec::new());
        let mut angle = 0.0;
        for row in 0..3600u32 {
            let level = [0.0, 4.0, 8.0, 4.0][row as usize / 36 % 4];
            input.push(level);
            output.push(angle + 0.05 * (random(91 * row) - 0.5) + 1e-3 * f64::from(row));
            angle += (level - angle) / 3.5;
        }
        let record = Record::of_run(0.01, input, output).unwrap();
        let model = identify(&record, &Options::default()).unwrap();
        let found = Scatter::of(record.runs(), &model);
        assert!(found.is_none(), "{:?}", found.map(|found| found.rows()));
    }

    /// Of a recording that a logger polled, where that is said or not.
    fn polled(stated: bool) -> Dataset<'static> {
        let record = record(1.0, 0.02, f64::INFINITY);
        let run = &record.runs()[0];
        let arrays = Arrays {
            period_s: 0.01,
            phase_s: if stated { 0.005 } else { 0.0 },
            runs: vec![ArrayRun {
                input: run.input().to_vec().into(),
                output: run.output().to_vec().into(),
                at_rest: None,
            }],
            ..Arrays::default()
        };
        let mut data = of_arrays(arrays).unwrap();
        (data.about.commands_at_rows, data.about.polled) = (!stated, stated);
        data.about.sensor_delay_uncertainty_s = if stated { 0.005 } else { 0.0 };
        data
    }

    /// A lag of 30 ms passes a half after 20.8 ms, its commands wait for 5 ms on average, and half a row is 5 ms.
    #[test]
    fn a_polled_recording_has_no_times_unless_that_is_said() {
        let model = |data: &Dataset| {
            identified(data, "polled", &Options::default())
                .unwrap()
                .model
        };
        let data = polled(false);
        let options = ComparisonOptions::default();
        let compared = compared([&data; 2], ["a", "b"], options).unwrap();
        assert_eq!(
            compared.bounds.withdrawn(),
            Some(Reason::CommandsBetweenRows)
        );
        let unsaid = model(&data);
        assert_eq!(unsaid.bounds.withdrawn(), Some(Reason::CommandsBetweenRows));
        assert_eq!(unsaid.advice[0].check, Check::CommandsBetweenRows);
        assert_eq!(unsaid.metrics.withheld, Some(Withheld::TimeFault));
        assert!(unsaid.metrics.dc_gain.value.is_some() && unsaid.metrics.t50_s.value.is_none());
        let said = model(&polled(true));
        assert!(said.linear && said.bounds.valid().is_some());
        assert!(said.metrics.t50_s.contains(0.0308), "{:?}", said.metrics);
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

    /// The same servo behind pulses every 23.7 ms, with which commands begin, under holds of `rows(stroke)`; no faster than `top` a step of 0.1 ms up, and `down` down.
    fn data_behind_pulses(rows: fn(u32) -> u32, [top, down]: [f64; 2]) -> Dataset<'static> {
        let random = |k: u32| (f64::from(k) * f64::from(k) * 0.7548776662).fract();
        let (mut input, mut output) = (Vec::new(), Vec::new());
        let (mut angle, mut in_force) = (0.0, 0.0);
        let mut part = 0u32;
        for stroke in 0..100 {
            let level = 10.0 * random(7 * stroke + 1) - 5.0;
            for row in 0..rows(stroke) {
                input.push(level);
                output.push(angle + 0.02 * (random(91 * stroke + row) - 0.5));
                for _ in 0..100 {
                    if part.is_multiple_of(237) {
                        in_force = level;
                    }
                    part += 1;
                    angle += f64::clamp((in_force - angle) / 300.0, -down, top);
                }
            }
        }
        let mut data = of_arrays(Arrays {
            period_s: 0.01,
            runs: vec![ArrayRun {
                input: input.into(),
                output: output.into(),
                at_rest: None,
            }],
            ..Arrays::default()
        })
        .unwrap();
        data.about.commands_at_rows = true;
        data
    }

    fn behind_pulses(rows: fn(u32) -> u32, limits: [f64; 2]) -> Model {
        let data = data_behind_pulses(rows, limits);
        let found = identified(&data, "pulses", &Options::default());
        found.unwrap().model
    }

    fn advised(model: &Model, words: &str) -> bool {
        let mut advice = model.advice.iter();
        advice.any(|item| item.finding.contains(words))
    }

    /// That the servo is linear with bounds, and its advice has these words.
    fn require_linear(model: &Model, words: &str) {
        assert!(
            model.linear && model.bounds.valid().is_some(),
            "{:?}",
            model.advice
        );
        assert!(advised(model, words), "{:?}", model.advice);
    }

    #[test]
    fn a_servo_behind_pulses_is_linear_and_its_frame_is_named() {
        let model = behind_pulses(|stroke| 20 + stroke % 21, [f64::INFINITY; 2]);
        require_linear(&model, "pulse of a frame of 23.7 ms");
    }

    #[test]
    fn under_equal_holds_it_is_linear_too_and_no_exact_frame_is_named() {
        let model = behind_pulses(|_| 20, [f64::INFINITY; 2]);
        require_linear(&model, "equal holds do not show it exactly");
    }

    /// The longest strokes are up to 330 a second, of which 100 or 150 are left: both ways, or up alone.
    #[test]
    fn a_limit_of_speed_behind_pulses_is_found() {
        for limits in [[0.01, 0.01], [0.015, 0.015], [0.015, f64::INFINITY]] {
            for rows in [|_| 20, |stroke| 20 + stroke % 21] {
                let model = behind_pulses(rows, limits);
                assert!(!model.linear, "{limits:?}: {:?}", model.advice);
                assert!(!advised(&model, "next pulse"), "{:?}", model.advice);
            }
        }
    }

    /// Exact commands of two lags of 20 and 30 ms, one after the other or in runs of their own: answers to the slower one are later.
    #[test]
    fn a_servo_that_changes_waits_for_nothing() {
        let random = |k: u32| (f64::from(k) * f64::from(k) * 0.7548776662).fract();
        let of_lag = |rows: f64, seed: u32| {
            let mut angle = 0.0;
            let levels = (0..60).flat_map(|stroke| {
                let level = 10.0 * random(7 * stroke + seed) - 5.0;
                std::iter::repeat_n(level, 20 + stroke as usize % 21)
            });
            let rows = levels.zip(0u32..).map(|(level, row)| {
                let seen = angle + 0.04 * (random(91 * row + seed) - 0.5);
                angle = level + (angle - level) * f64::exp(-1.0 / rows);
                (level, seen)
            });
            rows.unzip::<f64, f64, Vec<f64>, Vec<f64>>()
        };
        let [(u, y), (v, z)] = [of_lag(2.0, 1), of_lag(3.0, 2)];
        let run = |(u, y): (&[f64], &[f64])| Run::new(u.to_vec(), y.to_vec()).unwrap();
        let apart = vec![run((&u, &y)), run((&v, &z))];
        let behind = vec![run((&[u, v].concat(), &[y, z].concat()))];
        for runs in [apart, behind] {
            let record = Record::new(0.01, runs).unwrap();
            let model = identify(&record, &Options::default()).unwrap();
            let found = Scatter::of(record.runs(), &model);
            assert!(found.is_none_or(|found| !found.is_even()));
        }
    }

    /// The response under pulses has their mean wait, and no delay with poles is like it.
    #[test]
    fn a_low_order_model_of_commands_that_wait_has_no_intervals() {
        let data = data_behind_pulses(|stroke| 20 + stroke % 21, [f64::INFINITY; 2]);
        let request = IdentifyRequest {
            flight_model: true,
            ..IdentifyRequest::default()
        };
        let found = Identified::of(&data, "pulses", &request, || ()).unwrap();
        assert!(found.model.bounds.valid().is_some());
        let low_order = found.flight_model.unwrap().unwrap();
        assert_eq!(low_order.bounds.withdrawn(), Some(Reason::CommandsWait));
        assert!(low_order.is_consistent() && low_order.delay_s.lower.is_none());
    }

    /// Five strokes in one order, under equal holds behind pulses: each has its own times, as those of a servo that is not linear.
    #[test]
    fn strokes_that_repeat_themselves_are_distinguished_from_others() {
        let different = |model_of: fn(u32) -> f64| {
            let (mut input, mut output) = (Vec::new(), Vec::new());
            let (mut angle, mut in_force, mut part) = (0.0, 0.0, 0u32);
            for hold in 0..100 {
                for _ in 0..20 {
                    input.push(model_of(hold));
                    output.push(angle);
                    for _ in 0..100 {
                        if part.is_multiple_of(237) {
                            in_force = model_of(hold);
                        }
                        part += 1;
                        angle += (in_force - angle) / 300.0;
                    }
                }
            }
            let record = Record::of_run(0.01, input, output).unwrap();
            let model = identify(&record, &Options::default()).unwrap();
            Scatter::of(record.runs(), &model).map(|found| found.strokes_are_different())
        };
        let five = |hold: u32| [0.0, 4.0, -2.0, 1.0, -5.0][hold as usize % 5];
        assert_ne!(different(five), Some(true));
        let any = |hold: u32| (f64::from(hold) * f64::from(hold) * 0.7548776662).fract();
        assert_eq!(different(any), Some(true));
    }
}
