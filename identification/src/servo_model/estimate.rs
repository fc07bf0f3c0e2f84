//! From a record to a servo.
//!
//! The terms are chosen by the [ladder](crate::servo_model::terms::ladder), the parameters of the chosen ones are polished, and the evidence decides
//! whether bounds hold.

use super::candidates::{Candidates, polished};
use super::model::{Alternative, Covariance, LadderRung, MOST_CONTROLLERS, ServoFit, ServoModel};
use super::quantities::quantities;
use super::runs_alone::servo_changed;
use super::search_progress::Watch;
use super::search_setup::{CLIP, fine_grid, longest_delay_s, usable_stretches};
use crate::data::column::span;
use crate::data::{Quantisation, Record};
use crate::error::Error;
use crate::nonlinear::SpeedLimits;
use crate::results::{Bounds, Noise, Reason, fit_percent, pointwise_critical};
use crate::servo_model::descent::chosen_terms::Descent;
use crate::servo_model::descent::coordinates::{ArmTurn, LoadKind, Point, Terms};
use crate::servo_model::descent::starting_values::Shown;
use crate::servo_model::motion::reached_speeds::ReachedSpeeds;
use crate::servo_model::motion::simulated_motion::{largest_drive, largest_error};
use crate::servo_model::quantities::limit_at_work::LimitsAtWork;
use crate::servo_model::stretches::Stretch;
use crate::servo_model::terms::ladder::{Climbed, Ladder, Rung, beats, misses};
use crate::servo_model::terms::stops::PossibleStops;
use crate::servo_model::uncertainty::covariance::Uncertainty;
use crate::servo_model::uncertainty::possible_servo::PossibleServo;
use crate::servo_model::uncertainty::run_offsets;
use crate::servo_model::uncertainty::validity::against;
use crate::thresholds::RUN_OFFSETS_LEAVE;
use faer::Mat;
use rayon::prelude::*;
use servoid_dynamics::ServoParameters;
use servoid_dynamics::{Grid, PulseEnd, Stops};

/// Longest step of the integration in the search from far away \[s\], and the most steps in a sample period: what is faster does
/// not show in samples so far apart.
const SEARCH_STEPS: (f64, f64) = (3e-3, 16.0);

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
    /// Radians for each unit of the command; `None` to take them for degrees or radians by their size.
    pub radians_per_command: Option<f64>,
    /// Radians for each unit of the output, where that is an angle: an arm turns with it, whatever the commands are.
    pub radians_per_output: Option<f64>,
    /// What is known to speak against bounds of any model of the record; see [`Reason::is_of_the_record`].
    pub against: Option<Reason>,
    /// Where commands are pulse widths or stand for them: how much longer the pulse is for each unit of the command, and the neutral one. Whether the servo knows
    /// a pulse at its end is for the record to say.
    pub pulses: Option<PulseEnd>,
    /// Outputs at which the servo is known to stop \[output\]; those that its rests show, or its crests, are found without.
    pub stops_at: Vec<f64>,
}

impl Default for ServoModelOptions {
    fn default() -> Self {
        Self {
            controllers: Vec::new(),
            level: 0.99,
            radians_per_command: None,
            radians_per_output: None,
            against: None,
            pulses: None,
            stops_at: Vec::new(),
        }
    }
}

/// Finds the servo behind a record.
///
/// ```
/// use servoid_identification::servo_model::{ServoModelOptions, fit};
/// use servoid_identification::Record;
/// // Follows at 0.3 a sample at the most.
/// let u: Vec<f64> = (0..900).map(|k| [0.0, 5.0, -3.0, 1.0][k / 60 % 4]).collect();
/// let y: Vec<f64> = u.iter().scan(0.0, |y, u| {
///     *y += (0.2 * (u - *y)).clamp(-0.3, 0.3);
///     Some(*y)
/// }).collect();
/// let record = Record::of_run(0.01, &u, &y)?;
/// let servo = fit(&record, &ServoModelOptions::default())?;
/// assert!(servo.terms.limit && servo.fit.simulation_percent > 95.0);
/// # Ok::<(), servoid_identification::Error>(())
/// ```
///
/// # Errors
/// The record has too few samples, or too many controllers, or its samples are too far apart.
pub fn fit(record: &Record, options: &ServoModelOptions) -> Result<ServoModel, Error> {
    fit_watched(record, options, &())
}

