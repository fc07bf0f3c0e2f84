//! The speeds that the larger strokes of a recording have in common, beside the top speeds of a model whose figures may be off.
//!
//! A model that lacks something of the servo has it in other terms, and its top speeds may be off by a third. What the strokes show by
//! themselves is near the limit of the servo, whatever it comes from: the speed of a motor that builds up over a stroke ends above its mean
//! (79 limits of 60 simulated servos with such motors, under strokes of up to 60 degrees, were 93 to 99 % of the top speed; those of a loop that is
//! quick beside its motor lie further below).

use crate::data::units::Units;
use crate::presentation::summary::wording::numbers::digits;
use crate::presentation::summary::wording::speed_words::{
    measured_speed_in_words, speed_in_words, upwards,
};
use servoid_identification::servo_model::{QuantityKind, ServoModel};

/// The limits that the strokes of the recording show where the model has no intervals, upwards first.
pub(crate) fn measured_limits(model: &ServoModel) -> [Option<f64>; 2] {
    [
        QuantityKind::TopSpeedUpwards,
        QuantityKind::TopSpeedDownwards,
    ]
    .map(|kind| model.limit_of_strokes(Some(kind)))
}

/// The part of a limit by which its strokes may be slower, which two directions differ by where one has larger strokes.
const BUILDS_UP: f64 = 0.07;

/// Whether two limits differ by no more than strokes of other sizes do: which is the slower one they do not show.
fn are_alike([a, b]: [f64; 2]) -> bool {
    a.min(b) > (1.0 - BUILDS_UP) * a.max(b)
}

/// "500 deg/s (0.120 s/60°) upwards and 560 deg/s (0.107 s/60°) downwards", of the limits that the recording shows.
pub(crate) fn limits_in_words(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let of = |limit: f64| speed_in_words(model, (limit, digits(limit, 2)), units);
    let limits = measured_limits(model);
    // Where prediction needs two top speeds, sizes of strokes are not what makes the difference.
    let by_strokes = !model.terms.two_speeds;
    both_ways_in_words(limits, by_strokes, upwards(model), of)
}

/// The same of `limits` whose model is not at hand.
pub(crate) fn limits_of_strokes_in_words(
    limits: [Option<f64>; 2],
    units: Units<'_>,
) -> Option<String> {
    let of = |limit: f64| measured_speed_in_words((limit, digits(limit, 2)), units);
    both_ways_in_words(limits, true, "upwards", of)
}

fn both_ways_in_words(
    limits: [Option<f64>; 2],
    may_be_alike: bool,
    larger: &str,
    of: impl Fn(f64) -> String,
) -> Option<String> {
    match limits {
        [Some(up), Some(down)] if of(up) == of(down) => Some(format!("{} both ways", of(up))),
        [Some(up), Some(down)] => {
            let alike = match may_be_alike && are_alike([up, down]) {
                true => " (whether they differ, these strokes do not show)",
                false => "",
            };
            let (up, down) = (of(up), of(down));
            Some(format!("{up} {larger} and {down} downwards{alike}"))
        }
        [Some(up), None] => Some(format!("{} {larger}", of(up))),
        [None, Some(down)] => Some(format!("{} downwards", of(down))),
        [None, None] => None,
    }
}

/// What a data sheet is held against where the model has top speeds beside the limits that the recording shows: a sentence.
pub(crate) fn against_the_model(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let limits = limits_in_words(model, units)?;
    model.terms.is_limited().then(|| {
        format!(
            "The larger strokes of this recording go at about {limits}: the limit of this servo is that, or more where the speed builds up over a stroke. The top \
             speed of the model is where it would end; it has no interval, and stands for what the model lacks, too. A data sheet is held against both."
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::summary::servo::limited_servo::limited_servo;
    use crate::presentation::summary::servo::top_speeds::has_unreached_top_speeds;
    use servoid_identification::nonlinear::SpeedLimits;
    use servoid_identification::results::{Bounds, Reason};
    use servoid_identification::servo_model::Covariance;

    /// A servo of 30 a second at the most without intervals, with the limits that its strokes show.
    fn model(speed_limits: SpeedLimits) -> ServoModel {
        let mut model = limited_servo();
        model.speed_limits = speed_limits;
        model.covariance = Bounds::Withdrawn(Reason::ErrorsNotNoise);
        // The model expects more than the servo did.
        for quantity in &mut model.quantities {
            quantity.value *= 1.5;
            quantity.determined = true;
        }
        model
    }

    const DEGREES: Units<'static> = Units {
        input: Some("deg"),
        output: Some("deg"),
    };

    #[test]
    fn what_the_strokes_show_stands_before_a_model_without_intervals() {
        let both = SpeedLimits {
            upwards: Some(30.0),
            downwards: Some(27.0),
            change: None,
        };
        let of_model = model(SpeedLimits::default());
        assert!(has_unreached_top_speeds(&of_model));
        assert_eq!(limits_in_words(&of_model, DEGREES), None);
        let shown = model(both);
        assert!(!has_unreached_top_speeds(&shown));
        let words = "30 deg/s (2.000 s/60°) upwards and 27 deg/s (2.222 s/60°) downwards";
        assert_eq!(limits_in_words(&shown, DEGREES).as_deref(), Some(words));
        assert!(against_the_model(&shown, DEGREES).unwrap().contains(words));
        let alike = SpeedLimits {
            downwards: Some(29.0),
            ..both
        };
        let words = "30 deg/s (2.000 s/60°) upwards and 29 deg/s (2.069 s/60°) downwards (whether they differ, these strokes do not show)";
        assert_eq!(
            limits_in_words(&model(alike), DEGREES).as_deref(),
            Some(words)
        );
        let one = SpeedLimits {
            upwards: None,
            ..both
        };
        let words = "27 units/s (2.222 s/60° if that is degrees) downwards";
        assert_eq!(
            limits_in_words(&model(one), Units::default()).as_deref(),
            Some(words)
        );
    }

    #[test]
    fn intervals_that_hold_need_no_other_limit() {
        let both = SpeedLimits {
            upwards: Some(30.0),
            downwards: Some(30.0),
            change: None,
        };
        let mut known = model(both);
        let covariance = Covariance {
            level: 0.99,
            rows: Vec::new(),
        };
        known.covariance = Bounds::Valid(covariance);
        assert_eq!(limits_in_words(&known, DEGREES), None);
    }
}
