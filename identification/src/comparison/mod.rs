//! Is the second servo different from the first, and by how much?
//!
//! **The verdict is against a margin**, not against zero. With d_m the difference of the response
//! curves, s_m its standard deviation and q the critical value of all points at once,
//!
//! ```text
//! L = max_m (|d_m| - q s_m) / G0      U = max_m (|d_m| + q s_m) / G0
//! different if L > margin;  same if U <= margin;  undecided otherwise
//! ```
//!
//! so that "different by at least L" and "by at most U" hold with the probability of the level. One
//! servo recorded twice is never exactly the same: supply, friction and the phase of the clocks
//! scatter from run to run, and a test against zero would call almost every pair different.
//!
//! **A p-value** therefore needs three runs a side or more; it counts scatter between runs. When it
//! does not confirm a difference beyond the margin, the verdict is undecided.
//!
//! When a side answers up and down strokes differently ([`crate::nonlinear::direction`]), both curves enter.
//! Differences of single figures are intervals from the intervals of both sides (G. Y. Zou and
//! A. Donner, Statistics in Medicine 2008): with d = b - a,
//!
//! ```text
//! from d - sqrt((b - b_low)² + (a_up - a)²)   to d + sqrt((b_up - b)² + (a - a_low)²)
//! ```

mod difference;
mod motion;
mod outcome;
mod over_prediction;
mod pair;
mod scatter;
mod shift;
mod words;

use crate::data::record::Record;
use crate::data::timing::Timing;
use crate::diagnostics::advice::{self, Advice};
use crate::error::Error;
use crate::nonlinear::limits::Limits;
use crate::nonlinear::limits::levels::LEVELS;
use crate::options::Options;
use crate::results::metrics::{Interval, Metrics};
use crate::results::model::{Model, SCHEMA};
use crate::thresholds::{MARGIN, RUNS_DIFFER_SIGNIFICANCE};
use difference::{Curves, Differences};
use pair::{Identified, identified, same_period};
use scatter::RunToRun;

pub use motion::Motion;
pub use outcome::{
    Asymmetry, Comparison, DifferenceCurve, DifferencePercent, Levels, MetricDifference, Sides,
    Stroke, Verdict,
};
pub use over_prediction::OverPrediction;

/// What is asked of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparisonOptions {
    /// Largest difference that still counts as the same \[% of the step\].
    pub margin_percent: f64,
    /// How the sides are identified; its level is that of every bound.
    pub identification: Options,
    /// Samples after an edge from which a plateau counts; `None` is the settling time of the first
    /// side.
    pub wait_samples: Option<usize>,
    /// Standard deviation of the sensor's zero between the two sides \[output\].
    pub zero_sd: f64,
    /// The unit of the input, for sentences; empty when it is not known.
    pub input_unit: String,
    /// The unit of the output, likewise.
    pub output_unit: String,
}

impl Default for ComparisonOptions {
    fn default() -> Self {
        Self {
            margin_percent: 5.0,
            identification: Options::default(),
            wait_samples: None,
            zero_sd: 0.0,
            input_unit: String::new(),
            output_unit: String::new(),
        }
    }
}

