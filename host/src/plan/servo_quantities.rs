//! What a run of the reference will determine of the servo as a machine.
//!
//! Simulated runs are identified as real ones will be, until one has intervals: noise withdraws those of one run in some. A long run is thinned to at most [`MOST_SAMPLES`] samples, whose
//! intervals are wider than those of all samples. A recording has a rest before and after the reference, which shows the noise: so have these runs, and
//! where they are thinned it is so many times as long, because as many samples at rest are needed.

use super::request::PlanRequest;
use super::simulated_runs::simulated_with_rest;
use crate::instrument::rig::roll_frames;
use serde::Serialize;
use servoid_identification::results::{Bounds, Reason};
use servoid_identification::servo_model::{
    PulseEnd, Quantity, QuantityKind, ServoModelOptions, Terms, fit,
};
use servoid_identification::{Error, Record, Run};
use servoid_protocol::reference::Reference;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_simulator::{SERVO_SCALE, ServoKind, SimulationOptions};

/// Samples that are identified: some seconds of computing.
const MOST_SAMPLES: usize = 30_000;

/// Runs that are tried.
const RUNS: u64 = 3;

/// Thinnings that keep the edges of the command, which lie every 10 samples.
const THINNINGS: [usize; 4] = [1, 2, 5, 10];

/// What a run will determine.
#[derive(Clone, Debug, Serialize)]
pub struct ServoQuantities {
    /// Of the samples of a run, every so many were identified.
    pub every: usize,
    /// Simulated runs that were identified; all but the last had no intervals.
    pub tried: u64,
    /// The terms that were found.
    pub terms: Terms,
    /// Level of the intervals; withdrawn where the run will have none.
    #[serde(flatten)]
    pub level: Bounds<f64>,
    /// The quantities, and whether they come out determined.
    pub quantities: Vec<Quantity>,
    /// What to record instead, for what is not determined.
    pub remedies: Vec<&'static str>,
}

impl ServoQuantities {
    /// From the first of some simulated runs that has intervals, or else the last.
    ///
    /// # Errors
    /// The run is too short.
    pub(super) fn of(request: &PlanRequest) -> Result<Self, Error> {
        let mut found = Self::of_run(request, 1)?;
        while found.level.withdrawn() == Some(Reason::ErrorsNotNoise) && found.tried < RUNS {
            found = Self::of_run(request, found.tried + 1)?;
        }
        Ok(found)
    }

    fn of_run(request: &PlanRequest, number: u64) -> Result<Self, Error> {
        let (record, every) = recorded(request, number)?;
        let options = ServoModelOptions {
            level: request.level,
            radians_per_command: Some(1f64.to_radians()),
            // The servo may know a pulse at its end, as it may in a recording.
            pulses: Some(PulseEnd {
                s_per_command: 1e-6 * SERVO_SCALE.us_per_degree,
                neutral: 0.0,
            }),
            ..ServoModelOptions::default()
        };
        let found = fit(&record, &options)?;
        let level = found.covariance.as_ref().map(|found| found.level);
        let is_machine = |rig: &SimulationOptions| matches!(rig.servo, ServoKind::Machine(_));
        let is_of_equation = request.assumed.simulation.as_ref().is_some_and(is_machine);
        Ok(Self {
            every,
            tried: number,
            terms: found.terms,
            remedies: remedies(
                has_holds(&request.reference),
                is_of_equation,
                found.terms,
                &level,
                &found.quantities,
            ),
            level,
            quantities: found.quantities,
        })
    }
}

/// A run as it would be recorded, thinned to every so many samples.
pub(super) fn recorded(
    request: &PlanRequest,
    number: u64,
) -> Result<(Record<'static>, usize), Error> {
    let one = PlanRequest {
        runs: 1,
        ..request.clone()
    };
    let rest = usize::from(roll_frames(request.assumed.train));
    let frames = one.reference.frames() as usize + 2 * rest;
    let thinnings = THINNINGS.into_iter();
    let fits = |every: &usize| frames * SAMPLES_PER_FRAME / every <= MOST_SAMPLES;
    let every = thinnings.clone().find(fits).or(thinnings.last());
    let every = every.unwrap_or(1);
    let record = thinned(&simulated_with_rest(&one, rest * every, number)?, every)?;
    Ok((record, every))
}

