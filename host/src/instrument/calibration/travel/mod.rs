//! Where neutral is, how far a microsecond turns the servo, and where its travel ends.
//!
//! A slow staircase goes from neutral to one limit and back, then to the other one and back. Through the
//! readings goes a line that may break at a knee on each side,
//!
//! ```text
//!  counts = c0 + b clamp(x, low, high) + b_low min(x - low, 0) + b_high max(x - high, 0) + error
//! ```
//!
//! with x = pulse - neutral, by least squares over both knees. A knee is there where the line without it is
//! worse by more than scatter explains: F(2, ν) on the sums of squares, ν = readings - 6. Its interval is
//! where the sum of squares stays within F(1, ν) of its minimum (the profile likelihood of a change point:
//! D. V. Hinkley, *Inference in two-phase regression*, JASA 66, 1971). A servo that a load stalls answers less and less before it stands still, which
//! is no straight line: so the interval of a stop also holds the levels between which it stops moving. Where it stands still, finer
//! levels between these follow on the way back. Whether the servo stops there or
//! only answers less is judged by the slope beyond it, over all places in the interval of the knee.

use super::knee;
use super::measured_value::{Estimate, LEVEL, student};
use super::mover::{MoveError, Mover, Rest};
use crate::data::rig_file::{RigFile, SensorSection};
use crate::data::sensor_preset::range_counts;
use serde::Serialize;
use servoid_identification::results::pointwise_critical;

/// Levels on each side of neutral.
const LEVELS: u16 = 8;

/// A slope beyond a knee that is surely below this part of the slope before it is an end.
pub(super) const STANDS_STILL: f64 = 0.25;

/// A knee beyond which less than this part of the way is lost is none: no servo is straighter.
const SLIGHT: f64 = 0.02;

/// How the travel ends on one side.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum End {
    /// It does not end within the limits.
    NotWithin {
        /// The limit (µs).
        limit_us: u16,
        /// The angle there (deg).
        angle_deg: f64,
    },
    /// The servo goes no further.
    Stops {
        /// The pulse from which on it stands still (µs).
        at_us: Estimate,
        /// Where it stands (deg).
        angle_deg: Estimate,
    },
    /// From there on it answers less, and does not stop.
    Softens {
        /// From about this pulse on (µs).
        from_us: Estimate,
        /// The gain there, of that around neutral (percent).
        gain_percent: Estimate,
    },
    /// From there on it answers more: what is nearer to neutral answers less, by load, friction or linkage.
    AnswersMore {
        /// From about this pulse on (µs).
        from_us: Estimate,
        /// The gain there, of that around neutral (percent).
        gain_percent: Estimate,
    },
    /// The sensor's range ends; the servo may go on.
    SensorEnds {
        /// The outermost pulse at which the sensor still follows (µs).
        before_us: u16,
        /// Its reading at the end of its range (counts).
        counts: f64,
        /// The angle there (deg).
        angle_deg: f64,
    },
    /// It stops or answers less; the readings beyond do not determine which.
    Unclear {
        /// From about this pulse on (µs).
        from_us: Estimate,
    },
}

impl End {
    /// The outermost pulse before the servo stops, whole microseconds inwards of the interval, or before its sensor does (µs); `None` where neither
    /// stops.
    fn before_stop_us(&self, side: knee::Side) -> Option<u16> {
        match (self, side) {
            (Self::Stops { at_us, .. }, knee::Side::Low) => Some(at_us.upper.ceil() as u16),
            (Self::Stops { at_us, .. }, knee::Side::High) => Some(at_us.lower.floor() as u16),
            (Self::SensorEnds { before_us, .. }, _) => Some(*before_us),
            _ => None,
        }
    }
}

/// The result of a slow staircase.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Travel {
    /// The pulse at neutral (µs).
    pub neutral_us: u16,
    /// The sensor there (counts).
    pub neutral_counts: Estimate,
    /// The angle there (deg), the uncertainty of the sensor included.
    pub neutral_deg: Estimate,
    /// Change of the pulse for one degree (µs/deg), the uncertainty of the sensor included.
    pub us_per_degree: Estimate,
    /// On the side of the shortest pulse.
    pub short_end: End,
    /// On the side of the longest pulse.
    pub long_end: End,
    /// The reading farthest from the line (deg): dead band, friction, and what is not straight.
    pub largest_residual_deg: f64,
    /// The readings, in their order.
    pub rests: Vec<Rest>,
}

