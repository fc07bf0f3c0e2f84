//! How far apart the rests under one command are, on both sides: play in the gears, a dead band and friction make that.
//!
//! A step response is of whole strokes, of which play is a small share: a worn servo responds as a new one does. Where it rests shows the wear.

use super::sides::Sides;
use crate::numerics::{pointwise_critical, with_unit};
use crate::results::Interval;
use serde::{Deserialize, Serialize};

/// How far apart the rests under one command are: see [the rests of a record](crate::nonlinear::Hysteresis::with_rests_apart) \[output\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RestsApart {
    /// Of the first side; `None` where its record does not show it.
    pub a: Option<Interval>,
    /// Of the second side.
    pub b: Option<Interval>,
    /// Second less first, from the ends of both intervals: it holds wherever both hold.
    pub difference: Option<Interval>,
    /// The [mean over levels](crate::nonlinear::Hysteresis) of each side, where both have one and there is no difference of the largest distances \[output\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub means_by_direction: Option<Sides<Interval>>,
}

impl RestsApart {
    /// That of two sides, where the ratio of the scales of their outputs has the standard deviation `scale_sd`, 0.05 for 5 %; bounds have the
    /// `level`.
    pub(super) fn of([a, b]: [Option<Interval>; 2], scale_sd: f64, level: f64) -> Self {
        let between = |a: Interval, b: Interval| {
            let of_scale = pointwise_critical(level) * scale_sd * b.value?;
            let less = Interval::new(
                b.value? - a.value?,
                b.lower? - a.upper?,
                b.upper? - a.lower?,
            );
            Some(less.reaching(of_scale, of_scale))
        };
        Self {
            a,
            b,
            difference: a.zip(b).and_then(|(a, b)| between(a, b)),
            means_by_direction: None,
        }
    }

    /// The same with the `means` over levels of both sides, where the largest distances are not compared.
    pub(super) fn or_means(mut self, [a, b]: [Option<Interval>; 2]) -> Self {
        let means = a.zip(b).map(|(a, b)| Sides { a, b });
        self.means_by_direction = means.filter(|_| self.difference.is_none());
        self
    }

    /// Whether both sides have one of the two distances.
    #[must_use]
    pub fn is_known(&self) -> bool {
        self.difference.is_some() || self.means_by_direction.is_some()
    }

    /// Whether the two differ for sure.
    #[must_use]
    pub fn differ(&self) -> bool {
        self.difference.is_some_and(|found| !found.contains(0.0))
    }

    /// How far apart they are in `a` and in `b`, where they differ for sure; `unit` is that of the output.
    #[must_use]
    pub fn difference_in_words(&self, [a, b]: [&str; 2], unit: &str) -> Option<String> {
        let (of_a, of_b) = self.a.zip(self.b).filter(|_| self.differ())?;
        let decimals = self.decimals();
        let number = |of: Option<f64>| Some(format!("{:.decimals$}", of?.abs()));
        let ends = self.difference.and_then(|found| {
            let (how, near, far) = match found.value? < 0.0 {
                true => ("less", found.upper, found.lower),
                false => ("more", found.lower, found.upper),
            };
            let by = with_unit(number(found.value)?, unit);
            // An end that is rounded to 0 no longer says that the difference is sure.
            let near = near?.abs();
            let near = (decimals..12)
                .map(|decimals| format!("{near:.decimals$}"))
                .find(|text| text.contains(|digit| matches!(digit, '1'..='9')))?;
            Some(format!(", {by} ({near} .. {}) {how}", number(far)?))
        });
        Some(format!(
            "rests under one command, which {KEPT_APART_BY}, are {} {a} and {} {b}{}",
            self.side_in_words(of_a, unit),
            self.side_in_words(of_b, unit),
            ends.unwrap_or_default()
        ))
    }

