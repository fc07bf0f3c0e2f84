//! Whether the servo goes as far as the command says, where both are degrees.

use crate::data::dataset::Dataset;
use crate::data::sensor_preset::SensorKind;
use servoid_identification::column::mean;
use servoid_identification::diagnostics::{Approach, Arrival};
use servoid_identification::results::{Advice, Check, Interval, Model, Reason, pointwise_critical};

/// A gain from which on a servo goes as far as it is commanded, whatever its friction.
const WHOLE_WAY: f64 = 0.98;

/// How the servo arrives at the outermost commands, where it does not go as far as they say.
fn arrivals_short_of_command(data: &Dataset, model: &Model) -> Vec<Arrival> {
    let gain = model.metrics.dc_gain;
    let falls_short = gain.value.is_some_and(|gain| gain > 0.0)
        && (gain.upper.or(gain.value)).is_some_and(|most| most < WHOLE_WAY);
    match falls_short {
        true => {
            let found = Arrival::at_both_ends(&data.record, model);
            found.into_iter().flatten().collect()
        }
        false => Vec::new(),
    }
}

/// Takes the bounds away of a model whose servo falls short of its command and comes to rest at full speed, as at a stop, and says so. The
/// rests of a command of two levels do not show a stop; those of more do, which identification finds.
pub(crate) fn withdraw_at_stops(data: &Dataset, model: &mut Model) {
    let stands = model.level().withdrawn().is_none_or(Reason::leaves_a_servo);
    if data.about.calibrations.is_empty() || !stands || !model.stops.is_empty() {
        return;
    }
    let mut cut_off = arrivals_short_of_command(data, model);
    cut_off.retain(|arrival| arrival.approach == Approach::CutOff);
    let ends: Vec<String> = (cut_off.iter())
        .map(|end| format!("{:.1} deg under a command of {:.1}", end.rest, end.command))
        .collect();
    let (Some(gain), Some(first)) = (model.metrics.dc_gain.value, cut_off.first()) else {
        return;
    };
    let advice = Advice::new(
        Check::TravelEnd,
        format!(
            "The servo runs into a stop at {}: it gets there at full speed and ends at once, and its strokes are {gain:.2} of the command. All times here are \
             those of the stop, too.",
            ends.join(", and at ")
        ),
        first.rest,
        first.command,
        "Record again with an amplitude on this side of the stop; 'servoid calibrate' finds the ends of the travel. A servo that turns at a slow speed \
         which was programmed ends so, too.",
    );
    // Errors that follow the motion are its consequence.
    model.advice.retain(|item| !item.is_of_errors_in_motion());
    model.advice.insert(0, advice);
    model.withdraw_at_stops(cut_off.iter().map(|end| end.rest).collect());
}

/// That the gain of a recording of servoid is not 1 within what is known of it and of the sensor's scale: the command is in degrees of the
/// rig file, which the servo is to turn.
pub(crate) fn advice(data: &Dataset, model: &Model) -> Option<Advice> {
    let calibrations = &data.about.calibrations;
    let sd_percent = calibrations.iter().map(|found| found.scale_sd_percent);
    let scale_percent =
        pointwise_critical(model.level().into_valid()?) * sd_percent.reduce(f64::max)?;
    let gain = model.metrics.dc_gain;
    let rest_percent = 100.0 * gain_of_dead_band(data)?;
    // One that turns the other way is another finding.
    let value = gain
        .value
        .filter(|_| may_not_be_one(gain, scale_percent + rest_percent))?;
    let kind = calibrations.first().and_then(|found| {
        let degrees_per_count = found.degrees_per_count;
        other_sensor(value, degrees_per_count, scale_percent)
    });
    let arrivals = arrivals_short_of_command(data, model);
    let is_free = |arrival: &Arrival| arrival.approach == Approach::Free;
    let may_meet_stop = value < 1.0 && (arrivals.is_empty() || !arrivals.iter().all(is_free));
    let scales = match kind {
        Some(kind) => format!(
            "a sensor of another kind (that of a {} would make it {:.2}), a wrong us_per_degree or degrees_per_count",
            kind.preset().name,
            value * degrees_of(kind) / calibrations.first()?.degrees_per_count.abs()
        ),
        None => "a wrong us_per_degree or degrees_per_count".to_owned(),
    };
    let cause = match (may_meet_stop, value < 1.0 && kind.is_none()) {
        (true, _) => format!(
            "stops or a limit of the travel, which then make all times here, a load to which the servo yields, or {scales}"
        ),
        (false, true) => format!(
            "a load to which the servo yields, or {scales} (a stop is unlikely, since the servo slows down before its rest or passes it)"
        ),
        (false, false) => scales,
    };
    Some(Advice::new(
        Check::Travel,
        format!(
            "The servo ends at {value:.2} of the command, the scale of the sensor is known to ±{scale_percent:.1} %, and a dead band of {DEAD_BAND_US:.0} µs, as \
             servos have it, changes strokes of this size by no more than {rest_percent:.1} %: {cause}."
        ),
        value,
        1.0,
        "Run 'servoid calibrate', which measures both scales and finds the ends of the travel; stairs of several levels ('servoid capture --reference stairs') \
         show a stop, too.",
    ))
}

