//! A calibration as text.

use super::measured::{DOUBT_PERCENT, Measured};
use crate::instrument::calibration::{Calibration, End, Estimate, LEVEL, Travel};
use std::fmt::Write;

/// "1300, 1400, 1500".
pub(super) fn listed(pulses: &[u16]) -> String {
    let pulses: Vec<String> = pulses.iter().map(ToString::to_string).collect();
    pulses.join(", ")
}

/// One line on the source of the sensor's scale.
pub(super) fn remark(fit: &Calibration, assumed: bool) -> String {
    let farthest = fit.largest_residual_deg;
    match assumed {
        true => format!(
            "assumed, not measured: {} readings against the commanded angles, at most {farthest:.3} degrees from a straight line",
            fit.readings
        ),
        false => format!(
            "{} readings, at most {farthest:.3} degrees from a straight line",
            fit.readings
        ),
    }
}

pub(super) fn describe(measured: &Measured) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _infallible = write(&mut text, measured);
    text
}

fn write(text: &mut String, measured: &Measured) -> std::fmt::Result {
    if let Some(fit) = &measured.sensor {
        write_positions(text, measured, fit)?;
        write_sensor(text, fit, measured.assumed)?;
    }
    if let Some(travel) = &measured.travel {
        write_travel(text, travel, measured.assumed)?;
    }
    Ok(())
}

fn write_positions(text: &mut String, measured: &Measured, fit: &Calibration) -> std::fmt::Result {
    if measured.rests.is_empty() {
        return Ok(());
    }
    writeln!(
        text,
        "  pulse, µs    counts   sd, counts  angle, deg  off the line, deg"
    )?;
    for (rest, reading) in measured.rests.iter().zip(&measured.readings) {
        let on_line = (rest.counts - fit.zero_counts) * fit.degrees_per_count;
        writeln!(
            text,
            "  {:>9} {:>9.1} {:>12.1} {:>11.3} {:>18.3}",
            rest.pulse_us,
            rest.counts,
            rest.sd_counts,
            reading.angle_deg,
            on_line - reading.angle_deg
        )?;
    }
    writeln!(text)
}

fn write_sensor(text: &mut String, fit: &Calibration, assumed: bool) -> std::fmt::Result {
    let [low, high] = fit.degrees_per_count_interval;
    let level = LEVEL * 100.0;
    writeln!(
        text,
        "degrees_per_count = {:.7}   # {low:.7} to {high:.7} with {level} % confidence",
        fit.degrees_per_count
    )?;
    writeln!(
        text,
        "zero_counts = {:.1}   # ±{:.1} with {level} % confidence",
        fit.zero_counts, fit.zero_counts_half_width
    )?;
    writeln!(text, "zero_sd_deg = {:.4}", fit.zero_sd_deg)?;
    writeln!(text, "scale_sd_percent = {:.4}", fit.scale_sd_percent)?;
    writeln!(
        text,
        "Largest deviation from a straight line: {:.3} degrees ({} readings).",
        fit.largest_residual_deg, fit.readings
    )?;
    if assumed {
        writeln!(
            text,
            "The angles are assumed, not measured: 0 degrees is the position at the neutral pulse, and the scale is that of the\nrig file's us_per_degree, with an assumed standard deviation of {DOUBT_PERCENT} %."
        )?;
    }
    Ok(())
}

fn write_travel(text: &mut String, travel: &Travel, assumed: bool) -> std::fmt::Result {
    let level = LEVEL * 100.0;
    let interval = |estimate: &Estimate, digits: usize| {
        format!(
            "{:.digits$} to {:.digits$} with {level} % confidence",
            estimate.lower, estimate.upper
        )
    };
    let Travel {
        neutral_us,
        neutral_counts,
        neutral_deg,
        us_per_degree,
        ..
    } = travel;
    writeln!(
        text,
        "\nneutral      {neutral_us} µs: {:.1} counts, {:.3} degrees ({})",
        neutral_counts.value,
        neutral_deg.value,
        interval(neutral_deg, 3)
    )?;
    match assumed {
        true => writeln!(
            text,
            "scale        {:.3} µs per degree, as assumed",
            us_per_degree.value
        )?,
        false => writeln!(
            text,
            "us_per_degree = {:.4}   # {}",
            us_per_degree.value,
            interval(us_per_degree, 4)
        )?,
    }
    writeln!(
        text,
        "short end    {}",
        end(&travel.short_end, "shortest_us", f64::ceil)
    )?;
    writeln!(
        text,
        "long end     {}",
        end(&travel.long_end, "longest_us", f64::floor)
    )?;
    writeln!(
        text,
        "Largest deviation from the line: {:.3} degrees ({} readings).",
        travel.largest_residual_deg,
        travel.rests.len()
    )
}

/// One end; `key` is its limit in the rig file, and `inwards` rounds to whole microseconds.
fn end(end: &End, key: &str, inwards: fn(f64) -> f64) -> String {
    match end {
        End::NotWithin {
            limit_us,
            angle_deg,
        } => format!("no end within the limits: {angle_deg:.1} degrees at {limit_us} µs"),
        End::Stops { at_us, angle_deg } => format!(
            "stops at {:.0} µs ({:.0} to {:.0} µs), {:.2} degrees ({:.2} to {:.2} degrees); a servo that pushes against its\n             stop gets hot, so set {key} = {:.0} or less travel",
            at_us.value,
            at_us.lower,
            at_us.upper,
            angle_deg.value,
            angle_deg.lower,
            angle_deg.upper,
            inwards(if key == "longest_us" {
                at_us.lower
            } else {
                at_us.upper
            })
        ),
        End::Softens {
            from_us,
            gain_percent,
        } => bent("less", from_us, gain_percent),
        End::AnswersMore {
            from_us,
            gain_percent,
        } => bent("more", from_us, gain_percent),
        End::Unclear { from_us } => format!(
            "stops or answers less from {:.0} µs on ({:.0} to {:.0} µs): the readings cannot distinguish the two",
            from_us.value, from_us.lower, from_us.upper
        ),
    }
}

/// An end beyond which the servo goes on with another gain.
fn bent(answers: &str, from_us: &Estimate, gain_percent: &Estimate) -> String {
    format!(
        "answers {answers} from {:.0} µs on ({:.0} to {:.0} µs): with {:.0} % of the gain around neutral ({:.0} to {:.0} %)",
        from_us.value,
        from_us.lower,
        from_us.upper,
        gain_percent.value,
        gain_percent.lower,
        gain_percent.upper
    )
}
