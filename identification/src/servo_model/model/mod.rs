//! The result: a servo, how sure it is, and how it was chosen.

mod drawn_servo;
pub(super) mod hysteresis;
pub(super) mod old_quantities;
pub(super) mod prediction;
mod pulse_end;
pub(super) mod sine_response;
pub(super) mod stall;
pub(super) mod stroke_time;
mod top_speed_reached;

use super::quantities::{self, Quantity, widen_delay};
use crate::data::{Record, Run, Timing};
use crate::error::Error;
use crate::nonlinear::{MissedRest, SpeedLimits};
use crate::numerics::not_negative;
use crate::results::{Bounds, Interval, Noise, Reason, Validation, pointwise_critical};
use crate::servo_model::descent::coordinates::{
    ArmTurn, Coordinate, FRICTION_SPEED_SHARE, Point, Terms,
};
use crate::servo_model::descent::initial_state::find_starts;
use crate::servo_model::descent::step::MOST;
use crate::servo_model::motion::command_range::CommandRange;
use crate::servo_model::motion::reached_speeds::ReachedSpeeds;
use crate::servo_model::motion::simulated_motion::{largest_drive, largest_error};
use crate::servo_model::quantities::quantity_kind::QuantityKind;
use crate::servo_model::stretches::stretches;
use crate::servo_model::uncertainty::run_offsets;
use crate::thresholds::{LINEAR_MODEL_ADVANTAGE, SERVO_ERROR_BEYOND_RECORD};
use serde::{Deserialize, Serialize};
use servoid_dynamics::{Dual, Grid, PulseEnd, Scalar, ServoParameters, Start, Stops, simulate};

/// Controllers on one mechanism, at the most.
pub(super) const MOST_CONTROLLERS: usize = MOST - 15;

/// The servo as a machine: see the [module](super).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ServoModel {
    /// Sample period of the record \[s\].
    pub sample_period_s: f64,
    /// Time from the edge of the input to the sample of the output that belongs to it \[s\].
    pub sample_phase_s: f64,
    /// The terms of the equation that prediction needs.
    pub terms: Terms,
    /// Controllers that drove the same mechanism.
    pub controllers: usize,
    /// Radians for each unit of the command, which a load that turns with the shaft needs.
    pub radians_per_command: f64,
    /// Radians for each unit of the output, where that is an angle: those of the command are its product with the gain, whatever that is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radians_per_output: Option<f64>,
    /// The coordinates of the fit, in the order of `values` and of the covariance.
    pub coordinates: Vec<Coordinate>,
    /// Their values.
    pub values: Vec<f64>,
    /// The speed at which half of the excess of friction at rest is gone, as a share of the top speed: that of the equation, but for a servo that
    /// was drawn from `alternatives`.
    #[serde(
        default = "friction_speed_share",
        skip_serializing_if = "is_usual_friction_speed_share"
    )]
    pub friction_speed_share: f64,
    /// Whether `values` are those of a possible servo that was drawn at random: its quantities are then its own, and intervals and fit those of the estimate.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub drawn: bool,
    /// Covariance of the coordinates, where bounds hold.
    #[serde(flatten)]
    pub covariance: Bounds<Covariance>,
    /// Other servos that the record does not distinguish from this one, each with its covariance: what is said holds for all.
    pub alternatives: Vec<Alternative>,
    /// Parameters and what follows from them, in people's terms.
    pub quantities: Vec<Quantity>,
    /// The commands of the record; `None` in files from before this was kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commands: Option<CommandRange>,
    /// How fast the servo moved in the record, whatever the model says of it; `None` in files from before this was kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reached: Option<ReachedSpeeds>,
    /// Speeds that the larger strokes of the record have in common, whatever the model says of it.
    #[serde(default, skip_serializing_if = "SpeedLimits::are_none")]
    pub speed_limits: SpeedLimits,
    /// How far apart positions of rest that are reached from above and from below are \[output\]; `None` where the record does not show
    /// that they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hysteresis: Option<Interval>,
    /// How far apart rests under one command are, whatever strokes led there: see [the rests of a record](crate::nonlinear::Hysteresis::with_rests_apart) \[output\]; `None` where the
    /// record does not show it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rests_apart: Option<Interval>,
    /// The outermost commands under which the servo rests elsewhere than the model, as where a stop, a linkage or a load is not in it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub missed_rests: Vec<MissedRest>,
    /// The delay as far as noise leaves it open, where its interval among the `quantities` allows for output that was recorded earlier or later,
    /// too: that is the same in two recordings that were made alike.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delay_by_noise: Option<Interval>,
    /// The stops within the commands of the record, as it shows them by itself.
    #[serde(
        default,
        with = "StopsDocument",
        skip_serializing_if = "Stops::are_none"
    )]
    pub stops: Stops,
    /// Where the record shows that the servo knows a pulse at its end: what the length of that adds to the delay, which is that of the neutral command.
    #[serde(default, with = "pulse_end", skip_serializing_if = "Option::is_none")]
    pub pulse_end: Option<PulseEnd>,
    /// What the offset of each run of the record is above the quantity `offset`, their mean \[output\]; empty where the runs do not
    /// differ beyond chance.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub run_offsets: Vec<f64>,
    /// How well it follows the record.
    pub fit: ServoFit,
    /// Noise of the errors of simulation.
    pub noise: Noise,
    /// What was tried, in order.
    pub ladder: Vec<LadderRung>,
    /// Linear models of the record beside it; `None` where none was compared.
    #[serde(default)]
    pub linear_models: Option<LinearModels>,
}

