//! The quantities of two servo models beside each other.
//!
//! The interval of a quantity holds for every servo that its record does not distinguish, so it is a hull and has no standard
//! deviation. The interval of a difference b - a is therefore that of the two intervals,
//!
//! ```text
//! from b_low - a_up   to b_up - a_low
//! ```
//!
//! which holds wherever both hold. Where both recordings were made alike, most of the time by which their output may have been recorded earlier or later is one
//! and the same, and is not in the difference of the delays: that is of the intervals by noise, and of what each may be off by itself. Where two sensors recorded the sides, what their scales may be off from each other is added, and where a load changes with the angle, what the quantities of both are [apart by their
//! angles](super::at_one_angle). For independent records it is wider than it would have to be.

use super::at_one_angle::{by_angles, with_shift};
use super::rests_apart::RestsApart;
use super::sides::Sides;
use crate::nonlinear::SpeedLimits;
use crate::numerics::pointwise_critical;
use crate::options::Options;
use crate::results::{Bounds, Interval, Reason};
use crate::servo_model::{
    Quantity, QuantityKind, ServoModel, Spread, Stops, StopsDocument, Unit, WaitsForPulses,
};
use serde::{Deserialize, Serialize};

/// Two servo models beside each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ServoModelComparison {
    /// The quantities that one of the two has, in the order in which they are shown.
    pub quantities: Vec<QuantityPair>,
    /// The stops, where one of the two has any; left out elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stops: Option<StopsOfBoth>,
    /// How far apart the rests under one command are in the record of each.
    #[serde(default)]
    pub rests_apart: RestsApart,
    /// The speeds that larger strokes have in common in the record of each, where a model has no intervals of its top speeds; left out elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_limits: Option<SpeedLimitsOfBoth>,
    /// Whether the difference of the delays is without the time by which the outputs of both may have been recorded earlier or later.
    #[serde(default)]
    pub shared_delay_error: bool,
    /// The waits of the two recordings that the difference of the delays contains \[s\]; left out where it contains none.
    #[serde(default, skip_serializing_if = "is_without_waits")]
    pub waits_s: [f64; 2],
    /// Root mean square of the errors of either model \[output\]: what it lacks, such as a play of that size, may be in them.
    #[serde(default)]
    pub rmse: Sides<f64>,
    /// Whether quantities of both depend on the angle, and are those at the middle of commands that differ: their differences then contain what that makes.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub at_other_angles: bool,
    /// How long a whole stroke takes; left out where that was not asked for, or where neither model says it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stroke: Option<StrokeTimes>,
    /// Intervals of both sides and of their differences; withdrawn where one side has none.
    #[serde(flatten)]
    pub bounds: Bounds<QuantityDifferences>,
    /// Why a side has no intervals; left out where both have them.
    #[serde(default, skip_serializing_if = "Sides::have_none")]
    pub without_bounds: Sides<Option<Reason>>,
    /// The pulses that the commands of each side waited for, at which its model has them; left out where neither has any.
    #[serde(default, skip_serializing_if = "Sides::have_none")]
    pub waits_for_pulses: Sides<Option<WaitsForPulses>>,
}

/// The speeds of the larger strokes of both sides, as they were measured: no model is asked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpeedLimitsOfBoth {
    /// Of the first servo.
    pub a: SpeedLimits,
    /// Of the second servo.
    pub b: SpeedLimits,
}

/// How long a whole stroke takes, as both models have it, with delay, acceleration and braking.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StrokeTimes {
    /// Its size \[output\].
    pub size: f64,
    /// Of the first servo, upwards and downwards \[s\]; `None` where its model does not say it.
    pub a_s: Option<[f64; 2]>,
    /// Of the second servo.
    pub b_s: Option<[f64; 2]>,
}

/// The stops of both sides.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StopsOfBoth {
    /// Of the first servo.
    #[serde(with = "StopsDocument")]
    pub a: Stops,
    /// Of the second servo.
    #[serde(with = "StopsDocument")]
    pub b: Stops,
    /// Whether the two differ there: one has a stop where the other one, whose commands go farther, has none.
    pub differ: bool,
}

