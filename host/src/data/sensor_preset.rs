//! Angle sensors that people own, before any of them is calibrated.

use super::rig_file::{
    FULL_SCALE_VOLTS, RTY_DEGREES, RTY_VOLTS, SensorSection, UNCALIBRATED_SCALE_SD_PERCENT,
};

/// A kind of sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SensorKind {
    /// Honeywell RTY or another Hall sensor of 5 V, behind the divider.
    #[default]
    Rty,
    /// A breakout of the AS5600 at 3.3 V, as it comes: its slow filter averages most.
    As5600,
    /// The same, set to its fastest filter (SF = 11 in its register CONF).
    As5600Fast,
    /// Any other sensor with a voltage proportional to the angle, behind the divider.
    Linear,
    /// The potentiometer within the servo.
    Potentiometer,
}

/// What a data sheet says of a kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorPreset {
    /// As it is written at the command line.
    pub word: &'static str,
    /// What it is, for a list to choose from.
    pub words: &'static str,
    /// The usual name.
    pub name: &'static str,
    /// Output at the ends of its range (V).
    pub volts: [f64; 2],
    /// Angle between these (deg).
    pub degrees: f64,
    /// Volts of the sensor at the full scale of the converter: those of the divider, or the board's 3.3 V without one.
    pub full_scale_volts: f64,
    /// Delay, and how far the true one may be from it (ms).
    pub delay_ms: [f64; 2],
    /// Standard deviations of zero (deg) and scale (%) before a calibration, where they are not those of a supply by USB.
    pub spread: Option<[f64; 2]>,
}

/// A part at each end of the AS5600's range that a travel must not reach: there its output jumps from one end to the other.
const WRAP_PART: f64 = 0.05;

impl SensorKind {
    /// All kinds.
    pub const ALL: [Self; 5] = [
        Self::Rty,
        Self::As5600,
        Self::As5600Fast,
        Self::Linear,
        Self::Potentiometer,
    ];

    /// What is known of it.
    pub fn preset(self) -> SensorPreset {
        let rty = SensorPreset {
            word: "rty",
            words: "Honeywell RTY, or another Hall sensor of 0.5 to 4.5 V, behind the divider",
            name: "Honeywell RTY120",
            volts: RTY_VOLTS,
            degrees: RTY_DEGREES,
            full_scale_volts: FULL_SCALE_VOLTS,
            // "Output signal delay: 4 ms typ." in Honeywell's installation instructions 50069443, without limits: half of it.
            delay_ms: [4.0, 2.0],
            spread: None,
        };
        let as5600 = SensorPreset {
            word: "as5600",
            words: "AS5600 breakout at 3.3 V, its pin OUT straight to PA4, as it comes",
            name: "AS5600",
            volts: [0.0, 3.3],
            degrees: 360.0,
            full_scale_volts: 3.3,
            // Data sheet [v1-06], table of the filters: settles within 2.2 ms with 16x. An average over that time delays by half of
            // it; one that forgets exponentially, and settles to 1 % in it, by a fifth. It samples every 0.15 ms.
            delay_ms: [1.1, 0.7],
            // 4 degrees for its mounting; its linearity is ±1 degree, and its supply is the converter's reference.
            spread: Some([4.0, 1.0]),
        };
        match self {
            Self::Rty => rty,
            Self::As5600 => as5600,
            Self::As5600Fast => SensorPreset {
                word: "as5600-fast",
                words: "the same with its fastest filter (SF = 11)",
                // Settles within 0.286 ms with 2x.
                delay_ms: [0.2, 0.15],
                ..as5600
            },
            Self::Linear => SensorPreset {
                word: "linear",
                words: "any sensor with a voltage proportional to the angle, 0 to 5 V, behind the divider",
                name: "linear sensor",
                delay_ms: [0.0, 0.0],
                ..rty
            },
            Self::Potentiometer => SensorPreset {
                word: "potentiometer",
                words: "the servo's own potentiometer, its wiper through 100 kΩ, 200 kΩ to ground",
                name: "the servo's potentiometer",
                // Whatever its supply is: a calibration has to say it.
                volts: [0.0, 3.3],
                degrees: 270.0,
                delay_ms: [0.0, 0.05],
                spread: Some([30.0, 50.0]),
                ..rty
            },
        }
    }
}