/// Why a staircase has no result.
#[derive(Debug, thiserror::Error)]
pub enum TravelError {
    /// It could not be made.
    #[error(transparent)]
    Move(#[from] MoveError),
    /// The servo stays where it is.
    #[error(
        "the servo does not follow the pulses: between {shortest} and {longest} µs the sensor's reading changes by {counts:.0} counts, which is {degrees:.1} degrees on the scale of the sensor; look at the servo's supply, its signal wire, whether the sensor sits on its shaft, and at that scale: angles that were stated too small make it so"
    )]
    StandsStill {
        /// The shortest pulse of the readings (µs).
        shortest: u16,
        /// The longest one (µs).
        longest: u16,
        /// How far apart the readings are (counts).
        counts: f64,
        /// The same in degrees.
        degrees: f64,
    },
    /// Neutral is at a limit, or next to it.
    #[error(
        "the limits of the rig file leave no room on both sides of neutral for a staircase: {0} to {1} µs"
    )]
    NoRoom(u16, u16),
}

/// The pulses of one side's staircase, from neutral to the limit and back (µs).
fn staircase(neutral: u16, limit: u16) -> Vec<u16> {
    let level = |k: u16| {
        let way = f64::from(limit) - f64::from(neutral);
        (f64::from(neutral) + way * f64::from(k) / f64::from(LEVELS)).round() as u16
    };
    (0..=LEVELS).chain((0..LEVELS).rev()).map(level).collect()
}

/// Whether the servo moved from one level to the next by more than `share` of what it should.
fn moved(pair: &[Rest], counts_per_us: f64, share: f64) -> bool {
    let [a, b] = pair else { return true };
    let wanted = (f64::from(b.pulse_us) - f64::from(a.pulse_us)) * counts_per_us;
    (b.counts - a.counts).abs() >= share * wanted.abs()
}

/// Whether the servo has stood still for two levels in a row: pushing it further could do harm.
fn stands_still(rests: &[Rest], counts_per_us: f64) -> bool {
    let outwards = rests.len() <= usize::from(LEVELS) + 1;
    let mut last = rests.windows(2).rev().take(2);
    outwards && rests.len() > 2 && last.all(|pair| !moved(pair, counts_per_us, STANDS_STILL))
}

/// The way from the end of the levels `outwards` to neutral (µs): over the same levels, and where the servo stood still at the last of them, in finer
/// ones where it stopped, there and back, so that play is in them as in the others. `None` where that adds none.
fn finer_back(outwards: &[Rest], counts_per_us: f64) -> Option<Vec<u16>> {
    let mut pairs = outwards.windows(2);
    let moved_last = pairs.rposition(|pair| moved(pair, counts_per_us, STANDS_STILL));
    let stood_beyond = moved_last.filter(|index| index + 2 < outwards.len())?;
    let mut pulses = Vec::new();
    for (index, pair) in outwards.windows(2).enumerate().rev() {
        let [inner, outer] = pair else { continue };
        let way = f64::from(inner.pulse_us) - f64::from(outer.pulse_us);
        let level = |k: u16| {
            (f64::from(outer.pulse_us) + way * f64::from(k) / f64::from(LEVELS)).round() as u16
        };
        let is_end = index == stood_beyond
            || index == stood_beyond + 1 && moved(pair, counts_per_us, SLIGHT);
        if is_end {
            pulses.extend((1..=LEVELS).chain((0..LEVELS).rev()).map(level));
        }
        pulses.push(inner.pulse_us);
    }
    Some(pulses)
}

impl Travel {
    /// The shortest and the longest pulse that do not push the servo against a stop, where it stops (µs).
    #[must_use]
    pub fn before_stops_us(&self) -> [Option<u16>; 2] {
        [
            self.short_end.before_stop_us(knee::Side::Low),
            self.long_end.before_stop_us(knee::Side::High),
        ]
    }