/// Longest step of the integration in the search \[s\].
fn search_step_s(period_s: f64) -> f64 {
    let (longest_s, most) = SEARCH_STEPS;
    longest_s.max(period_s / most)
}

/// [`fit`] under the eyes of the caller, who may end the search.
///
/// # Errors
/// As [`fit`]; [`Error::SearchEnded`] where the caller has ended the search.
pub fn fit_watched(
    record: &Record,
    options: &ServoModelOptions,
    watch: &dyn Watch,
) -> Result<ServoModel, Error> {
    if controllers(options) > MOST_CONTROLLERS {
        return Err(Error::TooManyControllers {
            controllers: controllers(options),
            most: MOST_CONTROLLERS,
        });
    }
    let (parts, fold_of) = usable_stretches(record, &options.controllers)?;
    let search = Search {
        shown: Shown::by(&parts, record.sample_period_s()),
        record,
        options,
        fold_of: &fold_of,
        watch,
    };
    let mut found = search.found_with_stops(&parts);
    if let Some(pulses) = options.pulses.filter(|end| search.shows(*end, &found)) {
        let shown = search.shown.with_pulse_end(Some(pulses));
        let at_its_end = Search { shown, ..search }.found_with_stops(&parts);
        if beats(at_its_end.held_out(), found.held_out()) {
            found = at_its_end;
        }
    }
    if watch.ends() {
        return Err(Error::SearchEnded);
    }
    let mut model = describe(record, options, &found);
    let lacking = found.candidates.found.discrepancy;
    model.fit.servo_changed = model.fit.lacking.is_some()
        && servo_changed(record, &options.controllers, (found.best(), lacking), watch);
    Ok(model)
}

/// Of servos that predict as well as the best, one with the stops that the record [shows](PossibleStops::missing), and of these one with the fewest that are
/// [guesses](PossibleStops::guessed), and of these the one with the fewest numbers, each stop being one: a load of the air stands for a stop, and a stop that nothing touches for nothing. Of those alike, the one that predicts better.
///
/// A stop that the record shows is none where the servo has the same load without it, which holds it there.
fn preferred(mut all: Vec<Found>, possible: &PossibleStops) -> Found {
    let with_shown = (all.iter()).find(|found| found.best().stops == possible.shown);
    let load_beside = with_shown.map(|found| found.best().terms.load);
    let stops = |found: &Found| {
        let best = found.best();
        let servo = best.physics(0, |_, value| value);
        let missing = match load_beside == Some(best.terms.load) {
            true => 0,
            false => possible.missing(best.stops),
        };
        (missing, possible.guessed(&servo))
    };
    let numbers = |found: &Found| {
        let best = found.best();
        best.coordinates.len() + best.stops.count()
    };
    all.sort_by(|a, b| {
        let by_stops = stops(a).cmp(&stops(b));
        let by_numbers = numbers(a).cmp(&numbers(b));
        (by_stops.then(by_numbers)).then(a.total().total_cmp(&b.total()))
    });
    let best = (0..all.len()).min_by(|&a, &b| all[a].total().total_cmp(&all[b].total()));
    let best = &all[best.expect("a servo without stops")];
    let stops = best.best().stops;
    let as_good = |found: &Found| !misses(found.held_out(), best.held_out());
    let chosen = all
        .iter()
        .position(as_good)
        .expect("the best is as good as itself");
    let mut found = all.swap_remove(chosen);
    // With other stops it predicts better, if only by chance: a load stands for a stop down to the noise, with another delay.
    let is_open = stops != found.best().stops;
    let servo = found.best().physics(0, |_, value| value);
    let has_open_stop = possible.open(found.best().stops) > 0 || possible.may_be_load(&servo);
    let level = &mut found.candidates.level;
    *level = match level.withdrawn() {
        Some(Reason::TravelEnd) if has_open_stop => Bounds::Withdrawn(Reason::TravelEndOpen),
        _ => level.unless(is_open.then_some(Reason::TravelEndOpen)),
    };
    found
}