/// Compares two sides, each a record of one or more runs.
///
/// ```
/// use servoid_identification::comparison::{compare, ComparisonOptions, Verdict};
/// use servoid_identification::Record;
/// let u: Vec<f64> = (0..3000).map(|k| if k * k / 9000 % 2 == 0 { 5.0 } else { -5.0 }).collect();
/// let servo = |speed: f64, shift: usize| {
///     let noise = |k: usize| 0.01 * (((k + shift) * 7919 % 101) as f64 - 50.0) / 50.0;
///     let y: Vec<f64> = u.iter().enumerate().scan(5.0, |y, (k, u)| {
///         *y += speed * (u - *y); Some(*y + noise(k))
///     }).collect();
///     Record::from_slices(0.002, &u, &y)
/// };
/// let (bench, again, loaded) = (servo(0.2, 0)?, servo(0.2, 17)?, servo(0.1, 5)?);
/// let options = ComparisonOptions::default();
/// assert_eq!(compare(&bench, &again, &options)?.verdict, Verdict::Same);
/// let found = compare(&bench, &loaded, &options)?;
/// assert_eq!(found.verdict, Verdict::Different);
/// assert!(found.difference_percent.at_least > 20.0);
/// # Ok::<(), servoid_identification::Error>(())
/// ```
///
/// # Errors
/// A side cannot be identified, or the two differ in sample period.
pub fn compare(a: &Record, b: &Record, options: &ComparisonOptions) -> Result<Comparison, Error> {
    let (a, b) = identified(a, b, &options.identification)?;
    let level = options.identification.level;
    let both = a.split.as_ref().zip(b.split.as_ref());
    let split = both.filter(|_| a.asymmetric() || b.asymmetric());
    let points = a.model.structure.settling_samples;
    let curves = match split {
        Some((a, b)) => [Curves::of_split(a), Curves::of_split(b)],
        None => [
            Curves::of_model(&a.model, points)?,
            Curves::of_model(&b.model, points)?,
        ],
    };
    let run_to_run = match scatter::run_to_run(a.record, b.record, a.model.basis()?, level) {
        // A single run may be too short for a model of its own; then there is no test.
        Err(Error::TooFewSamples { .. } | Error::OneDirection) => None,
        other => other?,
    };
    let over_prediction = over_prediction::over_prediction(
        b.record,
        &over_prediction::FsfBasis {
            model: &a.model,
            sd_at_rest: a.sd_at_rest(),
            zero_sd: options.zero_sd,
            wait: options
                .wait_samples
                .unwrap_or((points as f64 / MARGIN).ceil() as usize),
            level,
        },
    );
    let runs = [a.record.runs().len(), b.record.runs().len()];
    let mut comparison = of_curves(&a.model, &b.model, &curves, run_to_run, runs, options);
    comparison.split = split.is_some();
    comparison.over_prediction = over_prediction;
    comparison.levels = Some(Sides {
        a: a.levels(),
        b: b.levels(),
    });
    comparison.asymmetry = Some(Sides {
        a: a.asymmetry(),
        b: b.asymmetry(),
    });
    if !(a.alone.bounds_hold() && b.alone.bounds_hold()) {
        comparison.without_bounds();
    }
    let motions = Sides {
        a: Motion::of(a.record),
        b: Motion::of(b.record),
    };
    comparison.motions = Some(motions);
    let differ = !motions.a.is_like(&motions.b);
    let linear = is_linear(&a.alone) && is_linear(&b.alone);
    if differ && !linear {
        // Each side has another description for the motion of the other.
        comparison.verdict = Verdict::Undecided;
        comparison.descriptions_of_different_motions = true;
    }
    comparison.summary = words::summary(&comparison, options);
    comparison.advice = advice(&comparison, [&a.alone, &b.alone], &[&a, &b]);
    if differ {
        let finding = different_references(&motions, linear, &options.input_unit);
        comparison.advice.insert(0, finding);
    }
    Ok(comparison)
}

/// Whether nothing was found that makes a response one of its motion alone.
fn is_linear(model: &Model) -> bool {
    model
        .advice
        .iter()
        .all(|found| found.check != advice::NOT_LINEAR && found.check != advice::MODEL_ERROR)
}

/// That the sides were not asked to do the same.
fn different_references(motions: &Sides<Motion>, linear: bool, unit: &str) -> Advice {
    let (a, b) = (motions.a.in_words(unit), motions.b.in_words(unit));
    let meaning = if linear {
        "Neither shows a servo that is not linear under its own reference, and a linear servo answers both \
         alike; one that is limited in speed or torque, or has play, does not, and would differ from itself."
    } else {
        "At least one of these is not shown to be linear, and a servo that is not answers each motion in a way \
         of its own: the two descriptions are then of different motions, and their difference is no finding \
         about the servos."
    };
    let range = |motion: &Motion| motion.highest - motion.lowest;
    Advice::new(
        "references",
        format!("The references differ: the first is {a}; the second is {b}. {meaning}"),
        range(&motions.b),
        range(&motions.a),
        "Record both sides with the same reference.",
    )
}

/// Compares two models without their records: plain step responses and figures.
///
/// # Errors
/// The two differ in sample period, or a hand-made document does not describe a filter bank.
pub fn compare_models(
    a: &Model,
    b: &Model,
    options: &ComparisonOptions,
) -> Result<Comparison, Error> {
    options.identification.check()?;
    same_period(a.sample_period_s, b.sample_period_s)?;
    let points = a
        .structure
        .settling_samples
        .max(b.structure.settling_samples);
    let curves = [Curves::of_model(a, points)?, Curves::of_model(b, points)?];
    let mut comparison = of_curves(a, b, &curves, None, [1, 1], options);
    if !(a.bounds_hold() && b.bounds_hold()) {
        comparison.without_bounds();
    }
    comparison.summary = words::summary(&comparison, options);
    comparison.advice = advice(&comparison, [a, b], &[]);
    comparison.advice.push(one_response());
    Ok(comparison)
}

