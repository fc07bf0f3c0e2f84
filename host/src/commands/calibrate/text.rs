//! A calibration as text.

use crate::instrument::calibration::{
    Calibration, DOUBT_PERCENT, End, Estimate, LEVEL, Measured, Reading, Rest, Travel,
};

/// "1300, 1400, 1500".
pub(super) fn listed(pulses: &[u16]) -> String {
    let pulses: Vec<String> = pulses.iter().map(ToString::to_string).collect();
    pulses.join(", ")
}

/// One line on the source of the sensor's scale.
pub(super) fn remark(fit: &Calibration, assumed: bool) -> String {
    let (readings, farthest) = (fit.readings, fit.largest_residual_deg);
    let (before, against) = match assumed {
        true => ("assumed, not measured: ", " against the commanded angles"),
        false => ("", ""),
    };
    format!(
        "{before}{readings} readings{against}, at most {farthest:.3} degrees from a straight line"
    )
}

pub(super) fn describe(measured: &Measured) -> String {
    let mut text = String::new();
    if let Some(fit) = &measured.sensor {
        text += &positions(measured, fit);
        text += &sensor(fit, measured.assumed);
    }
    text.extend(
        measured
            .travel
            .as_ref()
            .map(|found| travel(found, measured.assumed)),
    );
    text.extend((measured.moved_zero.iter()).map(|moved| format!("NOTE: {moved}\n")));
    for doubt in &measured.doubts {
        text += &format!("DOUBTFUL: {doubt}\n");
    }
    text
}

fn positions(measured: &Measured, fit: &Calibration) -> String {
    if measured.rests.is_empty() {
        return String::new();
    }
    let line = |(rest, reading): (&Rest, &Reading)| {
        let (
            Rest {
                pulse_us,
                counts,
                sd_counts,
                ..
            },
            angle,
        ) = (rest, reading.angle_deg);
        let off = (counts - fit.zero_counts) * fit.degrees_per_count - angle;
        format!("  {pulse_us:>9} {counts:>9.1} {sd_counts:>12.1} {angle:>11.3} {off:>18.3}\n")
    };
    let lines: String = measured
        .rests
        .iter()
        .zip(&measured.readings)
        .map(line)
        .collect();
    format!("  pulse, µs    counts   sd, counts  angle, deg  off the line, deg\n{lines}\n")
}

fn sensor(fit: &Calibration, assumed: bool) -> String {
    let Calibration {
        zero_counts,
        zero_counts_half_width,
        degrees_per_count,
        degrees_per_count_interval: [low, high],
        zero_sd_deg,
        scale_sd_percent,
        largest_residual_deg,
        readings,
        ..
    } = fit;
    let level = LEVEL * 100.0;
    let remark = match assumed {
        true => format!(
            "The angles are assumed, not measured: 0 degrees is the position at the neutral pulse, and the scale is that of the\nrig file's us_per_degree, with an assumed standard deviation of {DOUBT_PERCENT} %.\n"
        ),
        false => String::new(),
    };
    format!(
        "degrees_per_count = {degrees_per_count:.7}   # {low:.7} to {high:.7} with {level} % confidence
zero_counts = {zero_counts:.1}   # ±{zero_counts_half_width:.1} with {level} % confidence
zero_sd_deg = {zero_sd_deg:.4}
scale_sd_percent = {scale_sd_percent:.4}
Largest deviation from a straight line: {largest_residual_deg:.3} degrees ({readings} readings).
{remark}"
    )
}

/// "1.20 to 1.40".
fn range(estimate: &Estimate, digits: usize) -> String {
    format!("{:.digits$} to {:.digits$}", estimate.lower, estimate.upper)
}

fn travel(travel: &Travel, assumed: bool) -> String {
    let level = LEVEL * 100.0;
    let scale = travel.us_per_degree.value;
    let scale = match assumed {
        true => format!(
            "scale        {scale:.3} µs per degree over the staircase, which is no measurement: the angles were assumed"
        ),
        false => {
            let range = range(&travel.us_per_degree, 4);
            format!("us_per_degree = {scale:.4}   # {range} with {level} % confidence")
        }
    };
    let [shortest, longest] = travel.before_stops_us();
    format!(
        "
neutral      {} µs: {:.1} counts, {:.3} degrees ({} with {level} % confidence)
{scale}
short end    {}
long end     {}
Largest deviation from the line: {:.3} degrees ({} readings).
",
        travel.neutral_us,
        travel.neutral_counts.value,
        travel.neutral_deg.value,
        range(&travel.neutral_deg, 3),
        end(
            &travel.short_end,
            shortest.map(|us| format!("shortest_us = {us}"))
        ),
        end(
            &travel.long_end,
            longest.map(|us| format!("longest_us = {us}"))
        ),
        travel.largest_residual_deg,
        travel.rests.len()
    )
}

/// One end; `limit` is that of the rig file, where the servo stops.
fn end(end: &End, limit: Option<String>) -> String {
    match end {
        End::NotWithin {
            limit_us,
            angle_deg,
        } => {
            format!("no end within the limits: {angle_deg:.1} degrees at {limit_us} µs")
        }
        End::Stops { at_us, angle_deg } => {
            format!(
                "stops at {:.0} µs ({} µs), {:.2} degrees ({} degrees); a servo that pushes against its\n             stop gets hot: {}, or less travel",
                at_us.value,
                range(at_us, 0),
                angle_deg.value,
                range(angle_deg, 2),
                limit.unwrap_or_default()
            )
        }
        End::Softens {
            from_us,
            gain_percent,
        } => bent("less", from_us, gain_percent),
        End::AnswersMore {
            from_us,
            gain_percent,
        } => bent("more", from_us, gain_percent),
        End::SensorEnds {
            before_us,
            counts,
            angle_deg,
        } => format!(
            "the range of the sensor ends, at {counts:.0} counts ({angle_deg:.1} degrees): what the servo does beyond {before_us} µs is\n             not seen; turn the sensor on its shaft until it reads its middle at neutral, or take {}",
            limit.unwrap_or_default()
        ),
        End::Unclear { from_us } => format!(
            "stops or answers less from {:.0} µs on ({} µs): the readings cannot distinguish the two",
            from_us.value,
            range(from_us, 0)
        ),
    }
}

/// An end beyond which the servo goes on with another gain.
fn bent(answers: &str, from_us: &Estimate, gain_percent: &Estimate) -> String {
    format!(
        "answers {answers} from {:.0} µs on ({} µs): with {:.0} % of the gain around neutral ({} %)",
        from_us.value,
        range(from_us, 0),
        gain_percent.value,
        range(gain_percent, 0)
    )
}
