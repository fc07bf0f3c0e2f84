//! What is said of a rig before its servo moves: the pulses of a rig without a file, and a sensor's scale or delay that is that of another rig.

use crate::data::rig_file::{RigFile, SensorSection};
use crate::data::sensor_preset::SensorKind;
use crate::instrument::port;
use anyhow::{Result, bail};
use servoid_protocol::Hello;
use std::path::Path;

/// The pulses that a servo gets where no file names them.
///
/// # Errors
/// Where the rig at `address` simulates a servo for which they are too wide.
pub(super) fn pulses_without_file(address: Option<&str>) -> Result<String> {
    if let Some(address) = address
        && port::simulates_narrow_pulses(address)
    {
        bail!(
            "the servo was not moved: {address} is a narrow-pulse servo, and without a rig file pulses are wide, which may break such a servo; write a file with 'servoid init --pulse-type narrow --port \"{address}\"'"
        );
    }
    let RigFile { servo, limits, .. } = RigFile::default();
    Ok(format!(
        "without a rig file, pulses are {}, {} in a second, of {} to {} µs, neutral at {} µs; 'servoid init' writes a file for your servo",
        servo.pulse_type,
        servo.pulse_rate_hz,
        limits.shortest_us,
        limits.longest_us,
        servo.neutral_us
    ))
}

/// The sections that a rig file with this `text` leaves out, and what is taken for them.
pub(super) fn sections_left_out(path: &Path, text: &str) -> Option<String> {
    let RigFile { servo, limits, .. } = RigFile::default();
    let sections = [
        (
            "servo",
            format!(
                "pulses are {}, neutral at {} µs, {} µs for a degree",
                servo.pulse_type, servo.neutral_us, servo.us_per_degree
            ),
        ),
        (
            "sensor",
            format!(
                "the sensor is a {} by its data sheet",
                SensorKind::default().preset().name
            ),
        ),
        (
            "limits",
            format!(
                "pulses are {} to {} µs long",
                limits.shortest_us, limits.longest_us
            ),
        ),
    ];
    let stated: toml::Table = toml::from_str(text).ok()?;
    let left_out = sections.into_iter();
    let left_out = left_out.filter(|(section, _)| !stated.contains_key(*section));
    let (names, taken): (Vec<_>, Vec<_>) = left_out
        .map(|(section, taken)| (format!("[{section}]"), taken))
        .unzip();
    (!names.is_empty()).then(|| {
        format!(
            "{} has no {}, so {}; 'servoid init' writes a whole file",
            path.display(),
            names.join(", no "),
            taken.join(", and ")
        )
    })
}

/// Why the sensor's delay in `file` is not that of the rig at `address`, where it cannot be.
pub(super) fn delay_of_another_rig(address: &str, file: &RigFile) -> Option<String> {
    let (delay_ms, uncertainty_ms) = (file.sensor.delay_ms, file.sensor.delay_uncertainty_ms);
    let simulated = port::is_simulated(address);
    if simulated && delay_ms > uncertainty_ms {
        return Some(format!(
            "the simulated sensor reads the angle at once, and the rig file takes a delay of {delay_ms} ms out: times come out shorter by that"
        ));
    }
    let unknown = delay_ms == 0.0 && uncertainty_ms == 0.0;
    (!simulated && unknown).then(|| {
        let usual = SensorKind::default().preset();
        format!(
            "the sensor's delay is taken as 0 ms, as that of a simulated rig or a virtual board: of a real one times come out longer by the true one, which is {} ms for the {}; state it as delay_ms and delay_uncertainty_ms in the rig file",
            usual.delay_ms[0], usual.name
        )
    })
}

/// Ratio of two scales from which on they are of two kinds of sensor, and not of one before and after its calibration.
const ANOTHER_SCALE: f64 = 1.5;

/// That `file` is for another sensor than the simulated rig at `address` has: what it records is then no angle.
pub(super) fn scale_of_another_rig(address: &str, file: &RigFile) -> Option<String> {
    let simulated = SensorSection::default().degrees_per_count;
    let ratio = file.sensor.degrees_per_count / simulated;
    let alike = 1.0 / ANOTHER_SCALE..ANOTHER_SCALE;
    (port::is_simulated(address) && !alike.contains(&ratio)).then(|| {
        format!(
            "the simulated sensor is a {}, and the rig file is for another one: angles come out {ratio:.1} times as large as they are; to rehearse, write a file with 'servoid init --yes --port sim:bench -o simulated.toml', and name it with --rig",
            SensorKind::default().preset().name
        )
    })
}

