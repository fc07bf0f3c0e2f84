//! What a calibration disagrees about with the rig file: angles that were read wrong leave a straight line.

use super::measured::Measured;
use super::measured_value::LEVEL;
use super::mistyped_angle::mistyped_angle;
use super::sensor_scale::Calibration;
use super::swapped_angles::swapped_angles;
use crate::data::rig_file::{
    RigFile, SensorSection, UNCALIBRATED_SCALE_SD_PERCENT, UNCALIBRATED_ZERO_SD_DEG,
};
use servoid_identification::results::pointwise_critical;

/// A scale that differs by more from that of the rig file is doubtful (part of it): three standard deviations of a
/// data sheet, whose 5 % are the supply of the sensor, or the rounding of the maker of a servo.
const SCALE: f64 = 0.15;

/// A neutral farther from 0 degrees is doubtful, as a part of the distance between two positions.
const NEUTRAL: f64 = 0.5;

/// A calibration that replaces one so many times as certain is doubtful. Two of five readings each, of the same care, differ by more once in 80
/// times (the square is F-distributed with three degrees of freedom each).
const LESS_CERTAIN: f64 = 5.0;

/// One sentence for each disagreement of `measured` with the rig file.
#[must_use]
pub fn doubts(measured: &Measured, rig: &RigFile, pulses: &[u16]) -> Vec<String> {
    let mut found = Vec::new();
    if !measured.assumed {
        found.extend(mistyped_angle(&measured.readings).map(|angle| angle.to_string()));
        found.extend(swapped_angles(&measured.readings).map(|angles| angles.to_string()));
    }
    if let Some(sensor) = measured.sensor.as_ref().filter(|_| !measured.assumed) {
        found.extend(rough(sensor));
        found.extend(less_certain(sensor, &rig.sensor));
        found.extend(contradicted_scale(sensor, &rig.sensor));
    }
    let of_sensor = measured.sensor.as_ref();
    let of_sensor = of_sensor.map(|sensor| sensor.degrees_per_count / rig.sensor.degrees_per_count);
    let travel = measured.travel.as_ref().filter(|_| !measured.assumed);
    let of_servo = travel.map(|travel| rig.servo.us_per_degree / travel.us_per_degree.value);
    // A servo may be reversed where the sensor agrees with the angles. Where it does not, their signs may be wrong.
    let agrees = of_sensor.is_some_and(|ratio| ratio > 0.0);
    let judged = |ratio: f64| if agrees { ratio.abs() } else { ratio };
    found.extend(of_sensor.and_then(scale_of_sensor));
    let were_read = of_sensor.is_some();
    found.extend(of_servo.and_then(|ratio| scale_of_servo(judged(ratio), were_read)));
    let Some(travel) = travel else {
        return found;
    };
    let neighbours = pulses.iter().zip(pulses.iter().skip(1));
    let apart = neighbours.map(|(a, b)| a.abs_diff(*b)).min();
    let apart = f64::from(apart.unwrap_or_default()) / travel.us_per_degree.value.abs();
    let neutral = travel.neutral_deg.value;
    if measured.sensor.is_some() && neutral.abs() > NEUTRAL * apart {
        found.push(format!(
            "neutral ({} µs) is at {neutral:.1} degrees by these angles, and the positions are {apart:.1} degrees apart: was each angle read at its position, and is the protractor's zero at neutral?",
            travel.neutral_us
        ));
    }
    found
}

/// That the readings leave the scale less certain than a data sheet does.
fn rough(sensor: &Calibration) -> Option<String> {
    let [low, high] = sensor.degrees_per_count_interval;
    let half = (0.5 * (high - low) / sensor.degrees_per_count).abs();
    (sensor.scale_sd_percent > UNCALIBRATED_SCALE_SD_PERCENT).then(|| {
        format!(
            "these readings leave the sensor's scale known to ±{:.0} % only, and a data sheet says more (a standard deviation of {UNCALIBRATED_SCALE_SD_PERCENT} %, and these have {:.1} %): repeat, and read each angle more closely",
            100.0 * half,
            sensor.scale_sd_percent
        )
    })
}

