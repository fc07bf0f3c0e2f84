//! One angle that was typed wrong, or read at another position.

use super::sensor_scale::{Calibration, Reading};

/// Fewest readings among which one can be distinguished from the others: two of the rest show a line, and two how straight it is.
pub(super) const FEWEST: usize = 5;

/// How many times farther than any other reading it must lie from the line of the others. Of five readings with Gaussian errors one in a
/// hundred does so by chance (Student's t with two degrees of freedom at 0.2 %).
pub(super) const FARTHER: f64 = 20.0;

/// The reading that does not belong to the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MistypedAngle {
    /// The reading.
    pub reading: Reading,
    /// Where the others put it \[deg\].
    pub expected_deg: f64,
    /// The farthest of the others from their own line \[deg\].
    pub others_within_deg: f64,
}

impl std::fmt::Display for MistypedAngle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "the angle {} was given at {:.1} counts, where the others, which are within {:.2} degrees of a line, have {:.1}: was it typed wrong?",
            self.reading.angle_deg, self.reading.counts, self.others_within_deg, self.expected_deg
        )
    }
}

/// The one reading that is far from the straight line of the others.
pub fn mistyped_angle(readings: &[Reading]) -> Option<MistypedAngle> {
    if readings.len() < FEWEST {
        return None;
    }
    let apart = |index: usize| {
        let mut others = readings.to_vec();
        let reading = others.remove(index);
        let line = Calibration::fit(&others).ok()?;
        let found = MistypedAngle {
            reading,
            expected_deg: (reading.counts - line.zero_counts) * line.degrees_per_count,
            others_within_deg: line.largest_residual_deg,
        };
        let off = (found.expected_deg - reading.angle_deg).abs();
        // Readings of whole counts may lie on a line by chance.
        let within = line.largest_residual_deg.max(line.degrees_per_count.abs());
        (off > FARTHER * within).then_some(found)
    };
    let mut all = (0..readings.len()).filter_map(apart);
    all.next().filter(|_| all.next().is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_wrong_angle_is_named_and_readings_with_errors_are_not() {
        let readings = Reading::at_five_positions;
        assert_eq!(mistyped_angle(&readings([-8.0, -4.0, 0.0, 4.0, 8.0])), None);
        assert_eq!(mistyped_angle(&readings([-8.4, -3.8, 0.2, 4.1, 7.5])), None);
        let at_an_end = mistyped_angle(&readings([8.0, -4.0, 0.0, 4.0, 8.0])).unwrap();
        assert_eq!(at_an_end.reading.angle_deg, 8.0);
        let decimal = mistyped_angle(&readings([-8.0, -4.0, 0.0, 40.0, 8.0])).unwrap();
        assert!((decimal.expected_deg - 4.0).abs() < 0.1, "{decimal}");
        assert!(
            decimal
                .to_string()
                .starts_with("the angle 40 was given at 8633.0 counts")
        );
        let whole_counts = [-20.0, -10.0, 0.0, 10.0, 20.0]
            .into_iter()
            .zip([6008.0, 7100.0, 8192.0, 9284.0, 10377.0])
            .map(|(angle_deg, counts)| Reading { angle_deg, counts });
        assert_eq!(mistyped_angle(&whole_counts.collect::<Vec<_>>()), None);
        // Two wrong ones leave nothing to hold them against.
        assert_eq!(mistyped_angle(&readings([8.0, -4.0, 0.0, 40.0, 8.0])), None);
    }
}
