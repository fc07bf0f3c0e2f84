//! A plan as text.

use super::alternatives::Alternative;
use super::band_width::{BandWidths, MOST_RUNS, RunsNeeded, shows_step};
use super::forecast::Plan;
use crate::data::units::Units;
use crate::presentation::summary;
use servoid_identification::results::{Bounds, Reason};

/// A plan for a terminal.
#[must_use]
pub fn of_plan(plan: &Plan) -> String {
    let (noise, rest_s) = (plan.noise_deg, plan.run_s - plan.reference_s);
    let colour = match plan.noise_ar.len() {
        0 => "white".to_owned(),
        order => format!("coloured (order {order})"),
    };
    let (servo, runs, run_s) = (&plan.servo, in_words(plan.runs as u64), plan.run_s);
    let (settling, frequencies) = (plan.settling_samples, plan.frequencies);
    let all_s = run_s * plan.runs as f64;
    let rows = [
        (
            "assumed",
            match noise.is_finite() {
                true => {
                    summary::wrapped(&format!("{servo}, noise {noise:.4} deg rms, {colour}"), 14)
                }
                false => format!(
                    "{servo}, noise that grows without bound, {colour}: its model describes no noise at rest"
                ),
            },
        ),
        (
            "takes",
            format!("{runs} of {run_s:.1} s, {rest_s:.1} s of rest included: {all_s:.1} s"),
        ),
        (
            "structure",
            format!(
                "settling time N = {settling} samples, n = {frequencies} frequencies, as chosen on a simulated run"
            ),
        ),
        (
            "step band",
            match &plan.band {
                Bounds::Valid(band) => step_band(plan, band),
                Bounds::Withdrawn(reason) => none_because(*reason),
            },
        ),
    ];
    let mut text = format!("{}\n", plan.description);
    let beyond = plan.beyond_stops.iter();
    text.extend(beyond.map(|said| format!("  ! {}\n", summary::wrapped(said, 4))));
    for (name, value) in rows {
        text += &format!("  {name:11} {}\n", value.trim_end());
    }
    text.extend(
        plan.band
            .valid()
            .map(|band| more_runs_and_metrics(plan, band)),
    );
    text += &spectrum(plan);
    text += "\nQuestions beside the linear response\n";
    for answer in &plan.answers {
        let sign = if answer.answered {
            "shown    "
        } else {
            "not shown"
        };
        text += &format!("  {sign}  {}?\n", answer.question);
        text.extend(answer.why.as_ref().map(|why| format!("       {why}\n")));
    }
    text += &servo_model(plan);
    text += &alternatives(plan);
    if plan.spectrum.above_noise_up_to_hz == 0.0 {
        text += "\nThe servo's response is below the noise at all frequencies: raise --amplitude, or record many runs\n";
    }
    text
}

/// Why there is no band, of such a run or of the model that is planned with, and what to take instead.
fn none_because(reason: Reason) -> String {
    let remedy = match reason {
        Reason::InputUnexcited => "take a reference with sharp edges",
        Reason::FewLevels => "take a reference with three levels or more",
        Reason::FrictionUnseen | Reason::MotionInNoise => "take larger strokes",
        Reason::FrequenciesLeftOut => "identify the model again with more frequencies",
        Reason::ErrorsNotNoise | Reason::NeverAtRest => {
            "take holds in which the servo comes to rest"
        }
        Reason::QuantisationAboveNoise => {
            "take a reference with sharp edges, or a sensor with finer steps"
        }
        Reason::BeyondRecord => {
            "plan with a model of a recording with strokes as large and as quick as these"
        }
        Reason::SineOpen => "take a larger sine",
        Reason::ServoStopped => "take a model of what is before the servo stops",
        Reason::CommandsBetweenRows => "read the model's recording with --polled",
        Reason::CommandsWait => "write each command at the pulse with which it begins",
        Reason::GainDrift => "take a model of a part in which the servo does not change",
        Reason::EarlyMotion | Reason::LagDrift => "write command and position by one clock",
        Reason::TravelEnd | Reason::TravelEndOpen => "take strokes on this side of the stop",
        Reason::LoadHoldsDrive => "take strokes that the load lets the servo end",
        Reason::HeldOutput => "read the sensor with every sample",
        Reason::InputFollowsOutput => "record with a reference that was planned before",
        Reason::EndUnseen => "take holds of different lengths",
        Reason::OrderRejected => "take a servo model",
        Reason::ResponseNotOver => "take longer holds, and a longer reference",
    };
    let because = reason.because();
    format!(
        "none, as {because}: 'servoid identify' will give no bounds either\n              and may withhold metrics; {remedy}\n"
    )
}

/// A band of one run that is wider by this factor than the mean has another settling time.
const APART: f64 = 1.25;