/// That the calibration of the rig file is far more certain.
fn less_certain(found: &Calibration, before: &SensorSection) -> Option<String> {
    let (new, old) = (found.scale_sd_percent, before.scale_sd_percent);
    (old > 0.0 && new > LESS_CERTAIN * old).then(|| {
        format!(
            "the rig file has the sensor's scale with a standard deviation of {old:.2} %, and these readings have one of {new:.2} %: repeat, and read each angle more closely"
        )
    })
}

/// That the scale is beyond the uncertainty of both from that of a calibration before; one that is further off is another doubt.
fn contradicted_scale(found: &Calibration, before: &SensorSection) -> Option<String> {
    let ratio = found.degrees_per_count / before.degrees_per_count;
    let is_calibrated = before.scale_sd_percent < UNCALIBRATED_SCALE_SD_PERCENT;
    let within =
        pointwise_critical(LEVEL) * found.scale_sd_percent.hypot(before.scale_sd_percent) / 100.0;
    let contradicts = is_calibrated && (ratio - 1.0).abs() > within;
    (contradicts && ratio > 0.0 && !is_off(ratio)).then(|| {
        format!(
            "the sensor's scale is {:+.1} % from that of the rig file, and both together are known to ±{:.1} %: was each angle read right, now and then?",
            100.0 * (ratio - 1.0),
            100.0 * within
        )
    })
}

/// That 0 degrees are beyond the uncertainty of both from where a calibration before has them: no doubt, as a sensor or a protractor that was
/// moved has another zero.
#[must_use]
pub fn moved_zero(found: &Calibration, before: &SensorSection) -> Option<String> {
    let off = (found.zero_counts - before.zero_counts) * found.degrees_per_count;
    let within = pointwise_critical(LEVEL) * found.zero_sd_deg.hypot(before.zero_sd_deg);
    let is_calibrated = before.zero_sd_deg < UNCALIBRATED_ZERO_SD_DEG;
    (is_calibrated && off.abs() > within).then(|| {
        format!(
            "0 degrees are {off:+.2} degrees from where the rig file has them, and both together are known to ±{within:.2}: that is right if the sensor or the protractor was moved since then"
        )
    })
}

/// `ratio` is that of the measured angles to those that the rig file has for the same counts.
fn scale_of_sensor(ratio: f64) -> Option<String> {
    if ratio < 0.0 {
        return Some(
            "the sensor turns against the sign of degrees_per_count in the rig file: are the signs of the angles right?".to_owned(),
        );
    }
    is_off(ratio).then(|| format!(
        "the angles are {ratio:.2} times what the sensor should show by the rig file's degrees_per_count: were they read right, and is the sensor of the kind that the rig file names?"
    ))
}

/// `ratio` is that of the measured angles to those that the rig file has for the same pulses; they `were_read`, or the sensor's scale in the rig file
/// gives them.
fn scale_of_servo(ratio: f64, were_read: bool) -> Option<String> {
    let (turned, off) = match were_read {
        true => (
            "are the signs of the angles right?",
            "were they read right?",
        ),
        false => (
            "is the sign of degrees_per_count right? Calibrate with angles that are read",
            "is degrees_per_count that of this sensor, or us_per_degree another servo's? Calibrate with angles that are read",
        ),
    };
    if ratio < 0.0 {
        return Some(format!(
            "the servo turns against the sign of us_per_degree in the rig file: {turned}"
        ));
    }
    let by = match were_read {
        true => "the angles are",
        false => "by the sensor's scale in the rig file, the angles are",
    };
    is_off(ratio).then(|| {
        format!("{by} {ratio:.2} times what the servo should show by the rig file's us_per_degree: {off}")
    })
}

