//! The sentences of advice on a comparison.

use super::motion::Motion;
use super::outcome::{Comparison, DifferenceCurve, Levels, Subject};
use super::pair::Identified;
use super::run_means::half_width_by_runs;
use super::sides::Sides;
use super::verdict::Verdict;
use crate::data::References;
use crate::nonlinear::Limits;
use crate::numerics::with_unit;
use crate::results::{Advice, Check, Model};
use crate::thresholds::LEVELS_FOR_ENDS;

/// How advice calls the two sides.
pub const SIDES: [&str; 2] = ["The first", "The second"];

/// That the sides had different references.
pub(super) fn different_references(motions: &Sides<Motion>, linear: bool, unit: &str) -> Advice {
    let (a, b) = (motions.a.in_words(unit), motions.b.in_words(unit));
    let differ = match a == b {
        true => format!("The references differ in their strokes: both are {a}"),
        false => format!("The references differ: the first is {a}; the second is {b}"),
    };
    let meaning = if linear {
        "Neither servo is shown to be nonlinear under its own reference, and a linear servo responds to both alike; \
         one that is limited in speed or torque, or has play, does not, and would differ from itself."
    } else {
        "At least one of the servos is not shown to be linear, and a servo that is not responds to each motion \
         differently: this difference of step responses is one of two motions, and no finding about the servos."
    };
    let range = |motion: &Motion| motion.highest - motion.lowest;
    Advice::new(
        Check::References,
        format!("{differ}. {meaning}"),
        range(&motions.b),
        range(&motions.a),
        "Record both sides with the same reference.",
    )
}

