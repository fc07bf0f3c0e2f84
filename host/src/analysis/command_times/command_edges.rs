//! Whether commands take effect at moments of their own, and not at the rows at which they are written.
//!
//! Then [answers scatter](super::answer_scatter) evenly: over one row where a logger with a clock of its own looks for the command, and over one
//! frame where pulses have frames of their own.
//!
//! Where it is one row, a logger polled the command: every answer is up to a row later than its row says, so no time holds, and
//! errors that follow the motion are its consequence. That is a reason to have no bounds. A frame of pulses is part of what a simulation needs.
//! Where frames are regular, [each command waits for the next](super::pulse_frames). Errors that follow the motion are that wait where a model of the
//! [commands at their pulses](super::commands_at_pulses) has none.

use super::answer_scatter::{ONE_ROW, Scatter, of_runs};
use super::command_answers::CommandAnswer;
use super::commands_at_pulses::{RunInFrames, is_linear_at_pulses};
use super::pulse_frames::{PulseFrames, TimedAnswer};
use crate::analysis::duration_in_words::in_words;
use crate::data::dataset::Dataset;
use servoid_identification::results::{Advice, Check, Model, Reason};
use servoid_identification::{Identification, Options};

/// The longest frame of pulses, or cycle of a controller \[s\].
const LONGEST_FRAME_S: f64 = 0.05;

/// When commands take effect, where that is not at their rows.
pub(crate) enum CommandEdges {
    /// Between the rows: no time of the model holds.
    BetweenRows(Advice),
    /// Between the rows, as was said with the recording: that is what errors follow.
    AsStated,
    /// At moments of a frame of their own.
    InFrames(Advice),
    /// With the next of regular pulses: that is what errors follow.
    WithPulses(Advice),
}

/// That commands take effect between the rows of a file, or later than they are written by a frame that scatters.
pub(crate) fn command_edges(
    data: &Dataset,
    found: &Identification,
    options: &Options,
) -> Option<CommandEdges> {
    let model = &found.model;
    let (at_rows, polled) = (data.about.commands_at_rows, data.about.polled);
    // Where a gain changes, strokes pass where the model does sooner and later; steps of a coarse sensor scatter from stroke to stroke, too.
    let gain_changes = model.bounds.withdrawn() == Some(Reason::GainDrift);
    if !(at_rows || polled) || gain_changes || found.explanation.resolution.is_some() {
        return None;
    }
    let scatter = Scatter::of(data.record.runs(), model)?;
    let rows = scatter.rows();
    let scatter_s = rows * model.sample_period_s;
    let is_longer = rows > *ONE_ROW.end() && scatter_s <= LONGEST_FRAME_S;
    if at_rows
        && is_longer
        && let Some(advice) = explained_by_pulses(&scatter, data, found, options)
    {
        return Some(CommandEdges::WithPulses(advice));
    }
    // Answers that come later and later scatter evenly about their means, too.
    let drifts = model.bounds.withdrawn() == Some(Reason::LagDrift);
    if drifts || !scatter.is_even() {
        return None;
    }
    // Errors of a servo that is not linear scatter over any time, and one row is little of that.
    let is_plain = model.linear && model.bounds.valid().is_some();
    let is_frame = at_rows && is_plain && is_longer;
    match ONE_ROW.contains(&rows) {
        true if polled => Some(CommandEdges::AsStated),
        true => Some(CommandEdges::BetweenRows(between_rows(rows, model))),
        false => is_frame
            .then(|| CommandEdges::InFrames(in_frames(rows, scatter_s, scatter.answers.len()))),
    }
}

fn scatter_in_words(scatter_s: f64) -> String {
    format!(
        "The answers to commands scatter evenly over {}",
        in_words(scatter_s)
    )
}

fn between_rows(rows: f64, model: &Model) -> Advice {
    let period_s = model.sample_period_s;
    Advice::new(
        Check::CommandsBetweenRows,
        format!(
            "{}, about the time between rows, as if commands changed between them. A logger with a clock of its own does that, and friction does in some recordings: by \
             such a logger all times are half a row, {}, too early, which no bound contains, and errors follow the motion of a linear servo, too.",
            scatter_in_words(rows * period_s),
            in_words(0.5 * period_s)
        ),
        rows,
        *ONE_ROW.start(),
        "If such a logger wrote the file, say --polled: times are corrected, and their intervals allow for the rest. If each command was written when it changed, another recording \
         of the kind may have bounds. If the pulses of the servo are as far apart as the rows, do not: then all times contain the mean wait for a pulse, half a row. Better, record by the clock \
         of the commands.",
    )
}

fn in_frames(rows: f64, scatter_s: f64, answers: usize) -> Advice {
    let finding = format!(
        "{}, as if each waited for a moment of its own: pulses in frames that the rows know nothing of do that, controllers with \
         such a cycle, and some servos that are not linear. Where it is a wait, all times contain the mean of it",
        scatter_in_words(scatter_s)
    );
    of_wait(rows, &finding, scatter_s, answers)
}

