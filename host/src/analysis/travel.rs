//! Whether the servo goes as far as the command says, where both are degrees.

use crate::data::dataset::Dataset;
use crate::data::sensor_preset::SensorKind;
use servoid_identification::results::{Advice, Check, Interval, Model, pointwise_critical};

/// That the gain of a recording of servoid is not 1 within what is known of it and of the sensor's scale: the command is in degrees of the
/// rig file, which the servo is to turn.
pub(super) fn advice(data: &Dataset, model: &Model) -> Option<Advice> {
    let calibrations = &data.about.calibrations;
    let sd_percent = calibrations.iter().map(|found| found.scale_sd_percent);
    let scale_percent =
        pointwise_critical(model.level().into_valid()?) * sd_percent.reduce(f64::max)?;
    let gain = model.metrics.dc_gain;
    // One that turns the other way is another finding.
    let value = gain.value.filter(|_| may_not_be_one(gain, scale_percent))?;
    let kind = calibrations.first().and_then(|found| {
        let degrees_per_count = found.degrees_per_count;
        other_sensor(value, degrees_per_count, scale_percent)
    });
    let cause = match (kind, value < 1.0) {
        (Some(kind), _) => format!(
            "a sensor of another kind (that of a {} would make it {:.2}), a wrong us_per_degree or degrees_per_count",
            kind.preset().name,
            value * degrees_of(kind) / calibrations.first()?.degrees_per_count.abs()
        ),
        (None, true) => "a stop or a limit of the travel, a load to which the servo yields, or a wrong us_per_degree or degrees_per_count".to_owned(),
        (None, false) => "a wrong us_per_degree or degrees_per_count".to_owned(),
    };
    Some(Advice::new(
        Check::Travel,
        format!(
            "The servo ends at {value:.2} of the command, and the scale of the sensor is known to ±{scale_percent:.1} %: {cause}."
        ),
        value,
        1.0,
        "Run 'servoid calibrate', which measures both scales and finds the ends of the travel; stairs of several levels ('servoid capture --reference stairs') \
         show a stop, too.",
    ))
}

/// Whether 1 lies outside of the interval of a gain above 0, widened by what is not known of the sensor's scale.
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