/// How a document has stops.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Stops")]
pub(crate) struct StopsDocument {
    #[serde(skip_serializing_if = "Option::is_none")]
    lower: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    upper: Option<f64>,
}

/// Covariance of the coordinates, and the level of bounds that are made of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Covariance {
    /// Confidence level.
    pub level: f64,
    /// Rows of the covariance.
    pub rows: Vec<Vec<f64>>,
}

/// Another servo that predicts the record as well: of other terms, or of the same in another valley of the fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alternative {
    /// Its terms.
    pub terms: Terms,
    /// The coordinates of the fit.
    pub coordinates: Vec<Coordinate>,
    /// Their values.
    pub values: Vec<f64>,
    /// The speed at which half of the excess of friction at rest is gone, as a share of the top speed.
    #[serde(default = "friction_speed_share")]
    pub friction_speed_share: f64,
    /// Rows of their covariance.
    pub covariance: Vec<Vec<f64>>,
}

/// The share of the equation: models that were written without it had no other.
fn friction_speed_share() -> f64 {
    FRICTION_SPEED_SHARE
}

fn is_usual_friction_speed_share(share: &f64) -> bool {
    *share == FRICTION_SPEED_SHARE
}

impl ServoModel {
    /// The share of the top speed at which half of the excess of its friction at rest is gone, where that is not the 0.05 of other servos.
    #[must_use]
    pub fn own_friction_speed_share(&self) -> Option<f64> {
        let is_own = self.terms.friction && self.friction_speed_share != FRICTION_SPEED_SHARE;
        is_own.then_some(self.friction_speed_share)
    }
}

