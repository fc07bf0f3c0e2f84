//! A plan as text.

use super::alternatives::Alternative;
use super::band_width::BandWidths;
use super::forecast::Plan;
use super::runs_needed::{MOST_RUNS, RunsNeeded};
use crate::presentation::summary;
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
        "  structure   settling time N = {} samples, n = {} frequencies, as chosen on a simulated run",
        plan.settling_samples, plan.frequencies
    )?;
    match &plan.band {
        Some(band) => write_band(text, plan, band)?,
        None => writeln!(
            text,
            "  step band   none: the residuals of such a run are not noise, or the model that is planned with has no bounds, so\n              'servoid identify' will give none and may withhold metrics; take holds in which the servo comes to rest"
        )?,
    }
    write_spectrum(text, plan)?;
    writeln!(text, "\nQuestions beside the linear response")?;
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
            "\nThe servo's response is below the noise at all frequencies: raise --amplitude, or record many runs"
        )?;
    }
    Ok(())
}

/// The width of the band, the advice to narrow it, and the metrics with their intervals.
fn write_band(text: &mut String, plan: &Plan, band: &BandWidths) -> std::fmt::Result {
    let level = summary::percent(band.level);
    writeln!(
        text,
        "  step band   +-{:.2} % of the step at its widest, +-{:.2} % on average; each point +-{:.2} % ({level} % confidence)",
        band.widest_percent, band.mean_percent, band.mean_pointwise_percent
    )?;
    if plan.only_if_linear {
        writeln!(
            text,
            "              for a linear servo only: this reference has no hold in which the servo comes to rest, so speed\n              limit, dead band and friction make the band wider"
        )?;
    }
    if band.beyond_noise_percent > 0.0 {
        writeln!(
            text,
            "              +-{:.2} % of it is not noise: the servo is not linear, or the reference lacks power at some frequencies.\n              More runs do not narrow that part; holds in which the servo comes to rest do",
            band.beyond_noise_percent
        )?;
    } else if band.bias_percent > 0.0 {
        writeln!(
            text,
            "              +-{:.2} % of it is the bias by frequencies without power, which more runs do not narrow",
            band.bias_percent
        )?;
    }
    if let Some(needed) = &plan.needed {
        let wanted = needed.band_percent;
        writeln!(text, "  for +-{wanted} %  {}", in_words(needed))?;
    }
    if let (Some(wanted), None) = (plan.wanted_percent, &plan.needed) {
        let advice = band.narrowing().advice(wanted, plan.runs);
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
        "\nPower: {:.2} deg rms, crest factor {:.2}, 99 % below {:.1} Hz; the response is above the noise {}{}",
        spectrum.rms_deg,
        spectrum.crest_factor,
        spectrum.most_below_hz,
        match (spectrum.above_noise_from_hz, spectrum.above_noise_up_to_hz) {
            (_, 0.0) => "at no frequency".to_owned(),
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
        "\nAll references at this amplitude with default options, the narrowest first (half the band at its widest, % of the step)"
    )?;
    writeln!(
        text,
        "  {:10} {:>8} {:>9} {:>13}  questions answered",
        "", "run, s", "band, %", "in 1 minute"
    )?;
    for alternative in alternatives {
        let percent = |p: Option<f64>| p.map_or_else(|| "-".to_owned(), |p| format!("{p:.2}"));
        let needed = plan.wanted_percent.map(|wanted| match &alternative.needed {
            Some(needed) => format!("; +-{wanted} % needs {}", in_words(needed)),
            None => format!("; +-{wanted} % needs more than {MOST_RUNS} runs or another reference"),
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
                " (for a linear servo only)"
            } else {
                ""
            },
            needed.unwrap_or_default()
        )?;
    }
    writeln!(text, "{}", advice(alternatives))
}

/// The best reference for the band, and for the questions.
fn advice(alternatives: &[Alternative]) -> String {
    // Figures that hold for any servo go before figures that hold for a linear one only.
    let holds =
        |a: &&Alternative| !a.only_if_linear || alternatives.iter().all(|a| a.only_if_linear);
    let narrowest = alternatives
        .iter()
        .filter(holds)
        .filter_map(|a| Some((a.reference, a.widest_percent_in_a_minute?)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    // The first of equals: max_by_key alone takes the last.
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

fn in_words(needed: &RunsNeeded) -> String {
    let runs = match needed.runs {
        1 => "1 run".to_owned(),
        runs => format!("{runs} runs"),
    };
    format!("{runs}, {:.0} s", needed.seconds)
}
