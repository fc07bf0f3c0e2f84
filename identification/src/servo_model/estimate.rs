//! From a record to a servo.
//!
//! The terms are chosen by the [ladder](super::ladder) on a coarse grid, the parameters fitted on a fine one, and the
//! evidence decides whether bounds hold.

use super::coordinates::{Coordinate, Point, Terms};
use super::fit::Problem;
use super::ladder::{Ladder, Rung};
use super::model::{Covariance, LONGEST_STEP_S, LadderRung, ServoFit, ServoModel};
use super::quantities::quantities;
use super::search::Shown;
use super::simulation::Grid;
use super::start::find_starts;
use super::stretches::{Stretch, stretches};
use super::uncertainty::{Uncertainty, uncertainty};
use crate::data::Record;
use crate::error::Error;
use crate::results::{Noise, fit_percent, pointwise_critical};

/// Longest step of the integration while terms are chosen \[s\].
const CHOICE_STEP_S: f64 = 1.5e-3;

/// Longest step of the integration in the search from far away \[s\].
const SEARCH_STEP_S: f64 = 3e-3;

/// Errors beyond this many standard deviations of the output are clipped: a servo that is lost counts, but does not decide.
const CLIP: f64 = 0.5;

/// Steps of the last descent.
const STEPS: usize = 60;

/// Longest delay that is looked for \[s\], and in samples: the larger of the two.
const LONGEST_DELAY: (f64, f64) = (0.2, 4.0);

/// Command ranges up to this are taken for radians, beyond it for degrees, where the caller does not say: no R/C servo
/// turns further than this in radians, and a load does not change over so few degrees.
const RADIANS_UP_TO: f64 = 7.0;

/// What is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct ServoModelOptions {
    /// The controller of each run, from 0: several controllers on one mechanism differ in stiffness alone. Empty where
    /// all runs have the same.
    pub controllers: Vec<usize>,
    /// Confidence level of the bounds.
    pub level: f64,
    /// Radians for each unit of the command; `None` to tell degrees from radians by their size.
    pub radians_per_command: Option<f64>,
}

impl Default for ServoModelOptions {
    fn default() -> Self {
        Self {
            controllers: Vec::new(),
            level: 0.99,
            radians_per_command: None,
        }
    }
}

/// Finds the servo behind a record.
///
/// # Errors
/// The record has too few samples in one piece.
pub fn fit(record: &Record, options: &ServoModelOptions) -> Result<ServoModel, Error> {
    let (mut parts, fold_of) = stretches(record, &options.controllers);
    let samples: usize = parts.iter().map(|part| part.input.len()).sum();
    if samples < FEWEST {
        return Err(Error::TooShortForAuto {
            samples,
            needed: FEWEST,
        });
    }
    let period_s = record.sample_period_s();
    let shown = Shown::by(&parts, period_s);
    let controllers = options.controllers.iter().max().map_or(1, |last| last + 1);
    let mut ladder = Ladder {
        stretches: &mut parts,
        fold_of: &fold_of,
        grid: Grid::new(period_s, record.sample_phase_s(), CHOICE_STEP_S),
        search_grid: Grid::new(period_s, record.sample_phase_s(), SEARCH_STEP_S),
        shown,
        clip: CLIP * shown.output_sd,
        longest_delay_s: LONGEST_DELAY.0.max(LONGEST_DELAY.1 * period_s),
        controllers,
        radians: options.radians_per_command.unwrap_or_else(|| radians(record)),
        tried: Vec::new(),
    };
    let chosen = ladder.climb();
    let (tried, radians) = (std::mem::take(&mut ladder.tried), ladder.radians);
    let fine = Fine {
        grid: Grid::new(period_s, record.sample_phase_s(), LONGEST_STEP_S),
        clip: ladder.clip,
        longest_delay_s: ladder.longest_delay_s,
    };
    let point = fine.descend(&mut parts, tried[chosen].fit.clone());
    let found = uncertainty(&fine.problem(&parts), &point, fold_of.len());
    Ok(describe(record, options, &parts, &tried, chosen, radians, controllers, point, found))
}

/// Samples that are needed: a few for each of the blocks.
const FEWEST: usize = 64;

