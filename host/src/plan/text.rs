//! A plan as text and as a picture.

use super::{Alternative, MOST_RUNS, Needed, Plan, Widths};
use crate::presentation::plots::figure::{Band, Curve, Figure, Ink, Legend, Panel};
use crate::presentation::summary;
use servoid_identification::step_response::StepBounds;
use std::fmt::Write;

/// A plan for a terminal.
#[must_use]
pub fn of_plan(plan: &Plan) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _infallible = write_plan(&mut text, plan);
    text
}

fn write_plan(text: &mut String, plan: &Plan) -> std::fmt::Result {
    let spectrum = &plan.spectrum;
    writeln!(text, "{}", plan.description)?;
    writeln!(
        text,
        "  assumed     {}, noise {:.4} deg rms, {}",
        plan.servo,
        plan.noise_deg,
        match plan.noise_ar.len() {
            0 => "white".to_owned(),
            order => format!("coloured (order {order})"),
        }
    )?;
    writeln!(
        text,
        "  takes       {} of {:.1} s, {:.1} s of rest included: {:.1} s",
        match plan.runs {
            1 => "1 run".to_owned(),
            runs => format!("{runs} runs"),
        },
        plan.run_s,
        plan.run_s - plan.reference_s,
        plan.run_s * plan.runs as f64
    )?;
    writeln!(
        text,
        "  structure   settling N = {} samples, n = {} frequencies, as a simulated run has chosen",
        plan.settling_samples, plan.frequencies
    )?;
    match &plan.band {
        Some(band) => write_band(text, plan, band)?,
        None => writeln!(
            text,
            "  step band   none: what a model of such a run leaves over is not noise, so 'servoid identify' will give no\n              bounds and may withhold figures; holds in which the servo comes to rest do better"
        )?,
    }
    write_spectrum(text, plan)?;
    writeln!(text, "\nWhat it answers beside the linear response")?;
    for answer in &plan.answers {
        let sign = if answer.answered { "yes" } else { "no " };
        writeln!(text, "  {sign}  {}?", answer.question)?;
        if let Some(why) = &answer.why {
            writeln!(text, "       {why}")?;
        }
    }
    write_alternatives(text, plan)?;
    if spectrum.above_noise_up_to_hz == 0.0 {
        writeln!(
            text,
            "\nNowhere does the servo's answer stand above the noise: raise --amplitude, or average many runs"
        )?;
    }
    Ok(())
}

/// How wide the band will be, what narrows it, and the metrics with their intervals.
fn write_band(text: &mut String, plan: &Plan, band: &Widths) -> std::fmt::Result {
    let level = summary::percent(band.level);
    writeln!(
        text,
        "  step band   +-{:.2} % whole curve where it is widest, +-{:.2} % on average; +-{:.2} % each point ({level} %, of the step)",
        band.widest_percent, band.mean_percent, band.mean_pointwise_percent
    )?;
    if plan.only_if_linear {
        writeln!(
            text,
            "              for a linear servo: this reference does not let it rest, and where its speed limit, dead band\n              or friction show, the band is wider than that"
        )?;
    }
    if band.beyond_noise_percent > 0.0 {
        writeln!(
            text,
            "              of which +-{:.2} % is not noise: the servo is not linear, or frequencies without power hide it. More runs\n              do not narrow that; holds in which the servo comes to rest do",
            band.beyond_noise_percent
        )?;
    } else if band.bias_percent > 0.0 {
        writeln!(
            text,
            "              of which +-{:.2} % is what frequencies without power may hide: more runs do not narrow it",
            band.bias_percent
        )?;
    }
    if let Some(needed) = &plan.needed {
        let wanted = needed.band_percent;
        writeln!(text, "  for +-{wanted} %  {}", in_words(needed))?;
    }
    if let (Some(wanted), None) = (plan.wanted_percent, &plan.needed) {
        let advice = band.shrinking().advice(wanted, plan.runs);
        writeln!(text, "  narrower    {}", summary::wrapped(&advice, 14))?;
    }
    writeln!(text, "\n  {:36} expected interval, {level} %", "")?;
    for row in plan.metrics.iter().flat_map(summary::rows_of_metrics) {
        for (value, bounds) in &row.cells {
            writeln!(text, "  {:26} {value:>9} {bounds}", row.label)?;
        }
    }
    Ok(())
}

fn write_spectrum(text: &mut String, plan: &Plan) -> std::fmt::Result {
    let spectrum = &plan.spectrum;
    writeln!(
        text,
        "\nWhere its power is: {:.2} deg rms, crest factor {:.2}, 99 % below {:.1} Hz; the answer is above the noise {}{}",
        spectrum.rms_deg,
        spectrum.crest_factor,
        spectrum.most_below_hz,
        match (spectrum.above_noise_from_hz, spectrum.above_noise_up_to_hz) {
            (_, 0.0) => "nowhere".to_owned(),
            (0.0, high) => format!("up to {high} Hz"),
            (low, high) => format!("from {low} to {high} Hz"),
        },
        match spectrum.first_gap_hz {
            Some(hz) => format!("; no power at multiples of {hz:.2} Hz"),
            None => String::new(),
        }
    )?;
    writeln!(
        text,
        "  {:>6} - {:<6} {:>9} {:>9} {:>16}",
        "from", "to Hz", "rms deg", "share %", "above noise dB"
    )?;
    for octave in &spectrum.octaves {
        writeln!(
            text,
            "  {:>6} - {:<6} {:>9.4} {:>9.3} {:>16.1}",
            octave.from_hz,
            octave.to_hz,
            octave.rms_deg,
            octave.share_percent,
            octave.signal_to_noise_db
        )?;
    }
    Ok(())
}

