//! Where the servo comes to rest at the outermost commands, where that is short of them.
//!
//! A sensor whose zero is off moves both rests alike, so the two are judged together: by the way between them against that between the commands.
//! What changes with the direction of the stroke is the same at all levels, and what a scale or a spring leaves grows with the command: levels that
//! are reached from both sides distinguish these.

use crate::data::dataset::Dataset;
use crate::data::rest_error::{CommandedRest, ShortOfCommand, rests_of};
use servoid_identification::Options;
use servoid_identification::column::mean;
use servoid_identification::results::{
    Advice, Check, Model, Reason, Withheld, command_in_words, pointwise_critical, six_digits,
};

/// A part of the commanded way that matters, which is the margin of a comparison unless another one is asked for. Dead band and friction of a servo
/// that is not loaded leave less.
const MATTERS: f64 = 0.05;

/// Standard deviations of a mean that are no chance.
const BEYOND_CHANCE: f64 = 4.0;

/// The rests at the outermost commands, where both columns are in one unit and the servo falls short of its commands by more than matters, the
/// scatter of the rests and the scale of the sensor explain.
pub(crate) fn advice(data: &Dataset, model: &Model) -> Option<Advice> {
    let unit = data.about.units().common()?;
    // A servo that changes along the recording rests elsewhere at each end of it, and a slow one is still on its way.
    let changes = model.level().withdrawn() == Some(Reason::GainDrift);
    let is_slow = model.metrics.withheld == Some(Withheld::ResponseNotOver);
    if !model.stops.is_empty() || changes || is_slow {
        return None;
    }
    let rests = rests_of(&data.record);
    let commands = || rests.iter().map(|rest| rest.command);
    let [low, high] = [
        Rests::at(commands().reduce(f64::min)?, &rests)?,
        Rests::at(commands().reduce(f64::max)?, &rests)?,
    ];
    let commanded = high.command - low.command;
    let way = high.position - low.position;
    let chance = BEYOND_CHANCE * low.sd_of_mean.hypot(high.sd_of_mean);
    let matters = (MATTERS + scale_share(data, model)) * commanded;
    // One that turns the other way is another finding.
    if way <= 0.0 || commanded - way <= matters.max(chance) {
        return None;
    }
    // A thousandth of the way is finer than what a pilot feels.
    let decimals = (2.0 - commanded.log10().floor()).clamp(0.0, 12.0) as usize;
    let rest = |rests: &Rests| format!("{:.decimals$} {unit}", rests.position);
    let of_command = |rests: &Rests| command_in_words(six_digits(rests.command), low.command);
    Some(Advice::new(
        Check::Travel,
        format!(
            "Commanded {} {unit} the servo comes to rest at {}, and commanded {} {unit} at {}.",
            of_command(&high),
            rest(&high),
            of_command(&low),
            rest(&low)
        ),
        way,
        commanded,
        what_to_look_for(commanded - way, &rests, commanded, |way| {
            format!("{way:.decimals$} {unit}")
        }),
    ))
}

/// Where to look, of a way that is `short` of the one `commanded`.
fn what_to_look_for(
    short: f64,
    rests: &[CommandedRest],
    commanded: f64,
    in_words: impl Fn(f64) -> String,
) -> String {
    let total = format!(
        "Between the two it falls short by {}, which zeros that are off do not make",
        in_words(short)
    );
    let part = |short: Option<f64>, how: &str, look: String| {
        short.map(|short| format!("{} of that {how}: look {look}.", in_words(short)))
    };
    let parts = ShortOfCommand::of(rests, commanded).into_iter();
    let known = parts.flat_map(|found| {
        let holds_back = format!("for {HOLDS_BACK}");
        // Strokes that do not cross all of the play tilt the line: both parts are no more than the whole.
        let by_direction = found.by_direction.map(|part| part.min(short));
        let left = short - by_direction.unwrap_or(0.0);
        let by_gain = found.by_gain.map(|by_gain| by_gain.min(left));
        let by_gain = by_gain.filter(|by_gain| *by_gain > 0.0);
        [
            part(
                by_direction,
                "changes with the direction of the stroke",
                holds_back,
            ),
            part(
                by_gain,
                "grows with the command",
                GROWS_WITH_COMMAND.to_owned(),
            ),
        ]
    });
    let known: Vec<String> = known.flatten().collect();
    match known.is_empty() {
        false => format!("{total}. {}", known.join(" ")),
        true => format!(
            "{total}: look {GROWS_WITH_COMMAND}; or for {HOLDS_BACK}. Stairs that reach each level from both sides show which it is."
        ),
    }
}

/// What is the same at all levels, and changes with the direction of the stroke.
const HOLDS_BACK: &str = "a dead band, friction or play in the gears";

/// What does not change with the direction.
const GROWS_WITH_COMMAND: &str = "at the scale of both columns, for a load that its drive does not hold, such as a spring, a weight or the air, and for a stop";

/// The rests under one command.
struct Rests {
    command: f64,
    /// Their mean.
    position: f64,
    sd_of_mean: f64,
}

impl Rests {
    /// `None` where there are not two.
    fn at(command: f64, all: &[CommandedRest]) -> Option<Self> {
        let here = all.iter().filter(|rest| rest.command == command);
        let positions: Vec<f64> = here.map(|rest| rest.position).collect();
        let position = mean(&positions).filter(|_| positions.len() > 1)?;
        let squares: f64 = positions.iter().map(|at| (at - position).powi(2)).sum();
        let count = positions.len() as f64;
        Some(Self {
            command,
            position,
            sd_of_mean: (squares / (count - 1.0) / count).sqrt(),
        })
    }
}

/// How far the scale of the sensor may be off, as a share; 0 where it was not calibrated here.
fn scale_share(data: &Dataset, model: &Model) -> f64 {
    let sd_percent = data.about.calibrations.iter().map(|of| of.scale_sd_percent);
    let level = model
        .level()
        .into_valid()
        .unwrap_or(Options::default().level);
    pointwise_critical(level) * sd_percent.fold(0.0, f64::max) / 100.0
}