/// What a servo is looked for with.
#[derive(Clone, Copy)]
struct Search<'a> {
    record: &'a Record<'a>,
    options: &'a ServoModelOptions,
    fold_of: &'a [usize],
    shown: Shown,
    watch: &'a dyn Watch,
}

/// Errors of a servo, as root mean squares, by which it goes on where the recorded one rests.
const GOES_ON: f64 = 4.0;

/// Steps of the descent that shows whether a servo knows a pulse at its end.
const PULSE_END_STEPS: usize = 20;

/// What a search finds.
struct Found {
    /// The stretches of the record, with their starts.
    parts: Vec<Stretch>,
    climbed: Climbed,
    candidates: Candidates,
}

impl Found {
    fn best(&self) -> &Point {
        &self.candidates.possible[0].point
    }

    /// Squared errors in all that was not seen.
    fn total(&self) -> f64 {
        self.climbed.best().total()
    }

    /// Squared errors of each block that was not seen.
    fn held_out(&self) -> &[f64] {
        &self.climbed.best().held_out
    }

    /// Whether the servo may stand for one that ends at `rest`, where the recorded one rests under `command`: its load is of the air, which is none but at the ends; or its errors
    /// are not noise, and it goes on by more than they are.
    fn may_stand_for_a_stop(&self, [command, rest]: [f64; 2]) -> bool {
        let servo = self.best().physics(0, |_, value| value);
        let ends = servo
            .staying_angles(command)
            .map(|angle| angle * servo.gain + servo.offset);
        let (near, far) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        // Behind play the output is up to half of it away.
        let half_play = servo.half_play() * servo.gain.abs();
        let beyond = (near - rest).max(rest - far) - half_play;
        let goes_on = || beyond > GOES_ON * self.candidates.found.root_mean_square();
        self.best().terms.load == LoadKind::Air || !self.has_noise_alone() && goes_on()
    }

    /// Whether nothing speaks against intervals.
    fn has_noise_alone(&self) -> bool {
        against(&self.parts, self.best(), &self.candidates.found).is_none()
    }
}

