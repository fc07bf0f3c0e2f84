//! A servo whose drive is at its limit during most of a stroke.
//!
//! θ'' = A sat(k e - d θ') - (A/v) θ' for the distance e to the command: a drive of acceleration A and no-load speed v, behind a controller. Under
//! strokes of one size, from rest to rest, it has one response, which is no servo's of linear dynamics.

use faer::c64;

/// Stroke whose response it is \[deg\].
pub const STROKE: f64 = 16.0;

/// Of a small analog servo \[deg/s², deg/s\].
const ACCELERATION: f64 = 9000.0;
const NO_LOAD_SPEED: f64 = 330.0;

/// Of the controller: so much of the drive for each degree, and for each degree per second.
const PER_DEG: f64 = 0.336;
const PER_DEG_S: f64 = 0.0061;

/// Between points of the response, between which it is a line \[s\], and of them.
const POINT_S: f64 = 0.0005;
const POINTS: usize = 800;

/// Steps of the integration from point to point.
const STEPS: usize = 50;

/// The response to a stroke, for a command of one.
#[derive(Debug, Clone)]
pub struct LimitedDrive {
    pub gain: f64,
    delay_s: f64,
    /// Each [`POINT_S`] from the end of the delay on, as a share of the final value.
    points: Vec<f64>,
}

impl LimitedDrive {
    /// With so many times the usual acceleration and no-load speed, as another supply gives.
    #[must_use]
    pub fn new(gain: f64, delay_s: f64, drive: f64) -> Self {
        let acceleration = ACCELERATION * drive;
        let dt = POINT_S / STEPS as f64;
        let (mut position, mut speed) = (0.0, 0.0);
        let points = (0..POINTS).map(|_| {
            let now = position / STROKE;
            for _ in 0..STEPS {
                let wanted = PER_DEG * (STROKE - position) - PER_DEG_S * speed;
                let force = acceleration * wanted.clamp(-1.0, 1.0);
                let next = speed + dt * (force - ACCELERATION / NO_LOAD_SPEED * speed);
                position += dt * f64::midpoint(speed, next);
                speed = next;
            }
            now
        });
        Self {
            gain,
            delay_s,
            points: points.collect(),
        }
    }

    /// Response to a unit step at time zero.
    #[must_use]
    pub fn step(&self, t: f64) -> f64 {
        let place = ((t - self.delay_s) / POINT_S).max(0.0);
        let at = |i: usize| self.points.get(i).copied().unwrap_or(1.0);
        let (before, after) = (at(place as usize), at(place as usize + 1));
        self.gain * (before + place.fract() * (after - before))
    }

    /// That of the lines between the points: each moves evenly for its half millisecond.
    #[must_use]
    pub fn response(&self, omega: f64) -> c64 {
        let half = omega * POINT_S / 2.0;
        let even = match half.abs() > 0.0 {
            true => half.sin() / half,
            false => 1.0,
        };
        let turn = |angle: f64| c64::new(angle.cos(), -angle.sin());
        let mut at = turn(omega * self.delay_s + half);
        let step = turn(2.0 * half);
        let mut sum = c64::new(0.0, 0.0);
        for pair in self.points.windows(2) {
            sum += at * (pair[1] - pair[0]);
            at *= step;
        }
        sum * (even * self.gain)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// It is at rest within the points, moves at nearly its no-load speed meanwhile, and its response at rest is its gain.
    #[test]
    fn it_is_at_its_limit_and_comes_to_rest() {
        let servo = LimitedDrive::new(0.97, 0.005, 1.0);
        assert!((servo.step(0.4) - 0.97).abs() < 1e-6, "{}", servo.step(0.4));
        assert!(servo.step(0.005) == 0.0 && servo.step(0.006) > 0.0);
        let slope = |k: usize| (servo.points[k + 1] - servo.points[k]) * STROKE / POINT_S;
        let top = (0..POINTS - 1).map(slope).fold(0.0, f64::max);
        assert!((0.6..1.0).contains(&(top / NO_LOAD_SPEED)), "{top}");
        let at_rest = servo.response(0.0);
        let last = 0.97 * servo.points[POINTS - 1];
        assert!((at_rest.re - last).abs() < 1e-9 && at_rest.im == 0.0);
    }
}
