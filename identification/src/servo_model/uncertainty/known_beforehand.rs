//! What is known of a servo before it is recorded.
//!
//! - Dead band and friction keep the shaft off its command alike: a record of held commands shows their sum s = w + C/k, and hardly their difference
//!   d = C/k - w. Neither is negative, so that d is between -s and s. In the derivatives of a fit, as of one in which w is 0, d may be anything.
//! - The gears take a share of what turns them, between 0 and 1. A record whose drive hardly brakes shows what is left of the stiffness, and not
//!   the share.
//!
//! Evenly between its ends at m ± h, a value is off from that of the fit, v, by h²/3 + (v - m)² in the mean of squares. More than that is taken out
//! of the covariance as by a measurement of it (Kalman's).

use crate::numerics::dot;
use crate::servo_model::descent::coordinates::{Coordinate, Point};
use faer::Mat;

/// The covariance of the coordinates of a servo, and the changes of all that no output shows.
type Unknowns = (Mat<f64>, Vec<Vec<f64>>);

/// The same of the coordinates of `point`, no wider than what is known beforehand.
pub(super) fn within_known(point: &Point, unknowns: Unknowns) -> Unknowns {
    let place = |wanted| point.coordinates.iter().position(|at| *at == wanted);
    let mut unknowns = unknowns;
    // The share first: where it is open, so is the sum of dead band and friction.
    if let Some(share) = place(Coordinate::FrictionOfGears) {
        unknowns = with_share_of_one(point, unknowns, share);
    }
    if let Some(both) = place(Coordinate::DeadBand).zip(place(Coordinate::Friction)) {
        unknowns = with_rests_alike(point, unknowns, both);
    }
    unknowns
}

/// With the difference of dead band and friction, the coordinates `w` and `c`, no wider than their sum leaves it.
fn with_rests_alike(
    point: &Point,
    (covariance, unseen): Unknowns,
    (w, c): (usize, usize),
) -> Unknowns {
    let (sum, difference) = (
        point.values[c] + point.values[w],
        point.values[c] - point.values[w],
    );
    let of_sum = covariance[(c, c)] + covariance[(w, w)] + 2.0 * covariance[(c, w)];
    let most = sum * sum / 3.0 + difference * difference + of_sum.max(0.0);
    let is_of_difference =
        |change: &[f64]| (change[c] + change[w]).abs() < 0.5 * (change[c] - change[w]).abs();
    let mut of = vec![0.0; point.values.len()];
    (of[c], of[w]) = (1.0, -1.0);
    no_wider((covariance, unseen), (&of, most), is_of_difference)
}

/// With the share `at` no wider than from 0 to 1.
fn with_share_of_one(point: &Point, unknowns: Unknowns, at: usize) -> Unknowns {
    let most = 1.0 / 12.0 + (point.values[at] - 0.5).powi(2);
    let is_of_share = |change: &[f64]| change[at].abs() > f64::EPSILON.sqrt();
    let mut of = vec![0.0; point.values.len()];
    of[at] = 1.0;
    no_wider(unknowns, (&of, most), is_of_share)
}