/// Of frames whose length is known, or of those over whose length answers scatter.
fn with_pulses(rows: f64, length_s: Option<f64>, scatter_s: f64, answers: usize) -> Advice {
    let frame = match length_s {
        Some(length_s) => format!("a frame of {}", in_words(length_s)),
        None => format!(
            "a frame of its own, of about {} (equal holds do not show it exactly)",
            in_words(scatter_s)
        ),
    };
    let finding = format!(
        "Each command waits for the next pulse of {frame}, and errors that follow the motion are taken for these waits. All times contain the mean of them"
    );
    of_wait(rows, &finding, length_s.unwrap_or(scatter_s), answers)
}

/// The mean fourth power of the differences of evenly distributed levels beside the square of the mean second one: large strokes count for more, as if there were so many times fewer.
const LARGE_STROKES: f64 = 2.4;

/// Standard deviations of a normal variable that 99 % are within.
const NEARLY_ALL: f64 = 2.58;

/// A `finding` that goes on with the mean of a wait of up to `longest_s`, of so many `answers`.
fn of_wait(rows: f64, finding: &str, longest_s: f64, answers: usize) -> Advice {
    let mean_wait = in_words(0.5 * longest_s);
    let by_chance =
        in_words(NEARLY_ALL * longest_s * (LARGE_STROKES / (12.0 * answers as f64)).sqrt());
    Advice::new(
        Check::CommandEdges,
        format!(
            "{finding}, {mean_wait}, and single answers are up to as much sooner or later. Of the waits of one recording the mean is up to {by_chance} more or less by chance, which no bound contains."
        ),
        rows,
        *ONE_ROW.start(),
        format!(
            "For a simulation that has such a frame, take {mean_wait} from the delay. Better, write each command at the pulse with which it \
             begins. If the logger looked for the command once in a row, by a clock of its own and not that of the pulses, say --polled: else all times are half a row too early."
        ),
    )
}

/// That commands wait for regular pulses, where no error in motion is left to a model of the commands at their pulses.
fn explained_by_pulses(
    scatter: &Scatter,
    data: &Dataset,
    found: &Identification,
    options: &Options,
) -> Option<Advice> {
    if !scatter.is_free_of_strokes() {
        return None;
    }
    let scatter_s = scatter.rows() * data.record.sample_period_s();
    let runs = runs_in_frames(scatter, data.record.sample_period_s());
    let most = runs.iter().max_by_key(|run| run.answers.len())?;
    let in_frames: usize = runs.iter().map(|run| run.answers.len()).sum();
    let are_most = 2 * in_frames > scatter.answers.len();
    if most.frames.length_s.is_none() && !scatter.strokes_are_different() {
        return None;
    }
    let is_explained = || found.model.linear || is_linear_at_pulses(&data.record, &runs, options);
    (are_most && is_explained())
        .then(|| with_pulses(scatter.rows(), most.frames.length_s, scatter_s, in_frames))
}