fn is_off(ratio: f64) -> bool {
    (ratio - 1.0).abs() > SCALE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instrument::calibration::sensor_scale::Reading;

    /// Five angles, `factor` times as large as they are, on the sensor of the data sheet.
    fn found(factor: f64) -> Vec<String> {
        let rig = RigFile::default();
        let reading = |deg: f64| Reading {
            angle_deg: factor * deg,
            counts: rig.sensor.zero_counts + deg / rig.sensor.degrees_per_count,
        };
        let readings = [-8.0, -4.0, 0.0, 4.0, 8.0].map(reading).to_vec();
        let measured = Measured {
            sensor: Some(Calibration::fit(&readings).unwrap()),
            assumed: false,
            readings,
            rests: Vec::new(),
            travel: None,
            doubts: Vec::new(),
            moved_zero: None,
        };
        doubts(&measured, &rig, &[])
    }

    #[test]
    fn a_wrong_factor_and_a_wrong_sign_are_doubted_and_a_sensor_within_its_data_sheet_is_not() {
        for right in [0.9, 1.0, 1.1] {
            assert_eq!(found(right), [""; 0]);
        }
        assert!(found(2.0)[0].contains("2.00 times"));
        assert!(found(0.5)[0].contains("0.50 times"));
        assert!(found(-1.0)[0].contains("signs of the angles"));
    }

    /// A rig file that was calibrated with the angles -8 to 8.
    fn calibrated() -> SensorSection {
        let right = Reading::at_five_positions([-8.0, -4.0, 0.0, 4.0, 8.0]);
        let found = Calibration::fit(&right).unwrap();
        SensorSection {
            zero_counts: found.zero_counts,
            degrees_per_count: found.degrees_per_count,
            zero_sd_deg: found.zero_sd_deg,
            scale_sd_percent: found.scale_sd_percent,
            ..SensorSection::default()
        }
    }

    #[test]
    fn a_calibration_that_is_worse_than_the_one_before_or_contradicts_it_is_doubted() {
        let of = |angles: [f64; 5]| Calibration::fit(&Reading::at_five_positions(angles)).unwrap();
        let before = calibrated();
        // The zero of the protractor slipped in the middle.
        let slipped = of([-8.0, -4.0, 1.0, 5.0, 9.0]);
        assert!(slipped.scale_sd_percent > UNCALIBRATED_SCALE_SD_PERCENT);
        assert!(rough(&slipped).is_some() && less_certain(&slipped, &before).is_some());
        let shrunk = of([-7.6, -3.8, 0.0, 3.8, 7.6]);
        let said = contradicted_scale(&shrunk, &before).unwrap();
        assert!(said.contains("-5.0 % from that"), "{said}");
        assert_eq!(less_certain(&shrunk, &before), None);
        let shifted = of([-5.0, -1.0, 3.0, 7.0, 11.0]);
        assert_eq!(contradicted_scale(&shifted, &before), None);
        let said = moved_zero(&shifted, &before).unwrap();
        assert!(said.contains("0 degrees are -3.00 degrees"), "{said}");
        let again = of([-8.02, -3.97, 0.01, 4.02, 7.98]);
        assert_eq!(contradicted_scale(&again, &before), None);
        assert_eq!(less_certain(&again, &before), None);
        assert_eq!(moved_zero(&again, &before), None);
        // A data sheet is no calibration: it is held against SCALE alone.
        let sheet = SensorSection::default();
        assert_eq!(contradicted_scale(&shrunk, &sheet), None);
        assert_eq!(moved_zero(&shifted, &sheet), None);
    }

    #[test]
    fn angles_that_leave_a_scale_less_certain_than_a_data_sheet_are_doubted() {
        let said = |angles: [f64; 5]| {
            rough(&Calibration::fit(&Reading::at_five_positions(angles)).unwrap())
        };
        let careless = said([-8.5, -3.5, 0.0, 4.5, 6.5]).unwrap();
        assert!(careless.contains("% only"), "{careless}");
        assert_eq!(said([-8.0, -4.0, 0.0, 4.0, 8.0]), None);
    }
}
