//! Which pole of three is called the lag.
//!
//! Where two poles are a complex pair, the third is the lag. Three real poles are the same servo whichever of them has the name: there the pair are the two
//! that are closest to each other, so that a pair that has just become real stays the pair.

use std::f64::consts::PI;

use super::low_order::{LowOrder, Oscillator};

/// Damping below which a servo rings for some periods.
const RINGING: f64 = 0.2;

impl LowOrder {
    /// The same servo, of three real poles the two that are closest the pair; of others as it is.
    pub(super) fn with_closest_pair(self) -> Self {
        let (Some(pair), Some(lag)) = (self.oscillator, self.lag_s) else {
            return self;
        };
        let Some([slow, fast]) = pair.time_constants() else {
            return self;
        };
        let mut all = [slow, fast, lag];
        all.sort_by(f64::total_cmp);
        let [short, middle, long] = all;
        let (pair, lag) = match long / middle < middle / short {
            true => ([long, middle], short),
            false => ([middle, short], long),
        };
        let product: f64 = pair.iter().product();
        let oscillator = Oscillator {
            omega_rad_s: product.sqrt().recip(),
            damping: pair.iter().sum::<f64>() / (2.0 * product.sqrt()),
        };
        let as_before = (lag - self.lag_s.unwrap_or(lag)).abs() < 1e-9 * lag;
        match as_before {
            true => self,
            false => Self {
                oscillator: Some(oscillator),
                lag_s: Some(lag),
                ..self
            },
        }
    }

    /// Whether it goes on ringing at more than half of the rate of samples that are `period_s` apart.
    pub(super) fn rings_unseen(&self, period_s: f64) -> bool {
        let unseen = |pair: Oscillator| pair.omega_rad_s * period_s > PI && pair.damping < RINGING;
        self.oscillator.is_some_and(unseen)
    }

    /// Whether it has three poles, all real.
    pub(super) fn has_real_poles_alone(&self) -> bool {
        let pair = self.oscillator.and_then(|pair| pair.time_constants());
        self.lag_s.is_some() && pair.is_some()
    }
}

impl Oscillator {
    /// The longer and the shorter time constant of a pair that is real \[s\].
    fn time_constants(self) -> Option<[f64; 2]> {
        let root = (self.damping.powi(2) - 1.0).max(0.0).sqrt();
        let slow = (self.damping + root) / self.omega_rad_s;
        (root > 0.0).then(|| [slow, 1.0 / (self.omega_rad_s.powi(2) * slow)])
    }

    /// The time constant in which the slower of its poles dies out \[s\].
    fn longest_s(self) -> f64 {
        let slow = self.time_constants().map(|[slow, _]| slow);
        slow.unwrap_or(1.0 / (self.damping * self.omega_rad_s))
    }

    /// The nearest pair whose poles die out no later than in `longest_s`.
    fn quicker_than(self, longest_s: f64) -> Self {
        let omega_rad_s = self.omega_rad_s.max(1.0 / longest_s);
        let ratio = omega_rad_s * longest_s;
        // A complex pair dies out in 1/(ζω), and the slower pole of a real one is at ω/ratio.
        let [least, most] = [1.0 / ratio, f64::midpoint(ratio, 1.0 / ratio)];
        Self {
            omega_rad_s,
            damping: self.damping.max(least).min(most.max(least)),
        }
    }
}

/// A pole that shows, in time constants of the next slower one.
const VISIBLE: f64 = 0.4;

/// Which pole of three the lag stays while the others change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PoleNames {
    /// The one that it is.
    AsTheyAre,
    /// The slowest: a servo of first order has two more poles that do not show.
    LagIsSlowest,
    /// The fastest of real ones: a servo of second order has one more.
    LagIsFastest,
}

