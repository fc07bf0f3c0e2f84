//! The answer in two sentences: whether and by how much the two differ, and what a pilot notices of it.

use super::different_motions::references_of_models_in_words;
use super::options::ComparisonOptions;
use super::outcome::{
    Comparison, ComparisonBounds, DifferenceCurve, Direction, Levels, MetricDifference, Subject,
};
use super::shift_alone::ShiftIs;
use super::sides::Sides;
use super::verdict::Verdict;
use super::wear::NAMES_IN_SUMMARY;
use crate::numerics::{command_in_words, four_digits, pointwise_critical, six_digits};
use crate::results::{Bounds, Interval};
use crate::thresholds::NOTABLE_SHIFT_S;

/// Of a second side that turns the other way, `turned` is the comparison with its outputs of the other sign. Where not both are `linear`, strokes from elsewhere or of
/// other sizes are answered otherwise.
pub(super) fn summary(
    found: &Comparison,
    turned: Option<&Comparison>,
    linear: bool,
    options: &ComparisonOptions,
) -> String {
    let other_way = match found.turns_the_other_way {
        true => "Under the same command the second turns the other way. ",
        false => "",
    };
    match found.bounds {
        Bounds::Valid(bounds) if found.descriptions_of_different_motions => {
            format!("{other_way}{}", not_one_reference(found, &bounds, options))
        }
        Bounds::Valid(bounds) => {
            let turned = turned.and_then(with_its_sign_changed).unwrap_or_default();
            format!(
                "{}{turned} {}{}",
                answer(found, &bounds),
                feel(found, linear, options),
                play(found, &options.output_unit)
            )
        }
        Bounds::Withdrawn(reason) => {
            let of_sides = found.without_bounds.in_words(NAMES_IN_SUMMARY);
            format!(
                "{other_way}Not decided by the step responses: no bounds can be given, because {}. Identify each side by itself: its advice says what to record.{}",
                of_sides.unwrap_or_else(|| reason.because().to_owned()),
                play(found, &options.output_unit)
            )
        }
    }
}

/// What is known of the play of both, as a sentence behind others.
fn play(found: &Comparison, unit: &str) -> String {
    let sentence = found.rests_in_words(NAMES_IN_SUMMARY, unit);
    sentence.map_or_else(String::new, |sentence| format!(" {sentence}"))
}

/// What the comparison says once the outputs of the second side have the sign of those of the first; `None` where that is nothing.
fn with_its_sign_changed(turned: &Comparison) -> Option<String> {
    let answer = answer(turned, turned.bounds.valid()?);
    let mut letters = answer.chars();
    let first = letters.next()?.to_lowercase();
    Some(format!(
        " With the sign of its position changed, {first}{}",
        letters.as_str()
    ))
}

/// Why there is no verdict on sides that were asked for different motions, and what their responses are worth.
fn not_one_reference(
    found: &Comparison,
    bounds: &ComparisonBounds,
    options: &ComparisonOptions,
) -> String {
    let unit = &options.input_unit;
    let of_records = found.motions;
    let of_records = of_records.map(|both| both.a.difference_in_words(&both.b, unit));
    let differ = of_records
        .unwrap_or_else(|| references_of_models_in_words(options.strokes_of_models, unit));
    format!(
        "Not decided by the step responses: {differ}. A servo that is limited in speed or torque, or has play, answers each reference differently, so that what \
         differs may be the motion and not the servo. Record both sides with the same reference. Of the responses to the two motions, {}.",
        apart(found, bounds)
    )
}