impl Search<'_> {
    /// The servo behind `parts`, with the stops that predict.
    fn found_with_stops(&self, parts: &[Stretch]) -> Found {
        let searched = |stops: Stops| {
            let shown = self.shown.with_stops(stops);
            Search { shown, ..*self }.found_with_runs(parts.to_vec())
        };
        let possible = PossibleStops::of(self.record, &self.options.stops_at, self.shown.gain);
        let all = possible.choices().into_par_iter().map(searched).collect();
        let found = preferred(all, &possible);
        let may_be_a_stop = |rest: &[f64; 2]| found.may_stand_for_a_stop(*rest);
        let Some(wider) = possible.with_outermost_rests(self.record, may_be_a_stop) else {
            return found;
        };
        let further = wider.further_choices(&possible);
        let mut all: Vec<Found> = further.into_par_iter().map(searched).collect();
        all.push(found);
        preferred(all, &wider)
    }

    /// Whether the servo that was `found` follows the record better by more than scatter where it is taken to know pulses at their ends. What a wrong load or
    /// friction made of that before, the descent takes away.
    fn shows(&self, pulses: PulseEnd, found: &Found) -> bool {
        let descent = self.descent(found.best());
        let problem = descent.problem(&found.parts);
        let mut other = Point {
            pulse_end: Some(pulses),
            ..found.best().clone()
        };
        problem.descend(&mut other, PULSE_END_STEPS);
        let blocks = self.fold_of.len();
        beats(
            &problem.by_block(&other, blocks),
            &problem.by_block(found.best(), blocks),
        )
    }

    /// The servo behind `parts`, with an offset of each run where that is what its errors say.
    fn found_with_runs(&self, parts: Vec<Stretch>) -> Found {
        let found = self.found(parts.clone(), &[]);
        let own = self.run_offsets(&found);
        if own.is_empty() {
            return found;
        }
        // Beside errors that are not noise, the mean of a run is no zero of a sensor unless it is most of them: a servo that is lost has one, too.
        let with_own = self.found(parts, &own);
        let square = |found: &Found| found.candidates.found.discrepancy.powi(2);
        let is_most = square(&with_own) < RUN_OFFSETS_LEAVE * square(&found);
        match with_own.has_noise_alone() || is_most {
            true => with_own,
            false => found,
        }
    }

    /// The servo behind `parts`. Each run has an offset where `run_offsets` has what these begin with.
    fn found(&self, mut parts: Vec<Stretch>, run_offsets: &[f64]) -> Found {
        let period_s = self.record.sample_period_s();
        let ladder = Ladder {
            stretches: &mut parts,
            fold_of: self.fold_of,
            grid: Grid::new(
                period_s,
                self.record.sample_phase_s(),
                search_step_s(period_s),
            ),
            shown: self.shown,
            clip: CLIP * self.shown.output_sd,
            longest_delay_s: longest_delay_s(period_s),
            controllers: controllers(self.options),
            arm: ArmTurn::of(
                (self.options.radians_per_command).unwrap_or_else(|| radians(self.record)),
                self.options.radians_per_output,
            ),
            run_offsets,
            watch: self.watch,
            tried: Vec::new(),
        };
        let climbed = ladder.climbed();
        let found = self.with_candidates(parts, climbed);
        match found.candidates.level.withdrawn() {
            Some(Reason::ErrorsNotNoise) => self.with_noise_alone(found),
            _ => found,
        }
    }

    /// What the rungs of a ladder say of `parts`.
    fn with_candidates(&self, mut parts: Vec<Stretch>, climbed: Climbed) -> Found {
        let mut candidates = Candidates::of(
            &mut parts,
            self.fold_of,
            &self.shown,
            &climbed,
            &self.descent(&climbed.best().fit),
            Bounds::of_level(self.options.level, self.against(climbed.best().terms)),
        );
        candidates.level = self.with_steps(candidates.level, &candidates.found);
        Found {
            parts,
            climbed,
            candidates,
        }
    }

    /// The servo with the dead band, the friction and the play of which errors are noise, where prediction misses none; else the one that was `found`. All rest alike, and
    /// a fit takes one for another.
    fn with_noise_alone(&self, found: Found) -> Found {
        let tried = &found.climbed.tried;
        let beside = |rung: usize| Terms {
            dead_band: false,
            play: false,
            friction: false,
            ..tried[rung].terms
        };
        let is_alike = |rung: &usize| beside(*rung) == beside(found.climbed.chosen);
        let mut others = found.climbed.others.clone();
        others.retain(is_alike);
        let has_noise_alone = |rung: &usize| {
            let mut parts = found.parts.clone();
            let from = &tried[*rung].fit;
            let descent = self.descent(from);
            let (best, of) = polished(&mut parts, self.fold_of, &self.shown, from, &descent);
            against(&parts, &best, &of).is_none()
        };
        match others.into_iter().find(has_noise_alone) {
            Some(rung) => self.with_candidates(found.parts, found.climbed.with_chosen(rung)),
            None => found,
        }
    }

    /// The level of bounds that hold or not. Errors that are no noise are those of the sensor's steps where these are larger than the noise: what the
    /// model lacks does not show beside them.
    fn with_steps(&self, level: Bounds<f64>, found: &Uncertainty) -> Bounds<f64> {
        let is_step = |errors: f64| Quantisation::of(self.record, errors).is_some();
        match level.withdrawn() {
            Some(Reason::ErrorsNotNoise) if is_step(found.root_mean_square()) => {
                Bounds::Withdrawn(Reason::QuantisationAboveNoise)
            }
            _ => level,
        }
    }

    /// What speaks against bounds of the best servo, which has these terms. How sure the angle of a stop is, no interval contains, and where a
    /// load holds the drive, the record hardly shows how strong it is.
    fn against(&self, terms: Terms) -> Option<Reason> {
        let has_stop = !self.shown.stops.are_none();
        let by_stop = has_stop.then_some(Reason::TravelEnd);
        match self.options.against.or(by_stop) {
            Some(Reason::TravelEnd | Reason::TravelEndOpen)
                if !has_stop && terms.load != LoadKind::None =>
            {
                Some(Reason::LoadHoldsDrive)
            }
            found => found,
        }
    }

    fn descent(&self, from: &Point) -> Descent<'_> {
        Descent {
            grid: fine_grid(from, self.record),
            clip: CLIP * self.shown.output_sd,
            longest_delay_s: longest_delay_s(self.record.sample_period_s()),
            converged: 1e-5,
            watch: self.watch,
        }
    }

    /// Offsets of the runs, where the errors of a servo without them say that they differ.
    fn run_offsets(&self, found: &Found) -> Vec<f64> {
        let descent = self.descent(found.best());
        run_offsets::of_errors(&descent.problem(&found.parts), found.best())
    }
}