impl PoleNames {
    /// `servo`, or the nearest one whose lag is this pole: the others give way to a slowest lag, and a fastest one to them.
    pub(super) fn of(self, servo: LowOrder) -> LowOrder {
        let (Some(pair), Some(lag)) = (servo.oscillator, servo.lag_s) else {
            return servo;
        };
        let (pair, lag) = match self {
            Self::AsTheyAre => (pair, lag),
            Self::LagIsSlowest => (pair.quicker_than(lag), lag),
            Self::LagIsFastest => (pair, pair.time_constants().map_or(lag, |[_, t]| lag.min(t))),
        };
        LowOrder {
            oscillator: Some(pair),
            lag_s: Some(lag),
            ..servo
        }
    }

    /// `servo` with the poles that its order lacks so slow that they show, where they did not: from where they are too fast for that no derivative leads back.
    pub(super) fn with_visible_poles(self, servo: LowOrder) -> Option<LowOrder> {
        let (pair, lag) = (servo.oscillator?, servo.lag_s?);
        let late = |pair: Oscillator| 2.0 * pair.damping / pair.omega_rad_s;
        let (shown, later) = match self {
            Self::AsTheyAre => return None,
            Self::LagIsSlowest => {
                let pair = Oscillator {
                    omega_rad_s: 1.0 / (VISIBLE * lag),
                    damping: 1.0,
                };
                ((pair, lag), late(pair) - late(servo.oscillator?))
            }
            Self::LagIsFastest => {
                let fast = pair.time_constants().map(|[_, fast]| fast);
                let shown = VISIBLE * fast.unwrap_or(1.0 / pair.omega_rad_s);
                ((pair, shown), shown - lag)
            }
        };
        let (pair, lag) = shown;
        (later > 0.5 * VISIBLE * pair.longest_s().min(lag)).then_some(LowOrder {
            delay_s: servo.delay_s - later,
            oscillator: Some(pair),
            lag_s: Some(lag),
            ..servo
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn servo(omega_rad_s: f64, damping: f64, lag_s: f64) -> LowOrder {
        LowOrder {
            gain: 1.0,
            delay_s: 0.0,
            oscillator: Some(Oscillator {
                omega_rad_s,
                damping,
            }),
            lag_s: Some(lag_s),
        }
    }

    #[test]
    fn the_pair_of_real_poles_are_the_two_that_are_closest() {
        // 40, 10 and 8 ms, of which the pair had the first and the last.
        let pair = Oscillator {
            omega_rad_s: (0.04f64 * 0.008).sqrt().recip(),
            damping: 0.024 / (0.04f64 * 0.008).sqrt(),
        };
        let found = servo(pair.omega_rad_s, pair.damping, 0.01);
        let named = found.with_closest_pair();
        assert_relative_eq!(named.lag_s.unwrap(), 0.04, epsilon = 1e-9);
        let steps = [found, named].map(|servo| servo.step(0.03));
        assert_relative_eq!(steps[0], steps[1], epsilon = 1e-9);
        assert_eq!(named.with_closest_pair(), named);
        let complex = servo(50.0, 0.9, 0.004);
        assert_eq!(complex.with_closest_pair(), complex);
    }

    #[test]
    fn poles_with_a_name_give_way() {
        // The pair is 40 and 10 ms.
        let three = |lag_s: f64| servo(50.0, 1.25, lag_s);
        let lag = |names: PoleNames, lag_s: f64| names.of(three(lag_s)).lag_s.unwrap();
        assert_relative_eq!(lag(PoleNames::LagIsFastest, 0.005), 0.005, epsilon = 1e-9);
        assert_relative_eq!(lag(PoleNames::LagIsFastest, 0.02), 0.01, epsilon = 1e-9);
        assert_relative_eq!(lag(PoleNames::AsTheyAre, 0.02), 0.02, epsilon = 1e-9);
        for (lag_s, damping) in [(0.02, 1.25), (0.005, 1.25), (0.03, 0.1)] {
            let found = PoleNames::LagIsSlowest.of(servo(50.0, damping, lag_s));
            let longest = found.oscillator.unwrap().longest_s();
            assert!(found.lag_s == Some(lag_s) && longest < lag_s * (1.0 + 1e-9));
        }
        assert_eq!(PoleNames::LagIsSlowest.of(three(0.05)), three(0.05));
    }
}
