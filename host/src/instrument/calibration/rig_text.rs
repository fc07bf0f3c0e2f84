//! Puts the results into the text of a rig file, which otherwise stays as it is.

use super::measured_value::{Estimate, LEVEL};
use super::sensor_scale::Calibration;
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// Results of a calibration.
#[derive(Clone, Copy, Debug, Default)]
pub struct Found<'a> {
    /// The sensor's scale, and a remark of one line on how it was found.
    pub sensor: Option<(&'a Calibration, &'a str)>,
    /// Change of the pulse for one degree (µs/deg).
    pub us_per_degree: Option<Estimate>,
    /// The shortest and the longest pulse before the servo stops, where it does (µs).
    pub limits_us: [Option<u16>; 2],
}

/// How the remark on the sensor's scale begins: one that is there already is replaced.
const REMARK: &str = "# Calibrated: ";

/// Puts the results into the sections `[sensor]`, `[servo]` and `[limits]`; everything else, comments included,
/// stays as it is.
///
/// ```
/// use servoid::instrument::calibration::{Calibration, Found, Reading, put_into};
/// let readings = [(-20.0, 6008.0), (0.0, 8192.0), (20.0, 10377.0)]
///     .map(|(angle_deg, counts)| Reading { angle_deg, counts });
/// let sensor = Calibration::fit(&readings)?;
/// let found = Found { sensor: Some((&sensor, "3 readings")), ..Found::default() };
/// let text = put_into("[sensor]\nname = \"H\"  # the new one\n", &found)?;
/// assert!(text.contains("# the new one") && text.contains("# Calibrated: 3 readings"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// One sentence, where the text is no TOML, or has a section that is none.
pub fn put_into(rig_file: &str, found: &Found<'_>) -> Result<String, String> {
    let mut document: DocumentMut = rig_file
        .parse()
        .map_err(|_| "the rig file is no TOML".to_owned())?;
    if let Some(estimate) = &found.us_per_degree {
        let (lower, upper, level) = (estimate.lower, estimate.upper, 100.0 * LEVEL);
        let servo = section(&mut document, "servo")?;
        let remark = format!("  # {lower:.4} to {upper:.4} with {level} % confidence");
        set(servo, "us_per_degree", estimate.value, &remark);
    }
    for (key, limit) in ["shortest_us", "longest_us"]
        .into_iter()
        .zip(found.limits_us)
    {
        if let Some(limit_us) = limit {
            let limits = section(&mut document, "limits")?;
            set(limits, key, i64::from(limit_us), "");
            explain(limits, key, "the servo stops beyond this pulse");
        }
    }
    if found.limits_us != [None; 2] || found.us_per_degree.is_some() {
        let remark = travel_in_words(&document, found.limits_us);
        replace_travel(section(&mut document, "limits")?, remark.as_deref());
    }
    if let Some((sensor, remark)) = found.sensor {
        let table = section(&mut document, "sensor")?;
        for (key, number) in [
            ("zero_counts", sensor.zero_counts),
            ("degrees_per_count", sensor.degrees_per_count),
            ("zero_sd_deg", sensor.zero_sd_deg),
            ("scale_sd_percent", sensor.scale_sd_percent),
        ] {
            set(table, key, number, "");
        }
        explain(table, "zero_counts", remark);
    }
    Ok(document.to_string())
}

fn section<'d>(document: &'d mut DocumentMut, name: &str) -> Result<&'d mut dyn TableLike, String> {
    document
        .entry(name)
        .or_insert_with(toml_edit::table)
        .as_table_like_mut()
        .ok_or_else(|| format!("'{name}' in the rig file is no table"))
}

/// Sets a number; what stands behind an old one stays, and `remark` is put behind a new one.
fn set(table: &mut dyn TableLike, key: &str, number: impl Into<Value>, remark: &str) {
    let mut value = number.into();
    match table.get_mut(key) {
        Some(Item::Value(old)) => {
            *value.decor_mut() = old.decor().clone();
            *old = value;
        }
        _ => {
            value.decor_mut().set_suffix(remark);
            table.insert(key, Item::Value(value));
        }
    }
}