/// How far apart the responses are where they differ most.
fn apart(found: &Comparison, bounds: &ComparisonBounds) -> String {
    let ComparisonBounds {
        level,
        difference_percent: bounds,
        ..
    } = bounds;
    let stroke = match bounds.stroke {
        Direction::Both => "",
        Direction::Up => " on the way up",
        Direction::Down => " on the way down",
    };
    // Where they may not differ at all, there is no time at which they surely do; and before either moves they differ by errors of the models.
    let delays = found
        .differences
        .iter()
        .filter(|row| row.metric == "delay_s");
    let moves = delays.flat_map(|row| row.a.into_iter().chain(row.b));
    let moves = moves.reduce(f64::min).unwrap_or(0.0);
    let clearest = match bounds.at_least > 0.0 && bounds.at_s >= moves {
        true => format!(
            ", most clearly {:.0} ms after a command{stroke}",
            1e3 * bounds.at_s
        ),
        false => String::new(),
    };
    format!(
        "where they differ most they are at least {:.1} % and at most {:.1} % of the step apart ({} % sure){clearest}",
        bounds.at_least,
        bounds.at_most,
        six_digits(100.0 * level),
    )
}

fn answer(found: &Comparison, bounds: &ComparisonBounds) -> String {
    let apart = apart(found, bounds);
    let margin = found.margin_percent;
    let subject = subject(found);
    match found.verdict {
        Verdict::Different if found.turns_the_other_way => format!(
            "{subject} are different: under the same command the second turns the other way, and {apart}."
        ),
        Verdict::Different => format!(
            "{subject} are different: {apart}, and {margin} % would still have counted as the same."
        ),
        Verdict::Same => {
            format!(
                "{subject} have the same step response within the margin of {margin} %: {apart}."
            )
        }
        Verdict::Undecided if found.may_be_waits => format!(
            "Not decided by the step responses: {apart}, and commands that wait for the next of pulses on a clock of their own may make all of it but what counts as the same."
        ),
        Verdict::Undecided => {
            format!(
                "Not decided by the step responses: {apart}, and the margin of {margin} % lies between."
            )
        }
    }
}

/// What the verdict is of.
fn subject(found: &Comparison) -> &'static str {
    match (found.of, &found.motions) {
        (Subject::Servos, _) => "The two servos",
        (Subject::Runs, Some(_)) => "These recordings",
        (Subject::Runs, None) => "These models",
    }
}

fn feel(found: &Comparison, linear: bool, options: &ComparisonOptions) -> String {
    let time = behind(found, linear);
    let times = times_of_response(found);
    let rest = found
        .levels
        .as_ref()
        .and_then(|levels| rest(levels, options));
    let rest = rest.or_else(|| farther(found)).unwrap_or_default();
    let scale = match options.scale_error() {
        0.0 => String::new(),
        error => format!(
            "; the bounds contain that the scales of the two sensors may be off from each other by ±{:.1} %",
            100.0 * error
        ),
    };
    let runs = match (found.of, &found.motions) {
        (Subject::Servos, _) => "the bounds contain the scatter of the runs",
        (Subject::Runs, Some(_)) => {
            "what differs from run to run is not included: whether the servos differ takes three runs a side"
        }
        (Subject::Runs, None) => {
            "what differs from run to run, or between up and down strokes, is not included, which takes recordings"
        }
    };
    let all_of_it = by_time_alone(found);
    format!("{time}{times}{rest}{scale}; {runs}.{all_of_it}")
}

/// What the shift is of the difference, and that a logger makes one, too, where it is all of it.
fn by_time_alone(found: &Comparison) -> String {
    match ShiftIs::of(found) {
        ShiftIs::All => {
            " Apart from that shift in time these recordings show no difference. A servo that answers later makes such a shift, and so do commands \
             that wait for the next pulse, and a recording in which commands and positions have the times of two different clocks."
                .to_owned()
        }
        ShiftIs::NotAll(left) => format!(
            " That is not all: behind the shift that brings them closest the responses, each relative to its own end, still differ by up to about {left:.1} %."
        ),
        ShiftIs::Unknown => String::new(),
    }
}