/// A quantity of both sides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct QuantityPair {
    /// What it is, in the words of the glossary.
    pub name: String,
    /// Its unit.
    pub unit: Unit,
    /// Of the first servo; `None` where its record does not determine it, or its model does without.
    pub a: Option<f64>,
    /// Of the second servo.
    pub b: Option<f64>,
    /// What other fits to the record of each say, where its errors are not noise; left out elsewhere.
    #[serde(default, skip_serializing_if = "Sides::have_none")]
    pub other_fits: Sides<Option<Spread>>,
    /// Its interval on the one side that has any, where the other has none; left out elsewhere.
    #[serde(default, skip_serializing_if = "Sides::have_none")]
    pub interval_of_one: Sides<Option<Interval>>,
}

/// What is sure about the quantities of both sides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct QuantityDifferences {
    /// Level of each interval: the lower one of the two models.
    pub level: f64,
    /// Quantity by quantity, in the same order.
    pub differences: Vec<QuantityDifference>,
}

/// Intervals of a quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct QuantityDifference {
    /// What it is.
    pub name: String,
    /// Of the first servo, where its model has it.
    pub a: Option<Interval>,
    /// Of the second servo.
    pub b: Option<Interval>,
    /// Second less first, where both are determined.
    pub difference: Option<Interval>,
}

impl QuantityPair {
    /// Which quantity it is; `None` of one that this version does not know.
    #[must_use]
    pub fn kind(&self) -> Option<QuantityKind> {
        QuantityKind::named(&self.name)
    }
}

impl QuantityDifference {
    /// As of a [`QuantityPair`].
    fn kind(&self) -> Option<QuantityKind> {
        QuantityKind::named(&self.name)
    }

    /// Whether the two differ for sure.
    #[must_use]
    pub fn is_sure(&self) -> bool {
        self.difference.is_some_and(|found| !found.contains(0.0))
    }
}

fn is_without_waits(waits_s: &[f64; 2]) -> bool {
    *waits_s == [0.0; 2]
}

/// A shift by other angles that is this part of the width of a difference is worth a word.
const SHIFT_THAT_SHOWS: f64 = 0.01;

/// Puts two servo models beside each other, where the ratio of the scales of their outputs has the standard deviation `scale_sd`, 0.05 for 5 %, and
/// the outputs of both were recorded earlier or later than they are taken for by one and the same time, but for an `own_delay_error_s` of each; `None`
/// where these times have nothing to do with each other. Where they have several controllers, the quantities are those of the first.
#[must_use]
pub fn compare_servo_models(
    a: &ServoModel,
    b: &ServoModel,
    scale_sd: f64,
    own_delay_error_s: Option<f64>,
) -> ServoModelComparison {
    let [a_model, b_model] = [a, b];
    let pairs = paired(&a.quantities, &b.quantities);
    let have_both = a.covariance.valid().is_some() && b.covariance.valid().is_some();
    let pair = |(a, b): &(Option<&Quantity>, Option<&Quantity>)| {
        let either = a.or(*b)?;
        let known =
            |model: &ServoModel, of: &Quantity| of.determined && !model.only_extrapolates(of);
        let of_a = a.filter(|of| known(a_model, of));
        let of_b = b.filter(|of| known(b_model, of));
        let spread = |of: Option<&Quantity>| of.and_then(|of| of.other_fits);
        let of_one = |of: Option<&Quantity>| {
            let interval = of.and_then(|of| of.interval.valid().copied());
            interval.filter(|_| !have_both)
        };
        Some(QuantityPair {
            name: either.name.clone(),
            unit: either.unit,
            a: of_a.map(|of| of.value),
            b: of_b.map(|of| of.value),
            other_fits: Sides::of([of_a, of_b], spread),
            interval_of_one: Sides::of([of_a, of_b], of_one),
        })
    };
    let level = |of: &ServoModel| of.covariance.as_ref().map(|found| found.level);
    let delays = own_delay_error_s.and_then(|own| {
        let both = a.delay_by_noise.zip(b.delay_by_noise)?;
        Some((both.0.reaching(own, own), both.1.reaching(own, own)))
    });
    let shift = |(a, b): &(Option<&Quantity>, Option<&Quantity>)| {
        let kind = a.or(*b).and_then(Quantity::kind);
        kind.and_then(|kind| by_angles(kind, [a_model, b_model]))
            .unwrap_or_default()
    };
    let widens = |pair: &(Option<&Quantity>, Option<&Quantity>)| {
        let found = difference(pair.0, pair.1, 0.0, None).and_then(|found| found.difference);
        let width = found.and_then(|between| between.width());
        width.is_some_and(|width| shift(pair).abs() > SHIFT_THAT_SHOWS * width)
    };
    let differences = |level: f64| {
        let scale_error = pointwise_critical(level) * scale_sd;
        let of = |pair: &(Option<&Quantity>, Option<&Quantity>)| {
            let found = difference(pair.0, pair.1, scale_error, delays)?;
            let between = found.difference;
            Some(QuantityDifference {
                difference: between.map(|between| with_shift(between, shift(pair))),
                ..found
            })
        };
        pairs.iter().filter_map(of).collect()
    };
    let levels = level(a).zip(level(b)).map(|(a, b)| a.min(b));
    ServoModelComparison {
        quantities: pairs.iter().filter_map(pair).collect(),
        stops: stops(a, b),
        stroke: None,
        speed_limits: speed_limits(a, b).filter(|_| levels.valid().is_none()),
        rests_apart: RestsApart::of(
            [a.rests_apart, b.rests_apart],
            scale_sd,
            levels.into_valid().unwrap_or(Options::default().level),
        )
        .or_means([a.hysteresis, b.hysteresis]),
        shared_delay_error: delays.is_some(),
        waits_s: [0.0; 2],
        rmse: Sides::of([a, b], |model| model.fit.rmse),
        at_other_angles: pairs.iter().any(widens),
        without_bounds: Sides::of([a, b], |model| model.covariance.withdrawn()),
        waits_for_pulses: Sides::of([a, b], |model| model.fit.waits_for_pulses),
        bounds: levels.map(|level| QuantityDifferences {
            level,
            differences: differences(level),
        }),
    }
}