/// How the line begins by which 'servoid init' says how far the limits reach, and a word that it has.
const TRAVEL: [&str; 2] = ["# From ", " degrees: "];

/// How far the limits reach, of which a calibration found these; `None` where the file does not say what a degree is.
fn travel_in_words(document: &DocumentMut, found_us: [Option<u16>; 2]) -> Option<String> {
    let number = |section: &str, key: &str| {
        let value = document.get(section)?.get(key)?.as_value()?;
        value
            .as_float()
            .or(value.as_integer().map(|whole| whole as f64))
    };
    let (neutral, scale) = (
        number("servo", "neutral_us")?,
        number("servo", "us_per_degree")?,
    );
    let ends = ["shortest_us", "longest_us"].map(|key| number("limits", key));
    let [a, b] = ends.map(|end| end.map(|us| (us - neutral) / scale));
    let (low, high) = (a?.min(b?), a?.max(b?));
    let [begins, has] = TRAVEL;
    let remark = match found_us {
        [None, None] => {
            "the same pulses as before, by the calibrated scale. Make sure that the linkage allows that."
        }
        _ => "up to where the servo stops, by its calibration.",
    };
    Some(format!("{begins}{low:.1} to {high:.1}{has}{remark}"))
}

/// Puts this line in the place of the one that said how far earlier limits reached, where there is one.
fn replace_travel(limits: &mut dyn TableLike, remark: Option<&str>) {
    let [begins, has] = TRAVEL;
    let Some(mut key) = limits.key_mut("shortest_us") else {
        return;
    };
    let decor = key.leaf_decor_mut();
    let before = decor.prefix().and_then(|prefix| prefix.as_str());
    let is_old = |line: &&str| line.starts_with(begins) && line.contains(has);
    let lines: Vec<&str> = before.unwrap_or_default().lines().collect();
    if !lines.iter().any(is_old) {
        return;
    }
    let kept = lines.into_iter().filter_map(|line| match is_old(&line) {
        true => remark,
        false => Some(line),
    });
    decor.set_prefix(kept.map(|line| format!("{line}\n")).collect::<String>());
}

/// Puts a comment above a key, in the place of an earlier one of this kind.
fn explain(table: &mut dyn TableLike, key: &str, remark: &str) {
    let Some(mut key) = table.key_mut(key) else {
        return;
    };
    let decor = key.leaf_decor_mut();
    let before = decor.prefix().and_then(|prefix| prefix.as_str());
    let mut lines: Vec<&str> = before.unwrap_or_default().lines().collect();
    lines.retain(|line| !line.starts_with(REMARK));
    let kept: String = lines.iter().map(|line| format!("{line}\n")).collect();
    decor.set_prefix(format!("{kept}{REMARK}{remark}\n"));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reach_of_the_limits_is_that_of_the_new_ones() {
        let before = "[servo]\nneutral_us = 1500\nus_per_degree = 10.0\n[limits]\n# From -10.0 to 10.0 degrees: a cautious default.\n# Mine.\nshortest_us = 1400  # short\nlongest_us = 1600\n";
        let found = Found {
            limits_us: [None, Some(1560)],
            ..Found::default()
        };
        let after = put_into(before, &found).unwrap();
        assert!(
            after.contains("# From -10.0 to 6.0 degrees: up to where the servo stops"),
            "{after}"
        );
        assert!(
            !after.contains("cautious") && after.contains("# Mine.\nshortest_us = 1400  # short"),
            "{after}"
        );
    }

    #[test]
    fn the_reach_of_the_same_pulses_follows_the_scale() {
        let before = "[servo]\nneutral_us = 1500\nus_per_degree = 10.0\n[limits]\n# From -10.0 to 10.0 degrees: a cautious default.\nshortest_us = 1400\nlongest_us = 1600\n";
        let found = Found {
            us_per_degree: Some(Estimate {
                value: 5.0,
                lower: 4.9,
                upper: 5.1,
            }),
            ..Found::default()
        };
        let after = put_into(before, &found).unwrap();
        assert!(
            after.contains("# From -20.0 to 20.0 degrees: the same pulses as before"),
            "{after}"
        );
        assert!(!after.contains("cautious"), "{after}");
    }
}