fn write_alternatives(text: &mut String, plan: &Plan) -> std::fmt::Result {
    let alternatives = &plan.alternatives;
    writeln!(
        text,
        "\nAll references at this amplitude, without further options, the best first (the band where it is widest)"
    )?;
    writeln!(
        text,
        "  {:10} {:>8} {:>9} {:>13}  further answers",
        "", "run, s", "band, %", "in a minute"
    )?;
    for alternative in alternatives {
        let percent = |p: Option<f64>| p.map_or_else(|| "-".to_owned(), |p| format!("{p:.2}"));
        let needed = plan.wanted_percent.map(|wanted| match &alternative.needed {
            Some(needed) => format!("; +-{wanted} % needs {}", in_words(needed)),
            None => format!("; no +-{wanted} % within {MOST_RUNS} runs"),
        });
        writeln!(
            text,
            "  {:10} {:>8.1} {:>9} {:>13}  {}{}{}",
            alternative.reference,
            alternative.run_s,
            percent(alternative.widest_percent),
            percent(alternative.widest_percent_in_a_minute),
            alternative.answers.len(),
            if alternative.only_if_linear {
                " (only if the servo is linear)"
            } else {
                ""
            },
            needed.unwrap_or_default()
        )?;
    }
    writeln!(text, "{}", advice(alternatives))
}

/// Which does best at what.
fn advice(alternatives: &[Alternative]) -> String {
    // In a table of linear figures, those that hold for any servo go before the others.
    let holds =
        |a: &&Alternative| !a.only_if_linear || alternatives.iter().all(|a| a.only_if_linear);
    let narrowest = alternatives
        .iter()
        .filter(holds)
        .filter_map(|a| Some((a.reference, a.widest_percent_in_a_minute?)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    // Of equals the first: max_by_key would take the last.
    let most = alternatives
        .iter()
        .rev()
        .max_by_key(|alternative| alternative.answers.len());
    let narrowest = narrowest.map_or_else(
        || "no reference identifies this servo at this noise".to_owned(),
        |(name, percent)| format!("the narrowest band per minute is {name}'s (+-{percent:.2} %)"),
    );
    match most {
        Some(most) => format!(
            "  {narrowest}; {} answers the most questions ({})",
            most.reference,
            most.answers.len()
        ),
        None => format!("  {narrowest}"),
    }
}

fn in_words(needed: &Needed) -> String {
    let runs = match needed.runs {
        1 => "1 run".to_owned(),
        runs => format!("{runs} runs"),
    };
    format!("{runs}, {:.0} s", needed.seconds)
}

/// The spectrum over the noise, and the step response with the band that is to be expected, if there is one.
#[must_use]
pub fn figure(plan: &Plan, name: &str) -> Figure {
    let curve = |label: &str, ink, of: fn(&super::Line) -> f64| {
        Curve::solid(
            label,
            ink,
            plan.spectrum.lines.iter().map(|line| (line.hz, of(line))),
        )
    };
    let noise = Curve {
        dashed: true,
        ..curve("noise", Ink::Model, |line| line.noise_db)
    };
    let spectrum = Panel {
        x_label: "frequency (Hz)".into(),
        x_logarithmic: true,
        y_label: "density (dB over 1 deg²/Hz)".into(),
        legend: Legend::Above,
        curves: vec![
            curve("reference", Ink::Reference, |line| line.reference_db),
            curve("the servo's answer", Ink::Measured, |line| line.response_db),
            noise,
        ],
        ..Panel::default()
    };
    let step = &plan.step;
    let times = || step.time_s.iter().copied();
    let band = |(widths, bounds): (Widths, &StepBounds)| {
        let whole = &bounds.simultaneous;
        let bounds = whole.lower.iter().zip(&whole.upper);
        Band {
            name: format!(
                "expected, the whole curve, {} %",
                summary::percent(widths.level)
            ),
            ink: Ink::Model,
            points: times()
                .zip(bounds)
                .map(|(t, (&lower, &upper))| (t, lower, upper))
                .collect(),
        }
    };
    let response = Panel {
        x_label: "time since the edge of the command (s)".into(),
        y_label: "response to a unit step".into(),
        bands: plan
            .band
            .zip(step.bounds.valid())
            .map(band)
            .into_iter()
            .collect(),
        curves: vec![Curve::solid(
            plan.servo.as_str(),
            Ink::Model,
            times().zip(step.value.iter().copied()),
        )],
        ..Panel::default()
    };
    Figure {
        name: name.into(),
        title: plan.description.clone(),
        panels: vec![spectrum, response],
    }
}