impl ServoModelComparison {
    pub(super) fn differences(&self) -> &[QuantityDifference] {
        let bounds = self.bounds.valid();
        bounds.map_or(&[], |bounds| &bounds.differences)
    }

    /// Whether a quantity is determined in both, with an interval of the difference.
    #[must_use]
    pub fn compares(&self) -> bool {
        let has_ends = |found: &Interval| found.lower.or(found.upper).is_some();
        let differences = self.differences().iter();
        let mut both = differences.filter_map(|found| found.difference);
        both.any(|found| has_ends(&found))
    }

    /// The measured speeds of both sides in the place of the top speed `kind`, where both records show one and models have no intervals.
    #[must_use]
    pub fn speeds_of_strokes(&self, kind: QuantityKind) -> Option<[f64; 2]> {
        let SpeedLimitsOfBoth { a, b } = self.speed_limits?;
        match kind {
            QuantityKind::TopSpeedUpwards => Some([a.upwards?, b.upwards?]),
            QuantityKind::TopSpeedDownwards => Some([a.downwards?, b.downwards?]),
            _ => None,
        }
    }

    /// With the times of a stroke of `size` \[output\] by the two models; without that of one which takes it at a top speed that it extrapolates.
    #[must_use]
    pub fn with_stroke(self, [a, b]: [&ServoModel; 2], size: f64) -> Self {
        let of = |model: &ServoModel| {
            let mut quantities = model.quantities.iter();
            let extrapolates = quantities.any(|quantity| model.only_extrapolates(quantity));
            model.stroke_times_s(size).filter(|_| !extrapolates)
        };
        let [a_s, b_s] = [a, b].map(of);
        Self {
            stroke: (a_s.or(b_s)).map(|_| StrokeTimes { size, a_s, b_s }),
            ..self
        }
    }

    /// With delays that contain waits of the two recordings, each of up to `waits_s`, which are not of the servos.
    #[must_use]
    pub fn with_waits(self, waits_s: [f64; 2]) -> Self {
        let delay = QuantityKind::Delay;
        let reach = |found: Interval| found.reaching(waits_s[1], waits_s[0]);
        let bounds = self.bounds.map(|mut bounds| {
            let mut differences = bounds.differences.iter_mut();
            if let Some(found) = differences.find(|found| found.kind() == Some(delay)) {
                found.difference = found.difference.map(reach);
            }
            bounds
        });
        Self {
            bounds,
            waits_s,
            ..self
        }
    }