/// How the number of a virtual board begins.
const VIRTUAL: &[u8] = b"virt";

/// Why the sensor's delay in `file` is not that of the board that answers, where it is a virtual one.
pub(super) fn delay_of_virtual_board(hello: &Hello, file: &RigFile) -> Option<String> {
    let delay_ms = file.sensor.delay_ms;
    let lags = delay_ms > file.sensor.delay_uncertainty_ms;
    (hello.unique_id.starts_with(VIRTUAL) && lags).then(|| {
        format!(
            "this is a virtual board, whose simulated sensor reads the angle at once, and the rig file takes a delay of {delay_ms} ms out: times come out \
             shorter by that; write 0 as delay_ms and delay_uncertainty_ms for it"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(address: &str, delay_ms: f64, delay_uncertainty_ms: f64) -> Option<String> {
        let sensor = SensorSection {
            delay_ms,
            delay_uncertainty_ms,
            ..SensorSection::default()
        };
        let file = RigFile {
            sensor,
            ..RigFile::default()
        };
        delay_of_another_rig(address, &file)
    }

    #[test]
    fn a_file_for_another_sensor_than_the_simulated_one_is_named() {
        let said = |address: &str, kind: SensorKind, calibrated: f64| {
            let preset = kind.preset();
            let mut sensor = preset.section(preset.volts, preset.degrees);
            sensor.degrees_per_count *= calibrated;
            let file = RigFile {
                sensor,
                ..RigFile::default()
            };
            scale_of_another_rig(address, &file)
        };
        let found = said("sim:bench", SensorKind::As5600, 1.0).unwrap();
        assert!(found.contains("2.4 times as large"), "{found}");
        assert_eq!(said("sim:bench", SensorKind::Rty, 1.05), None);
        assert_eq!(said("/dev/ttyUSB0", SensorKind::As5600, 1.0), None);
    }

    #[test]
    fn a_delay_that_is_not_of_the_port_is_named() {
        let said_of_board = said("/dev/ttyUSB0", 0.0, 0.0).unwrap();
        assert!(said_of_board.contains("4 ms for the Honeywell RTY120"));
        let said_of_simulation = said("sim:bench", 4.0, 2.0).unwrap();
        assert!(said_of_simulation.contains("shorter"));
        assert_eq!(said("sim:bench", 0.0, 0.0), None);
        assert_eq!(said("/dev/ttyUSB0", 4.0, 2.0), None);
        // A potentiometer does not lag.
        assert_eq!(said("/dev/ttyUSB0", 0.0, 0.05), None);
    }

    #[test]
    fn sections_that_a_file_leaves_out_are_named() {
        let said = |text: &str| sections_left_out(Path::new("rig.toml"), text);
        let of_nothing = said("").unwrap();
        assert!(
            of_nothing.starts_with(
                "rig.toml has no [servo], no [sensor], no [limits], so pulses are wide, neutral at 1500 µs"
            ),
            "{of_nothing}"
        );
        let calibrated = said("[servo]\n[sensor]\nzero_counts = 8192.0").unwrap();
        assert!(
            calibrated.contains("no [limits], so pulses are 1000 to 2000 µs long"),
            "{calibrated}"
        );
        assert_eq!(said("[servo]\n[sensor]\n[limits]"), None);
    }

    #[test]
    fn pulses_without_a_file_are_named_and_not_for_narrow_ones() {
        let said = pulses_without_file(Some("/dev/ttyUSB0")).unwrap();
        assert!(
            said.contains("wide, 50 in a second, of 1000 to 2000 µs"),
            "{said}"
        );
        let refused = pulses_without_file(Some("sim:bench?pulses=narrow"));
        let refused = refused.unwrap_err().to_string();
        assert!(refused.contains("--pulse-type narrow"), "{refused}");
        // An option that is wrong is for the port to refuse.
        assert!(pulses_without_file(Some("sim:bench?pulses=thin")).is_ok());
    }
}