/// How well a servo follows a record.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ServoFit {
    /// 100 (1 - |y - ŷ| / |y - mean y|), simulated from the input alone.
    pub simulation_percent: f64,
    /// The same for parts of the record that the fit had not seen.
    pub held_out_percent: f64,
    /// The same for a linear servo of second order.
    pub linear_held_out_percent: f64,
    /// Root mean square of the errors \[output\].
    pub rmse: f64,
    /// The largest of them \[output\]; `None` in files from before it was kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_residual: Option<f64>,
    /// Upper limit of the root mean square of what the equation lacks: the part of the errors that does not average out as
    /// the noise at rest does. A bound like the others: `None` where bounds are withdrawn.
    pub discrepancy: Option<f64>,
    /// The same limit where bounds are withdrawn because the errors are not noise: how much of them the model lacks, and no bound. `None` elsewhere, and where the servo
    /// is not seen at rest, or what moves it there is as slow as the servo.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lacking: Option<f64>,
    /// Whether each run by itself leaves its servo nothing but noise where all of them together do not: the servo changed between the runs.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub servo_changed: bool,
    /// The pulses that the commands waited for, where its record has them at these: then the delay is that behind a pulse. Who has the recording finds that, so a new model has `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub waits_for_pulses: Option<WaitsForPulses>,
    /// Largest distance of the simulated angle from the command \[command\].
    pub largest_error: f64,
    /// The largest drive of the simulation, as the error that asks for it, if all of the damping is in the loop \[command\]: a limit of the drive beyond it does not show. `None` in files
    /// from before it was kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_drive: Option<f64>,
    /// Samples used.
    pub samples_used: usize,
    /// Samples without an output, or without an input.
    pub samples_missing: usize,
}

/// Pulses on a clock of their own that the commands of a record waited for, and that were found by its motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WaitsForPulses {
    /// From one pulse to the next \[s\].
    pub frame_s: f64,
    /// By how much all of them may have come sooner or later at the most \[s\]; the interval of the delay contains it.
    pub delay_error_s: f64,
    /// Whether holds of one length leave open how long the frame is: with others they end at the same moments of a frame.
    #[serde(default)]
    pub length_is_open: bool,
}

impl WaitsForPulses {
    /// The length of the frame in hundredths of a millisecond \[s\]: the clock of another recording has other digits behind that. In whole ones where it is open.
    #[must_use]
    pub fn nominal_frame_s(&self) -> f64 {
        let digits = if self.length_is_open { 1e3 } else { 1e5 };
        (digits * self.frame_s).round() / digits
    }

    /// How far apart they come.
    ///
    /// ```
    /// # use servoid_identification::servo_model::WaitsForPulses;
    /// let mut waits = WaitsForPulses { frame_s: 0.020_07, delay_error_s: 1e-4, length_is_open: false };
    /// assert_eq!(waits.in_words(), "20.1 ms apart");
    /// waits.length_is_open = true;
    /// assert_eq!(waits.in_words(), "about 20 ms apart (holds of one length leave open how far exactly)");
    /// ```
    #[must_use]
    pub fn in_words(&self) -> String {
        match self.length_is_open {
            true => format!(
                "about {:.0} ms apart (holds of one length leave open how far exactly)",
                1e3 * self.frame_s
            ),
            false => format!("{:.1} ms apart", 1e3 * self.frame_s),
        }
    }
}

/// Terms that were tried.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LadderRung {
    /// The terms.
    pub terms: Terms,
    /// Fit of what it had not seen \[%\]; where other terms are better by far, that of the whole record.
    pub held_out_percent: f64,
    /// Fit of the whole record \[%\].
    pub fit_percent: f64,
    /// Whether it was chosen.
    pub chosen: bool,
}

/// The servo model and linear ones on parts of the record that each was identified without: the folds of the ladder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LinearModels {
    /// Samples that all of them predict; each is judged by these.
    pub samples_used: usize,
    /// Fit of the servo model \[%\].
    pub servo_model_percent: f64,
    /// The linear models that every fold determines.
    pub models: Vec<LinearModelFit>,
}

/// How well a linear model predicts what it has not seen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LinearModelFit {
    /// Which model.
    pub kind: LinearKind,
    /// Fit of what it had not seen \[%\]; where other terms are better by far, that of the whole record.
    pub held_out_percent: f64,
}

/// A linear model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LinearKind {
    /// [`Model`](crate::results::Model): one response to all strokes.
    Linear,
    /// [`DirectionModel`](crate::nonlinear::DirectionModel): one response to strokes up and another to strokes down.
    DirectionSplit,
}

/// A simulated response with its bounds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ServoResponse {
    /// The output, sample by sample.
    pub value: Vec<f64>,
    /// Half width of the band about each sample, at the level of the model: that of the servo's own response, without
    /// the noise of the sensor.
    #[serde(flatten)]
    pub half_width: Bounds<Vec<f64>>,
}