fn of_curves(
    a: &Model,
    b: &Model,
    curves: &[Curves; 2],
    run_to_run: Option<RunToRun>,
    runs: [usize; 2],
    options: &ComparisonOptions,
) -> Comparison {
    let p_value = run_to_run.map(|found| found.p);
    let level = options.identification.level;
    let differences = Differences::of(&curves[0], &curves[1], level);
    let found = differences.largest();
    let margin = options.margin_percent / 100.0;
    let by_margin = if found.at_least > margin {
        Verdict::Different
    } else if found.at_most <= margin {
        Verdict::Same
    } else {
        Verdict::Undecided
    };
    let verdict = match by_margin {
        Verdict::Different if explained_by_chance(p_value) => Verdict::Undecided,
        Verdict::Same if run_to_run.is_some_and(|found| found.at_most > margin) => {
            Verdict::Undecided
        }
        other => other,
    };
    let timing = a.timing();
    let later = Later {
        curves,
        level,
        period_s: timing.sample_period_s,
        phases_s: b.sample_phase_s - a.sample_phase_s,
    };
    let curves_of_difference = difference_curves(&differences, timing, &later);
    let difference_percent = DifferencePercent {
        at_least: 100.0 * found.at_least.max(0.0),
        at_most: 100.0 * found.at_most,
        at_s: timing.seconds(found.sample as f64),
        stroke: curves_of_difference[found.curve].stroke,
    };
    let (shift, _) = later.by(0..differences.curves());
    Comparison {
        schema: SCHEMA,
        verdict,
        bounds_hold: true,
        margin_percent: options.margin_percent,
        difference_percent,
        level,
        runs,
        p_value,
        run_to_run_at_most_percent: run_to_run.map(|found| 100.0 * found.at_most),
        delay_shift_s: shift.value,
        delay_shift_bounds_s: shift.lower.zip(shift.upper).map(<[f64; 2]>::from),
        delay_shift_definition: shift::DEFINITION.to_owned(),
        split: false,
        motions: None,
        descriptions_of_different_motions: false,
        over_prediction: None,
        levels: None,
        asymmetry: None,
        differences: metric_differences(&a.metrics, &b.metrics),
        curves: curves_of_difference,
        summary: String::new(),
        advice: Vec::new(),
    }
}

/// Whether runs of one servo differ as much among themselves.
fn explained_by_chance(p_value: Option<f64>) -> bool {
    p_value.is_some_and(|p| p > RUNS_DIFFER_SIGNIFICANCE)
}

/// How much later the second side moves.
struct Later<'a> {
    curves: &'a [Curves; 2],
    level: f64,
    period_s: f64,
    /// How much later after an edge the second side is sampled \[s\].
    phases_s: f64,
}

impl Later<'_> {
    /// By how much on the curves with these numbers \[s\], and what such a delay leaves unexplained
    /// \[% of the final value\].
    fn by(&self, curves: std::ops::Range<usize>) -> (Interval, Option<f64>) {
        let [a, b] = self.curves;
        let found = shift::shift(a, b, curves, self.level);
        let seconds = |samples: f64| samples * self.period_s + self.phases_s;
        let percent = found.remains.map(|remains| 100.0 * remains);
        (found.samples.map(seconds), percent)
    }
}

fn difference_curves(
    differences: &Differences,
    timing: Timing,
    later: &Later<'_>,
) -> Vec<DifferenceCurve> {
    let strokes: &[Stroke] = match differences.curves() {
        1 => &[Stroke::Both],
        _ => &[Stroke::Up, Stroke::Down],
    };
    let curve = |(index, &stroke): (usize, &Stroke)| {
        let (value, half) = differences.curve(index);
        let percent = |sign: f64| {
            let bound = |(d, h): (&f64, &f64)| 100.0 * (d + sign * h);
            value.iter().zip(half).map(bound).collect()
        };
        let (delay_shift_s, shift_leaves_percent) = later.by(index..index + 1);
        DifferenceCurve {
            stroke,
            time_s: (0..value.len()).map(|m| timing.seconds(m as f64)).collect(),
            percent: percent(0.0),
            lower: percent(-1.0),
            upper: percent(1.0),
            delay_shift_s,
            shift_leaves_percent,
        }
    };
    strokes.iter().enumerate().map(curve).collect()
}

