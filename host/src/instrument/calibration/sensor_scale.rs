//! The sensor's scale from readings at known angles.
//!
//! `counts = zero + angle / scale + error`, by least squares of the readings on the angles, which are
//! taken as exact; the size of the errors follows from the scatter around the line (N. R. Draper and
//! H. Smith, *Applied Regression Analysis*, 1998, §1.4).

use super::measured_value::{LEVEL, student};
use serde::Serialize;
use servoid_identification::results::pointwise_critical;

/// Variance that readings have at least, however straight their line (counts²): a count is the sum of
/// four conversions, each rounded to a whole number, which errs by 1/12 (uniform).
pub(super) const ROUNDING: f64 = 4.0 / 12.0;

/// A reading at a known angle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Reading {
    /// The angle (deg).
    pub angle_deg: f64,
    /// The reading of the sensor there (counts; an average need not be whole).
    pub counts: f64,
}

#[cfg(test)]
impl Reading {
    /// Five, where the sensor has the same counts whatever angles were read.
    pub(super) fn at_five_positions(angles_deg: [f64; 5]) -> Vec<Self> {
        let counts = [7314.2, 7760.1, 8196.3, 8633.0, 9070.7];
        let of = |(angle_deg, counts)| Self { angle_deg, counts };
        angles_deg.into_iter().zip(counts).map(of).collect()
    }
}

/// A sensor's scale, and how sure it is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// How many readings.
    pub readings: usize,
    /// Degrees for one count, negative where counts fall as the angle grows.
    pub degrees_per_count: f64,
    /// The interval of `degrees_per_count` at [`LEVEL`], the smaller end first.
    pub degrees_per_count_interval: [f64; 2],
    /// Reading at 0 degrees (counts).
    pub zero_counts: f64,
    /// Half the width of the interval of `zero_counts` at [`LEVEL`] (counts).
    pub zero_counts_half_width: f64,
    /// Standard deviation to state for the zero (deg). It gives a normal distribution the interval
    /// that Student's t has: few readings make it larger than the standard error.
    pub zero_sd_deg: f64,
    /// Standard deviation to state for the scale (percent of it), likewise.
    pub scale_sd_percent: f64,
    /// The reading farthest from the line (deg): noise and the sensor's nonlinearity together.
    pub largest_residual_deg: f64,
}

/// Why readings give no scale.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// A number that cannot be.
    #[error("angles must lie within ±360 degrees and counts within 0 to 65535")]
    OutOfRange,
    /// Not enough.
    #[error(
        "a scale with its uncertainty needs readings at three different angles or more, and there are {0}"
    )]
    TooFewAngles(usize),
    /// No slope that differs from none.
    #[error(
        "the readings do not follow the angles well enough to show even the direction: look for an angle that was typed wrong; else take angles that are farther apart, or more of them, and look at the sensor's wiring"
    )]
    Flat,
}

impl Calibration {
    /// The line through readings at three different angles or more.
    ///
    /// ```
    /// use servoid::instrument::calibration::{Calibration, Reading};
    /// let readings = [(-20.0, 6008.0), (0.0, 8192.0), (20.0, 10377.0)]
    ///     .map(|(angle_deg, counts)| Reading { angle_deg, counts });
    /// let found = Calibration::fit(&readings)?;
    /// assert!((found.degrees_per_count - 0.009155).abs() < 1e-5);
    /// # Ok::<(), servoid::instrument::calibration::CalibrationError>(())
    /// ```
    pub fn fit(readings: &[Reading]) -> Result<Self, CalibrationError> {
        let usable = |r: &Reading| {
            (-360.0..=360.0).contains(&r.angle_deg) && (0.0..=65535.0).contains(&r.counts)
        };
        if !readings.iter().all(usable) {
            return Err(CalibrationError::OutOfRange);
        }
        let mut angles: Vec<f64> = readings.iter().map(|r| r.angle_deg).collect();
        angles.sort_by(f64::total_cmp);
        angles.dedup();
        if angles.len() < 3 {
            return Err(CalibrationError::TooFewAngles(angles.len()));
        }
        let count = readings.len() as f64;
        let mean = |of: fn(&Reading) -> f64| readings.iter().map(of).sum::<f64>() / count;
        let (angle, counts) = (mean(|r| r.angle_deg), mean(|r| r.counts));
        let sum = |of: &dyn Fn(&Reading) -> f64| readings.iter().map(of).sum::<f64>();
        let spread = sum(&|r| (r.angle_deg - angle).powi(2));
        let slope = sum(&|r| (r.angle_deg - angle) * (r.counts - counts)) / spread;
        let zero = counts - slope * angle;
        let residual = |r: &Reading| r.counts - zero - slope * r.angle_deg;
        let degrees = count - 2.0;
        let scatter = sum(&|r| residual(r).powi(2)) / degrees;
        let variance = scatter.max(ROUNDING);
        let normal = pointwise_critical(LEVEL);
        let t = student(degrees);
        let slope_half = t * (variance / spread).sqrt();
        let zero_half = t * (variance * (1.0 / count + angle * angle / spread)).sqrt();
        // Written so that a slope of zero without scatter is flat, too.
        if slope.abs() <= slope_half || slope.abs() < f64::EPSILON {
            return Err(CalibrationError::Flat);
        }
        let mut interval = [slope - slope_half, slope + slope_half].map(f64::recip);
        interval.sort_by(f64::total_cmp);
        let largest = readings
            .iter()
            .map(|r| residual(r).abs())
            .fold(0.0, f64::max);
        Ok(Self {
            readings: readings.len(),
            degrees_per_count: slope.recip(),
            degrees_per_count_interval: interval,
            zero_counts: zero,
            zero_counts_half_width: zero_half,
            zero_sd_deg: zero_half / normal / slope.abs(),
            scale_sd_percent: 100.0 * slope_half / normal / slope.abs(),
            largest_residual_deg: largest / slope.abs(),
        })
    }