impl LinearModels {
    /// The fit of the linear model of this kind \[%\].
    #[must_use]
    pub fn percent_of(&self, kind: LinearKind) -> Option<f64> {
        let found = self.models.iter().find(|other| other.kind == kind);
        found.map(|found| found.held_out_percent)
    }
}

/// At rest under `command`. Within a dead band the load alone places the shaft, however small it is, and derivatives by a load that the record
/// hardly shows have no bound there: the angle counts as given, and the edges of the dead band say how far off it may be.
fn start_at_rest(servo: &ServoParameters<Dual<MOST>>, command: Dual<MOST>) -> Start<Dual<MOST>> {
    let angle = servo.resting_angle(command);
    let width = servo.dead_band.map_or(0.0, Scalar::value);
    let angle = match (command.value() - angle.value()).abs() < width {
        true => Dual::constant(angle.value()),
        false => angle,
    };
    Start {
        output: angle * servo.gain + servo.offset,
        rate: Dual::constant(0.0),
        command_before: Some(command),
        in_play: 0.0,
    }
}

impl ServoModel {
    /// The point of the search that it stands for.
    pub(super) fn point(&self) -> Point {
        Point {
            run_offsets: self.run_offsets.clone(),
            ..self.point_of(self.terms, &self.coordinates, &self.values)
        }
    }

    fn point_of(&self, terms: Terms, coordinates: &[Coordinate], values: &[f64]) -> Point {
        Point {
            terms,
            coordinates: coordinates.to_vec(),
            values: values.to_vec(),
            arm: ArmTurn::of(self.radians_per_command, self.radians_per_output),
            friction_speed_share: self.friction_speed_share,
            run_offsets: Vec::new(),
            stops: self.stops,
            pulse_end: self.pulse_end,
        }
    }

    /// The point of another set of terms that predicts as well.
    fn point_of_alternative(&self, other: &Alternative) -> Point {
        Point {
            friction_speed_share: other.friction_speed_share,
            ..self.point_of(other.terms, &other.coordinates, &other.values)
        }
    }

    /// The quantity of this kind, where the servo has it.
    #[must_use]
    pub fn quantity(&self, kind: QuantityKind) -> Option<&Quantity> {
        self.quantities
            .iter()
            .find(|found| found.kind() == Some(kind))
    }

    /// The parameters of the equation, with the controller number `controller` (from 0).
    #[must_use]
    pub fn parameters(&self, controller: usize) -> ServoParameters {
        self.point().physics(controller, |_, value| value)
    }

    /// The quantity `kind` under the load at the angle `angle` \[command\]; `None` of a servo that has none.
    pub(crate) fn quantity_at(&self, kind: QuantityKind, angle: f64) -> Option<f64> {
        quantities::value(kind, &self.parameters(0), angle)
    }

    pub(super) fn grid(&self, timing: Timing) -> Grid {
        let stiffness = self.parameters(0).stiffness;
        Grid::for_stiffness(timing.sample_period_s, timing.sample_phase_s, stiffness)
    }