/// That both sides stand apart where the step responses, which are of changes alone, agree.
fn different_zeros(
    levels: &Sides<Levels>,
    sides: &[&Identified<'_>],
    margin_percent: f64,
    unit: &str,
) -> Option<Advice> {
    let &[a, b] = sides else { return None };
    let [low_a, high_a] = a.stands_at(&levels.a)?;
    let [low_b, high_b] = b.stands_at(&levels.b)?;
    let stroke = (high_a - low_a).abs();
    let apart = f64::midpoint(low_b, high_b) - f64::midpoint(low_a, high_a);
    let commanded = |side: &Levels| side.command_plus + side.command_minus;
    let same_command =
        (commanded(&levels.a) - commanded(&levels.b)).abs() / 2.0 < margin_percent / 100.0 * stroke;
    let percent = 100.0 * apart.abs() / stroke;
    (same_command && percent > margin_percent).then(|| {
        Advice::new(
            Check::Zeros,
            format!(
                "The second stands {} from the first, {percent:.0} % of the stroke, under the same commands. The verdict is on \
                 step responses, which are of changes alone; an over-prediction at the two ends counts from zero and contains it.",
                with_unit(format!("{apart:+.3}"), unit)
            ),
            percent,
            margin_percent,
            "Calibrate the sensor of both sides with the same zero, unless a load holds the second servo there.",
        )
    })
}

/// That the sides turn in different directions under the same command.
fn other_way(comparison: &Comparison) -> Option<Advice> {
    comparison.turns_the_other_way.then(|| {
        Advice::new(
            Check::Direction,
            "The second turns the other way under the same command: its gain has the other sign.",
            -1.0,
            0.0,
            "Where the servo is the same, change the sign of command or position of one side: of a column, of a direction that a transmitter or \
             controller is set to, or in the rig file.",
        )
    })
}

/// The limit of a comparison of two models, whatever servos they are of.
pub(super) fn one_response() -> Advice {
    Advice::new(
        Check::OneResponse,
        "Single strokes, and single runs, may differ by more than these models do: a model has one response for up and down \
         strokes and for all its runs, and a settling time of its own, so the metrics of models and of recordings are not the same.",
        1.0,
        2.0,
        "Compare the recordings: that separates up and down strokes, with one structure for both sides.",
    )
}

/// That models have no rests, which their recordings may have.
fn rests_of_models() -> Advice {
    Advice::new(
        Check::Levels,
        "Models do not carry where the servo rests at each level, so nothing here shows where it loses travel, nor whether it meets a stop.",
        0.0,
        LEVELS_FOR_ENDS as f64,
        "Compare the recordings: where they have rests at four levels or more, these show it.",
    )
}

/// More runs a side than this are no remedy that anybody takes.
const MOST_RUNS: usize = 20;

/// How many runs on each side bring the largest difference that is possible with `runs` below the margin, or what twice as many leave of the width
/// that so few make, where they scatter alike.
fn more_runs(found: &Comparison, runs: usize, level: f64) -> String {
    let left = |more: usize| half_width_by_runs(more, level) / half_width_by_runs(runs, level);
    let most = |more: usize| {
        let of_curve = |curve: &DifferenceCurve| {
            let upper = &curve.bounds.valid()?.upper;
            let ends = curve.percent.iter().zip(upper);
            let largest = ends.map(|(value, upper)| value.abs() + left(more) * (upper - value));
            largest.reduce(f64::max)
        };
        let of_curves = found.curves.iter().filter_map(of_curve);
        of_curves.fold(0.0, f64::max)
    };
    match (runs + 1..=MOST_RUNS).find(|more| most(*more) <= found.margin_percent) {
        Some(enough) => format!(
            "Record {enough} runs a side: where they scatter alike, about {:.1} % remains possible.",
            most(enough)
        ),
        None => format!(
            "Record more runs a side: where they scatter alike, {} leave about {:.0} % of the width that this makes.",
            2 * runs,
            100.0 * left(2 * runs)
        ),
    }
}

/// That so few runs leave a difference beyond the margin possible, where nothing else decides, or that the responses themselves are not known well enough:
/// without any scatter of the runs, the largest difference may be `of_recordings` \[percent\].
fn few_runs(
    comparison: &Comparison,
    models: [&Model; 2],
    sides: &[&Identified<'_>],
    of_recordings: Option<f64>,
) -> Option<Advice> {
    let bounds = comparison.bounds.valid()?;
    let undecided = comparison.verdict == Verdict::Undecided
        && !comparison.descriptions_of_different_motions
        && !comparison.may_be_waits;
    if comparison.of != Subject::Servos || !undecided {
        return None;
    }
    let fewest = comparison.runs[0].min(comparison.runs[1]);
    let most = bounds.difference_percent.at_most;
    let mut findings = models.iter().flat_map(|model| &model.advice);
    let of_recordings = of_recordings.filter(|most| *most > comparison.margin_percent);
    let finding = match (of_recordings, findings.any(Advice::is_of_scatter)) {
        (Some(most), _) => format!(
            "The step responses are known so badly that {most:.1} % of the step is possible without any scatter of the runs."
        ),
        (None, true) => format!(
            "The runs, {fewest} a side, scatter so much that {most:.1} % of the step is possible."
        ),
        (None, false) => format!(
            "The runs are not found to scatter beyond their noise, but {fewest} a side are so few to show it ({} degrees of freedom each) that {most:.1} % \
             of the step is possible.",
            fewest - 1
        ),
    };
    let are_linear = models.iter().all(|model| model.linear);
    let mut remedy = match of_recordings {
        Some(_) if are_linear => "Record longer runs, or larger steps.".to_owned(),
        Some(_) => "Record longer runs, or larger steps; of servos that are not linear steps of one size, to and fro: all of them have one answer.".to_owned(),
        None if are_linear => more_runs(comparison, fewest, bounds.level),
        // Runs of other orders differ by more than those at hand.
        None => "Record more runs a side.".to_owned(),
    };
    let is_of_one_order = |side: &&Identified<'_>| References::repeat(side.record.runs());
    if !are_linear && sides.iter().any(is_of_one_order) {
        remedy += OTHER_ORDERS;
    }
    Some(Advice::new(
        Check::Runs,
        finding,
        most,
        comparison.margin_percent,
        remedy,
    ))
}

/// How runs of a servo that is not linear are of use.
const OTHER_ORDERS: &str = " The servo is not linear: give each run its levels in another order, and both sides the same orders, because in runs of one order what the \
    linear model lacks repeats, and more of them say no more of it.";

/// Findings on either side that bear on their difference, and questions that the recordings leave open; `of_recordings` as in [`few_runs`].
pub(super) fn gather(
    comparison: &Comparison,
    models: [&Model; 2],
    sides: &[&Identified<'_>],
    output_unit: &str,
    of_recordings: Option<f64>,
) -> Vec<Advice> {
    let mut advice = Vec::new();
    for (side, model) in SIDES.into_iter().zip(models) {
        let bearing = |found: &&Advice| found.bears_on_comparison();
        let of_side = |found: &Advice| found.said_of(side);
        advice.extend(model.advice.iter().filter(bearing).map(of_side));
    }
    advice.extend(other_way(comparison));
    advice.extend(comparison.levels.and_then(|levels| {
        different_zeros(&levels, sides, comparison.margin_percent, output_unit)
    }));
    let fewest = comparison.runs[0].min(comparison.runs[1]);
    // Models have lost their runs, and the advice on models says so.
    if comparison.of == Subject::Runs && !sides.is_empty() {
        let runs = if fewest == 1 { "run" } else { "runs" };
        // With three or more, it is the runs that do not serve.
        let (why, remedy) = match fewest < 3 {
            true => ("", "Record three or more runs a side."),
            false => (
                " Some runs do not determine a response by themselves.",
                "Record runs with several strokes each way.",
            ),
        };
        let is_between_levels = |motions: &Sides<Motion>| {
            motions.a.is_between_two_levels() && motions.b.is_between_two_levels()
        };
        let several_sizes = comparison
            .motions
            .as_ref()
            .is_some_and(|found| !is_between_levels(found));
        let is_open = comparison.verdict == Verdict::Undecided
            && several_sizes
            && models.iter().any(|model| !model.linear);
        let sooner = match is_open {
            true => {
                " Of servos that are not linear, strokes to and fro between two levels decide sooner, as all are of one size."
            }
            false => "",
        };
        advice.push(Advice::new(
            Check::Runs,
            format!("{fewest} {runs} a side: differences from run to run are not included.{why}"),
            fewest as f64,
            3.0,
            format!("{remedy}{sooner}"),
        ));
    }
    advice.extend(few_runs(comparison, models, sides, of_recordings));
    let rested = |side: &&Identified<'_>| {
        let cells = Limits::level_table(side.record, &side.model);
        let mut levels: Vec<f64> = cells.iter().map(|cell| cell.command).collect();
        levels.dedup();
        levels.len()
    };
    if sides.is_empty() {
        advice.push(rests_of_models());
        return advice;
    }
    let fewest = sides.iter().map(rested).min().unwrap_or(0);
    if fewest < LEVELS_FOR_ENDS {
        let rests = match fewest {
            0 => "What was compared shows no rests of the servo, so it".to_owned(),
            1 => "The servo rested at one level of the command, which".to_owned(),
            more => format!("The servo rested at {more} levels of the command, which"),
        };
        advice.push(Advice::new(
            Check::Levels,
            format!("{rests} does not show where it loses travel, nor whether it meets a stop."),
            fewest as f64,
            LEVELS_FOR_ENDS as f64,
            "Record stairs up and down with at least four levels, both ends included, each reached \
             from both sides three times and held for twice the settling time.",
        ));
    }
    advice
}
