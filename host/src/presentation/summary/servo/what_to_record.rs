//! What to record where a servo model leaves something open.

use super::top_speeds::has_unreached_top_speeds;
use servoid_identification::results::Reason;
use servoid_identification::servo_model::{Quantity, QuantityKind, ServoModel};

/// What to say below the quantities of a servo model.
pub(crate) fn advice_on_servo_model(model: &ServoModel) -> Vec<&'static str> {
    match model.is_linear() && model.covariance.valid().is_some() {
        true => vec![LINEAR_IS_SHARPER],
        false => {
            let mut advice = what_to_record(&model.quantities);
            advice.extend(has_unreached_top_speeds(model).then_some(LARGER_STROKES));
            advice.extend(holds_alike(model).then_some(STAIRS_DO_NOT_SEPARATE));
            let end = match misses(model) {
                true => Some(OF_ANOTHER_LOGGER),
                false => (!advice.is_empty()).then_some(WHERE_IT_ENDS),
            };
            advice.extend(end);
            advice
        }
    }
}

/// Whether the record leaves open how a servo is held off its command: by a dead band, which stands still at its edge, or by friction.
fn holds_alike(model: &ServoModel) -> bool {
    let is_held = model.terms.dead_band || model.terms.friction;
    let is_open = |found: &Quantity| {
        let of_friction = |kind| QuantityKind::OF_FRICTION.contains(&kind);
        !found.determined && found.kind().is_some_and(of_friction)
    };
    is_held && (misses(model) || model.quantities.iter().any(is_open))
}

/// Whether the record has something that the model lacks.
fn misses(model: &ServoModel) -> bool {
    model.covariance.withdrawn() == Some(Reason::ErrorsNotNoise)
}

/// Said of a servo that was faster than any stroke let it show.
const LARGER_STROKES: &str = "Strokes of this recording were too small to show the top speed: record larger ones, as far as the travel allows.";

/// Said of a servo that a dead band or friction holds, where the record does not show which.
const STAIRS_DO_NOT_SEPARATE: &str = "Dead band and friction rest alike, and stairs hardly distinguish them: a large slow motion that goes on does, such as \
    sines of 0.1 to 3 Hz that add up to 30 degrees, for 20 s, with two seconds of rest before and after them (in servoid: --reference multisine --amplitude 30 \
    --frequencies 0.1:3 --length 20).";

/// Said last: whoever has followed the advice would be sent from one recording to the next otherwise.
const WHERE_IT_ENDS: &str = "If this recording has what is asked for here, only a longer one or one with less noise may show more of it. A limit beyond the travel shows in \
    none, and neither does what the model lacks, such as play.";

/// Said last where the model lacks something. Of servos with a limit and a dead band in rows of 2 to 10 ms, 34 of 36 recordings have intervals where commands act at rows, and none of 72 where
/// pulses had a clock of their own or the gears had play, whatever moved: levels, stairs, sines.
const OF_ANOTHER_LOGGER: &str = "Other recordings by this logger may show more values, and hardly intervals: the errors are those of what the model lacks, such as play in the \
    gears, or of commands that act between the rows, as pulses on a clock of their own do. A logger on the clock of the pulses, such as servoid's own board, mends the \
    second. How far the model is off without intervals, a recording shows that it has not seen: servoid validate.";

/// Said of a servo model without any term beyond a linear servo.
const LINEAR_IS_SHARPER: &str = "This recording needs no more than a linear servo: where the linear model has intervals, they are \
    narrower. Those here also hold for limits, friction and loads that the recording leaves open.";

/// Quantities that a recording may leave open, and what would show them: in a few words, and as advice.
const WHAT_SHOWS: [(&[QuantityKind], &str, &str); 3] = [
    (
        QuantityKind::OF_LIMIT,
        "large strokes show it",
        "Top speed and acceleration show in large strokes: record steps over most of the travel, each held until the servo rests.",
    ),
    (
        QuantityKind::OF_SMALL_SIGNALS,
        "small quick strokes show it",
        "Bandwidth and damping show in small quick strokes: record steps or random levels of a few degrees, sampled several times within the rise time.",
    ),
    (
        QuantityKind::OF_REST,
        "rests at many levels show it",
        "Friction, dead band, load and gain show at rest: record stairs of at least four levels, each reached from both sides and held until the servo rests.",
    ),
];

/// What to record for the quantities that this recording leaves open.
fn what_to_record(quantities: &[Quantity]) -> Vec<&'static str> {
    let open = |kinds: &&[QuantityKind]| {
        let left_open = quantities.iter().filter(|found| !found.determined);
        let mut left_open = left_open.filter_map(Quantity::kind);
        left_open.any(|kind| kinds.contains(&kind))
    };
    WHAT_SHOWS
        .iter()
        .filter(|(kinds, ..)| open(kinds))
        .map(|(.., advice)| *advice)
        .collect()
}

/// What would show a quantity of this kind, in a few words.
pub(crate) fn shown_by(kind: QuantityKind) -> Option<&'static str> {
    let mut all = WHAT_SHOWS.iter();
    let found = all.find(|(kinds, ..)| kinds.contains(&kind));
    found.map(|(_, words, _)| *words)
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_identification::results::{Bounds, Interval};
    use servoid_identification::servo_model::Unit;

    #[test]
    fn stairs_are_not_advised_alone_where_dead_band_and_friction_are_alike() {
        let levels = [0.0, 5.0, -3.0, 1.0, 4.0];
        let input: Vec<f64> = (0..900).map(|k| levels[k / 60 % 5]).collect();
        let follow = |y: &mut f64, (k, u): (usize, &f64)| {
            *y += 0.2 * (u - *y);
            Some(*y + 0.01 * (0.7 * (k * k) as f64).sin())
        };
        let output: Vec<f64> = input.iter().enumerate().scan(0.0, follow).collect();
        let record = servoid_identification::Record::of_run(0.01, input, output).unwrap();
        let options = servoid_identification::servo_model::ServoModelOptions::default();
        let mut model = servoid_identification::servo_model::fit(&record, &options).unwrap();
        let advised =
            |model: &ServoModel| advice_on_servo_model(model).contains(&STAIRS_DO_NOT_SEPARATE);
        model.covariance = Bounds::Withdrawn(Reason::ErrorsNotNoise);
        assert!(!advised(&model));
        model.terms.friction = true;
        assert!(advised(&model));
        assert_eq!(
            advice_on_servo_model(&model).last(),
            Some(&OF_ANOTHER_LOGGER)
        );
        model.covariance = Bounds::Withdrawn(Reason::TravelEnd);
        assert!(!advised(&model));
    }

    fn quantity(name: &str, determined: bool) -> Quantity {
        Quantity {
            name: name.to_owned(),
            unit: Unit::OutputPerSecond,
            determined,
            value: 400.0,
            interval: Bounds::Valid(Interval::new(400.0, 390.0, 410.0)),
            other_fits: None,
        }
    }

    #[test]
    fn what_is_not_determined_says_what_to_record() {
        let open = ["damping ratio", "top speed upwards"].map(|name| quantity(name, false));
        let advice = what_to_record(&open);
        assert_eq!(advice.len(), 2);
        assert!(advice[0].contains("large strokes") && advice[1].contains("small quick strokes"));
        assert!(what_to_record(&[quantity("top speed upwards", true)]).is_empty());
    }
}
