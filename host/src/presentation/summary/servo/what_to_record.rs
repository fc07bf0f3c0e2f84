//! What to record where a servo model leaves something open.

use super::top_speeds::has_unreached_top_speeds;
use crate::data::model_file::ServoModelDocument;
use servoid_identification::nonlinear::SpeedLimits;
use servoid_identification::results::Reason;
use servoid_identification::servo_model::{Quantity, QuantityKind, ServoModel};

/// What to say below the quantities of a servo model.
pub(crate) fn advice_on_servo_model(document: &ServoModelDocument) -> Vec<&'static str> {
    let model = &document.model;
    if model.is_linear() && model.covariance.valid().is_some() {
        return vec![LINEAR_IS_SHARPER];
    }
    if model.covariance.withdrawn() == Some(Reason::ErrorsNotNoise) {
        return match model.fit.servo_changed {
            true => vec![ONE_BY_ONE],
            false => beside_what_the_model_lacks(document),
        };
    }
    let mut advice = what_to_record(&model.quantities);
    advice.extend(has_unreached_top_speeds(model).then_some(LARGER_STROKES));
    advice.extend(holds_alike(model).then_some(STAIRS_DO_NOT_SEPARATE));
    advice.extend((!advice.is_empty()).then_some(WHERE_IT_ENDS));
    advice
}

/// Where the model lacks something, other recordings have no intervals either: what is asked for is what shows a value that stands without one.
///
/// The table "without intervals" in `docs/servo-model.md` is the evidence: accelerations, offset and bandwidth stay open whatever is recorded.
fn beside_what_the_model_lacks(document: &ServoModelDocument) -> Vec<&'static str> {
    let model = &document.model;
    let speeds = [
        QuantityKind::TopSpeedUpwards,
        QuantityKind::TopSpeedDownwards,
    ];
    let mut speeds = speeds.into_iter().filter_map(|kind| model.quantity(kind));
    let shows_no_speed =
        speeds.any(|found| !found.determined && model.limit_of_strokes(found.kind()).is_none());
    // A motion that goes on shows no rests.
    let has_strokes = model.speed_limits != SpeedLimits::default();
    let comes_to_rest = has_strokes || model.rests_apart.is_some() || model.hysteresis.is_some();
    let has_open_frame = (model.fit.waits_for_pulses).is_some_and(|waits| waits.length_is_open);
    let advice = [
        shows_no_speed.then_some(SPEED_IS_OPEN),
        (comes_to_rest && holds_alike(model)).then_some(STAIRS_DO_NOT_SEPARATE),
        (document.is_of_rows && !document.polled).then_some(SAY_POLLED),
        has_open_frame.then_some(HOLDS_OF_ONE_LENGTH),
        Some(match document.is_of_rows {
            true => WHAT_A_LOGGER_MAY_LACK,
            false => WHAT_MAY_BE_LACKING,
        }),
        Some(RUNS_ALONE),
        Some(WITHOUT_INTERVALS),
    ];
    advice.into_iter().flatten().collect()
}

/// Whether the record leaves open how a servo is held off its command: by a dead band, which stands still at its edge, or by friction. Of a model that lacks
/// something that is where it has one of the two: both are taken where each predicts what the other does not.
fn holds_alike(model: &ServoModel) -> bool {
    let is_held = model.terms.dead_band || model.terms.friction;
    let has_both = model.terms.dead_band && model.terms.friction;
    let is_open = |found: &Quantity| {
        let of_friction = |kind| QuantityKind::OF_FRICTION.contains(&kind);
        !found.determined && found.kind().is_some_and(of_friction)
    };
    let misses = model.covariance.withdrawn() == Some(Reason::ErrorsNotNoise);
    // Of a model that has one of the two, an interval from 0 on is that the other may be all of it.
    let may_be_none = |found: &Quantity| {
        let is_one = [QuantityKind::DeadBand, QuantityKind::RestingError]
            .map(Some)
            .contains(&found.kind());
        let interval = found.interval.valid();
        is_one && interval.is_some_and(|interval| interval.lower == Some(0.0))
    };
    let one_or_the_other = !has_both && model.quantities.iter().any(may_be_none);
    is_held && (misses && !has_both || one_or_the_other || model.quantities.iter().any(is_open))
}