    /// The response of the servo with the controller number `controller` (from 0) to `input`, from rest at the first
    /// command: in the middle of where it may rest. The band holds the responses of all servos that the record does not distinguish, from wherever friction, a dead band or play
    /// may hold them at first, at each point by itself. It is withdrawn where the command runs ahead of the servo by a quarter more than in the record: what happens there
    /// did not show. To each side it is no wider than the commands of the record go: linearised in a load that the motion hardly met, it would be.
    #[must_use]
    pub fn respond(&self, input: &[f64], controller: usize) -> ServoResponse {
        let own = self.covariance.valid();
        let rows = own.map_or(&[][..], |found| &found.rows);
        let (value, spread) = self.response_of(&self.point(), rows, input, controller);
        let critical = own.map_or(f64::NAN, |found| pointwise_critical(found.level));
        let discrepancy = self.fit.discrepancy.unwrap_or(f64::NAN);
        let bound = |sd: f64| critical * sd.hypot(discrepancy);
        let mut half: Vec<f64> = spread.iter().map(|sd| bound(*sd)).collect();
        let mut hold = |theirs: &[f64], spread: &[f64]| {
            for (k, half) in half.iter_mut().enumerate() {
                *half = half.max((theirs[k] - value[k]).abs() + bound(spread[k]));
            }
        };
        for other in self.alternatives.iter().filter(|_| own.is_some()) {
            let point = self.point_of_alternative(other);
            let (theirs, spread) = self.response_of(&point, &other.covariance, input, controller);
            hold(&theirs, &spread);
        }
        if own.is_some() {
            for theirs in self.responses_from_farthest_rests(input, controller) {
                hold(&theirs, &spread);
            }
        }
        let travel = self.commands.map_or(f64::INFINITY, |commands| {
            2.0 * commands.amplitude() * self.parameters(controller).gain.abs()
        });
        let half_width = (self.covariance.as_ref())
            .map(|_| half.into_iter().map(|half| half.min(travel)).collect());
        ServoResponse {
            half_width: half_width.unless(self.beyond_record(input, &value, controller)),
            value,
        }
    }

    /// The responses from the two rests that are farthest apart among those under the first command: the shaft at either end of the angles at which it stays, and the output
    /// half the play beyond, as it is where the shaft came from there. None where it has one rest.
    fn responses_from_farthest_rests(&self, input: &[f64], controller: usize) -> Vec<Vec<f64>> {
        let (physics, Some(first)) = (self.parameters(controller), input.first()) else {
            return Vec::new();
        };
        let [low, high] = physics.staying_angles(*first);
        let half_play = physics.half_play();
        let has_rests = low < high || half_play > 0.0;
        let ends = [(low, 1.0), (high, -1.0)].into_iter();
        let from = |(angle, in_play): (f64, f64)| {
            let shown = angle - in_play * half_play;
            let start = Start {
                in_play,
                ..Start::at_rest(shown * physics.gain + physics.offset, Some(*first))
            };
            let mut value = Vec::new();
            let grid = self.grid(self.timing());
            simulate(&physics, &grid, &start, input, |_, y| value.push(y));
            value
        };
        ends.filter(|_| has_rests).map(from).collect()
    }

    /// Sample period and phase.
    fn timing(&self) -> Timing {
        Timing {
            sample_period_s: self.sample_period_s,
            sample_phase_s: self.sample_phase_s,
        }
    }

    /// Why the record says too little of the response `value` to `input`.
    fn beyond_record(&self, input: &[f64], value: &[f64], controller: usize) -> Option<Reason> {
        let servo = self.parameters(controller);
        let is_beyond = |found: f64, recorded: f64| found > SERVO_ERROR_BEYOND_RECORD * recorded;
        let error = largest_error(&servo, input, value);
        let limit = self.quantity(QuantityKind::ErrorOfFullDrive);
        let limit_is_open = limit.is_none_or(|limit| !limit.determined);
        let drive = self.fit.largest_drive.filter(|_| limit_is_open);
        let has_unseen_drive = drive.is_some_and(|recorded| {
            is_beyond(
                largest_drive(&servo, input, value, self.sample_period_s),
                recorded,
            )
        });
        (is_beyond(error, self.fit.largest_error) || has_unseen_drive)
            .then_some(Reason::BeyondRecord)
    }

    /// Response and its standard deviation.
    fn response_of(
        &self,
        point: &Point,
        covariance: &[Vec<f64>],
        input: &[f64],
        controller: usize,
    ) -> (Vec<f64>, Vec<f64>) {
        let physics = point.physics(controller, |i, value| Dual::<MOST>::variable(value, i));
        let (mut value, mut spread) = (Vec::new(), Vec::new());
        let Some(first) = input.first().copied().map(Dual::constant) else {
            return (value, spread);
        };
        let start = start_at_rest(&physics, first);
        let grid = self.grid(self.timing());
        simulate(&physics, &grid, &start, input, |_, y| {
            value.push(y.value);
            spread.push(not_negative(quadratic(covariance, &y.slope)).sqrt());
        });
        (value, spread)
    }

