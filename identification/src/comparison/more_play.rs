//! Which of two servos has more play: that is wear of the gears, or of what is between them and the sensor.

use super::servo_models::{QuantityDifference, QuantityPair, ServoModelComparison};
use super::sides::Sides;
use crate::results::Interval;
use crate::servo_model::QuantityKind;

/// A model without play may lack one of so many times its rms error, half of which is to each side.
const UNSEEN: f64 = 2.0;

/// A servo that has more play than the other one for sure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MorePlay {
    /// Whether it is the second of the two.
    pub is_second: bool,
    /// Its play, whole width \[output\].
    pub play: f64,
    /// That of the other one; `None` where its model has none, and would have one as wide.
    pub of_other: Option<f64>,
}

impl ServoModelComparison {
    /// Which of the two has more play for sure; `None` where that is open, or where a model has no intervals.
    #[must_use]
    pub fn more_play(&self) -> Option<MorePlay> {
        let (pair, difference) = (self.quantities.iter())
            .zip(&self.bounds.valid()?.differences)
            .find(|(pair, _)| pair.kind() == Some(QuantityKind::Play))?;
        MorePlay::of(pair, difference, self.rmse)
    }
}

impl ServoModelComparison {
    /// Whether one has more play than the other as far as their models say, beyond the errors of both: without intervals that is not sure.
    #[must_use]
    pub fn plays_are_apart(&self) -> bool {
        let mut pairs = self.quantities.iter();
        let play = pairs.find(|pair| pair.kind() == Some(QuantityKind::Play));
        let apart = play.and_then(|pair| Some((pair.a? - pair.b?).abs()));
        apart.is_some_and(|apart| MorePlay::would_show(apart, self.rmse.a.max(self.rmse.b)))
    }
}

impl MorePlay {
    /// Whether a model of this rms error that has no play would have one as wide as this.
    #[must_use]
    pub fn would_show(play: f64, rmse: f64) -> bool {
        play > UNSEEN * rmse
    }

    /// By the plays of both and the rms errors of their models.
    fn of(pair: &QuantityPair, difference: &QuantityDifference, rmse: Sides<f64>) -> Option<Self> {
        let is_seen = |own: Option<Interval>, error_of_other: f64| {
            own.and_then(|own| own.lower)
                .is_some_and(|lower| Self::would_show(lower, error_of_other))
        };
        let (is_sure, is_second, play, of_other) = match (pair.a, pair.b) {
            (Some(a), Some(b)) => (difference.is_sure(), b > a, a.max(b), Some(a.min(b))),
            (Some(a), None) => (is_seen(difference.a, rmse.b), false, a, None),
            (None, Some(b)) => (is_seen(difference.b, rmse.a), true, b, None),
            (None, None) => return None,
        };
        is_sure.then_some(Self {
            is_second,
            play,
            of_other,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo_model::Unit;

    /// Servos of which each has a play with these ends, or a model without it.
    fn compared(a: Option<[f64; 2]>, b: Option<[f64; 2]>, rmse: f64) -> Option<MorePlay> {
        let interval = |[low, high]: [f64; 2]| Interval::new((low + high) / 2.0, low, high);
        let between = |[a, b]: [[f64; 2]; 2]| interval([b[0] - a[1], b[1] - a[0]]);
        let name = || "play, whole width".to_owned();
        let difference = QuantityDifference {
            name: name(),
            a: a.map(interval),
            b: b.map(interval),
            difference: a.zip(b).map(|(a, b)| between([a, b])),
        };
        let pair = QuantityPair {
            name: name(),
            unit: Unit::Output,
            a: difference.a.and_then(|found| found.value),
            b: difference.b.and_then(|found| found.value),
            other_fits: Sides::default(),
            interval_of_one: Sides::default(),
        };
        MorePlay::of(&pair, &difference, Sides { a: rmse, b: rmse })
    }

    #[test]
    fn a_servo_is_not_the_worn_one_by_a_play_that_the_other_may_have_as_well() {
        let (new, worn) = (Some([0.02, 0.06]), Some([0.98, 1.1]));
        let of = |is_second: bool, of_other: Option<f64>| MorePlay {
            is_second,
            play: 1.04,
            of_other,
        };
        assert_eq!(compared(new, worn, 0.05), Some(of(true, Some(0.04))));
        assert_eq!(compared(worn, new, 0.05), Some(of(false, Some(0.04))));
        assert_eq!(compared(None, worn, 0.05), Some(of(true, None)));
        assert_eq!(compared(worn, None, 0.05), Some(of(false, None)));
        // 0.02 to 0.06 beside a model whose errors are as large.
        assert_eq!(compared(new, None, 0.05), None);
        assert_eq!(compared(None, new, 0.05), None);
        assert_eq!(compared(new, Some([0.03, 0.08]), 0.05), None);
        assert_eq!(compared(None, None, 0.05), None);
    }
}