/// Said of a servo that was faster than any stroke let it show.
const LARGER_STROKES: &str = "This recording does not show the top speed: strokes may have been too small for it, or commands that wait for their pulses, gusts or the supply hide it. Record larger strokes, as far as the travel allows.";

/// Said where a model that lacks something of the servo has no top speed.
const SPEED_IS_OPEN: &str = "The top speed is open, at least in one direction: random levels over most of the travel, held for random times, show it, in a recording of their own. If this is one, strokes may have been too small for it, what the model lacks may hide it, or commands that wait for their pulses.";

/// Said of a servo that a dead band or friction holds, where the record does not show which.
const STAIRS_DO_NOT_SEPARATE: &str = "Dead band and friction rest alike, and stairs hardly distinguish them: a large slow motion that goes on does, such as \
    sines of 0.1 to 3 Hz that add up to 30 degrees, for 20 s, with two seconds of rest before and after them (in servoid: --reference multisine --amplitude 30 \
    --frequencies 0.1:3 --length 20). Identify it together with this recording, in rows of one period, for the servo model alone: the linear model of two kinds of motion is of neither. A recording that has both shows no more.";

/// What times count from in a file of which nothing is stated.
const SAY_POLLED: &str = "If the logger, and not the pulses, had a clock of its own and looked for the command once in a row, say --polled: without it all times are half a row too early.";

/// What gives intervals in a file of another program, where more of the same does not.
const WHAT_A_LOGGER_MAY_LACK: &str = "Another recording of this kind, or a longer one, may have intervals where the model has all of the servo: of such servos a few recordings in a hundred have none by chance. Where pulses come on a clock of their own, commands wait for them: under random levels that are held \
    for random times, in a recording of their own, such pulses are mostly found where they come about every 20 ms, and none were found here, which does not say that there are none; or change the command with the pulse, and write it in the row of that moment, as servoid's own board does. Where the output is behind a linkage that is not linear, the supply changes along a recording, friction at rest is gone at once, or gusts load the shaft, \
    which the model lacks, fewer recordings have them, or hardly any. Steps of a sensor that are larger than its noise may hide them, too.";

/// The same of a recording of servoid, whose commands change with the pulse.
const WHAT_MAY_BE_LACKING: &str = "Another recording, or a longer one, may have intervals where the model has all of the servo, of which a few recordings in a hundred have none by chance, and fewer have, or hardly any, where the supply changes along a recording, friction at rest is gone at once, or gusts load the shaft, which it lacks. Steps of a sensor that are larger than its noise may hide intervals, too.";

/// Said of commands that waited for pulses, and were held for one length.
const HOLDS_OF_ONE_LENGTH: &str = "Holds of one length leave open how far apart the pulses are, and without that when they came: random levels that are held for random times, in a recording of their own, show both, and mostly have intervals.";

/// Said last but one: several runs may be those of a servo that changed a little, as by its supply.
const RUNS_ALONE: &str = "Several runs together may have no intervals where each alone has them: identify them one by one as well.";

/// Said of a servo that changed between runs, each of which has noise alone.
const ONE_BY_ONE: &str = "Identify the runs one by one: each may have intervals, and the scatter of their figures is that of the servo, of which intervals of one run say nothing. Look for \
    what changes between the runs, such as the supply voltage or the temperature.";

/// What is known without intervals.
const WITHOUT_INTERVALS: &str = "What is known without intervals: how far other fits are from the figures, and by 'servoid validate' how well the model predicts a recording \
    that it has not seen.";

/// Said last: whoever has followed the advice would be sent from one recording to the next otherwise.
const WHERE_IT_ENDS: &str = "If this recording has what is asked for here, only a longer one or one with less noise may show more of it. A limit beyond the travel shows in \
    none, and neither does what the model lacks.";

/// Said of a servo model without any term beyond a linear servo.
const LINEAR_IS_SHARPER: &str = "This recording needs no more than a linear servo: where the linear model has intervals, those of gain, bandwidth and times are \
    narrower as a rule. Those here also hold for limits, friction and loads that the recording leaves open.";

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
        "Friction, dead band, play, load and gain show at rest: record stairs of at least four levels, each reached from both sides and held until the servo rests.",
    ),
];