    /// The same with an interval of the delay that allows for output that was recorded up to `seconds` earlier or later than it
    /// is taken for. The covariance is that of the noise alone.
    #[must_use]
    pub fn with_delay_error(mut self, seconds: f64) -> Self {
        if seconds > 0.0 {
            let delay = self.quantity(QuantityKind::Delay);
            self.delay_by_noise = delay.and_then(|delay| delay.interval.valid().copied());
        }
        widen_delay(&mut self.quantities, seconds);
        self
    }

    /// The servo of a record whose commands are at pulses that were found by its motion. What they leave open of the delay is in its covariance, and in those of the servos that are possible as well: with it, responses and draws have it, too.
    #[must_use]
    pub fn behind_pulses(mut self, waits: WaitsForPulses) -> Self {
        // Nothing says where between its ends, so that two standard deviations have them.
        let variance = (0.5 * waits.delay_error_s).powi(2);
        let add = |coordinates: &[Coordinate], rows: &mut [Vec<f64>]| {
            let delay = coordinates.iter().position(|at| *at == Coordinate::Delay);
            if let Some(own) = delay.and_then(|at| rows.get_mut(at)?.get_mut(at)) {
                *own += variance;
            }
        };
        if let Bounds::Valid(covariance) = &mut self.covariance {
            add(&self.coordinates, &mut covariance.rows);
        }
        for other in &mut self.alternatives {
            add(&other.coordinates, &mut other.covariance);
        }
        widen_delay(&mut self.quantities, waits.delay_error_s);
        self.fit.waits_for_pulses = Some(waits);
        self
    }

    /// The same servo without friction, for which late commands pass.
    #[must_use]
    pub fn without_friction(mut self) -> Self {
        for (coordinate, value) in self.coordinates.iter().zip(&mut self.values) {
            if coordinate.is_of_friction() {
                *value = 0.0;
            }
        }
        self
    }

    /// The same servo with a delay that is so many `seconds` shorter, or none.
    #[must_use]
    pub fn sooner(mut self, seconds: f64) -> Self {
        let delay = (self.coordinates.iter()).position(|at| *at == Coordinate::Delay);
        if let Some(delay_s) = delay.and_then(|at| self.values.get_mut(at)) {
            *delay_s = (*delay_s - seconds).max(0.0);
        }
        self
    }

    /// The output of each run of a record, simulated from its input and its first samples. NaN where an input is missing,
    /// until the motion is known again. `controllers` has the controller of each run; without it, all have the first. The model is
    /// continuous in time, so the record may have any sample period. Where the offset differed between the runs that it was found
    /// from, that of another run is not known: it is taken from the run itself, so that its errors have the mean zero.
    #[must_use]
    pub fn simulate(&self, record: &Record, controllers: &[usize]) -> Vec<Vec<f64>> {
        let mut point = self.point();
        let grid = self.grid(record.timing());
        let (mut parts, _) = stretches(record, controllers);
        if self.run_offsets.is_empty() {
            find_starts(&mut parts, &point, &grid);
        } else {
            run_offsets::find(&mut point, &mut parts, &grid, record.runs().len());
        }
        let unknown = |run: &Run| vec![f64::NAN; run.len()];
        let mut outputs: Vec<Vec<f64>> = record.runs().iter().map(unknown).collect();
        for part in &parts {
            let physics = point.servo_of(part, |_, value| value);
            let output = &mut outputs[part.run][part.first..];
            simulate(&physics, &grid, &part.start, part.commands(), |k, y| {
                output[k] = y;
            });
        }
        outputs
    }

    /// Simulates every run of a record that the model has not seen, from its input and its first samples, and compares.
    ///
    /// # Errors
    /// The record has no sample that can be compared.
    pub fn validate(&self, record: &Record, controllers: &[usize]) -> Result<Validation, Error> {
        let simulated = self.simulate(record, controllers);
        let pairs = record.outputs().zip(simulated.into_iter().flatten());
        Validation::of_pairs(pairs).ok_or(Error::NoHistory { history: 1 })
    }

