//! Where the descent begins: values that the record shows, and a coarse grid of those that it does not.
//!
//! The surface has poor minima, such as a long delay in place of a slow drive. From a few dozen points of a coarse grid,
//! with a few steps each, the good valley is found.

use super::coordinates::{ArmTurn, Coordinate, FRICTION_SPEED_SHARE, Point, Terms};
use super::fit::Problem;
use crate::servo_model::stretches::Stretch;
use servoid_dynamics::{PulseEnd, Stops};

/// Descents that are continued after the grid.
const CONTINUED: usize = 3;

/// Steps of each descent on the grid, and of those that are continued.
const STEPS: (usize, usize) = (4, 20);

/// Time over which a stroke's speed is measured \[s\].
const STROKE_S: f64 = 0.04;

/// Time in which a servo comes to its speed \[s\], of one of which nothing else is known.
const SPEED_AFTER_S: f64 = 0.02;

/// What a record shows before any fit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown {
    /// Standard deviation of the output.
    pub(crate) output_sd: f64,
    /// Sum of the squares of the output about its mean.
    pub(crate) output_square: f64,
    /// The same in units of the command.
    pub(crate) spread: f64,
    /// Mean of the command.
    pub(crate) middle: f64,
    /// Output for each unit of the command, with its sign.
    pub(crate) gain: f64,
    /// Output at command 0.
    offset: f64,
    /// Speed of the steepest strokes \[units of the command for each second\].
    pub(super) top_speed: f64,
    /// The stops.
    pub(crate) stops: Stops,
    /// Whether the servo knows a pulse at its end.
    pub(crate) pulse_end: Option<PulseEnd>,
    /// Sample period \[s\].
    period_s: f64,
}

/// The largest but one in 200: the largest of all may be a glitch.
fn nearly_largest(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let index = values.len().checked_sub(1 + values.len() / 200)?;
    values.get(index).copied()
}

impl Shown {
    pub(crate) fn by(stretches: &[Stretch], period_s: f64) -> Self {
        let pairs = || {
            stretches
                .iter()
                .flat_map(|s| s.input.iter().zip(&s.output))
                .filter(|(_, y)| !y.is_nan())
        };
        let count = pairs().count() as f64;
        let mean = |of: &dyn Fn((&f64, &f64)) -> f64| pairs().map(of).sum::<f64>() / count;
        let (u, y) = (mean(&|(u, _)| *u), mean(&|(_, y)| *y));
        let output_sd = mean(&|(_, b)| (b - y).powi(2)).sqrt();
        let gain = strongest_slope(stretches, u, y);
        let lag = ((STROKE_S / period_s).ceil() as usize).max(1);
        let stroke = |y: &[f64]| (y[lag] - y[0]) / (lag as f64 * period_s);
        let windows = stretches.iter().flat_map(|s| s.output.windows(lag + 1));
        let speeds = windows.map(stroke).filter(|v| v.is_finite());
        let speed = nearly_largest(speeds.map(f64::abs))
            .filter(|v| *v > 0.0)
            .unwrap_or(output_sd / period_s);
        Self {
            output_sd,
            output_square: output_sd * output_sd * count,
            spread: output_sd / gain.abs(),
            middle: u,
            gain,
            offset: y - gain * u,
            top_speed: speed / gain.abs(),
            stops: Stops::default(),
            pulse_end: None,
            period_s,
        }
    }

    /// The same with stops.
    pub(crate) fn with_stops(self, stops: Stops) -> Self {
        Self { stops, ..self }
    }

    /// The same of a servo that knows a pulse at its end.
    pub(crate) fn with_pulse_end(self, pulse_end: Option<PulseEnd>) -> Self {
        Self { pulse_end, ..self }
    }

    /// A value for a coordinate that a servo did not have before.
    pub(crate) fn fresh(&self, coordinate: Coordinate, arm: ArmTurn) -> f64 {
        match coordinate {
            Coordinate::DeadBand => 0.005 * self.spread,
            Coordinate::Play => 0.01 * self.spread,
            Coordinate::Friction => 0.01 * self.spread,
            Coordinate::FrictionAtRest => 0.3,
            Coordinate::FrictionOfGears => 0.1,
            Coordinate::LnTopSpeed | Coordinate::LnSpeedLimit => self.top_speed.ln(),
            Coordinate::LnAcceleration => (self.top_speed / SPEED_AFTER_S).ln(),
            Coordinate::MotorShare => 0.5,
            Coordinate::Spring => 0.05,
            Coordinate::Gravity => {
                0.01 * self.spread / (self.spread * arm.radians(self.gain)).min(1.0).sin()
            }
            Coordinate::GravityFrom => -self.middle,
            Coordinate::AirStiffening => 0.01 / self.spread,
            Coordinate::AirFrom => self.middle - 0.5 * self.spread,
            _ => 0.0,
        }
    }