/// What to record for the quantities that this recording leaves open.
fn what_to_record(quantities: &[Quantity]) -> Vec<&'static str> {
    let open = |kinds: &&[QuantityKind]| {
        let left_open = quantities.iter().filter(|found| !found.determined);
        let mut left_open = left_open.filter_map(Quantity::kind);
        // It is the acceleration over the stiffness: larger strokes show no more of it.
        left_open.any(|kind| kinds.contains(&kind) && kind != QuantityKind::ErrorOfFullDrive)
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
    use crate::presentation::summary::servo::limited_servo::limited_servo;
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
        let model = servoid_identification::servo_model::fit(&record, &options).unwrap();
        let mut document = document(model, false);
        document.model.hysteresis = Some(Interval::new(0.4, 0.3, 0.5));
        let advised = |document: &ServoModelDocument| {
            advice_on_servo_model(document).contains(&STAIRS_DO_NOT_SEPARATE)
        };
        document.model.covariance = Bounds::Withdrawn(Reason::ErrorsNotNoise);
        assert!(!advised(&document));
        document.model.terms.friction = true;
        assert!(advised(&document));
        // One of sines is what is asked for.
        document.model.hysteresis = None;
        assert!(!advised(&document));
        document.model.covariance = Bounds::Withdrawn(Reason::TravelEnd);
        assert!(!advised(&document));
    }

    /// Of an interval from 0 on, all of it may be a dead band.
    #[test]
    fn friction_that_may_be_none_may_be_a_dead_band() {
        for (lower, is_advised) in [(0.0, true), (0.1, false)] {
            let mut model = limited_servo();
            (model.terms.friction, model.terms.dead_band) = (true, false);
            // Not for the errors, which have advice of their own.
            model.covariance = Bounds::Withdrawn(Reason::TravelEnd);
            model.quantities = vec![Quantity {
                interval: Bounds::Valid(Interval::new(0.2, lower, 0.3)),
                ..quantity("resting error by friction", true)
            }];
            let advice = advice_on_servo_model(&document(model, false));
            assert_eq!(
                advice.contains(&STAIRS_DO_NOT_SEPARATE),
                is_advised,
                "{lower}"
            );
        }
    }

    fn document(model: ServoModel, is_of_rows: bool) -> ServoModelDocument {
        ServoModelDocument {
            model,
            controller_names: Vec::new(),
            stroke_of_60_degrees_s: None,
            is_of_rows,
            polled: false,
            common_wait_s: 0.0,
        }
    }

    #[test]
    fn no_recording_is_asked_for_that_has_no_intervals_either() {
        let mut model = limited_servo();
        for quantity in &mut model.quantities {
            let of_rest = (quantity.kind()).is_some_and(|kind| {
                QuantityKind::OF_REST.contains(&kind) || kind == QuantityKind::AccelerationUpwards
            });
            quantity.determined = !of_rest;
        }
        model.covariance = Bounds::Withdrawn(Reason::TravelEnd);
        let before_a_stop = document(model.clone(), true);
        assert!(advice_on_servo_model(&before_a_stop).contains(&WHERE_IT_ENDS));
        model.covariance = Bounds::Withdrawn(Reason::ErrorsNotNoise);
        let of_logger = advice_on_servo_model(&document(model.clone(), true));
        assert_eq!(
            of_logger,
            [
                SAY_POLLED,
                WHAT_A_LOGGER_MAY_LACK,
                RUNS_ALONE,
                WITHOUT_INTERVALS
            ]
        );
        let polled = ServoModelDocument {
            polled: true,
            ..document(model.clone(), true)
        };
        assert!(!advice_on_servo_model(&polled).contains(&SAY_POLLED));
        let of_servoid = advice_on_servo_model(&document(model, false));
        assert_eq!(
            of_servoid,
            [WHAT_MAY_BE_LACKING, RUNS_ALONE, WITHOUT_INTERVALS]
        );
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