/// The width of the band, and the part of it that is not noise.
fn step_band(plan: &Plan, band: &BandWidths) -> String {
    let level = summary::percent(band.level);
    let mut text = match shows_step(band.widest_percent) {
        true => format!(
            "±{:.2} % of the step at its widest, ±{:.2} % on average; each point ±{:.2} % ({level} % confidence)\n",
            band.widest_percent, band.mean_percent, band.mean_pointwise_percent
        ),
        false => format!(
            "none: ±{:.0} % at its widest, which is more than the step itself, so that such a run does not show how the servo answers one\n",
            band.widest_percent
        ),
    };
    if band.widest_of_all_percent > APART * band.widest_percent {
        let width = match shows_step(band.widest_of_all_percent) {
            true => format!("±{:.2} %", band.widest_of_all_percent),
            false => "wider than the step itself".to_owned(),
        };
        text += &format!(
            "              {width} in one of the simulated runs: some runs show an end of the response that others do not, and take a longer\n              settling time; --settling N of 'servoid identify' sets it\n",
        );
    }
    if band.without_bounds_percent > 0.0 {
        text += &format!(
            "              {:.0} % of the simulated identifications have no bounds\n",
            band.without_bounds_percent
        );
    }
    if plan.only_if_linear {
        text += "              for a linear servo only: this reference has no hold in which the servo comes to rest, so speed\n              limit, dead band and friction make the band wider\n";
    }
    let (bias, beyond) = (band.bias_percent, band.beyond_noise_percent);
    if beyond > 0.0 {
        text += &format!(
            "              ±{beyond:.2} % of it is not noise: the servo is not linear, or the reference lacks power at some frequencies.\n              More runs do not narrow that part; holds in which the servo comes to rest do\n"
        );
    } else if bias > 0.0 {
        text += &format!(
            "              ±{bias:.2} % of it is the bias by frequencies without power, which more runs do not narrow\n"
        );
    }
    text
}

/// The runs for the wanted band, and the metrics with their intervals.
fn more_runs_and_metrics(plan: &Plan, band: &BandWidths) -> String {
    let mut text = match (&plan.needed, plan.wanted_percent) {
        (Some(needed), _) => format!(
            "  for ±{} %  {}, on average of simulations: runs that show a slow end of the response take a longer\n              settling time, and have a wider band\n",
            needed.band_percent,
            time_of(needed)
        ),
        (None, Some(wanted)) => {
            let advice = match &plan.closest {
                Some(closest) => format!(
                    "±{wanted} % is not reached: {} {}. What is left is not noise, which alone more runs narrow; another reference, or a larger --amplitude while the servo stays linear, may reach it",
                    in_words(closest.runs),
                    match closest.band_percent.is_finite() {
                        true => format!("come to ±{:.2} % in simulations", closest.band_percent),
                        false => "mostly have no bounds in simulations".to_owned(),
                    }
                ),
                None => band.narrowing().advice(wanted, plan.runs),
            };
            format!("  narrower    {}\n", summary::wrapped(&advice, 14))
        }
        (None, None) => String::new(),
    };
    if !shows_step(band.widest_percent) {
        return text;
    }
    let level = summary::percent(band.level);
    text += &format!("\n  {:36} expected interval, {level} %\n", "");
    let metrics = plan.metrics.iter();
    for row in metrics.flat_map(|metrics| summary::metric_rows(&[metrics], "")) {
        for (value, bounds) in &row.cells {
            text += &format!("  {:26} {value:>9} {bounds}\n", row.label);
        }
    }
    text
}

fn spectrum(plan: &Plan) -> String {
    let spectrum = &plan.spectrum;
    let above = match (spectrum.above_noise_from_hz, spectrum.above_noise_up_to_hz) {
        (_, 0.0) => "at no frequency".to_owned(),
        (0.0, high) => format!("up to {high} Hz"),
        (low, high) => format!("from {low} to {high} Hz"),
    };
    let gap = spectrum
        .first_gap_hz
        .map(|hz| format!("; no power at multiples of {hz:.2} Hz"));
    let [from, to, rms, share, ratio] = ["from", "to Hz", "rms deg", "share %", "above noise dB"];
    let mut text = format!(
        "\nPower: {:.2} deg rms, crest factor {:.2}, 99 % below {:.1} Hz; the response is above the noise {above}{}\n  {from:>6} - {to:<6} {rms:>9} {share:>9} {ratio:>16}\n",
        spectrum.rms_deg,
        spectrum.crest_factor,
        spectrum.most_below_hz,
        gap.unwrap_or_default()
    );
    for octave in &spectrum.octaves {
        let (from, to, rms) = (octave.from_hz, octave.to_hz, octave.rms_deg);
        let (share, ratio) = (octave.share_percent, octave.signal_to_noise_db);
        text += &format!("  {from:>6} - {to:<6} {rms:>9.4} {share:>9.3} {ratio:>16.1}\n");
    }
    text
}