/// The runs that show regular pulses.
fn runs_in_frames(scatter: &Scatter, period_s: f64) -> Vec<RunInFrames> {
    let scatter_s = scatter.rows() * period_s;
    let of_run = |answers: &[CommandAnswer]| {
        let run = answers.first()?.at.0;
        let timed = answers.iter().map(|answer| TimedAnswer {
            at_s: answer.at.1 as f64 * period_s,
            late_s: answer.late * period_s,
        });
        let answers: Vec<TimedAnswer> = timed.collect();
        let frames = PulseFrames::of(&answers, scatter_s)?;
        Some(RunInFrames {
            run,
            answers,
            frames,
        })
    };
    of_runs(&scatter.answers).filter_map(of_run).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::command_times::answer_scatter::tests::record;
    use crate::analysis::{Identified, IdentifyRequest, compared, identified};
    use crate::data::dataset::{ArrayRun, Arrays, of_arrays};
    use servoid_identification::comparison::ComparisonOptions;
    use servoid_identification::results::Withheld;

    /// Of a recording that a logger polled, where that is said or not.
    fn polled(stated: bool) -> Dataset<'static> {
        let record = record(1.0, 0.02, f64::INFINITY);
        let run = &record.runs()[0];
        let arrays = Arrays {
            period_s: 0.01,
            phase_s: if stated { 0.005 } else { 0.0 },
            runs: vec![ArrayRun {
                input: run.input().to_vec().into(),
                output: run.output().to_vec().into(),
                at_rest: None,
            }],
            ..Arrays::default()
        };
        let mut data = of_arrays(arrays).unwrap();
        (data.about.commands_at_rows, data.about.polled) = (!stated, stated);
        data.about.sensor_delay_uncertainty_s = if stated { 0.005 } else { 0.0 };
        data
    }

    /// A lag of 30 ms passes a half after 20.8 ms, its commands wait for 5 ms on average, and half a row is 5 ms.
    #[test]
    fn a_polled_recording_has_no_times_unless_that_is_said() {
        let model = |data: &Dataset| {
            identified(data, "polled", &Options::default())
                .unwrap()
                .model
        };
        let data = polled(false);
        let options = ComparisonOptions::default();
        let compared = compared([&data; 2], ["a", "b"], options).unwrap();
        assert_eq!(
            compared.bounds.withdrawn(),
            Some(Reason::CommandsBetweenRows)
        );
        let unsaid = model(&data);
        assert_eq!(unsaid.bounds.withdrawn(), Some(Reason::CommandsBetweenRows));
        assert_eq!(unsaid.advice[0].check, Check::CommandsBetweenRows);
        assert_eq!(unsaid.metrics.withheld, Some(Withheld::TimeFault));
        assert!(unsaid.metrics.dc_gain.value.is_some() && unsaid.metrics.t50_s.value.is_none());
        let said = model(&polled(true));
        assert!(said.linear && said.bounds.valid().is_some());
        assert!(said.metrics.t50_s.contains(0.0308), "{:?}", said.metrics);
    }

    /// The same servo behind pulses every 23.7 ms, with which commands begin, under holds of `rows(stroke)`; no faster than `top` a step of 0.1 ms up, and `down` down.
    fn data_behind_pulses(rows: fn(u32) -> u32, [top, down]: [f64; 2]) -> Dataset<'static> {
        let random = |k: u32| (f64::from(k) * f64::from(k) * 0.7548776662).fract();
        let (mut input, mut output) = (Vec::new(), Vec::new());
        let (mut angle, mut in_force) = (0.0, 0.0);
        let mut part = 0u32;
        for stroke in 0..100 {
            let level = 10.0 * random(7 * stroke + 1) - 5.0;
            for row in 0..rows(stroke) {
                input.push(level);
                output.push(angle + 0.02 * (random(91 * stroke + row) - 0.5));
                for _ in 0..100 {
                    if part.is_multiple_of(237) {
                        in_force = level;
                    }
                    part += 1;
                    angle += f64::clamp((in_force - angle) / 300.0, -down, top);
                }
            }
        }
        let mut data = of_arrays(Arrays {
            period_s: 0.01,
            runs: vec![ArrayRun {
                input: input.into(),
                output: output.into(),
                at_rest: None,
            }],
            ..Arrays::default()
        })
        .unwrap();
        data.about.commands_at_rows = true;
        data
    }

    fn behind_pulses(rows: fn(u32) -> u32, limits: [f64; 2]) -> Model {
        let data = data_behind_pulses(rows, limits);
        let found = identified(&data, "pulses", &Options::default());
        found.unwrap().model
    }

    fn advised(model: &Model, words: &str) -> bool {
        let mut advice = model.advice.iter();
        advice.any(|item| item.finding.contains(words))
    }

    /// That the servo is linear with bounds, and its advice has these words.
    fn require_linear(model: &Model, words: &str) {
        assert!(
            model.linear && model.bounds.valid().is_some(),
            "{:?}",
            model.advice
        );
        assert!(advised(model, words), "{:?}", model.advice);
    }

    #[test]
    fn a_servo_behind_pulses_is_linear_and_its_frame_is_named() {
        let model = behind_pulses(|stroke| 20 + stroke % 21, [f64::INFINITY; 2]);
        require_linear(&model, "pulse of a frame of 23.7 ms");
    }

    #[test]
    fn under_equal_holds_it_is_linear_too_and_no_exact_frame_is_named() {
        let model = behind_pulses(|_| 20, [f64::INFINITY; 2]);
        require_linear(&model, "equal holds do not show it exactly");
    }

    /// The longest strokes are up to 330 a second, of which 100 or 150 are left: both ways, or up alone.
    #[test]
    fn a_limit_of_speed_behind_pulses_is_found() {
        for limits in [[0.01, 0.01], [0.015, 0.015], [0.015, f64::INFINITY]] {
            for rows in [|_| 20, |stroke| 20 + stroke % 21] {
                let model = behind_pulses(rows, limits);
                assert!(!model.linear, "{limits:?}: {:?}", model.advice);
                assert!(!advised(&model, "next pulse"), "{:?}", model.advice);
            }
        }
    }

    /// The response under pulses has their mean wait, and no delay with poles is like it.
    #[test]
    fn a_low_order_model_of_commands_that_wait_has_no_intervals() {
        let data = data_behind_pulses(|stroke| 20 + stroke % 21, [f64::INFINITY; 2]);
        let request = IdentifyRequest {
            flight_model: true,
            ..IdentifyRequest::default()
        };
        let found = Identified::of(&data, "pulses", &request, || ()).unwrap();
        assert!(found.model.bounds.valid().is_some());
        let low_order = found.flight_model.unwrap().unwrap();
        assert_eq!(low_order.bounds.withdrawn(), Some(Reason::CommandsWait));
        assert!(low_order.is_consistent() && low_order.delay_s.lower.is_none());
    }
}