/// Every so many samples of each run.
fn thinned(record: &Record, every: usize) -> Result<Record<'static>, Error> {
    let thin = |values: &[f64]| -> Vec<f64> { values.iter().step_by(every).copied().collect() };
    let runs: Result<Vec<Run>, Error> = record
        .runs()
        .iter()
        .map(|run| Run::new(thin(run.input()), thin(run.output())).map(Run::with_exact_input))
        .collect();
    let thinned = Record::new(record.sample_period_s() * every as f64, runs?)?;
    Ok(thinned.with_sample_phase(record.sample_phase_s()))
}

/// Whether a reference holds its levels.
fn has_holds(reference: &Reference) -> bool {
    !matches!(reference, Reference::Sweep(_) | Reference::Multisine(_))
}

/// What strokes at top speed show.
const SPEEDS: [QuantityKind; 2] = [
    QuantityKind::TopSpeedUpwards,
    QuantityKind::TopSpeedDownwards,
];

/// What to record of a servo that ran into a stop.
const WITHIN_THE_STOPS: &str =
    "take strokes between the stops: lower --amplitude, or write a table of steps";

/// What to record for what is not determined, the most important first. A servo may have what the equation lacks, unless it is a model
/// of that equation.
fn remedies(
    has_holds: bool,
    is_of_equation: bool,
    terms: Terms,
    level: &Bounds<f64>,
    quantities: &[Quantity],
) -> Vec<&'static str> {
    let open = |kinds: &[QuantityKind]| {
        let left_open = quantities.iter().filter(|found| !found.determined);
        let mut left_open = left_open.filter_map(Quantity::kind);
        left_open.any(|kind| kinds.contains(&kind))
    };
    let by_reason = match level.withdrawn() {
        Some(Reason::FewLevels) => Some(
            "take a reference with more than two levels, such as stairs or a table of random steps: two positions of rest do not \
             distinguish friction, dead band and load from gain and offset",
        ),
        Some(Reason::FrictionUnseen | Reason::MotionInNoise) => {
            Some("take larger strokes: the servo hardly moves, and its friction does not show")
        }
        // No reference that goes beyond the stop serves for anything else, either.
        Some(Reason::TravelEnd | Reason::TravelEndOpen) => return vec![WITHIN_THE_STOPS],
        Some(_) if !has_holds => Some(
            "add a run of another reference with holds in which the servo comes to rest, such as stairs: this one has none that could be longer",
        ),
        Some(_) if is_of_equation => Some(
            "take longer holds, so that noise at rest can be distinguished from errors in motion",
        ),
        Some(_) => Some(
            "take longer holds, so that noise at rest can be distinguished from errors in motion; if that does not help, the servo has what \
             the equation lacks, and its values stand without intervals",
        ),
        None => None,
    };
    let is_held = terms.dead_band || terms.friction;
    let leaves_alike =
        level.withdrawn() == Some(Reason::ErrorsNotNoise) || open(QuantityKind::OF_FRICTION);
    let all = [
        (is_held && leaves_alike).then_some(
            "take a large slow motion that goes on, which distinguishes dead band and friction: --reference multisine --amplitude 30 --frequencies 0.1:3 \
             --length 20, as far as the travel allows",
        ),
        (!terms.is_limited()).then_some(
            "raise --amplitude, if the servo may turn further: no stroke of this reference shows a limit of the drive or of the speed",
        ),
        (terms.is_limited() && open(&SPEEDS)).then_some(
            "raise --amplitude and the hold, so that strokes reach the top speed and stay at it",
        ),
        (terms.is_limited() && !open(&SPEEDS) && open(QuantityKind::OF_LIMIT)).then_some(
            "raise --amplitude: of the limit of the drive, the acceleration is open, which larger strokes show for longer",
        ),
        open(QuantityKind::OF_SMALL_SIGNALS).then_some(
            "add small strokes, within the error of full drive: stairs with more --levels have both kinds",
        ),
        open(QuantityKind::OF_FRICTION).then_some(
            "approach each level from both sides and rest there: stairs with a longer --hold",
        ),
        open(QuantityKind::OF_LOAD).then_some("use more of the travel: a load shows where it changes with the angle"),
    ];
    by_reason
        .into_iter()
        .chain(all.into_iter().flatten())
        .collect()
}