    /// A linear servo of the bandwidth `bandwidth` (rad/s).
    fn servo(
        &self,
        terms: Terms,
        controllers: usize,
        bandwidth: f64,
        delay_s: f64,
        (arm, run_offsets): (ArmTurn, &[f64]),
    ) -> Point {
        let coordinates = terms.coordinates(controllers);
        let value = |at: &Coordinate| match at {
            Coordinate::Delay => delay_s,
            Coordinate::LnStiffness => 2.0 * bandwidth.ln(),
            Coordinate::LnDamping => (1.5 * bandwidth).ln(),
            Coordinate::Gain => self.gain,
            Coordinate::Offset => self.offset,
            other => self.fresh(*other, arm),
        };
        Point {
            terms,
            values: coordinates.iter().map(value).collect(),
            coordinates,
            arm,
            friction_speed_share: FRICTION_SPEED_SHARE,
            run_offsets: run_offsets.to_vec(),
            stops: self.stops,
            pulse_end: self.pulse_end,
        }
    }
}

/// The slope of the output over the input, at the lag at which it explains most.
fn strongest_slope(stretches: &[Stretch], mean_u: f64, mean_y: f64) -> f64 {
    let mut best = (0.0, 1.0);
    // Lags of 1, 2, 4, .. samples: the command leads by the delay and about a rise time.
    for lag in (0..10).map(|power| (1usize << power) - 1) {
        let (mut product, mut inputs, mut outputs) = (0.0, 0.0, 0.0);
        for stretch in stretches.iter().filter(|s| s.input.len() > lag) {
            let pairs = stretch.input.iter().zip(&stretch.output[lag..]);
            for (u, y) in pairs.filter(|(_, y)| !y.is_nan()) {
                product += (u - mean_u) * (y - mean_y);
                inputs += (u - mean_u).powi(2);
                outputs += (y - mean_y).powi(2);
            }
        }
        let explained = product * product / (inputs * outputs);
        if explained > best.0 {
            best = (explained, product / inputs);
        }
    }
    best.1
}

/// The best servo with these terms that is found from the grid. `terms` has no more than a limit and two speeds; `own` are how far
/// an arm turns and the offsets of the runs.
pub(crate) fn search(
    problem: &Problem<'_>,
    shown: &Shown,
    terms: Terms,
    controllers: usize,
    own: (ArmTurn, &[f64]),
) -> Point {
    let mut found: Vec<(f64, Point)> = grid(shown, terms, controllers, own)
        .into_iter()
        .map(|mut point| (problem.descend(&mut point, STEPS.0), point))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(CONTINUED);
    for (cost, point) in &mut found {
        *cost = problem.descend(point, STEPS.1);
    }
    let best = found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    best.expect("the grid has points").1
}

/// The servo `point`, and others of the same terms in which a descent from it may not end: with shorter and longer delays, since
/// a delay in place of a slow drive is the commonest poor minimum, and with little friction at rest.
pub(crate) fn other_starts(point: &Point, problem: &Problem<'_>, shown: &Shown) -> Vec<Point> {
    let with = |coordinate: Coordinate, value: f64| {
        let mut other = point.clone();
        other.set(coordinate, value);
        other
    };
    let delay_s = point.get(Coordinate::Delay).unwrap_or(0.0);
    let mut starts = vec![point.clone()];
    for (factor, more_s) in [(0.5, 0.0), (0.75, 0.0), (1.25, 0.003), (1.5, 0.006)] {
        let other_s = factor * delay_s + more_s;
        starts.push(with(
            Coordinate::Delay,
            other_s.min(problem.longest_delay_s),
        ));
    }
    if point.terms.friction {
        let at_rest = Coordinate::FrictionAtRest;
        starts.push(with(at_rest, shown.fresh(at_rest, point.arm)));
    }
    starts
}

/// Bandwidths from slow to fast, short and long delays, and for a limited drive the top speed below and above the
/// steepest stroke, with more or less of the damping in the motor, and far above it with hardly any: a motor that only its acceleration limits.
fn grid(shown: &Shown, terms: Terms, controllers: usize, own: (ArmTurn, &[f64])) -> Vec<Point> {
    let mut points = Vec::new();
    for bandwidth in [2.0, 6.0, 16.0, 40.0, 90.0] {
        for delay_s in [0.5 * shown.period_s, 0.03] {
            let servo = shown.servo(terms, controllers, bandwidth, delay_s, own);
            if !terms.limit {
                points.push(servo);
                continue;
            }
            for (factor, share) in [(0.6, 0.9), (1.2, 0.3), (1.2, 0.9), (8.0, 0.05)] {
                let mut limited = servo.clone();
                limited.set(Coordinate::LnTopSpeed, (factor * shown.top_speed).ln());
                limited.set(Coordinate::MotorShare, share);
                points.push(limited);
            }
        }
    }
    points
}