/// Radians for each unit of the command, by the range of the command.
fn radians(record: &Record) -> f64 {
    let range = span(record.inputs()).unwrap_or_default();
    if range > RADIANS_UP_TO {
        1f64.to_radians()
    } else {
        1.0
    }
}

/// The result in people's terms.
fn describe(record: &Record, options: &ServoModelOptions, servo: &Found) -> ServoModel {
    let Found {
        parts,
        climbed,
        candidates,
    } = servo;
    let Candidates {
        level,
        possible,
        found,
        ..
    } = candidates;
    let point = &possible[0].point;
    let spread = spread_about_mean(parts);
    let rung = |(index, rung): (usize, &Rung)| LadderRung {
        terms: rung.terms,
        held_out_percent: fit_percent(rung.total(), spread),
        fit_percent: fit_percent(rung.cost, spread),
        chosen: index == climbed.chosen,
    };
    let alternative = |other: &PossibleServo| Alternative {
        terms: other.point.terms,
        coordinates: other.point.coordinates.clone(),
        values: other.point.values.clone(),
        friction_speed_share: other.point.friction_speed_share,
        covariance: rows(&other.covariance),
    };
    let mut quantities = quantities(
        possible,
        (
            pointwise_critical(options.level),
            longest_delay_s(record.sample_period_s()),
        ),
        level,
        &found.motion,
        &candidates.other_fits,
    );
    if point.terms.is_limited() {
        let at_work = LimitsAtWork::of(parts, point, &fine_grid(point, record), found);
        at_work.open(&mut quantities, &found.motion.fastest);
    }
    let mut model = ServoModel {
        sample_period_s: record.sample_period_s(),
        sample_phase_s: record.sample_phase_s(),
        terms: point.terms,
        controllers: controllers(options),
        radians_per_command: point.arm.radians(point.physics(0, |_, value| value).gain),
        radians_per_output: options.radians_per_output,
        covariance: level.as_ref().map(|level| Covariance {
            level: *level,
            rows: rows(&possible[0].covariance),
        }),
        alternatives: match level {
            Bounds::Withdrawn(_) => Vec::new(),
            _ => possible[1..].iter().map(alternative).collect(),
        },
        quantities,
        coordinates: point.coordinates.clone(),
        values: point.values.clone(),
        friction_speed_share: point.friction_speed_share,
        drawn: false,
        commands: Some(found.motion.commands),
        reached: Some(ReachedSpeeds::of(parts, record.sample_period_s())),
        speed_limits: speed_limits(record, point),
        hysteresis: None,
        rests_apart: None,
        missed_rests: Vec::new(),
        delay_by_noise: None,
        stops: point.stops,
        pulse_end: point.pulse_end,
        run_offsets: point.run_offsets.clone(),
        fit: fit_of(servo, record, spread),
        noise: Noise {
            ar: found.ar.clone(),
            sigma: found.sigma,
        },
        ladder: climbed.tried.iter().enumerate().map(rung).collect(),
        linear_models: None,
    };
    model.leave_extrapolated_speeds_open();
    model.leave_slower_fits_out();
    model
}