/// What a `shift` of the second side behind the first is, as the end of a sentence.
fn timing(shift: &Interval) -> String {
    // The best shift of these curves is no more than a guess where no interval says how far the servos are off it.
    let (Some(seconds), Some(ends)) = (shift.value, shift.ends()) else {
        return "is not known to be earlier or later than the first".to_owned();
    };
    if shift.contains(0.0) {
        let [lower, upper] = ends;
        return format!(
            "is between {:.1} ms ahead of the first and {:.1} ms behind it",
            -1e3 * lower,
            1e3 * upper
        );
    }
    if ends.iter().all(|end| end.abs() < NOTABLE_SHIFT_S) {
        return format!(
            "is neither ahead of the first nor behind it by more than {:.2} ms",
            1e3 * NOTABLE_SHIFT_S
        );
    }
    let place = if seconds > 0.0 { "behind" } else { "ahead of" };
    format!("is about {:.1} ms {place} the first", 1e3 * seconds.abs())
}

/// Whether the second is behind the first in time, stroke by stroke where they differ.
fn behind(found: &Comparison, linear: bool) -> String {
    let the_second = match linear {
        true => "The second",
        // Where a load changes with the angle, the one that is ahead in some strokes is behind in others.
        false => "In the mean of these strokes, each relative to its own end, the second",
    };
    match &found.curves[..] {
        [up, down] => format!(
            "{the_second} {} on the way up, and {} on the way down",
            timing(&up.delay_shift_s),
            timing(&down.delay_shift_s)
        ),
        curves => {
            let shifts = curves.iter().map(|curve| timing(&curve.delay_shift_s));
            let timing: String = shifts.collect();
            format!("{the_second} {timing}")
        }
    }
}

/// "; the rise time of the second is 4.8 ms longer ...", where that is sure: a servo that is slower in the middle of a stroke need not be later. When it passes 5 % of its way, too,
/// where nothing else says that it is later: that is no dead time.
fn times_of_response(found: &Comparison) -> String {
    let is_open = |curve: &DifferenceCurve| curve.delay_shift_s.contains(0.0);
    let delay = found.curves.iter().all(is_open).then(|| {
        surely_longer(found, "delay_s", |more, range| {
            let how = if more > 0.0 { "later" } else { "sooner" };
            format!(
                "; the second passes 5 % of its way {:.1} ms {how} ({range})",
                more.abs()
            )
        })
    });
    let rise = surely_longer(found, "rise_time_s", |more, range| {
        let how = if more > 0.0 { "longer" } else { "shorter" };
        // A servo that stops early is quick to where it stops.
        let own = match more < 0.0 && goes_less_far(found) {
            true => ", to its own nearer end,",
            false => "",
        };
        format!(
            "; the rise time of the second{own} is {:.1} ms {how} ({range})",
            more.abs()
        )
    });
    delay.flatten().into_iter().chain(rise).collect()
}

/// Whether the strokes of the second surely go less far.
fn goes_less_far(found: &Comparison) -> bool {
    let row = (found.differences.iter()).find(|row| row.metric == "dc_gain");
    let less = |row: &MetricDifference| {
        let towards_zero = row.a? * row.difference? < 0.0;
        Some(towards_zero && (row.lower? > 0.0 || row.upper? < 0.0))
    };
    row.and_then(less).unwrap_or(false)
}

/// By how much \[ms\] this time of the second is longer, and within which range, in the words of `say`, where that is sure.
fn surely_longer(
    found: &Comparison,
    metric: &str,
    say: impl FnOnce(f64, String) -> String,
) -> Option<String> {
    let row = (found.differences.iter()).find(|row| row.metric == metric)?;
    let ms = |seconds: Option<f64>| Some(1e3 * seconds?);
    let (more, lower, upper) = (ms(row.difference)?, ms(row.lower)?, ms(row.upper)?);
    let (from, to) = match (lower > 0.0, upper < 0.0) {
        (true, _) => (lower, upper),
        (_, true) => (-upper, -lower),
        _ => return None,
    };
    // An end that is rounded to 0 no longer says that the difference is sure.
    let digits = if from < 0.05 { 3 } else { 1 };
    Some(say(more, format!("{from:.digits$} .. {to:.1}")))
}