/// How to read a figure.
type Figure = fn(&Metrics) -> Interval;

fn metric_differences(a: &Metrics, b: &Metrics) -> Vec<MetricDifference> {
    let figures: [(&str, Figure); 8] = [
        ("dc_gain", |m| m.dc_gain),
        ("delay_s", |m| m.delay_s),
        ("t50_s", |m| m.t50_s),
        ("rise_time_s", |m| m.rise_time_s),
        ("overshoot_percent", |m| m.overshoot_percent),
        ("settling_time_s", |m| m.settling_time_s),
        ("bandwidth_rad_s", |m| m.bandwidth_rad_s),
        ("phase_minus_90_rad_s", |m| m.phase_minus_90_rad_s),
    ];
    let bounds = |of: &Interval| of.lower.zip(of.upper).map(<[f64; 2]>::from);
    figures
        .iter()
        .map(|(name, of)| {
            let (a, b) = (of(a), of(b));
            let difference = b.value.zip(a.value).map(|(b, a)| b - a);
            let away =
                |from: Option<f64>, to: Option<f64>| from.zip(to).map(|(from, to)| to - from);
            let bound = |b_part: Option<f64>, a_part: Option<f64>| {
                b_part.zip(a_part).map(|(x, y)| x.hypot(y))
            };
            let below = bound(away(b.lower, b.value), away(a.value, a.upper));
            let above = bound(away(b.value, b.upper), away(a.lower, a.value));
            MetricDifference {
                metric: (*name).to_owned(),
                a: a.value,
                a_bounds: bounds(&a),
                b: b.value,
                b_bounds: bounds(&b),
                difference,
                lower: difference.zip(below).map(|(d, below)| d - below),
                upper: difference.zip(above).map(|(d, above)| d + above),
            }
        })
        .collect()
}

/// Findings on a model that bear on what it is compared for.
const BEAR_ON_COMPARISON: [&str; 5] = [
    advice::MODEL_ERROR,
    advice::NOT_LINEAR,
    "excitation",
    "repeats",
    "settled",
];

/// What two models cannot show, whatever servo they are of.
fn one_response() -> Advice {
    Advice::new(
        "one_response",
        "A model holds one response for up and down strokes alike, and a settling time of its own: where \
         a servo answers the two differently, as a loaded one does, each stroke may differ by more than \
         is said here, and the figures of models and of recordings are not the same."
            .to_owned(),
        1.0,
        2.0,
        "Compare the recordings: that takes up and down strokes apart, with one structure for both sides.",
    )
}

/// What the recordings cannot answer.
fn advice(comparison: &Comparison, models: [&Model; 2], sides: &[&Identified<'_>]) -> Vec<Advice> {
    let mut advice = Vec::new();
    for (which, model) in ["The first", "The second"].into_iter().zip(models) {
        let bearing = |found: &&Advice| BEAR_ON_COMPARISON.contains(&found.check.as_str());
        advice.extend(model.advice.iter().filter(bearing).map(|found| Advice {
            finding: format!("{which}: {}", found.finding),
            ..found.clone()
        }));
    }
    let fewest = comparison.runs[0].min(comparison.runs[1]);
    if comparison.p_value.is_none() {
        advice.push(Advice::new(
            "runs",
            format!("{fewest} run a side: differences from run to run are not included."),
            fewest as f64,
            3.0,
            "Record three or more runs a side, five for the sharper test.",
        ));
    }
    let rested = |side: &&Identified<'_>| {
        let cells = Limits::level_table(side.record, &side.model);
        let mut levels: Vec<f64> = cells.iter().map(|cell| cell.command).collect();
        levels.dedup();
        levels.len()
    };
    let fewest = sides.iter().map(rested).min().unwrap_or(0);
    if fewest < LEVELS {
        advice.push(Advice::new(
            "levels",
            format!(
                "Where between its levels a servo loses travel, and whether it meets a stop, cannot be known \
                 from {fewest} levels at which it rests."
            ),
            fewest as f64,
            LEVELS as f64,
            "Record stairs up and down with at least four levels, both ends included, each reached \
             from both sides three times and held for twice the settling time.",
        ));
    }
    advice
}
