//! Two angles that were given at each other's position.

use super::mistyped_angle::{FARTHER, FEWEST};
use super::sensor_scale::{Calibration, Reading};

/// Two readings whose angles belong to each other's counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwappedAngles {
    /// The angles, in their order \[deg\].
    pub angles_deg: [f64; 2],
    /// The farthest reading from the line once they have changed places \[deg\].
    pub then_within_deg: f64,
}

impl std::fmt::Display for SwappedAngles {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [a, b] = self.angles_deg;
        write!(
            f,
            "the angles {a} and {b} seem to have changed places: the other way round all are within {:.2} degrees of a line",
            self.then_within_deg
        )
    }
}

/// The one pair whose exchange puts all readings on a line, far nearer to it than the two angles are to each other.
pub fn swapped_angles(readings: &[Reading]) -> Option<SwappedAngles> {
    let count = readings.len();
    if count < FEWEST {
        return None;
    }
    let pairs = (0..count).flat_map(|first| (first + 1..count).map(move |second| [first, second]));
    let mut found = pairs.filter_map(|[first, second]| {
        let angles_deg = [
            readings.get(first)?.angle_deg,
            readings.get(second)?.angle_deg,
        ];
        let mut exchanged = readings.to_vec();
        exchanged.get_mut(first)?.angle_deg = angles_deg[1];
        exchanged.get_mut(second)?.angle_deg = angles_deg[0];
        let line = Calibration::fit(&exchanged).ok()?;
        let within = line.largest_residual_deg.max(line.degrees_per_count.abs());
        let apart = (angles_deg[0] - angles_deg[1]).abs();
        (apart > FARTHER * within).then_some(SwappedAngles {
            angles_deg,
            then_within_deg: line.largest_residual_deg,
        })
    });
    found.next().filter(|_| found.next().is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_angles_at_each_others_place_are_named() {
        let found = |angles| swapped_angles(&Reading::at_five_positions(angles));
        let swapped = found([-8.0, -4.0, 0.0, 8.0, 4.0]).unwrap();
        assert_eq!(swapped.angles_deg, [8.0, 4.0]);
        assert!(
            swapped.to_string().starts_with("the angles 8 and 4 seem"),
            "{swapped}"
        );
        assert_eq!(
            found([-4.0, -8.0, 0.0, 4.0, 8.0]).unwrap().angles_deg,
            [-4.0, -8.0]
        );
        assert_eq!(found([-8.0, -4.0, 0.0, 4.0, 8.0]), None);
        assert_eq!(found([-8.5, -3.5, 0.0, 4.5, 7.5]), None);
        assert_eq!(found([8.0, -4.0, 0.0, 4.0, 8.0]), None);
    }
}