/// By how much farther the strokes of the second go, where that is sure.
fn farther(found: &Comparison) -> Option<String> {
    let row = (found.differences.iter()).find(|row| row.metric == "dc_gain")?;
    let sure = row.lower? > 0.0 || row.upper? < 0.0;
    let first = row.a?;
    let percent = 100.0 * ((row.b? / first).abs() - 1.0);
    let shown = format!("{:.1}", percent.abs());
    let [one, other] = [row.lower?, row.upper?].map(|end| 100.0 * (end / first).abs());
    let range = format!("{:.1} .. {:.1}", one.min(other), one.max(other));
    // Relative to their ends, shorter strokes at the same speed are ahead.
    let is_ahead = |curve: &DifferenceCurve| curve.delay_shift_s.upper.is_some_and(|s| s < 0.0);
    let how = match percent > 0.0 {
        true => "farther",
        false if found.curves.iter().any(is_ahead) => "less far, and shorter ones are over sooner",
        false => "less far",
    };
    (sure && shown != "0.0").then(|| format!("; its strokes go {shown} % ({range}) {how}"))
}

/// The end of the command at which the two rest farthest apart. Where that is within the bounds of the difference, and not nothing, there is
/// nothing to say.
fn rest(levels: &Sides<Levels>, options: &ComparisonOptions) -> Option<String> {
    let (a, b) = (&levels.a, &levels.b);
    let least = a.command_minus.min(b.command_minus);
    let ends = [
        (a.command_plus, b.command_plus, a.plus, b.plus),
        (a.command_minus, b.command_minus, a.minus, b.minus),
    ];
    ends.into_iter()
        .filter(|(command_a, command_b, ..)| command_a == command_b)
        .filter_map(|(command, _, a, b)| {
            let sure = (b.value? - a.value?).abs() > half_width_of_difference(a, b, options)?;
            Some((command, a.value?, b.value?, sure))
        })
        .max_by(|(_, a, b, _), (_, c, d, _)| (b - a).abs().total_cmp(&(d - c).abs()))
        .and_then(|(command, a, b, sure)| {
            let with = |number: String, unit: &str| match unit {
                "" => number,
                unit => format!("{number} {unit}"),
            };
            // A thousandth of the larger is finer than what a difference means to a pilot.
            let size = a.abs().max(b.abs());
            let decimals = match size > 0.0 {
                true => (3.0 - size.log10().floor()).clamp(0.0, 12.0) as usize,
                false => 0,
            };
            let position = |level: f64| with(format!("{level:.decimals$}"), &options.output_unit);
            // "+4.981" of 4.980556789934776: pulses are whole microseconds, and degrees by a calibration are not.
            let commanded = command_in_words(four_digits(command), least);
            let commanded = with(commanded, &options.input_unit);
            match (position(a), position(b)) {
                (a, b) if a == b => {
                    Some(format!("; commanded {commanded} both come to rest at {a}"))
                }
                (a, b) => sure.then(|| {
                    let zeros = by_zeros(levels, options);
                    format!(
                        "; commanded {commanded} it comes to rest at {b}, the first at {a}{zeros}"
                    )
                }),
            }
        })
}

/// What zeros of sensors may have to do with the second resting elsewhere than the first at one end for sure, or at both; nothing where one end is not known.
fn by_zeros(levels: &Sides<Levels>, options: &ComparisonOptions) -> &'static str {
    let off = |a: Interval, b: Interval| {
        let half_width = half_width_of_difference(a, b, options)?;
        Some((b.value? - a.value?, half_width))
    };
    let (a, b) = (&levels.a, &levels.b);
    let Some(((plus, of_plus), (minus, of_minus))) = off(a.plus, b.plus).zip(off(a.minus, b.minus))
    else {
        return "";
    };
    match (plus.abs() > of_plus, minus.abs() > of_minus) {
        (true, true) if (plus - minus).abs() <= of_plus.hypot(of_minus) => {
            ", and as far off at the other end: so do sensors whose zeros differ"
        }
        (true, true) if plus * minus > 0.0 => {
            ", and off to the same side at the other end: a part of it may be that the zeros of the sensors differ"
        }
        (true, true) if (plus < 0.0) == (a.plus.value > a.minus.value) => {
            ", and goes less far to the other end, too"
        }
        (true, true) => ", and farther to the other end, too",
        _ => {
            ", and at the other end no difference is sure: a load to one side does that, and zeros of the sensors that differ"
        }
    }
}