    /// Makes the staircase and evaluates it; `sensor` turns counts into degrees. On a side on which
    /// the servo stands still for two levels in a row the staircase turns back there.
    pub fn measure(mover: &mut Mover<'_>, sensor: &SensorSection) -> Result<Self, TravelError> {
        let RigFile { servo, limits, .. } = mover.rig().clone();
        let [shortest, longest] = [limits.shortest_us, limits.longest_us];
        if longest.saturating_sub(servo.neutral_us) < LEVELS
            || servo.neutral_us.saturating_sub(shortest) < LEVELS
        {
            return Err(TravelError::NoRoom(shortest, longest));
        }
        let counts_per_us = 1.0 / (servo.us_per_degree * sensor.degrees_per_count);
        let mut rests = Vec::new();
        for limit in [longest, shortest] {
            let levels = staircase(servo.neutral_us, limit);
            let seen = mover.visit(&levels, &|rests| stands_still(rests, counts_per_us))?;
            let outwards = seen.get(..=usize::from(LEVELS)).unwrap_or(&seen);
            let finer = finer_back(outwards, counts_per_us);
            // The first position is reached from inside, and has been read.
            let end = outwards.last().map(|rest| rest.pulse_us);
            let back: Vec<u16> = end.into_iter().chain(finer.into_iter().flatten()).collect();
            rests.extend(seen);
            if back.len() > 1 {
                rests.extend(mover.visit(&back, &|_| false)?.into_iter().skip(1));
            }
        }
        Self::of(rests, servo.neutral_us, [shortest, longest], sensor)
    }

    /// The result of readings that go to both sides of `neutral_us`.
    ///
    /// # Errors
    /// [`TravelError::StandsStill`], also where there are fewer than twelve readings.
    pub fn of(
        rests: Vec<Rest>,
        neutral_us: u16,
        limits_us: [u16; 2],
        sensor: &SensorSection,
    ) -> Result<Self, TravelError> {
        let offset = |pulse_us: u16| f64::from(pulse_us) - f64::from(neutral_us);
        let point = |rest: &Rest| (offset(rest.pulse_us), rest.counts);
        let points: Vec<(f64, f64)> = rests.iter().map(point).collect();
        let stands_still = || {
            let pulses = || rests.iter().map(|rest| rest.pulse_us);
            let counts = |pick: fn(f64, f64) -> f64| rests.iter().map(|r| r.counts).reduce(pick);
            let counts = counts(f64::max).unwrap_or(0.0) - counts(f64::min).unwrap_or(0.0);
            TravelError::StandsStill {
                shortest: pulses().min().unwrap_or(neutral_us),
                longest: pulses().max().unwrap_or(neutral_us),
                counts,
                degrees: (counts * sensor.degrees_per_count).abs(),
            }
        };
        let line = knee::Line::through(&points).ok_or_else(stands_still)?;
        let normal = pointwise_critical(LEVEL);
        let t = student(line.degrees_of_freedom);
        let slope_half = t * line.slope_se;
        if line.slope.abs() <= slope_half || !slope_half.is_finite() {
            return Err(stands_still());
        }
        let zero_half = t * line.zero_se;
        let us_per_degree = 1.0 / (line.slope * sensor.degrees_per_count);
        // Errors of the line and of the sensor are independent.
        let relative = (slope_half / line.slope).hypot(normal * sensor.scale_sd_percent / 100.0);
        let zero_deg = (zero_half * sensor.degrees_per_count).hypot(normal * sensor.zero_sd_deg);
        let view = View {
            line: &line,
            points: &points,
            neutral_us,
            t,
            sensor,
            rests: &rests,
        };
        Ok(Self {
            neutral_us,
            neutral_counts: Estimate::around(line.zero, zero_half),
            neutral_deg: Estimate::around(degrees(sensor, line.zero), zero_deg),
            us_per_degree: Estimate::around(us_per_degree, (us_per_degree * relative).abs()),
            short_end: view.end(knee::Side::Low, limits_us[0]),
            long_end: view.end(knee::Side::High, limits_us[1]),
            largest_residual_deg: line.largest_residual * sensor.degrees_per_count.abs(),
            rests,
        })
    }
}