/// The last, fine fit.
struct Fine {
    grid: Grid,
    clip: f64,
    longest_delay_s: f64,
}

impl Fine {
    fn problem<'a>(&self, stretches: &'a [Stretch]) -> Problem<'a> {
        Problem {
            stretches,
            grid: self.grid,
            used: &|_| true,
            clip: self.clip,
            longest_delay_s: self.longest_delay_s,
            converged: 1e-8,
        }
    }

    /// The best of descents from several delays, with the starts found anew for each.
    fn descend(&self, parts: &mut Vec<Stretch>, from: Point) -> Point {
        let delay_s = from.get(Coordinate::Delay).unwrap_or(0.0);
        let mut best: Option<(f64, Point, Vec<Stretch>)> = None;
        for delay_s in [delay_s, 0.8 * delay_s, 1.2 * delay_s] {
            let mut point = from.clone();
            point.set(Coordinate::Delay, delay_s.min(self.longest_delay_s));
            let mut own = parts.clone();
            let mut cost = f64::INFINITY;
            for _ in 0..2 {
                find_starts(&mut own, &point, &self.grid);
                cost = self.problem(&own).descend(&mut point, STEPS);
            }
            if best.as_ref().is_none_or(|(lowest, ..)| cost < *lowest) {
                best = Some((cost, point, own));
            }
        }
        let (_, point, own) = best.expect("three delays were tried");
        *parts = own;
        point
    }
}

/// Radians for each unit of the command, by the range of the command.
fn radians(record: &Record) -> f64 {
    let inputs = || record.runs().iter().flat_map(|run| run.input()).filter(|u| !u.is_nan());
    let range = inputs().fold(f64::MIN, |a, b| a.max(*b)) - inputs().fold(f64::MAX, |a, b| a.min(*b));
    if range > RADIANS_UP_TO {
        1f64.to_radians()
    } else {
        1.0
    }
}

#[expect(clippy::too_many_arguments)]
fn describe(
    record: &Record,
    options: &ServoModelOptions,
    parts: &[Stretch],
    tried: &[Rung],
    chosen: usize,
    radians: f64,
    controllers: usize,
    point: Point,
    found: Uncertainty,
) -> ServoModel {
    let known: Vec<f64> = found.errors.iter().flatten().copied().filter(|e| !e.is_nan()).collect();
    let count = known.len() as f64;
    let error: f64 = known.iter().map(|e| e * e).sum();
    let outputs = || parts.iter().flat_map(|part| &part.output).filter(|y| !y.is_nan());
    let mean = outputs().sum::<f64>() / count;
    let spread: f64 = outputs().map(|y| (y - mean).powi(2)).sum();
    let linear = tried.iter().find(|rung| rung.terms == Terms::default());
    let held_out = |rung: &Rung| fit_percent(rung.total(), spread);
    let level = super::validity::level(options.level, record, parts, &point, &found);
    let rows = |of: f64| Covariance {
        level: of,
        rows: (0..point.values.len())
            .map(|i| (0..point.values.len()).map(|j| found.covariance[(i, j)]).collect())
            .collect(),
    };
    let rung = |(index, rung): (usize, &Rung)| LadderRung {
        terms: rung.terms,
        held_out_percent: held_out(rung),
        fit_percent: fit_percent(rung.cost, spread),
        chosen: index == chosen,
    };
    ServoModel {
        sample_period_s: record.sample_period_s(),
        sample_phase_s: record.sample_phase_s(),
        terms: point.terms,
        controllers,
        radians_per_command: radians,
        covariance: level.as_ref().map(|level| rows(*level)),
        quantities: quantities(
            &point,
            &found.covariance,
            &found.seen,
            pointwise_critical(options.level),
            &level,
        ),
        coordinates: point.coordinates.clone(),
        values: point.values.clone(),
        fit: ServoFit {
            simulation_percent: fit_percent(error, spread),
            held_out_percent: held_out(&tried[chosen]),
            linear_held_out_percent: linear.map_or(f64::NAN, held_out),
            rmse: (error / count).sqrt(),
            samples_used: known.len(),
            samples_missing: record.samples() - known.len(),
        },
        noise: Noise {
            ar: found.ar,
            sigma: found.sigma,
        },
        ladder: tried.iter().enumerate().map(rung).collect(),
    }
}