/// Of two rests of two recordings, whose sensors may have other zeros and scales.
fn half_width_of_difference(a: Interval, b: Interval, options: &ComparisonOptions) -> Option<f64> {
    let half = |of: Interval| Some((of.upper? - of.lower?) / 2.0);
    let of_zero = pointwise_critical(options.identification.level) * options.zero_sd;
    let of_scale = options.scale_error() * b.value?;
    Some(half(a)?.hypot(half(b)?).hypot(of_zero).hypot(of_scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shift_without_an_interval_is_not_said() {
        let of = |value: f64, ends: Option<[f64; 2]>| {
            timing(&Interval {
                value: Some(value),
                lower: ends.map(|[lower, _]| lower),
                upper: ends.map(|[_, upper]| upper),
            })
        };
        for value in [0.16e-3, -0.34e-3, 5e-3] {
            assert!(of(value, None).contains("not known"), "{value}");
        }
        let said = |value: f64, ends: [f64; 2]| of(value, Some(ends));
        assert!(said(0.1e-3, [0.05e-3, 0.2e-3]).contains("by more than 0.25 ms"));
        assert!(said(0.2e-3, [0.05e-3, 0.4e-3]).contains("about 0.2 ms behind"));
        assert!(said(0.2e-3, [-0.3e-3, 0.7e-3]).contains("between 0.3 ms ahead"));
    }

    #[test]
    fn rests_that_are_off_alike_at_both_ends_may_be_the_zeros_of_sensors() {
        let of = |minus: f64, plus: f64| Levels {
            command_plus: 10.0,
            plus: Interval::new(plus, plus - 0.1, plus + 0.1),
            command_minus: -10.0,
            minus: Interval::new(minus, minus - 0.1, minus + 0.1),
        };
        let said = |minus: f64, plus: f64| {
            let levels = Sides {
                a: of(-9.0, 9.0),
                b: of(minus, plus),
            };
            rest(&levels, &ComparisonOptions::default()).unwrap()
        };
        let shifted = said(-7.0, 11.1);
        assert!(shifted.ends_with("the first at 9.00, and as far off at the other end: so do sensors whose zeros differ"), "{shifted}");
        let larger = said(-10.5, 11.0);
        assert!(
            larger.ends_with(
                "it comes to rest at 11.00, the first at 9.00, and farther to the other end, too"
            ),
            "{larger}"
        );
        let smaller = said(-8.0, 7.5);
        assert!(
            smaller.ends_with(", and goes less far to the other end, too"),
            "{smaller}"
        );
        let one_end = said(-9.0, 8.0);
        assert!(
            one_end.contains("the first at 9.000, and at the other end no difference is sure"),
            "{one_end}"
        );
    }

    #[test]
    fn two_rests_differ_where_that_is_sure() {
        let of = |rest: f64, half_width: f64| Levels {
            command_plus: 10.0,
            plus: Interval {
                value: Some(rest),
                lower: Some(rest - half_width),
                upper: Some(rest + half_width),
            },
            command_minus: -10.0,
            minus: Interval::default(),
        };
        let said = |half_width: f64, zero_sd: f64| {
            let levels = Sides {
                a: of(4.30, half_width),
                b: of(4.31, half_width),
            };
            let options = ComparisonOptions {
                zero_sd,
                ..ComparisonOptions::default()
            };
            rest(&levels, &options)
        };
        let sure = said(0.005, 0.0).unwrap();
        assert_eq!(
            sure,
            "; commanded +10 it comes to rest at 4.310, the first at 4.300"
        );
        assert_eq!(said(0.02, 0.0), None);
        // The sensor's zero may have moved between the two.
        assert_eq!(said(0.005, 0.01), None);
    }
}
