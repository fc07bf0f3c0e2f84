//! Findings on what was taken out of the record: glitches and hum.

use crate::diagnostics::advice::evidence::{Evidence, two_digits};
use crate::diagnostics::noise::hum::Hum;
use crate::diagnostics::outlying::other_strokes::LASTING;
use crate::diagnostics::outlying::taken_out::TakenOut;
use crate::results::{Advice, Check, Withheld};
use crate::thresholds::ABOVE_NEIGHBOURS;

/// Places that are named; the explanation has all.
const NAMED: usize = 3;

pub(super) fn outliers(evidence: &Evidence<'_>) -> Option<Advice> {
    let taken_out = evidence.explanation.taken_out.iter();
    let taken_out: Vec<&TakenOut> = taken_out.filter(|found| !found.other_stroke).collect();
    let count: usize = taken_out.iter().map(|found| found.samples).sum();
    // At a stop it is no glitch that is outlying.
    if count == 0 || evidence.validity.travel_ends.iter().any(Option::is_some) {
        return None;
    }
    let period = evidence.model.sample_period_s;
    let several = taken_out.iter().any(|found| found.run > 1);
    let place = |found: &TakenOut| {
        let seconds = found.sample as f64 * period;
        match several {
            true => format!("{seconds:.3} s of run {}", evidence.run_name(found.run)),
            false => format!("{seconds:.3} s"),
        }
    };
    let places: Vec<String> = (taken_out.iter().take(NAMED))
        .map(|found| place(found))
        .collect();
    let more = if taken_out.len() > NAMED {
        " and later"
    } else {
        ""
    };
    let (were, are) = match count {
        1 => ("was", "it is"),
        _ => ("were", "they are"),
    };
    let lasting = taken_out.iter().copied().filter(|found| !found.spike);
    let longest = lasting.max_by_key(|found| found.samples);
    let longest = longest.filter(|found| found.samples >= LASTING);
    // No motion is as long as a stroke, and a drift has no beginning.
    let changes = |found: &TakenOut| {
        let slow = evidence.slow_errors();
        slow.is_some_and(|slow| found.samples as f64 * period > slow.stroke_s())
    };
    let motion = longest.map(|found| match changes(found) {
        true => format!(
            " One lasts for {} samples, longer than a stroke, and the errors are slow: something such as a load changed there. Split the recording at \
             {}, and identify both parts.",
            found.samples,
            place(found)
        ),
        false => format!(
            " One lasts for {} samples, as glitches seldom do: where the servo was fast there, it may have met a limit of its speed, which a \
             linear model lacks and a servo model looks for.",
            found.samples
        ),
    });
    let smooth = evidence.validity.withheld == Some(Withheld::InputUnexcited);
    let lacking = smooth.then_some(
        " The model has a few frequencies of this input: where the input is quickest, what it lacks may be motion.",
    );
    let remedy =
        "Look at these places (the explanation has all) for glitches of the sensor or its wiring.";
    Some(Advice::new(
        Check::Outliers,
        format!(
            "{count} of {} samples {were} left out, because noise does not explain how far {are} from what the others predict: at \
             {}{more}.",
            evidence.samples,
            places.join(", ")
        ),
        count as f64,
        0.0,
        remedy.to_owned() + lacking.unwrap_or_default() + &motion.unwrap_or_default(),
    ))
}

pub(super) fn drift(evidence: &Evidence<'_>) -> Option<Advice> {
    let drift = &evidence.explanation.drift;
    let largest = drift
        .iter()
        .copied()
        .reduce(|a, b| if b.abs() > a.abs() { b } else { a })?;
    let bounds = match evidence.has_bounds() {
        true => ", and the bounds allow for it",
        false => "",
    };
    Some(Advice::new(
        Check::Drift,
        format!(
            "A straight line of each run, which changes by up to {} over a run, was taken out of the output within the regression: \
             the input does not explain it{bounds}. The servo model, plots and validations still have it.",
            evidence.output(format!("{largest:+.3}"))
        ),
        largest,
        0.0,
        "Look for the cause of the drift, such as temperature, supply or a load that changes; play and friction leave such a line in some recordings, too. It can be left in.",
    ))
}

pub(super) fn hum(evidence: &Evidence<'_>) -> Option<Advice> {
    let hum = &evidence.explanation.hum;
    let line = |line: &Hum| {
        format!(
            "{:.1} Hz with an amplitude of {}",
            line.hz,
            evidence.output(two_digits(line.amplitude))
        )
    };
    let lines: Vec<String> = hum.iter().map(line).collect();
    let strongest = hum.first()?;
    Some(Advice::new(
        Check::Hum,
        format!(
            "A periodic disturbance was taken out of the output: {}.",
            lines.join(", ")
        ),
        strongest.hz,
        ABOVE_NEIGHBOURS,
        "Look for its source: 50 or 60 Hz and multiples are those of the mains.",
    ))
}