    /// Without what depends on the unit of the command, which the two sides do not share.
    #[must_use]
    pub fn of_the_output_alone(self) -> Self {
        let of_output = self.with_quantities(|pair| {
            let of_command = matches!(pair.unit, Unit::Command | Unit::OutputPerCommand);
            !of_command && pair.kind() != Some(QuantityKind::Offset)
        });
        Self {
            // Which commands go farther nobody can say.
            stops: of_output.stops.map(|stops| StopsOfBoth {
                differ: false,
                ..stops
            }),
            ..of_output
        }
    }

    /// Without the output at rest under command 0, of servos whose commands are all far from it: it differs there by what the gains differ by.
    #[must_use]
    pub fn without_offset(self) -> Self {
        self.with_quantities(|pair| pair.kind() != Some(QuantityKind::Offset))
    }

    fn with_quantities(self, is_kept: impl Fn(&QuantityPair) -> bool) -> Self {
        let mut quantities = self.quantities;
        quantities.retain(is_kept);
        let is_left =
            |found: &QuantityDifference| quantities.iter().any(|pair| pair.name == found.name);
        let bounds = self.bounds.map(|mut bounds| {
            bounds.differences.retain(is_left);
            bounds
        });
        Self {
            quantities,
            bounds,
            ..self
        }
    }
}

/// `None` where neither has any.
fn stops(a: &ServoModel, b: &ServoModel) -> Option<StopsOfBoth> {
    let any = !(a.stops.are_none() && b.stops.are_none());
    any.then(|| StopsOfBoth {
        a: a.stops,
        b: b.stops,
        differ: has_a_stop_of_its_own(a, b) || has_a_stop_of_its_own(b, a),
    })
}

/// `None` where neither record shows any.
fn speed_limits(a: &ServoModel, b: &ServoModel) -> Option<SpeedLimitsOfBoth> {
    let [a, b] = [a.speed_limits, b.speed_limits];
    (!a.are_none() || !b.are_none()).then_some(SpeedLimitsOfBoth { a, b })
}

/// Whether `servo` has a stop, and shows it, at an end where `other` has none, and follows commands beyond it by more than its errors.
fn has_a_stop_of_its_own(servo: &ServoModel, other: &ServoModel) -> bool {
    let Some(commands) = other.commands.filter(|_| servo.shows_its_stops()) else {
        return false;
    };
    let [own, others] = [servo, other].map(|of| of.parameters(0).range());
    let errors = (other.fit.rmse / other.parameters(0).gain).abs();
    let below = own[0].is_finite() && others[0].is_infinite();
    let above = own[1].is_finite() && others[1].is_infinite();
    (below && commands.least < own[0] - errors) || (above && commands.largest > own[1] + errors)
}

/// The quantities of both by name: those of the first, then those that only the second has.
fn paired<'q>(
    a: &'q [Quantity],
    b: &'q [Quantity],
) -> Vec<(Option<&'q Quantity>, Option<&'q Quantity>)> {
    let named = |of: &'q [Quantity], name: &str| of.iter().find(|found| found.name == name);
    let of_a = a.iter().map(|found| (Some(found), named(b, &found.name)));
    let only_b = b
        .iter()
        .filter(|found| named(a, &found.name).is_none())
        .map(|found| (None, Some(found)));
    of_a.chain(only_b).collect()
}

/// Whether a quantity of this unit grows with the scale of the output.
fn has_scale(unit: Unit) -> bool {
    match unit {
        Unit::Seconds | Unit::Hertz | Unit::One | Unit::Command => false,
        Unit::OutputPerCommand
        | Unit::Output
        | Unit::OutputPerSecond
        | Unit::OutputPerSecondSquared => true,
    }
}