/// What a run will determine of the servo as a machine, and what to record for the rest.
fn servo_model(plan: &Plan) -> String {
    let Some(found) = &plan.servo_model else {
        return String::new();
    };
    let samples = match found.every {
        1 => "all samples".to_owned(),
        2 => "every second sample, which takes less time".to_owned(),
        every => format!("one sample in {every}, which takes less time"),
    };
    let tried = match (found.tried, found.level.withdrawn()) {
        (1, _) => String::new(),
        (tried, None) => format!("; {} of {tried} runs had no intervals", tried - 1),
        (tried, Some(_)) => format!("; none of {tried} runs had intervals"),
    };
    let mut text = format!(
        "\nThe servo as a machine, as identified on a simulated run ({samples}{tried})\n  {}\n",
        summary::terms_in_words(found.terms)
    );
    if let Bounds::Withdrawn(reason) = &found.level {
        text += &format!("  ! NO INTERVALS CAN BE GIVEN: {}\n", reason.because());
    }
    let degrees = Units {
        input: Some("deg"),
        output: Some("deg"),
    };
    text += &summary::quantities(&found.quantities, found.level, degrees, |_| false);
    for remedy in &found.remedies {
        text += &format!("  - {}\n", summary::wrapped(remedy, 4));
    }
    text
}

fn alternatives(plan: &Plan) -> String {
    let [run, band, minute] = ["run, s", "band, %", "in 1 minute"];
    let mut text = format!(
        "\nAll references at this amplitude with default options, the narrowest in 1 minute first (half the band at its widest, % of the step; -: not identified)\n  {:10} {run:>8} {band:>9} {minute:>13}  questions answered\n",
        ""
    );
    for alternative in &plan.alternatives {
        let percent = |p: Option<f64>| p.map_or_else(|| "-".to_owned(), |p| format!("{p:.2}"));
        let needed =
            plan.wanted_percent
                .map(|wanted| match (&alternative.needed, &alternative.closest) {
                    (Some(needed), _) => format!("; ±{wanted} % needs {}", time_of(needed)),
                    (None, closest) => format!(
                        "; ±{wanted} % needs more than {} runs or another reference",
                        closest.map_or(MOST_RUNS, |closest| closest.runs)
                    ),
                });
        let linear = match alternative.only_if_linear {
            true => " (for a linear servo only)",
            false => "",
        };
        text += &format!(
            "  {:10} {:>8.1} {:>9} {:>13}  {}{linear}{}\n",
            alternative.reference,
            alternative.run_s,
            percent(alternative.widest_percent),
            percent(alternative.widest_percent_in_a_minute),
            alternative.answers.len(),
            needed.unwrap_or_default()
        );
    }
    text + &advice(&plan.alternatives) + "\n"
}

/// The best reference for the band, and for the questions.
fn advice(alternatives: &[Alternative]) -> String {
    // Figures that hold for any servo go before figures that hold for a linear one only.
    let holds =
        |a: &&Alternative| !a.only_if_linear || alternatives.iter().all(|a| a.only_if_linear);
    let widths = alternatives.iter().filter(holds);
    let narrowest = widths
        .filter_map(|a| Some((a.reference, a.widest_percent_in_a_minute?)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let narrowest = narrowest.map_or_else(
        || "no reference identifies this servo at this noise".to_owned(),
        |(name, percent)| format!("the narrowest band per minute is {name}'s (±{percent:.2} %)"),
    );
    // The first of equals: max_by_key alone takes the last.
    let most = alternatives.iter().rev().max_by_key(|a| a.answers.len());
    let most = most.map(|most| {
        let (name, count) = (most.reference, most.answers.len());
        format!("; {name} answers the most questions ({count})")
    });
    format!("  {narrowest}{}", most.unwrap_or_default())
}

fn in_words(runs: u64) -> String {
    match runs {
        1 => "1 run".to_owned(),
        runs => format!("{runs} runs"),
    }
}

fn time_of(needed: &RunsNeeded) -> String {
    format!("{}, {:.0} s", in_words(needed.runs), needed.seconds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instrument::reference::ReferenceSpec;
    use crate::plan::{AssumedServo, PlanRequest};
    use servoid_protocol::PulseTrain;

    #[test]
    fn a_band_that_is_wider_than_the_step_is_none() {
        let assumed = AssumedServo::simulated(&"linear".parse().unwrap(), PulseTrain::USUAL);
        let request = PlanRequest {
            reference: ReferenceSpec::default().resolve(10.0).unwrap().reference,
            us_per_degree: 10.0,
            runs: 1,
            assumed: assumed.unwrap(),
            level: 0.99,
            wanted_percent: None,
            servo_model: false,
        };
        let plan = Plan::of(&request).unwrap();
        let of = |widest_percent: f64, widest_of_all_percent: f64| {
            let band = plan.band.map(|band| BandWidths {
                widest_percent,
                widest_of_all_percent,
                ..band
            });
            of_plan(&Plan {
                band,
                ..plan.clone()
            })
        };
        let usual = of(9.0, 9.0);
        assert!(usual.contains("±9.00 % of the step at its widest") && usual.contains("DC gain"));
        let one = of(99.0, 479.0);
        assert!(
            one.contains("wider than the step itself in one of the simulated runs")
                && !one.contains("479"),
            "{one}"
        );
        let none = of(102.6, 102.6);
        assert!(
            none.contains("none: ±103 % at its widest") && !none.contains("DC gain"),
            "{none}"
        );
    }
}
