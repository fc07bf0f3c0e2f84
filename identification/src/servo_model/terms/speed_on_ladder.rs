//! Whether the servo's speed is cut off: a second climb of the [ladder](crate::servo_model::terms::ladder), behind the first.
//!
//! A motor comes to its top speed by and by. The speed of a digital servo that follows a profile, and of most servos that simulations have, is cut off at its
//! limit. Terms of the first kind stand for the second with errors that are several times the noise, and delays that are off by a third.

use super::ladder::Ladder;
use super::neighbouring_terms::richer;
use crate::servo_model::descent::coordinates::{Coordinate, Point, Terms};
use crate::thresholds::SERVO_LARGE_ADVANTAGE;

impl Ladder<'_> {
    /// The rung with a limit of the speed, where it predicts better than `without` by more than scatter and by as much as is needed; else that one,
    /// and none of those that were tried for it is left.
    pub(super) fn with_speed_limit(&mut self, without: usize) -> usize {
        if !self.tried[without].terms.limit {
            return without;
        }
        let known = self.tried.len();
        let best = self.climb_with_speed_limit(without);
        let most = (1.0 - needed_advantage(self.tried[best].terms)) * self.tried[without].total();
        if self.tried[best].total() < most && self.tried[best].beats(&self.tried[without]) {
            for terms in richer(self.tried[best].terms) {
                self.extended(best, terms);
            }
            best
        } else {
            self.tried.truncate(known);
            without
        }
    }

    /// The best rung with a limit of the speed. Other terms of `without` may stand for it, so it is tried with the fewest, too: from there, and found
    /// from far away where the drive has no limit of its own, for which a stiff drive with a long delay may stand.
    fn climb_with_speed_limit(&mut self, without: usize) -> usize {
        let own = Terms {
            speed_limit: true,
            ..self.tried[without].terms
        };
        let at_once = Terms {
            two_speeds: true,
            speed_limit: true,
            ..Terms::default()
        };
        let two_speeds = Terms {
            limit: true,
            ..at_once
        };
        let from = self.searched(at_once);
        let at_once = self.add(at_once, &from);
        let starts =
            [without, at_once].map(|rung| self.variants(&self.tried[rung].fit, two_speeds));
        let profiles: Vec<Point> = starts
            .iter()
            .flat_map(|all| all.last().map(profile))
            .collect();
        let both = self.add_lowest(two_speeds, [starts.concat(), profiles].concat());
        let own = self.extended(without, own);
        let best = [both, own].into_iter();
        let best = best.fold(at_once, |best, rung| self.better(best, rung));
        if self.better(without, best) == without {
            return best;
        }
        let best = self.add_terms(best);
        self.drop_terms(best)
    }

    /// The servo `plain`, which is new to a limit of the speed, with the acceleration of `from` and larger ones: full drive that falls with
    /// the speed is lower on the average than at rest. A fit that has to come to its speed by and by is late, so shorter delays are tried, too.
    pub(super) fn with_speed_cut_off(&self, from: &Point, plain: Point) -> Vec<Point> {
        let drive = from.physics(0, |_, value| value).limit;
        let delay_s = plain.get(Coordinate::Delay).unwrap_or(0.0);
        let mut points = Vec::new();
        for (stronger, earlier) in [(1.0, 1.0), (2.0, 1.0), (1.0, 0.7), (2.0, 0.7), (8.0, 0.7)] {
            let mut point = plain.clone();
            if let Some(limit) = drive {
                point.set(Coordinate::LnAcceleration, (stronger * limit.up).ln());
            }
            point.set(Coordinate::Delay, earlier * delay_s);
            points.push(point);
        }
        points
    }
}

/// The share of the squared errors that a limit of the speed must take away in servos with these terms, beside the scatter. Where few strokes reach the
/// limit, or noise is most of the errors, that share is small, and terms of the drive miss the truth all the same. But beside friction or a dead band a limit
/// stands for stiction that the equation does not have, with up to 22 % of the squared errors and 10 times the scatter. Of servos without
/// these that have no such speed, it came to 2.4 times the scatter at the most, in 85 comparisons.
fn needed_advantage(terms: Terms) -> f64 {
    match terms.friction || terms.dead_band || terms.play {
        true => SERVO_LARGE_ADVANTAGE,
        false => 0.0,
    }
}

/// Logarithm of the factor by which the loop of a profile is stiffer and more damped.
const QUICKER: f64 = 2.0;

/// The servo `point` as one that follows a profile: it comes to a speed that is proportional to the error as soon as its acceleration lets it.
fn profile(point: &Point) -> Point {
    let mut quick = point.clone();
    for faster in [Coordinate::LnStiffness, Coordinate::LnDamping] {
        let value = point.get(faster).unwrap_or(0.0);
        quick.set(faster, value + QUICKER);
    }
    quick
}