/// Whether a scale is known as well as a data sheet has it, and no calibration has measured it.
pub fn is_of_data_sheet(scale_sd_percent: f64) -> bool {
    let spreads = SensorKind::ALL.map(|kind| kind.preset().spread);
    let mut scales = (spreads.into_iter())
        .map(|spread| spread.map_or(UNCALIBRATED_SCALE_SD_PERCENT, |[_, scale]| scale));
    scales.any(|scale| scale == scale_sd_percent)
}

/// The readings between which a sensor of a known kind follows its shaft (counts), where these are not the ends of the converter. A rig file that
/// names no sensor has the usual one; another range of volts shows in its healthy counts.
pub fn range_counts(sensor: &SensorSection) -> Option<[f64; 2]> {
    let is_named = |kind: &SensorKind| sensor.name.contains(kind.preset().name);
    let found = SensorKind::ALL.into_iter().find(is_named);
    let usual = sensor.name.is_empty().then(SensorKind::default);
    let preset = found.or(usual)?.preset();
    let as_delivered = preset.section(preset.volts, preset.degrees);
    let is_known = preset.volts[0] > 0.0 && sensor.healthy_counts == as_delivered.healthy_counts;
    let half = 0.5 * preset.degrees / as_delivered.degrees_per_count;
    is_known.then(|| [-half, half].map(|counts| as_delivered.zero_counts + counts))
}

impl std::str::FromStr for SensorKind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let kinds = Self::ALL.into_iter();
        kinds
            .clone()
            .find(|kind| kind.preset().word == text)
            .ok_or_else(|| {
                let words: Vec<_> = kinds.map(|kind| kind.preset().word).collect();
                format!("it must be one of {}", words.join(", "))
            })
    }
}

impl SensorPreset {
    /// The section of a rig file, with another range of volts and degrees where they are known.
    pub fn section(&self, volts: [f64; 2], degrees: f64) -> SensorSection {
        let mut section = SensorSection::from_data_sheet(volts, degrees, self.full_scale_volts);
        let [delay_ms, uncertainty_ms] = self.delay_ms;
        (section.delay_ms, section.delay_uncertainty_ms) = (delay_ms, uncertainty_ms);
        if let Some([zero_sd_deg, scale_sd_percent]) = self.spread {
            (section.zero_sd_deg, section.scale_sd_percent) = (zero_sd_deg, scale_sd_percent);
        }
        if self.volts[0] == 0.0 && volts == self.volts {
            // The range reaches both rails, where an open or shorted wire reads as well.
            let [low, high] = [WRAP_PART, 1.0 - WRAP_PART];
            let share = volts[1] / self.full_scale_volts * 4.0 * 4096.0;
            section.healthy_counts = [low, high].map(|part| (part * share) as u16);
        }
        section
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_as5600_has_its_turn_over_the_whole_converter() {
        let preset = SensorKind::As5600.preset();
        let section = preset.section(preset.volts, preset.degrees);
        assert_eq!(section.zero_counts, 8_192.0);
        assert!((section.degrees_per_count - 360.0 / 16_384.0).abs() < 1e-12);
        // Neither the wrap nor a lost magnet, which reads 0, is healthy.
        let [low, high] = section.healthy_counts;
        assert_eq!([low, high], [819, 15_564]);
        assert_eq!((section.delay_ms, section.delay_uncertainty_ms), (1.1, 0.7));
    }

    #[test]
    fn words_are_read_and_others_named() {
        for kind in SensorKind::ALL {
            assert_eq!(kind.preset().word.parse(), Ok(kind));
        }
        let error = "hall".parse::<SensorKind>().unwrap_err();
        assert!(error.contains("as5600-fast"), "{error}");
    }
}
