//! How often the bands of automatically structured models hold the exact response.

use std::collections::BTreeMap;

use rayon::prelude::*;
use servoid_identification::thresholds::RESIDUAL_SIGNIFICANCE;
use servoid_identification::{Options, Record, identify_explained};

use crate::oracle;
use crate::plants::{Noise, PERIOD, Plant, low_passed, prbs, random, simulate, square, staircase};
use crate::trial::Trial;

/// The reference that drives the servo.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    Staircase,
    Prbs,
    /// The staircase behind four lags of 20 Hz: without high frequencies.
    LowPassed,
    /// Equal holds of 400 ms, from the first sample to the last: it repeats itself.
    Square,
}

/// One line of the table.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    pub reference: Reference,
    pub plant: Plant,
    pub noise: Noise,
    /// Factor on the noise.
    pub scale: f64,
}

/// The result of the runs of one case.
pub struct Line {
    /// Reference, servo, noise and factor on the noise, as the first columns of the table.
    pub label: String,
    pub runs: usize,
    /// Share of runs that have bounds. The others are about these alone.
    pub claimed: f64,
    /// Mean and smallest share of runs, over the points, in which a point is inside its pointwise
    /// bounds. Points that fewer than half of the runs reach are left out.
    pub mean: f64,
    pub worst: f64,
    /// Share of runs in which the whole response is inside the simultaneous band.
    pub whole: f64,
    /// Smallest, median and largest N.
    pub settling: (usize, usize, usize),
    /// Most frequent noise order.
    pub order: usize,
    /// Mean half widths.
    pub half_widths: (f64, f64),
    /// Those of one who knows N and the noise, where they were asked for.
    pub oracle: Option<(f64, f64)>,
    /// Share of runs that carried advice.
    pub advised: f64,
    /// Share of runs with each piece of advice, by its check.
    pub checks: BTreeMap<String, f64>,
    /// Shares of runs in which whiteness, independence of the input, and linearity had p < 1 %.
    pub rejected: [f64; 3],
    /// Share of runs in which errors were found not to be noise, so that bounds have no level.
    pub withdrawn: f64,
    /// Share of runs with any finding of the tests of the errors: false alarms, because all servos are linear and
    /// all noise is of an order that the choice considers.
    pub alarmed: f64,
    /// Most frequent n.
    pub frequencies: usize,
}

/// Which exact values lie within the bounds of one run.
struct Held {
    inside: Vec<bool>,
    whole: bool,
    half_widths: (f64, f64),
}

struct Outcome {
    /// `None` where bounds are withdrawn.
    held: Option<Held>,
    settling: usize,
    frequencies: usize,
    order: usize,
    checks: Vec<String>,
    rejected: [bool; 3],
    withdrawn: bool,
    alarmed: bool,
}

/// The seed of a run: cases and runs never share one.
fn seed(case: &Case, run: usize) -> u64 {
    let (reference, plant, noise) = (case.reference as u64, case.plant as u64, case.noise as u64);
    let case = (case.scale as u64) << 12 | reference << 8 | plant << 4 | noise;
    (case << 32) | run as u64
}

/// Identifies `runs` seeded simulations of a case.
pub fn measure(case: Case, runs: usize, options: &Options) -> Line {
    measure_trials(case.label(), runs, options, |run| case.trial(run))
}

/// Identifies the first `runs` trials.
pub fn measure_trials(
    label: String,
    runs: usize,
    options: &Options,
    trial: impl Fn(usize) -> Trial + Sync,
) -> Line {
    let outcomes: Vec<Outcome> = (0..runs)
        .into_par_iter()
        .map(|run| outcome(&trial(run), options))
        .collect();
    let count = outcomes.len() as f64;
    let held: Vec<&Held> = outcomes.iter().filter_map(|o| o.held.as_ref()).collect();
    let longest = held.iter().map(|held| held.inside.len()).max().unwrap_or(0);
    let points: Vec<f64> = (0..longest)
        .filter_map(|m| {
            let reached: Vec<bool> = held
                .iter()
                .filter_map(|held| held.inside.get(m).copied())
                .collect();
            (2 * reached.len() >= held.len()).then(|| {
                reached.iter().filter(|inside| **inside).count() as f64 / reached.len() as f64
            })
        })
        .collect();
    let share =
        |what: fn(&Outcome) -> bool| outcomes.iter().filter(|o| what(o)).count() as f64 / count;
    let mean = |what: fn(&Held) -> f64| {
        held.iter().map(|held| what(held)).sum::<f64>() / held.len() as f64
    };
    let mut settling: Vec<usize> = outcomes.iter().map(|o| o.settling).collect();
    settling.sort_unstable();
    Line {
        label,
        runs,
        claimed: held.len() as f64 / count,
        mean: points.iter().sum::<f64>() / points.len() as f64,
        worst: points.iter().copied().fold(1.0, f64::min),
        whole: mean(|held| f64::from(u8::from(held.whole))),
        settling: (
            settling[0],
            settling[settling.len() / 2],
            settling[settling.len() - 1],
        ),
        order: mode(outcomes.iter().map(|o| o.order)),
        frequencies: mode(outcomes.iter().map(|o| o.frequencies)),
        half_widths: (
            mean(|held| held.half_widths.0),
            mean(|held| held.half_widths.1),
        ),
        oracle: None,
        advised: share(|o| !o.checks.is_empty()),
        checks: shares(outcomes.iter().flat_map(|o| &o.checks), runs),
        rejected: [
            share(|o| o.rejected[0]),
            share(|o| o.rejected[1]),
            share(|o| o.rejected[2]),
        ],
        withdrawn: share(|o| o.withdrawn),
        alarmed: share(|o| o.alarmed),
    }
}

