//! How the answers to commands scatter in time, where that is more than noise.
//!
//! Each change of the command is answered [later or sooner](super::command_answers) than the model says. Where the moments at which commands take effect have nothing to do with the
//! rows, these times fill an interval of a certain length evenly. Noise, and a servo that is not linear, scatter them in another way: their kurtosis is that
//! of a bell, 3, or more, and that of an even scatter is 1.8. A servo that is limited in its speed is later by more the longer the stroke: an
//! even choice of strokes scatters its answers evenly, too, so times that follow the stroke do not count. Behind a dead band, strokes are shorter or longer, by which side of it
//! they begin and end at: so times only count that are the same beside the size of each stroke.

use super::command_answers::{CommandAnswer, answers, of_noise};
use servoid_identification::Run;
use servoid_identification::results::Model;
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
pub(super) const ONE_ROW: std::ops::RangeInclusive<f64> = 0.6..=1.3;

/// Share of the scatter that may follow the size or the direction of the strokes: of ten answers to a clock, a third by chance.
const MOST_BY_STROKE: f64 = 0.5;

/// Share of the scatter that equal strokes have among themselves, below which it is of the strokes: moments of a clock of its own are others each time.
const LEAST_AMONG_EQUAL: f64 = 0.5;

/// Squared correlation of the times with those beside the size of the stroke, below which they are of its size: of commands between rows it is 0.94 or more in little noise, behind a
/// dead band and with friction mostly less than 0.5.
const SAME_TIMES: f64 = 0.8;

/// By how much the answers to commands are later than the model, one by one, where that is more than noise.
pub(super) struct Scatter {
    /// Those to changes that are not small, by time.
    pub(super) answers: Vec<CommandAnswer>,
    /// Their variance beyond noise \[samples²\].
    variance: f64,
    kurtosis: f64,
}

impl Scatter {
    pub(super) fn of(runs: &[Run<'_>], model: &Model) -> Option<Self> {
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
    pub(super) fn rows(&self) -> f64 {
        // An interval of length 1 has the variance 1/12.
        (12.0 * self.variance).sqrt()
    }

    pub(super) fn is_even(&self) -> bool {
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

    pub(super) fn is_free_of_strokes(&self) -> bool {
        let by_stroke: [fn(&CommandAnswer) -> f64; 2] =
            [CommandAnswer::stroke, |answer| answer.stroke().abs()];
        let mut by_stroke = by_stroke.into_iter();
        let beside_size = |answer: &CommandAnswer| answer.late_beside_size;
        by_stroke.all(|of| squared_correlation(&self.answers, of) < MOST_BY_STROKE)
            && squared_correlation(&self.answers, beside_size) > SAME_TIMES
    }

    /// Whether most strokes are others than those before. Where they repeat themselves under equal holds, a servo that is not linear answers each in its own time,
    /// and any clock may have such times.
    pub(super) fn strokes_are_different(&self) -> bool {
        let strokes = self.answers.iter().map(|answer| answer.levels);
        let strokes: BTreeSet<[u64; 2]> = strokes.map(|levels| levels.map(f64::to_bits)).collect();
        2 * strokes.len() > self.answers.len()
    }
}

fn halves(answers: &[CommandAnswer]) -> impl Iterator<Item = &[CommandAnswer]> {
    of_runs(answers).flat_map(|run| run.chunks(run.len().div_ceil(2)))
}

/// Those of each run.
pub(super) fn of_runs(answers: &[CommandAnswer]) -> impl Iterator<Item = &[CommandAnswer]> {
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
pub(super) mod tests {
    use super::*;
    use servoid_identification::{Options, Record, identify};

    /// A lag of 30 ms under levels of 0.2 to 0.4 s, in rows of 10 ms; a command takes effect up to `wait` rows after its row, or before where
    /// that is negative. The servo is no faster than `top` a step of 0.1 ms.
    pub(in super::super) fn record(wait: f64, noise: f64, top: f64) -> Record<'static> {
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

    #[test]
    fn commands_that_wait_for_a_row_or_a_frame_are_seen_and_noise_is_not() {
        let row = scatter(1.0, 0.05).unwrap();
        assert!(ONE_ROW.contains(&row), "{row}");
        let frame = scatter(3.0, 0.05).unwrap();
        assert!((frame - 3.0).abs() < 0.6, "{frame}");
        assert_eq!(scatter(0.0, 0.05), None);
        assert_eq!(scatter(0.0, 1.0), None);
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
