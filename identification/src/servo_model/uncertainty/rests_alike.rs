//! What is known beforehand of a dead band beside friction.
//!
//! Both keep the shaft off its command alike: a record of held commands shows their sum s = w + C/k, and hardly their difference d = C/k - w. Neither is negative, so that d is
//! between -s and s. In the derivatives of a fit, as of one in which w is 0, d may be anything. Evenly between its ends it is off from the d₀ of the fit by
//! s²/3 + d₀² in the mean of squares, and more than that is taken out of the covariance as by a measurement of d (Kalman's).

use crate::servo_model::descent::coordinates::{Coordinate, Point};
use faer::Mat;

/// The covariance of the coordinates of `point`, and the changes of all that no output shows, with the difference of dead band and friction no wider than both
/// leave it.
pub(super) fn within_both(
    point: &Point,
    mut covariance: Mat<f64>,
    unseen: Vec<Vec<f64>>,
) -> (Mat<f64>, Vec<Vec<f64>>) {
    let place = |wanted| point.coordinates.iter().position(|at| *at == wanted);
    let Some((w, c)) = place(Coordinate::DeadBand).zip(place(Coordinate::Friction)) else {
        return (covariance, unseen);
    };
    let (sum, difference) = (
        point.values[c] + point.values[w],
        point.values[c] - point.values[w],
    );
    let of_both = |sign: f64, covariance: &Mat<f64>| {
        covariance[(c, c)] + covariance[(w, w)] + sign * 2.0 * covariance[(c, w)]
    };
    let most = sum * sum / 3.0 + difference * difference + of_both(1.0, &covariance).max(0.0);
    let is_of_difference =
        |change: &Vec<f64>| (change[c] + change[w]).abs() < 0.5 * (change[c] - change[w]).abs();
    let (of_difference, unseen): (Vec<_>, Vec<_>) = unseen.into_iter().partition(is_of_difference);
    let size = covariance.nrows();
    for change in of_difference {
        let share = most / (change[c] - change[w]).powi(2);
        covariance += Mat::from_fn(size, size, |i, j| share * change[i] * change[j]);
    }
    let variance = of_both(-1.0, &covariance);
    if variance > most {
        let with: Vec<f64> = (0..size)
            .map(|i| covariance[(i, c)] - covariance[(i, w)])
            .collect();
        let taken = (variance - most) / (variance * variance);
        covariance -= Mat::from_fn(size, size, |i, j| taken * with[i] * with[j]);
    }
    (covariance, unseen)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo_model::descent::coordinates::{FRICTION_SPEED_SHARE, Terms};
    use servoid_dynamics::Stops;

    fn point(width: f64, friction: f64) -> (Point, usize, usize) {
        let terms = Terms {
            dead_band: true,
            friction: true,
            ..Terms::default()
        };
        let coordinates = terms.coordinates(1);
        let place = |wanted| coordinates.iter().position(|at| *at == wanted).unwrap();
        let (w, c) = (place(Coordinate::DeadBand), place(Coordinate::Friction));
        let mut values = vec![0.0; coordinates.len()];
        (values[w], values[c]) = (width, friction);
        let point = Point {
            terms,
            coordinates,
            values,
            radians: 1.0,
            friction_speed_share: FRICTION_SPEED_SHARE,
            run_offsets: Vec::new(),
            stops: Stops::default(),
        };
        (point, w, c)
    }

    /// A sum known to 0.01 and a difference that is open, whether it is in the covariance or among what no output shows.
    #[test]
    fn a_difference_that_is_open_is_no_wider_than_both() {
        let (point, w, c) = point(0.0, 0.3);
        let size = point.values.len();
        let (mut wide, mut narrow) = (Mat::zeros(size, size), Mat::zeros(size, size));
        for (of, variance) in [(&mut wide, 800.0), (&mut narrow, 0.0)] {
            (of[(w, w)], of[(c, c)]) = (variance, variance + 1e-4);
            (of[(w, c)], of[(c, w)]) = (-variance, -variance);
        }
        let mut change = vec![0.0; size];
        (change[w], change[c]) = (-1.0, 1.0);
        for (covariance, unseen) in [(wide, vec![]), (narrow, vec![change])] {
            let (found, unseen) = within_both(&point, covariance, unseen);
            assert!(unseen.is_empty());
            let [sum, difference] =
                [2.0, -2.0].map(|both| found[(w, w)] + found[(c, c)] + both * found[(w, c)]);
            assert!((sum - 1e-4).abs() < 1e-6, "{sum}");
            // 0.3²/3 + 0.3²
            assert!((difference - 0.12).abs() < 1e-3, "{difference}");
        }
    }

    #[test]
    fn a_difference_that_is_known_stays_as_it_is() {
        let (point, w, c) = point(0.2, 0.3);
        let size = point.values.len();
        let mut covariance = Mat::zeros(size, size);
        (covariance[(w, w)], covariance[(c, c)]) = (1e-3, 2e-3);
        // Friction that nothing shows, by itself.
        let mut change = vec![0.0; size];
        change[c] = 1.0;
        let (found, unseen) = within_both(&point, covariance.clone(), vec![change.clone()]);
        assert_eq!((found, unseen), (covariance, vec![change]));
    }
}