/// What is sure of one quantity; `delays` are the intervals of the delay that count for its difference, where they are others than those of the quantity.
fn difference(
    a: Option<&Quantity>,
    b: Option<&Quantity>,
    scale_error: f64,
    delays: Option<(Interval, Interval)>,
) -> Option<QuantityDifference> {
    let interval = |of: Option<&Quantity>| of.and_then(|of| of.interval.valid().copied());
    let (a_is, b_is) = (interval(a), interval(b));
    let both = a.zip(b).filter(|(a, b)| a.determined && b.determined);
    let less = |x: Option<f64>, y: Option<f64>| Some(x? - y?);
    let is_delay = a.or(b)?.kind() == Some(QuantityKind::Delay);
    let between = delays.filter(|_| is_delay).or(a_is.zip(b_is));
    let difference = both.and(between).map(|(a, b)| Interval {
        value: less(b.value, a.value),
        lower: less(b.lower, a.upper),
        upper: less(b.upper, a.lower),
    });
    let of_scale = |b: &Quantity| match has_scale(b.unit) {
        true => scale_error * b.value.abs(),
        false => 0.0,
    };
    let error = b.map_or(0.0, of_scale);
    let difference = difference.map(|of: Interval| of.reaching(error, error));
    Some(QuantityDifference {
        name: a.or(b)?.name.clone(),
        a: a_is,
        b: b_is,
        difference,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::Verdict;
    use crate::nonlinear::SpeedLimits;
    use crate::results::Reason;
    use crate::servo_model::{ServoModelOptions, fit};
    use crate::{Record, Run};

    /// A servo that follows with this top speed, in degrees for each sample.
    fn model(top_speed: f64) -> ServoModel {
        let levels = [0.0, 5.0, -3.0, 1.0, 4.0];
        let u: Vec<f64> = (0..900).map(|k| levels[k / 60 % 5]).collect();
        let follow = |y: &mut f64, (k, u): (usize, &f64)| {
            *y += (0.2 * (u - *y)).clamp(-top_speed, top_speed);
            Some(*y + 0.01 * (0.7 * (k * k) as f64).sin())
        };
        let y: Vec<f64> = u.iter().enumerate().scan(0.0, follow).collect();
        let record = Record::new(0.01, vec![Run::new(u, y).unwrap()]).unwrap();
        fit(&record, &ServoModelOptions::default()).unwrap()
    }

    #[test]
    fn a_stop_that_only_one_has_is_a_difference_where_the_other_one_goes_beyond_it() {
        let free = model(1.0);
        let mut stopped = free.clone();
        let found = |a: &ServoModel, b: &ServoModel| compare_servo_models(a, b, 0.0, None).stops;
        assert_eq!(found(&free, &stopped), None);
        // Commands of the record go from -3 to 5.
        for (end, differ) in [(3.0, true), (6.0, false)] {
            stopped.stops.upper = Some(end);
            let both = found(&free, &stopped).unwrap();
            assert_eq!((both.a, both.b), (Stops::default(), stopped.stops));
            assert_eq!(both.differ, differ, "{end}");
            assert_eq!(found(&stopped, &free).unwrap().differ, differ, "{end}");
            assert!(!found(&stopped, &stopped).unwrap().differ);
        }
        let text =
            serde_json::to_string(&compare_servo_models(&free, &stopped, 0.0, None)).unwrap();
        assert!(
            text.contains(r#""stops":{"a":{},"b":{"upper":6.0},"differ":false}"#),
            "{text}"
        );
    }

    #[test]
    fn a_top_speed_that_a_model_without_intervals_extrapolates_is_not_compared() {
        let kind = Some(QuantityKind::TopSpeedUpwards);
        let compares = |times: f64| {
            let mut model = model(0.5);
            let reached = model.reached.unwrap().measured()[0];
            model.covariance = Bounds::Withdrawn(Reason::ErrorsNotNoise);
            model.speed_limits = SpeedLimits::default();
            let mut quantities = model.quantities.iter_mut();
            let speed = quantities.find(|of| of.kind() == kind).unwrap();
            (speed.determined, speed.value) = (true, times * reached);
            let found = compare_servo_models(&model, &model, 0.0, None);
            let mut pairs = found.quantities.into_iter();
            let pair = pairs.find(|pair| pair.kind() == kind).unwrap();
            pair.a.is_some() && pair.b.is_some()
        };
        assert!(compares(1.05));
        assert!(!compares(1.2));
    }

    #[test]
    fn far_from_command_zero_all_but_the_offset_is_compared() {
        let found = compare_servo_models(&model(0.5), &model(1.0), 0.0, None);
        let without = found.clone().without_offset();
        let names = |of: &ServoModelComparison| -> Vec<String> {
            of.quantities.iter().map(|pair| pair.name.clone()).collect()
        };
        let mut expected = names(&found);
        assert!(expected.iter().any(|name| name == "offset"));
        expected.retain(|name| name != "offset");
        assert_eq!(names(&without), expected);
        if let Some(bounds) = without.bounds.valid() {
            let of_bounds = bounds.differences.iter().map(|of| of.name.clone());
            assert_eq!(of_bounds.collect::<Vec<_>>(), expected);
        }
    }

    #[test]
    fn a_command_in_another_unit_leaves_what_is_of_the_output() {
        let (slow, fast) = (model(0.5), model(1.0));
        let found = compare_servo_models(&slow, &fast, 0.0, None)
            .with_stroke([&slow, &fast], 4.0)
            .of_the_output_alone();
        let names: Vec<&str> = found.quantities.iter().map(|of| of.name.as_str()).collect();
        assert!(names.contains(&"delay") && names.contains(&"bandwidth at small signals"));
        assert!(
            !names.contains(&"gain") && !names.contains(&"offset"),
            "{names:?}"
        );
        if let Some(bounds) = found.bounds.valid() {
            let of_bounds: Vec<&str> = bounds
                .differences
                .iter()
                .map(|of| of.name.as_str())
                .collect();
            assert_eq!(of_bounds, names);
        }
        let stroke = found.stroke.unwrap();
        assert!(
            stroke.a_s.unwrap()[0] > stroke.b_s.unwrap()[0],
            "{stroke:?}"
        );
    }

    fn with_interval(mut model: ServoModel, half: f64) -> ServoModel {
        model.covariance = Bounds::Valid(crate::servo_model::Covariance {
            level: 0.99,
            rows: Vec::new(),
        });
        for quantity in &mut model.quantities {
            let value = quantity.value;
            quantity.determined = true;
            quantity.interval =
                Bounds::Valid(Interval::new(value, value - half, value + 2.0 * half));
        }
        model
    }

    #[test]
    fn what_two_recordings_leave_open_alike_is_not_in_the_difference_of_their_delays() {
        let apart = |own_delay_error_s: Option<f64>| {
            let of = |half: f64| with_interval(model(1.0), half).with_delay_error(0.006);
            let found = compare_servo_models(&of(0.001), &of(0.002), 0.0, own_delay_error_s);
            let bounds = found.bounds.valid().unwrap();
            let delay = bounds.differences.iter().find(|one| one.name == "delay");
            (found.shared_delay_error, delay.unwrap().difference.unwrap())
        };
        let (shared, noise) = apart(Some(0.0));
        let (_, wider) = apart(Some(0.001));
        let (both, wide) = apart(None);
        assert!(shared && !both);
        // From 1 ms below the first and 4 ms above the second to 2 ms above the first and 2 ms below the second.
        assert!((noise.lower.unwrap() + 0.004).abs() < 1e-9, "{noise:?}");
        assert!((noise.upper.unwrap() - 0.005).abs() < 1e-9, "{noise:?}");
        assert!((wider.upper.unwrap() - 0.007).abs() < 1e-9, "{wider:?}");
        assert!(wide.lower < wider.lower && wide.upper > wider.upper);
    }

    #[test]
    fn rests_that_are_farther_apart_are_a_difference_of_machines_without_intervals_too() {
        let apart = |model: ServoModel, value: f64| ServoModel {
            rests_apart: Some(Interval::new(value, value - 0.05, value + 0.05)),
            ..model
        };
        let of = |a: f64, b: f64| {
            compare_servo_models(&apart(model(1.0), a), &apart(model(1.0), b), 0.0, None)
        };
        assert!(of(0.06, 0.6).rests_apart.differ() && of(0.06, 0.6).answer_before(None));
        assert!(!of(0.06, 0.1).rests_apart.differ());
        let alike = of(0.06, 0.1).rests_apart;
        let alike = alike.nothing_sure_in_words(["A", "B"], "deg");
        let said = "are up to 0.060 deg (0.010 .. 0.110) apart in A and up to 0.100 deg (0.050 .. 0.150) apart in B. That shows no difference, and does not exclude one of up to 0.140 deg. It excludes no wear: play between the motor and the servo's own sensor may leave rests as they are, and friction may stop a servo that overshoots where play takes it back.";
        assert!(alike.ends_with(said), "{alike}");
        let unknown = compare_servo_models(&model(1.0), &apart(model(1.0), 0.6), 0.0, None);
        assert!(!unknown.rests_apart.differ());
        let sentence = unknown.rests_apart.nothing_sure_in_words(["A", "B"], "deg");
        assert!(
            sentence.contains("the recording of A does not show"),
            "{sentence}"
        );
    }

    #[test]
    fn machines_that_determine_nothing_are_not_compared_and_come_after_what_step_responses_show() {
        let determined = with_interval(model(1.0), 1.0);
        let mut open = determined.clone();
        for quantity in &mut open.quantities {
            quantity.determined = false;
        }
        let of = |a: &ServoModel, b: &ServoModel| compare_servo_models(a, b, 0.0, None);
        let (same, nothing) = (of(&determined, &determined), of(&determined, &open));
        assert!(same.compares() && same.answer_before(None));
        assert!(!nothing.compares() && !nothing.answer_before(None));

        let noise = |k: usize| 0.02 * (((k * 7919) % 101) as f64 - 50.0) / 50.0;
        let u: Vec<f64> = (0..2000).map(|k| [5.0, -5.0][k * k / 9000 % 2]).collect();
        let lag = |speed: f64, shift: usize| {
            let follow = |y: &mut f64, (k, u): (usize, &f64)| {
                *y += speed * (u - *y);
                Some(*y + noise(k + shift))
            };
            let y: Vec<f64> = u.iter().enumerate().scan(5.0, follow).collect();
            Record::of_run(0.002, &u, y).unwrap()
        };
        let options = crate::comparison::ComparisonOptions {
            margin_percent: 0.0,
            ..Default::default()
        };
        let mut undecided =
            crate::comparison::compare(&lag(0.2, 0), &lag(0.2, 17), &options).unwrap();
        undecided.verdict = Verdict::Undecided;
        assert!(!same.answer_before(Some(&undecided)));
        undecided.descriptions_of_different_motions = true;
        assert!(same.answer_before(Some(&undecided)));
        assert!(!nothing.answer_before(Some(&undecided)));
    }

    #[test]
    #[ignore = "five seconds: cargo test -p servoid-identification --lib -- --ignored differences_hold"]
    fn differences_hold_wherever_both_intervals_hold_and_go_with_them() {
        let (slow, fast) = (model(0.2), model(0.4));
        let (a, b) = (
            with_interval(slow.clone(), 1.0),
            with_interval(fast.clone(), 1.0),
        );
        let found = compare_servo_models(&a, &b, 0.0, None);
        let bounds = found.bounds.valid().unwrap();
        assert_eq!(bounds.differences.len(), found.quantities.len());
        let at = |name: &str| bounds.differences.iter().find(|d| d.name == name).unwrap();
        let speed = at("top speed upwards");
        let pair = found.quantities.iter().find(|q| q.name == speed.name);
        let value = pair.and_then(|q| Some(q.b? - q.a?)).unwrap();
        assert!(value > 10.0, "{value}");
        let expected = Interval::new(value, value - 3.0, value + 3.0);
        let difference = speed.difference.unwrap();
        for (x, y) in [
            (difference.lower, expected.lower),
            (difference.upper, expected.upper),
        ] {
            // Rounding.
            assert!((x.unwrap() - y.unwrap()).abs() < 1e-9);
        }
        assert!(speed.is_sure() && !at("gain").is_sure());
        let mut without = b.clone();
        without.covariance = Bounds::Withdrawn(Reason::ErrorsNotNoise);
        let found = compare_servo_models(&a, &without, 0.0, None);
        assert_eq!(found.bounds.withdrawn(), Some(Reason::ErrorsNotNoise));
        let text = serde_json::to_string(&found).unwrap();
        assert!(!text.contains("lower"), "{text}");
    }
}