/// How far a servo may rest off its command \[µs\]: data sheets of servos for models state dead bands from 1 µs (digital) to 10 µs (the smallest ones).
const DEAD_BAND_US: f64 = 5.0;

/// What a rest that is off by that to the inner or to the outer side changes in a gain: under strokes from -A to A it is off by its share of A.
fn gain_of_dead_band(data: &Dataset) -> Option<f64> {
    let off = DEAD_BAND_US / data.about.us_per_degree?.abs();
    let inputs = data.record.inputs();
    let inputs: Vec<f64> = inputs.filter(|input| !input.is_nan()).collect();
    let middle = mean(&inputs)?;
    let from_middle = inputs.iter().map(|input| (input - middle).abs());
    let (sum, square) = from_middle.fold((0.0, 0.0), |(sum, square), way| {
        (sum + way, square + way * way)
    });
    Some(off * sum / square)
}

/// Whether 1 lies outside of the interval of a gain above 0, widened by what is not known beside it.
fn may_not_be_one(gain: Interval, scale_percent: f64) -> bool {
    let widened =
        |bound: Option<f64>, sign: f64| Some(bound? * (1.0 + sign * scale_percent / 100.0));
    let ends = widened(gain.lower, -1.0).zip(widened(gain.upper, 1.0));
    gain.lower.is_some_and(|lower| lower > 0.0)
        && ends.is_some_and(|(lower, upper)| !(lower..=upper).contains(&1.0))
}

/// The kind of sensor by whose scale the gain would be 1, as far as a scale is known.
fn other_sensor(gain: f64, degrees_per_count: f64, scale_percent: f64) -> Option<SensorKind> {
    let percent = |kind: &SensorKind| {
        let would_be = gain * degrees_of(*kind) / degrees_per_count.abs();
        100.0 * (would_be - 1.0).abs()
    };
    let mut kinds = SensorKind::ALL.into_iter();
    kinds.find(|kind| percent(kind) <= scale_percent)
}

/// Degrees for a count by the data sheet of a kind.
fn degrees_of(kind: SensorKind) -> f64 {
    let preset = kind.preset();
    let section = preset.section(preset.volts, preset.degrees);
    section.degrees_per_count.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_is_doubted_beyond_its_interval_and_the_scale() {
        let doubted =
            |gain: f64, scale| may_not_be_one(Interval::new(gain, gain - 0.01, gain + 0.01), scale);
        assert!(doubted(0.72, 12.9) && doubted(2.4, 12.9));
        assert!(!doubted(0.95, 12.9) && !doubted(1.01, 12.9) && !doubted(-1.0, 12.9));
        assert!(doubted(0.95, 1.3));
    }

    #[test]
    fn a_sensor_of_another_kind_is_named() {
        let of = |kind, stated| {
            other_sensor(
                degrees_of(stated) / degrees_of(kind),
                degrees_of(stated),
                12.9,
            )
        };
        assert_eq!(
            of(SensorKind::Rty, SensorKind::As5600),
            Some(SensorKind::Rty)
        );
        assert_eq!(
            of(SensorKind::As5600, SensorKind::Rty),
            Some(SensorKind::As5600)
        );
        assert_eq!(other_sensor(0.72, degrees_of(SensorKind::Rty), 12.9), None);
    }
}