    /// What a sure difference leaves open.
    #[must_use]
    pub fn what_it_leaves_open(&self) -> Option<&'static str> {
        self.differ().then_some(
            "Rests alone do not show which of the two is worn, as strokes of another size may turn their difference round: the play of the servos as machines does, and it can be felt at the horn of a servo that holds. The worn one is to be replaced where what differs here is more than its use allows.",
        )
    }

    /// What is known where no difference is sure: each side, and the largest difference that is not excluded; or what would show it.
    #[must_use]
    pub fn nothing_sure_in_words(&self, [a, b]: [&str; 2], unit: &str) -> String {
        let decimals = self.decimals();
        match self.a.zip(self.b).zip(self.most_between()) {
            Some(((of_a, of_b), most)) => format!(
                "Rests under one command, which {KEPT_APART_BY}, are {} {a} and {} {b}. That shows no difference, and does not exclude one of up to {}. It excludes no wear: play between the motor and the servo's own sensor may leave rests as they are, and friction may stop a servo that overshoots where play takes it back.",
                self.side_in_words(of_a, unit),
                self.side_in_words(of_b, unit),
                with_unit(format!("{most:.decimals$}"), unit)
            ),
            None if let Some(means) = self.means_by_direction => {
                means_in_words(means, [a, b], unit)
            }
            None => {
                let of = match (self.a, self.b) {
                    (None, Some(_)) => format!("the recording of {a} does"),
                    (Some(_), None) => format!("the recording of {b} does"),
                    _ => "the recordings do".to_owned(),
                };
                format!(
                    "Whether one has more play than the other is not known: {of} not show how far apart rests under one command are. Record stairs of \
                     each, which reach each level from below and from above, twice or more, and hold it until the servo rests."
                )
            }
        }
    }

    /// "up to 1.00 deg (0.52 .. 1.61) apart in": one side, with its interval.
    fn side_in_words(&self, of: Interval, unit: &str) -> String {
        format!("up to {} apart in", with_ends(of, self.decimals(), unit))
    }

    /// By how much they may differ at the most.
    fn most_between(&self) -> Option<f64> {
        let found = self.difference?;
        Some(found.upper?.max(-found.lower?))
    }

    /// With which the ends of the intervals have three digits \[decimals\].
    fn decimals(&self) -> usize {
        decimals([self.a, self.b].into_iter().flatten())
    }
}

/// With which the largest end of `intervals` has three digits \[decimals\].
fn decimals(intervals: impl Iterator<Item = Interval>) -> usize {
    let largest = intervals.filter_map(|of| of.upper).fold(0.0, f64::max);
    match largest > 0.0 {
        true => (2.0 - largest.log10().floor()).clamp(0.0, 12.0) as usize,
        false => 0,
    }
}

/// "1.00 deg (0.52 .. 1.61)".
fn with_ends(of: Interval, decimals: usize, unit: &str) -> String {
    let [value, low, high] = [of.value, of.lower, of.upper]
        .map(|number| format!("{:.decimals$}", number.unwrap_or(f64::NAN)));
    format!("{} ({low} .. {high})", with_unit(value, unit))
}

/// How far apart the means from both directions are.
fn means_in_words(means: Sides<Interval>, [a, b]: [&str; 2], unit: &str) -> String {
    let decimals = decimals([means.a, means.b].into_iter());
    let of = |of: Interval| with_ends(of, decimals, unit);
    let farther = match (means.a.ends(), means.b.ends()) {
        (Some([_, of_a]), Some([of_b, _])) if of_a < of_b => format!(", farther in {b}"),
        (Some([of_a, _]), Some([_, of_b])) if of_b < of_a => format!(", farther in {a}"),
        _ => String::new(),
    };
    format!(
        "Rests that are reached from above and from below, which {KEPT_APART_BY}, are in the mean {} apart in {a} and {} in {b}{farther}. Strokes that overshoot count against others in that \
         mean, so that it does not show for sure which has more play: stairs of each do, which reach each level from below and from above, twice or more, and hold it until the servo rests.",
        of(means.a),
        of(means.b),
    )
}

/// What does.
const KEPT_APART_BY: &str = "play in the gears, a dead band or friction keep apart";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sure_difference_has_no_end_of_0() {
        let rests = RestsApart::of(
            [
                Some(Interval::new(0.43, 0.0, 0.92)),
                Some(Interval::new(1.49, 0.923, 2.1)),
            ],
            0.0,
            0.99,
        );
        let said = rests.difference_in_words(["A", "B"], "deg").unwrap();
        assert!(said.ends_with("1.06 deg (0.003 .. 2.10) more"), "{said}");
    }

    #[test]
    fn the_means_of_both_directions_are_said_where_no_stroke_was_made_again() {
        let means = [
            Some(Interval::new(0.51, 0.45, 0.57)),
            Some(Interval::new(2.1, 1.9, 2.3)),
        ];
        let none = RestsApart::of([None, None], 0.0, 0.99);
        let said = |means| {
            none.or_means(means)
                .nothing_sure_in_words(["A", "B"], "deg")
        };
        let of_both = said(means);
        let expected =
            "0.51 deg (0.45 .. 0.57) apart in A and 2.10 deg (1.90 .. 2.30) in B, farther in B.";
        assert!(of_both.contains(expected), "{of_both}");
        let [a, b] = means;
        assert!(said([b, a]).contains("farther in A."));
        assert!(said([a, a]).contains("in B. Strokes"));
        assert!(said([a, None]).contains("is not known"));
        // Those of the largest distances come first.
        let known = RestsApart::of(means, 0.0, 0.99).or_means(means);
        assert_eq!(known.means_by_direction, None);
    }
}