impl Case {
    /// The first columns of its line.
    pub fn label(&self) -> String {
        let Self {
            reference,
            plant,
            noise,
            scale,
        } = self;
        format!("| {reference:?} | {plant:?} | {noise:?} | {scale} |")
    }

    /// The half widths of one who knows N and the noise.
    pub fn oracle(&self) -> Option<(f64, f64)> {
        oracle::half_widths(&self.trial(0), self.noise, self.scale)
    }

    fn trial(&self, run: usize) -> Trial {
        let mut random = random(seed(self, run));
        let input = match self.reference {
            Reference::Staircase => staircase(),
            Reference::Prbs => prbs(&mut random),
            Reference::LowPassed => low_passed(&low_passed(&staircase(), 20.0), 20.0),
            Reference::Square => square(),
        };
        let output = simulate(self.plant, self.noise, &input, self.scale, &mut random);
        Trial {
            record: Record::of_run(PERIOD, input, output).expect("a simulated record is sound"),
            truth: self.plant.step(LONGEST_TRUTH),
        }
    }
}

/// Points of an exact step response, more than any N.
pub(crate) const LONGEST_TRUTH: usize = 2000;

fn outcome(trial: &Trial, options: &Options) -> Outcome {
    let found = identify_explained(&trial.record, options).expect("a simulated record is enough");
    let step = &found.model.step;
    let last = step.value.len() - 1;
    let mut truth = trial.truth[..last].to_vec();
    truth.push(1.0); // The last point is the final value.
    let within = |lower: &[f64], upper: &[f64]| -> Vec<bool> {
        (0..=last)
            .map(|m| (lower[m]..=upper[m]).contains(&truth[m]))
            .collect()
    };
    // The final value is judged with the whole curve; its place differs between runs.
    let held = step.bounds.valid().map(|bounds| {
        let (each, whole) = (&bounds.pointwise, &bounds.simultaneous);
        Held {
            inside: within(&each.lower, &each.upper),
            whole: within(&whole.lower, &whole.upper)
                .iter()
                .all(|inside| *inside),
            half_widths: bounds.mean_half_widths(),
        }
    });
    let tests = &found.model.residuals;
    let rejected = [
        tests.whiteness_p,
        tests.input_correlation_p,
        tests.linearity_p,
    ]
    .map(|p| p.is_some_and(|p| p < RESIDUAL_SIGNIFICANCE));
    let withdrawn = found.explanation.model_errors.is_some();
    let follows = found.explanation.linearity;
    let follows = follows.is_some_and(|linearity| linearity.errors_follow_motion());
    Outcome {
        withdrawn,
        alarmed: withdrawn || follows || rejected[0] || rejected[1],
        rejected,
        held,
        settling: found.model.structure.settling_samples,
        frequencies: found.model.structure.frequencies,
        order: found.model.structure.noise_order,
        checks: found
            .model
            .advice
            .iter()
            .map(|a| a.check.to_string())
            .collect(),
    }
}

fn shares<'a>(values: impl Iterator<Item = &'a String>, runs: usize) -> BTreeMap<String, f64> {
    let mut shares = BTreeMap::new();
    for value in values {
        *shares.entry(value.clone()).or_insert(0.0) += 1.0 / runs as f64;
    }
    shares
}

fn mode(values: impl Iterator<Item = usize>) -> usize {
    let mut counts = BTreeMap::new();
    for value in values {
        *counts.entry(value).or_insert(0usize) += 1;
    }
    counts
        .into_iter()
        .max_by_key(|(_, count)| *count)
        .map_or(0, |(value, _)| value)
}

impl Line {
    /// The heading of the table.
    pub const HEADING: &str = "| reference | plant | noise | x | runs | claimed % | mean % | worst % | whole % | N median (min-max) | n | d | half width point / whole | oracle point / whole | whiteness / independence / linearity rejected % | withdrawn / any alarm % | advised % |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|";

    /// Share of runs with the advice of `check`.
    pub fn share_of(&self, check: &str) -> f64 {
        self.checks.get(check).copied().unwrap_or(0.0)
    }
}

impl std::fmt::Display for Line {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (low, median, high) = self.settling;
        let percent = |share: f64| 100.0 * share;
        let oracle = self.oracle.map_or_else(
            || "-".to_owned(),
            |(point, whole)| format!("{point:.4} / {whole:.4}"),
        );
        write!(
            f,
            "{} {} | {:.1} | {:.2} | {:.1} | {:.1} | {median} ({low}-{high}) | {} | {} | {:.4} / {:.4} | {oracle} | {:.1} / {:.1} / {:.1} | {:.1} / {:.1} | {:.1}",
            self.label,
            self.runs,
            percent(self.claimed),
            percent(self.mean),
            percent(self.worst),
            percent(self.whole),
            self.frequencies,
            self.order,
            self.half_widths.0,
            self.half_widths.1,
            percent(self.rejected[0]),
            percent(self.rejected[1]),
            percent(self.rejected[2]),
            percent(self.withdrawn),
            percent(self.alarmed),
            percent(self.advised),
        )?;
        for (check, share) in &self.checks {
            write!(f, ", {check} {:.1}", percent(*share))?;
        }
        write!(f, " |")
    }
}
