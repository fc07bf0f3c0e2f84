//! Findings on the record: whether it is enough, sound for the arithmetic, and of one piece.

use crate::data::References;
use crate::diagnostics::advice::evidence::Evidence;
use crate::diagnostics::runs::run_scatter::{RunComparison, RunDifference, Scatter};
use crate::estimation::{Solver, WELL_CONDITIONED};
use crate::numerics::{four_digits, two_digits};
use crate::results::{Advice, Check};
use crate::thresholds::{
    INITIAL_REST_MISSED, LARGE_SHARE, LOST_TO_HISTORY, RESIDUAL_SIGNIFICANCE, RUNS_FOR_MEAN,
    START_SIGNIFICANCE,
};

pub(super) fn parameters(evidence: &Evidence<'_>) -> Option<Advice> {
    let rows = evidence.explanation.rows as f64;
    let share = (evidence.model.theta.len() + 1) as f64 / rows;
    (share > LARGE_SHARE).then(|| {
        Advice::new(
            Check::Parameters,
            format!(
                "The model has a parameter for every {:.1} samples.",
                1.0 / share
            ),
            share,
            LARGE_SHARE,
            "Record longer, or ask for a shorter settling time.",
        )
    })
}

pub(super) fn conditioning(evidence: &Evidence<'_>) -> Option<Advice> {
    (evidence.explanation.path == Solver::Qr).then(|| {
        Advice::new(
            Check::Conditioning,
            "The moments were not accurate enough for this input or this little noise; the rows were factorised by \
             QR instead, which is slower and as accurate as ever.",
            evidence.explanation.condition,
            WELL_CONDITIONED,
            "Nothing needs to be done; sharper edges in the input make the moments suffice.",
        )
    })
}

pub(super) fn converged(evidence: &Evidence<'_>) -> Option<Advice> {
    let iterations = evidence.model.iterations as f64;
    (!evidence.model.converged).then(|| {
        Advice::new(
            Check::Converged,
            "The noise model did not converge.",
            iterations,
            iterations,
            "Fix the noise order, or look for a disturbance that comes and goes.",
        )
    })
}

/// A run against the common model. Its delay is that of a small shift: one that is longer than the response is half way stands for something else.
fn differences(run: &RunDifference, evidence: &Evidence<'_>) -> String {
    let model = evidence.model;
    let whole_s = model.structure.settling_samples as f64 * model.sample_period_s;
    let longest_s = model.metrics.t50_s.value.unwrap_or(0.5 * whole_s);
    let gain = run.gain_percent.value;
    let offset = evidence.output(format!("{:+}", two_digits(run.offset.value)));
    let offset = format!("offset {offset} against the common model");
    match run.delay_s.value {
        delay if delay.abs() <= longest_s => {
            format!("gain {gain:+.2} %, delay {:+.2} ms, {offset}", 1e3 * delay)
        }
        _ => format!("gain {gain:+.2} %, {offset}, and a motion that differs by more than a delay"),
    }
}

/// Which command offsets of `runs` are stated at.
fn at_mean_command(runs: &RunComparison, evidence: &Evidence<'_>) -> String {
    let command = evidence.input(four_digits(runs.mean_command));
    format!("at the mean command of {command}")
}

/// Whether all runs have one reference.
fn have_one_reference(evidence: &Evidence<'_>) -> bool {
    let runs = evidence.recorded.map(|record| record.runs().iter());
    runs.is_none_or(|runs| References::of(runs).count() == 1)
}

pub(super) fn scatter(evidence: &Evidence<'_>) -> Option<Advice> {
    let runs = evidence.explanation.runs.as_ref()?;
    let scatter = [runs.gain_percent, runs.delay_s, runs.offset];
    let p = scatter.iter().map(|s| s.p).fold(1.0, f64::min);
    let threshold = RESIDUAL_SIGNIFICANCE / scatter.len() as f64;
    let bounds = match evidence.has_bounds() {
        true if runs.runs.len() < RUNS_FOR_MEAN => {
            " The bounds are those of these recordings, not of the servo: its mean takes three runs."
        }
        true => {
            " The bounds contain this scatter: they are those of the mean of all such runs of the servo, not of its next run."
        }
        false => "",
    };
    // Beside one that is found, those that are not are left out.
    let is_found = |of: &Scatter| of.p < threshold;
    let moves = is_found(&runs.gain_percent) || is_found(&runs.delay_s);
    let named = [
        (
            &runs.gain_percent,
            format!("gain by {} %", two_digits(runs.gain_percent.sd)),
        ),
        (
            &runs.delay_s,
            format!("delay by {} ms", two_digits(1000.0 * runs.delay_s.sd)),
        ),
        (
            &runs.offset,
            format!(
                "offset by {} {}",
                evidence.output(two_digits(runs.offset.sd)),
                at_mean_command(runs, evidence)
            ),
        ),
    ];
    let named = named.into_iter().filter(|(of, _)| is_found(of));
    let named: Vec<String> = named.map(|(_, words)| words).collect();
    (p < threshold).then(|| {
        Advice::new(
            Check::RunScatter,
            format!(
                "The runs differ{} by more than their noise: {} (standard deviations between runs{}).{bounds}{}",
                match evidence.model.linear {
                    true => "",
                    false => ", each as of a linear servo,",
                },
                named.join(", "),
                match moves {
                    true => "; another bandwidth or damping passes for gain and delay here",
                    false => "",
                },
                farthest(evidence, runs).unwrap_or_default()
            ),
            p,
            threshold,
            match (evidence.model.linear, moves) {
                (true, false) => {
                    "The step response does not depend on it. Look at the zero of the sensor, at the horn on its spline, at loads that pull to one side, and at friction or play, which leave the servo a little elsewhere in each run."
                }
                (true, true) if !have_one_reference(evidence) => {
                    "These runs have different commands, and a servo that is not linear, by less than shows here, answers each in its own way: runs of one order show what is left. Look there \
                     for what changes from run to run, such as the supply voltage, the temperature, or when pulses come that have a clock of their own."
                }
                (true, true) => {
                    "Look for what changes from run to run, such as the supply voltage, the temperature, or when pulses come that have a clock of their own; \
                     compare servos by several runs each."
                }
                (false, _) => {
                    "This servo is not linear: it answers another motion, and levels in another order, in another way, and behind a dead band or friction its rests depend on where it comes \
                     from. Runs of one order show what is left: look there for what changes from run to run, such as the supply voltage, the temperature, or when pulses come that have a clock of \
                     their own."
                }
            },
        )
    })
}