    /// The same scale where all angles may be wrong by one factor, whose standard deviation is `percent`:
    /// that makes no scatter, and the scale is no better known than the factor is.
    #[must_use]
    pub fn with_doubtful_angles(mut self, percent: f64) -> Self {
        let normal = pointwise_critical(LEVEL);
        self.scale_sd_percent = self.scale_sd_percent.hypot(percent);
        let half = (self.degrees_per_count * normal * self.scale_sd_percent / 100.0).abs();
        self.degrees_per_count_interval = [-half, half].map(|half| self.degrees_per_count + half);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    const ANGLES: [f64; 5] = [-20.0, -10.0, 0.0, 10.0, 20.0];

    fn readings(counts: impl Fn(f64) -> f64) -> Vec<Reading> {
        let reading = |angle_deg| Reading {
            angle_deg,
            counts: counts(angle_deg),
        };
        ANGLES.into_iter().map(reading).collect()
    }

    #[test]
    fn a_straight_line_is_found_as_it_is() {
        for slope in [100.0, -109.2] {
            let found = Calibration::fit(&readings(|a| 8000.0 + slope * a)).unwrap();
            // Rounding of numbers of 1e4 counts.
            assert!((found.degrees_per_count * slope - 1.0).abs() < 1e-12);
            assert!((found.zero_counts - 8000.0).abs() < 1e-8);
            assert!(found.largest_residual_deg < 1e-8);
        }
    }

    #[test]
    fn intervals_cover_the_truth_as_often_as_they_say() {
        let (slope, zero, trials) = (-109.2, 8123.4, 2000);
        let mut missed = [0; 2];
        for seed in 0..trials {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let mut noisy = readings(|a| zero + slope * a);
            for reading in &mut noisy {
                let noise: f64 = StandardNormal.sample(&mut random);
                reading.counts += 30.0 * noise;
            }
            let found = Calibration::fit(&noisy).unwrap();
            let [low, high] = found.degrees_per_count_interval;
            let scale: f64 = 1.0 / slope;
            missed[0] += i32::from(!(low..=high).contains(&scale));
            missed[1] += i32::from((found.zero_counts - zero).abs() > found.zero_counts_half_width);
        }
        // Binomial, 2000 trials at 1 %: 20, standard deviation 4.45; four of them to each side.
        assert!(missed.iter().all(|m| (3..=37).contains(m)), "{missed:?}");
    }

    #[test]
    fn what_gives_no_scale_is_said() {
        let fit = |counts: &dyn Fn(f64) -> f64| Calibration::fit(&readings(counts)).unwrap_err();
        assert_eq!(fit(&|_| 8192.0), CalibrationError::Flat);
        assert_eq!(fit(&|a| 8192.0 + a * a), CalibrationError::Flat);
        assert_eq!(fit(&|_| -1.0), CalibrationError::OutOfRange);
        assert_eq!(fit(&|_| f64::NAN), CalibrationError::OutOfRange);
        let two = &readings(|a| 8000.0 + a)[..2];
        let twice = [two, two].concat();
        let error = Calibration::fit(&twice).unwrap_err();
        assert_eq!(error, CalibrationError::TooFewAngles(2));
    }
}