/// With the variance of the combination `of` the coordinates no larger than `most`, also where it is among what no output shows, as the
/// changes are that `shown_by` it.
fn no_wider(
    (mut covariance, unseen): Unknowns,
    (of, most): (&[f64], f64),
    shown_by: impl Fn(&[f64]) -> bool,
) -> Unknowns {
    let size = covariance.nrows();
    let (shown, unseen): (Vec<_>, Vec<_>) = unseen.into_iter().partition(|change| shown_by(change));
    for change in shown {
        let share = most / dot(of, &change).powi(2);
        covariance += Mat::from_fn(size, size, |i, j| share * change[i] * change[j]);
    }
    let row = |i: usize| {
        of.iter()
            .enumerate()
            .map(|(j, a)| a * covariance[(i, j)])
            .sum()
    };
    let with: Vec<f64> = (0..size).map(row).collect();
    let variance = dot(of, &with);
    if variance > most {
        let taken = (variance - most) / (variance * variance);
        covariance -= Mat::from_fn(size, size, |i, j| taken * with[i] * with[j]);
    }
    (covariance, unseen)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo_model::descent::coordinates::{ArmTurn, FRICTION_SPEED_SHARE, Terms};
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
            arm: ArmTurn::OfCommand(1.0),
            friction_speed_share: FRICTION_SPEED_SHARE,
            run_offsets: Vec::new(),
            stops: Stops::default(),
            pulse_end: None,
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
            let (found, unseen) = within_known(&point, (covariance, unseen));
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
        let (found, unseen) = within_known(&point, (covariance.clone(), vec![change.clone()]));
        assert_eq!((found, unseen), (covariance, vec![change]));
    }

    /// A share that is open, with which friction grows, beside a difference that is open, too.
    #[test]
    fn a_difference_is_no_wider_than_the_sum_that_a_share_of_one_leaves() {
        let terms = Terms {
            dead_band: true,
            friction: true,
            friction_of_gears: true,
            ..Terms::default()
        };
        let (mut point, ..) = point(0.1, 3.0);
        point.coordinates = terms.coordinates(1);
        let size = point.coordinates.len();
        let place = |wanted| {
            point
                .coordinates
                .iter()
                .position(|at| *at == wanted)
                .unwrap()
        };
        let (w, c) = (place(Coordinate::DeadBand), place(Coordinate::Friction));
        let g = place(Coordinate::FrictionOfGears);
        point.values = vec![0.0; size];
        (point.values[w], point.values[c]) = (0.1, 3.0);
        let (mut of_share, mut of_difference) = (vec![0.0; size], vec![0.0; size]);
        (of_share[g], of_share[c]) = (30.0, 100.0);
        (of_difference[w], of_difference[c]) = (-80.0, 80.0);
        let product = |change: &[f64], i: usize, j: usize| change[i] * change[j];
        let covariance = Mat::from_fn(size, size, |i, j| {
            product(&of_share, i, j) + product(&of_difference, i, j)
        });
        let (found, _) = within_known(&point, (covariance, vec![]));
        let [sum, difference] =
            [2.0, -2.0].map(|both| found[(w, w)] + found[(c, c)] + both * found[(w, c)]);
        // Shares to 1 leave friction to 100 / 30 of the root of 1/12 + 0.25, and the difference is no wider than 3.1²/3 + 2.9² and that.
        assert!((sum - 3.7).abs() < 0.1, "{sum}");
        assert!((difference - 15.3).abs() < 0.2, "{difference}");
    }

    /// A share that nothing shows, but what of the stiffness makes up for it.
    #[test]
    fn a_share_that_is_open_is_no_wider_than_one() {
        let terms = Terms {
            friction_of_gears: true,
            ..Terms::default()
        };
        let coordinates = terms.coordinates(1);
        let size = coordinates.len();
        let place = |wanted| coordinates.iter().position(|at| *at == wanted).unwrap();
        let (k, g) = (
            place(Coordinate::LnStiffness),
            place(Coordinate::FrictionOfGears),
        );
        let mut values = vec![0.0; size];
        values[g] = 0.2;
        let point = Point {
            terms,
            coordinates,
            values,
            arm: ArmTurn::OfCommand(1.0),
            friction_speed_share: FRICTION_SPEED_SHARE,
            run_offsets: Vec::new(),
            stops: Stops::default(),
            pulse_end: None,
        };
        let mut change = vec![0.0; size];
        (change[g], change[k]) = (1.0, 1.25);
        let of_change = |share: f64| Mat::from_fn(size, size, |i, j| share * change[i] * change[j]);
        for (covariance, unseen) in [
            (of_change(9.0), vec![]),
            (Mat::zeros(size, size), vec![change.clone()]),
        ] {
            let (found, unseen) = within_known(&point, (covariance, unseen));
            assert!(unseen.is_empty());
            // 0.5²/3 + 0.3²
            assert!((found[(g, g)] - 0.1733).abs() < 1e-3, "{}", found[(g, g)]);
            assert!((found[(k, g)] - 1.25 * found[(g, g)]).abs() < 1e-9);
        }
        let narrow = of_change(0.01);
        assert_eq!(within_known(&point, (narrow.clone(), vec![])).0, narrow);
    }
}