/// Time to within 2 % of the end of a step, of two equal poles, in reciprocals of these: the solution x of (1 + x) exp(-x) = 0.02.
const TO_REST: f64 = 5.834;

/// The limits that the strokes of `record` show, which the servo `point` ends.
fn speed_limits(record: &Record, point: &Point) -> SpeedLimits {
    let servo = point.physics(0, |_, value| value);
    let response_s = servo.delay_s.max(0.0) + TO_REST / servo.stiffness.sqrt();
    let response = (response_s / record.sample_period_s()).ceil() as usize;
    SpeedLimits::of(record, response, servo.gain < 0.0)
}

/// Sum of the squares of the known output about its mean.
fn spread_about_mean(parts: &[Stretch]) -> f64 {
    let outputs = || {
        let all = parts.iter().flat_map(|part| &part.output);
        all.filter(|y| !y.is_nan())
    };
    let mean = outputs().sum::<f64>() / outputs().count() as f64;
    outputs().map(|y| (y - mean).powi(2)).sum()
}

/// How well the model fits the output, whose squares about its mean are `spread`.
fn fit_of(servo: &Found, record: &Record, spread: f64) -> ServoFit {
    let Candidates {
        level,
        possible,
        found,
        ..
    } = &servo.candidates;
    let errors = found.errors();
    let known = || errors.iter().flatten().filter(|e| !e.is_nan());
    let (count, error) = (known().count(), known().map(|e| e * e).sum::<f64>());
    let held_out = |rung: &Rung| fit_percent(rung.total(), spread);
    ServoFit {
        simulation_percent: fit_percent(error, spread),
        held_out_percent: held_out(servo.climbed.best()),
        linear_held_out_percent: servo.climbed.linear().map_or(f64::NAN, held_out),
        rmse: (error / count as f64).sqrt(),
        largest_residual: Some(known().fold(0.0, |most, e| e.abs().max(most))),
        discrepancy: level.valid().map(|_| found.discrepancy),
        lacking: (found.lacking()).filter(|_| level.withdrawn() == Some(Reason::ErrorsNotNoise)),
        servo_changed: false,
        waits_for_pulses: None,
        largest_error: largest_of(&servo.parts, &possible[0].point, found, largest_error),
        largest_drive: Some(largest_of(
            &servo.parts,
            &possible[0].point,
            found,
            |physics, input, output| {
                largest_drive(physics, input, output, record.sample_period_s())
            },
        )),
        samples_used: count,
        samples_missing: record.samples() - count,
    }
}

/// The largest `of` all of the simulated record.
fn largest_of(
    parts: &[Stretch],
    point: &Point,
    found: &Uncertainty,
    of: impl Fn(&ServoParameters, &[f64], &[f64]) -> f64,
) -> f64 {
    let simulated = parts.iter().zip(&found.motion.simulated);
    let of_part = |(part, output): (&Stretch, &Vec<f64>)| {
        let physics = point.servo_of(part, |_, value| value);
        of(&physics, &part.input, output)
    };
    simulated.map(of_part).fold(0.0, f64::max)
}

fn rows(matrix: &Mat<f64>) -> Vec<Vec<f64>> {
    let row = |i: usize| (0..matrix.ncols()).map(|j| matrix[(i, j)]).collect();
    (0..matrix.nrows()).map(row).collect()
}

/// Number of controllers.
fn controllers(options: &ServoModelOptions) -> usize {
    options.controllers.iter().max().map_or(1, |last| last + 1)
}