/// Beyond this, how likely a distance is says nothing \[%\].
const LIKELY_PERCENT: f64 = 20.0;

/// Of so many runs any distance happens by chance.
const FEW_RUNS: usize = 4;

/// The run that lies farthest from the others, where that is no finding of its own.
fn farthest(evidence: &Evidence<'_>, runs: &RunComparison) -> Option<String> {
    let farthest = runs.farthest.filter(|_| runs.deviating.is_none())?;
    let run = runs.runs.iter().find(|run| run.run == farthest.run)?;
    let chance = match 100.0 * farthest.p {
        percent if percent < LIKELY_PERCENT => {
            format!(
                "of {} runs of one servo happens by chance in at most {percent:.0} % of recordings",
                runs.runs.len()
            )
        }
        // Standard deviations of so few are hardly known.
        _ if runs.runs.len() <= FEW_RUNS => format!(
            "{} runs are too few to call unusual: some run is always the farthest",
            runs.runs.len()
        ),
        _ => format!(
            "is nothing unusual: of {} runs of one servo, some run is always the farthest",
            runs.runs.len()
        ),
    };
    Some(format!(
        " Run {} lies farthest from the others ({}; {:.1} standard deviations of the others in one of these), which \
         {chance}.",
        evidence.run_name(run.run),
        differences(run, evidence),
        farthest.distance
    ))
}

pub(super) fn deviating(evidence: &Evidence<'_>) -> Option<Advice> {
    let runs = evidence.explanation.runs.as_ref()?;
    let deviating = runs.deviating?;
    let run = runs.runs.iter().find(|run| run.run == deviating.run)?;
    Some(Advice::new(
        Check::DeviatingRun,
        format!(
            "Run {} deviates from the others: {} (the offset {}).",
            evidence.run_name(run.run),
            differences(run, evidence),
            at_mean_command(runs, evidence)
        ),
        deviating.distance,
        deviating.threshold,
        format!(
            "Look at run {} before using it; identify again without it and compare.",
            evidence.run_name(run.run)
        ),
    ))
}

pub(super) fn history(evidence: &Evidence<'_>) -> Option<Advice> {
    let fit = &evidence.model.fit;
    let present = (evidence.samples - fit.samples_missing) as f64;
    let lost = 1.0 - evidence.explanation.rows as f64 / present;
    (lost > LOST_TO_HISTORY).then(|| {
        Advice::new(
            Check::History,
            format!(
                "{:.0} % of the samples only serve as history of others, because each run begins \
                 with an unknown past, and so does what follows a gap.",
                100.0 * lost
            ),
            lost,
            LOST_TO_HISTORY,
            "State the input before the runs (at rest), if it is known; or record fewer and longer \
             runs.",
        )
    })
}

pub(super) fn at_rest(evidence: &Evidence<'_>) -> Option<Advice> {
    let found = evidence.explanation.at_rest?;
    Some(Advice::new(
        Check::AtRest,
        format!(
            "Run {} did not begin at rest under an input of {}: its first readings are {:+.3} from there, {:.0} times \
             the usual error, as if the input had been {:.3}. A wrong statement bends the whole response.",
            evidence.run_name(found.run),
            found.stated,
            found.error,
            found.times_usual,
            found.rather
        ),
        found.times_usual,
        INITIAL_REST_MISSED,
        "State the input at which the servo rested before the run, or none.",
    ))
}

pub(super) fn start(evidence: &Evidence<'_>) -> Option<Advice> {
    let found = evidence.explanation.start.as_ref()?;
    let runs = match found.samples.len() {
        1 => "The run begins",
        _ => "Runs begin up to",
    };
    Some(Advice::new(
        Check::Start,
        format!(
            "{runs} {} from where the servo comes to rest later under the same command, as play or friction leave it on the side from which it came. First \
             strokes are as much longer or shorter, and are left out.",
            evidence.output(two_digits(found.distance.abs()))
        ),
        found.chance,
        START_SIGNIFICANCE,
        "Let the servo come to its first position as it does later, by a stroke from the same side.",
    ))
}