    /// Whether its parts fit together: a document may say anything.
    #[must_use]
    pub fn is_consistent(&self) -> bool {
        let square = |rows: &[Vec<f64>], size: usize| {
            rows.len() == size
                && rows
                    .iter()
                    .all(|row| row.len() == size && row.iter().all(|x| x.is_finite()))
        };
        let sized = |terms: Terms, coordinates: &[Coordinate], values: &[f64]| {
            coordinates == terms.coordinates(self.controllers)
                && values.len() == coordinates.len()
                && values.iter().all(|value| value.is_finite())
        };
        let own = self
            .covariance
            .valid()
            .is_none_or(|own| square(&own.rows, self.values.len()));
        let other = |other: &Alternative| {
            sized(other.terms, &other.coordinates, &other.values)
                && other.friction_speed_share > 0.0
                && square(&other.covariance, other.values.len())
        };
        self.sample_period_s > 0.0
            && (1..=MOST_CONTROLLERS).contains(&self.controllers)
            && self.radians_per_command.is_finite()
            && self.radians_per_output.is_none_or(f64::is_finite)
            && self.stops.have_travel()
            && (self.pulse_end)
                .is_none_or(|end| end.later_s(0.0).is_finite() && end.s_per_command.is_finite())
            && self.friction_speed_share > 0.0
            && sized(self.terms, &self.coordinates, &self.values)
            && own
            && self.alternatives.iter().all(other)
            && self.is_of_one_validity()
    }

    /// Whether all parts have bounds, or none for one reason. Withdrawn models of older files have a discrepancy all the same.
    fn is_of_one_validity(&self) -> bool {
        let own = self.covariance.as_ref().map(|_| ());
        let has_bounds = own.valid().is_some();
        let of_quantity = |quantity: &Quantity| quantity.interval.as_ref().map(|_| ()) == own;
        self.quantities.iter().all(of_quantity)
            && (has_bounds || self.alternatives.is_empty())
            && (!has_bounds || self.fit.discrepancy.is_some_and(f64::is_finite))
    }

    /// How well the linear model predicts where it predicts better than the servo model, by as much as matters and on most of
    /// the samples \[%\].
    #[must_use]
    pub fn better_linear_percent(&self) -> Option<f64> {
        let found = self.linear_models.as_ref()?;
        let percent = found.percent_of(LinearKind::Linear)?;
        let better = percent > found.servo_model_percent + LINEAR_MODEL_ADVANTAGE;
        let most = 2 * found.samples_used > self.fit.samples_used;
        (better && most).then_some(percent)
    }

    /// How well the linear model and this one predict parts that they have not seen \[%\], where this one predicts its recording, and better.
    #[must_use]
    pub fn beyond_linear_percent(&self) -> Option<[f64; 2]> {
        let found = self.linear_models.as_ref().filter(|_| self.predicts())?;
        let linear = found.percent_of(LinearKind::Linear)?;
        let own = found.servo_model_percent;
        (own > linear + LINEAR_MODEL_ADVANTAGE).then_some([linear, own])
    }

    /// Whether the recording shows that its stops are stops: several commands beyond each end there. One command alone ends short of itself
    /// before a load, too, and by friction, and all of them do so before a load that stalls the drive.
    #[must_use]
    pub fn shows_its_stops(&self) -> bool {
        self.covariance.withdrawn() != Some(Reason::TravelEndOpen)
    }

    /// Whether the servo is linear: no term but delay, stiffness and damping helps prediction.
    #[must_use]
    pub fn is_linear(&self) -> bool {
        self.terms == Terms::default()
    }
}

/// s'Cs.
fn quadratic(rows: &[Vec<f64>], slopes: &[f64]) -> f64 {
    let row =
        |(row, a): (&Vec<f64>, &f64)| a * row.iter().zip(slopes).map(|(c, b)| c * b).sum::<f64>();
    rows.iter().zip(slopes).map(row).sum()
}