/// The angle of a reading, which may be a mean (deg).
fn degrees(sensor: &SensorSection, counts: f64) -> f64 {
    (counts - sensor.zero_counts) * sensor.degrees_per_count
}

/// A fitted line, and the data by which its ends are judged.
struct View<'a> {
    line: &'a knee::Line,
    points: &'a [(f64, f64)],
    neutral_us: u16,
    /// Student's t at [`LEVEL`].
    t: f64,
    sensor: &'a SensorSection,
    rests: &'a [Rest],
}

impl View<'_> {
    /// The interval of a stop, which holds the levels between which the servo stops moving.
    fn with_last_motion(&self, side: knee::Side, at_us: Estimate) -> Estimate {
        let moved = self.line.last_motion(self.points, side, STANDS_STILL);
        let us = moved.map(|pair| pair.map(|offset| f64::from(self.neutral_us) + offset));
        let [a, b] = us.unwrap_or([at_us.value; 2]);
        Estimate {
            value: at_us.value.clamp(a.min(b), a.max(b)),
            lower: at_us.lower.min(a).min(b),
            upper: at_us.upper.max(a).max(b),
        }
    }

    /// The end of the sensor's range, where it is reached on the side of `outermost`: there the mean reading is within the noise of it.
    fn sensor_end(&self, outermost: f64) -> Option<End> {
        let [low, high] = range_counts(self.sensor)?;
        let noise = self.rests.iter().map(|rest| rest.sd_counts);
        let noise = noise.fold(0.0, f64::max);
        let is_at_end = |rest: &&Rest| rest.counts < low + noise || rest.counts > high - noise;
        let offset = |rest: &Rest| f64::from(rest.pulse_us) - f64::from(self.neutral_us);
        let on_side = |rest: &&Rest| offset(rest) * outermost >= 0.0;
        let farthest = |a: &&Rest, b: &&Rest| offset(a).abs().total_cmp(&offset(b).abs());
        let own = || self.rests.iter().filter(on_side);
        let end = own().filter(is_at_end).min_by(farthest)?;
        let before = own().filter(|rest| !is_at_end(rest)).max_by(farthest)?;
        Some(End::SensorEnds {
            before_us: before.pulse_us,
            counts: end.counts,
            angle_deg: degrees(self.sensor, end.counts),
        })
    }

    fn end(&self, side: knee::Side, limit_us: u16) -> End {
        let us = |offset: f64| f64::from(self.neutral_us) + offset;
        let outermost = side.outermost(self.points);
        let not_within = End::NotWithin {
            limit_us,
            angle_deg: degrees(self.sensor, self.line.at(outermost)),
        };
        let Some(knee) = self.line.knee(self.points, side, LEVEL, self.t) else {
            return not_within;
        };
        if (outermost - knee.at).abs() < SLIGHT * outermost.abs() {
            return not_within;
        }
        if let Some(end) = self.sensor_end(outermost) {
            return end;
        }
        let from_us = Estimate {
            value: us(knee.at),
            lower: us(knee.interval[0]),
            upper: us(knee.interval[1]),
        };
        let [least, most] = knee.gain;
        let gain_percent = Estimate {
            value: 50.0 * (least + most),
            lower: 100.0 * least,
            upper: 100.0 * most,
        };
        if -STANDS_STILL < least && most < STANDS_STILL {
            let [counts, half] = knee.beyond;
            let zero_half = pointwise_critical(LEVEL) * self.sensor.zero_sd_deg;
            let half = (half * self.sensor.degrees_per_count).hypot(zero_half);
            End::Stops {
                at_us: self.with_last_motion(side, from_us),
                angle_deg: Estimate::around(degrees(self.sensor, counts), half),
            }
        } else if least <= STANDS_STILL {
            End::Unclear { from_us }
        } else if most < 1.0 {
            End::Softens {
                from_us,
                gain_percent,
            }
        } else if least > 1.0 {
            End::AnswersMore {
                from_us,
                gain_percent,
            }
        } else {
            // It may be the same gain on both sides of the knee.
            not_within
        }
    }
}

#[cfg(test)]
mod tests;
