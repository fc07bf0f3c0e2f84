//! A JSBSim system: an actuator with speeds, hysteresis and delay, and a filter before or behind it.
//!
//! Behind the actuator the filter's lag behind a ramp, c/k times the speed, is the distance at which a servo of full drive begins to
//! brake. A servo whose speed alone is limited does not brake, and would be late by c/k: its filter comes first.

use super::difference::Difference;
use super::exported::ExportedServo;
use super::fixed_step::longest_s;
use super::rate_limit::{behind_in_larger_strokes, best_share};
use super::smooth_command::SmoothCommand;
use super::statement::{Comparison, Frame};
use super::subject::{NO_LIMIT, ServoExport};
use super::terms::Term;
use super::trial_command::Trial;
use super::worst_command::with_worst;
use crate::data::neutral::neutral;
use crate::presentation::export::emulation::SecondOrder;
use crate::presentation::export::error::ExportError;
use crate::presentation::export::jsbsim::{NO_NUMBER, TIME, before_servo, hold_switch, start};
use crate::presentation::export::jsbsim_delay::{DelayOfParts, aligned};
use crate::presentation::export::target::Target;
use crate::presentation::export::text::{XML_STYLE, identifier, number};
use crate::presentation::summary::four_digits;
use crate::presentation::template::fill;
use servoid_identification::servo_model::ServoParameters;

/// Step of the emulation without a choice \[s\]: the longest that the file advises.
pub(crate) const STEP_S: f64 = 0.002;

/// Delays that are tried, up to that of the servo.
const DELAYS: usize = 8;

/// What an actuator has not.
const LEFT_OUT: [Term; 9] = [
    Term::FullDrive,
    Term::SpeedInLoop,
    Term::FrictionOfGears,
    Term::FrictionAtRest,
    Term::Weight,
    Term::Spring,
    Term::ChangeOfLoadOfAir,
    Term::JumpOfRests,
    Term::PulseEnd,
];

/// Where the filter is.
#[derive(Clone, Copy, PartialEq)]
enum Filter {
    Before,
    Behind,
}

/// The numbers of the actuator and of the filter, in units of the command.
#[derive(Clone, Copy)]
struct Actuator {
    filter: Filter,
    /// The command under which all parts begin.
    centre: f64,
    delay_s: f64,
    /// Towards larger and smaller theta \[1/s\].
    rates: Option<(f64, f64)>,
    hysteresis_width: f64,
    /// Of the play behind all of that.
    play: f64,
    /// What the constant load moves the rest by.
    bias: f64,
    stiffness: f64,
    damping: f64,
    gain: f64,
    offset: f64,
    /// The least and the largest command that is passed on, and position; infinite without stops.
    commands: [f64; 2],
    positions: [f64; 2],
}

impl Actuator {
    fn of(export: &ServoExport<'_>) -> Self {
        let export = &export.with_spring_in_loop();
        let p = &export.parameters;
        let like = (export.parameters_with(export.only_constant_load())).without_stops();
        let bias = like.resting_angle(0.0);
        let hysteresis_width = hysteresis_width(export);
        let [least, most] = p.range().map(|end| end - bias);
        Self {
            filter: Filter::Behind,
            centre: neutral(export.metadata.units(), export.model.commands),
            // What is passed on falls short of the command by half of the hysteresis.
            commands: [
                least - hysteresis_width / 2.0,
                most + hysteresis_width / 2.0,
            ],
            positions: [
                p.stops.lower.unwrap_or(f64::NEG_INFINITY),
                p.stops.upper.unwrap_or(f64::INFINITY),
            ],
            delay_s: p.delay_s.max(0.0),
            rates: export.top_speeds(),
            hysteresis_width,
            play: p.play.unwrap_or(0.0),
            bias,
            stiffness: p.stiffness,
            damping: p.damping,
            gain: p.gain,
            offset: p.offset,
        }
    }

    /// With the filter there, at the rates that come closest to the servo in strokes. Of a command that is held for frames, a rate limit spreads each step over the time that it takes,
    /// which a shorter delay makes up for; a smooth one it passes on as it is. So the delay is the one that is closest in strokes and smooth motion together.
    fn fitted(
        &self,
        export: &ServoExport<'_>,
        filter: Filter,
        (trial, smooth): (&Trial, &Smooth),
    ) -> Closest {
        let top = self.rates.map(|(up, down)| up.max(down));
        let of_delay = |part: usize| {
            let delay_s = self.delay_s * part as f64 / DELAYS as f64;
            let full_speed = Self {
                filter,
                delay_s,
                ..*self
            };
            let found = best_share(export, trial, top, |share, trial| {
                (full_speed.slower(share)).respond(&trial.command(), trial.step_s)
            });
            let actuator = full_speed.slower(found.share);
            Closest {
                difference: found.difference.hypot(smooth.difference(&actuator)),
                share: found.share,
                actuator,
            }
        };
        let shorter = if export.frame_s() > 0.0 { 0 } else { DELAYS };
        (shorter..DELAYS)
            .map(of_delay)
            .fold(of_delay(DELAYS), Closest::or_closer)
    }

    /// With this share of its rates; without a limit where there is none.
    fn slower(&self, share: Option<f64>) -> Self {
        let rates = self.rates.zip(share);
        Self {
            rates: rates.map(|((up, down), share)| (share * up, share * down)),
            ..*self
        }
    }

    /// The position at the beginning of each step, as JSBSim computes it: an actuator limits the rate, then has its hysteresis and its
    /// delay, and filters are discrete by Tustin's rule.
    fn respond(&self, command: &[f64], step_s: f64) -> Vec<f64> {
        let [least, most] = self.commands;
        let mut late = DelayOfParts::new(self.delay_s, step_s, self.centre);
        let mut filter = SecondOrder::new(self.stiffness, self.damping, step_s, self.centre);
        let (mut limited, mut played) = (self.centre, self.centre);
        let mut act = |command: f64| {
            limited = match self.rates {
                None => command,
                Some((up, down)) => {
                    limited + (command - limited).clamp(-down * step_s, up * step_s)
                }
            };
            let half = self.hysteresis_width / 2.0;
            played = played.clamp(limited - half, limited + half);
            late.pass(played)
        };
        let mut shown = self.centre;
        let half_play = self.play / 2.0;
        let position = |command: &f64| {
            let command = command.max(least).min(most);
            let moved = match self.filter {
                Filter::Before => act(filter.pass(command)),
                Filter::Behind => filter.pass(act(command)),
            };
            shown = shown.clamp(moved - half_play, moved + half_play);
            self.position(shown)
        };
        command.iter().map(position).collect()
    }

    /// The position at rest under a command.
    fn position(&self, command: f64) -> f64 {
        let [lower, upper] = self.positions;
        let free = self.gain * (command + self.bias) + self.offset;
        free.max(lower).min(upper)
    }

    /// The parts of the system from the property `input` on, in their order, and the property behind them.
    fn parts(&self, id: &str, input: &str) -> (String, String) {
        let [limited, aligned_at, moved] =
            ["limited", "aligned", "moved"].map(|name| format!("fcs/{id}-{name}"));
        let first = format!("fcs/{id}-{input}");
        let (to_actuator, to_filter, last) = match self.filter {
            Filter::Before => (&moved, &first, &aligned_at),
            Filter::Behind => (&first, &aligned_at, &moved),
        };
        let values = |input: &str| {
            [
                ("id", id.to_owned()),
                ("input", input.to_owned()),
                ("elements", self.elements()),
                ("square", number(self.stiffness)),
                ("middle", number(self.damping)),
            ]
        };
        let actuator = [
            fill(
                include_str!("../templates/servo_model/limited.xml"),
                &values(to_actuator),
            ),
            aligned(id, &limited, self.delay_s),
        ];
        let filter = [fill(
            include_str!("../templates/oscillator.xml"),
            &values(to_filter),
        )];
        let mut parts = match self.filter {
            Filter::Before => [&filter[..], &actuator].concat(),
            Filter::Behind => [&actuator[..], &filter].concat(),
        };
        if self.play == 0.0 {
            return (parts.join("\n"), last.clone());
        }
        let values = [
            ("id", id.to_owned()),
            ("input", last.clone()),
            ("width", number(self.play)),
        ];
        parts.push(fill(
            include_str!("../templates/servo_model/played.xml"),
            &values,
        ));
        (parts.join("\n"), format!("fcs/{id}-played"))
    }

    /// What its elements are of the servo.
    fn in_words(&self) -> String {
        let place = match self.filter {
            Filter::Before => "before",
            Filter::Behind => "behind",
        };
        let mut said =
            format!("In JSBSim: the filter, {place} the actuator, is the servo at small signals");
        if self.hysteresis_width > 0.0 {
            said += "; hysteresis_width is the distance between the rests from above and from below, by friction at rest and dead band: a shaft that is moved slowly from either side stays so far apart, and here it is as far behind in motion";
        }
        if self.play > 0.0 {
            said += "; the hysteresis_width of the last actuator is the play";
        }
        if self.bias != 0.0 {
            said += "; the constant load, which moves the rest, is in the last bias";
        }
        said + "."
    }

    /// The elements of the actuator.
    fn elements(&self) -> String {
        let mut lines = Vec::new();
        if let Some((up, down)) = self.rates {
            lines.push(format!(
                "<rate_limit sense=\"incr\">{}</rate_limit>",
                number(up)
            ));
            lines.push(format!(
                "<rate_limit sense=\"decr\">{}</rate_limit>",
                number(down)
            ));
        }
        if self.hysteresis_width > 0.0 {
            let width = number(self.hysteresis_width);
            lines.push(format!("<hysteresis_width>{width}</hysteresis_width>"));
        }
        lines.push(format!(
            "<delay type=\"time\">{}</delay>",
            number(self.delay_s)
        ));
        lines.join("\n      ")
    }
}

/// An actuator that is closest to the servo.
struct Closest {
    actuator: Actuator,
    /// Of its rates, of those of the servo; `None` without a limit.
    share: Option<f64>,
    /// The root mean squares of its differences in strokes and in smooth motion, together.
    difference: f64,
}

impl Closest {
    fn or_closer(self, other: Self) -> Self {
        match other.difference < self.difference {
            true => other,
            false => self,
        }
    }
}

/// Smooth motion of the servo, which an actuator is held against.
struct Smooth {
    command: SmoothCommand,
    held: Vec<f64>,
    exact: Vec<f64>,
    step_s: f64,
}

impl Smooth {
    fn of(export: &ServoExport<'_>, trial: &Trial) -> Self {
        let command = SmoothCommand::of(export, trial, None);
        Self {
            command,
            held: command.held(),
            exact: command.exact(export),
            step_s: trial.step_s,
        }
    }

    /// The root mean square of the difference from the servo.
    fn difference(&self, actuator: &Actuator) -> f64 {
        let positions = actuator.respond(&self.held, self.step_s);
        self.command.root_mean_square(&positions, &self.exact)
    }
}

/// The distance between the rests from above and from below. Where the load moves the shaft through the dead band, it rests at one
/// edge, from wherever it comes.
fn hysteresis_width(export: &ServoExport<'_>) -> f64 {
    let p = &export.parameters;
    let [least, most] = p.holding_drives(export.constant_load());
    let without_dead_band = ServoParameters {
        dead_band: None,
        ..*p
    };
    let friction = without_dead_band.error_of(most) - without_dead_band.error_of(least);
    let open = if least * most > 0.0 {
        0.0
    } else {
        2.0 * p.dead_band.unwrap_or(0.0)
    };
    friction + open
}

/// The element that holds a value between these, one of which may be infinite; `None` where both are.
fn clip(range: [f64; 2]) -> Option<String> {
    let [least, most] = range.map(|end| number(end.clamp(-NO_LIMIT, NO_LIMIT)));
    range.iter().any(|end| end.is_finite()).then(|| {
        format!("\n      <clipto>\n        <min>{least}</min>\n        <max>{most}</max>\n      </clipto>")
    })
}

/// The system.
pub(super) fn write(export: &ServoExport<'_>) -> Result<ExportedServo, ExportError> {
    let any = Actuator::of(export);
    let trial = Trial::of(
        export,
        export.options.step_s.unwrap_or(STEP_S),
        [f64::NEG_INFINITY, f64::INFINITY],
    );
    let smooth = Smooth::of(export, &trial);
    let exact = trial.exact(&export.parameters);
    // In strokes that end both places of the filter may be about as close, and in those that turn round one of them several times as far.
    let with_reversals = |filter: Filter| {
        let found = any.fitted(export, filter, (&trial, &smooth));
        let positions = found.actuator.respond(&trial.command(), trial.step_s);
        let in_strokes = trial.root_mean_square(&positions, &exact);
        Closest {
            difference: in_strokes.hypot(smooth.difference(&found.actuator)),
            ..found
        }
    };
    let Closest {
        actuator, share, ..
    } = with_reversals(Filter::Behind).or_closer(with_reversals(Filter::Before));
    let step_s = trial.step_s;
    let trial = with_worst(trial, export, |commands| actuator.respond(commands, step_s));
    let positions = actuator.respond(&trial.command(), step_s);
    let slowest = actuator.rates.map(|(up, down)| up.min(down));
    let smooth = SmoothCommand::of(export, &trial, slowest);
    let like = export.parameters_with(export.load_of_loop());
    let difference = Difference::of(export, trial, |_| positions.clone(), &like);
    let id = identifier(export.name);
    let [limits, tops] = [&actuator, &any].map(|of| of.rates.map(<[f64; 2]>::from));
    let rate = export.rate(limits, tops.unwrap_or_default());
    let shorter = shorter_delay(export, actuator.delay_s);
    let mut about = about(export, &actuator, rate, &difference);
    about.extend(shorter.iter().map(|said| format!("Here {said}.")));
    about.push(smooth.in_words(export, &|sine| actuator.respond(&sine.held(), step_s)));
    let centre = actuator.centre;
    let (mut before, input) = before_servo(&id, centre, export.frame_s());
    let within = clip(actuator.commands.map(|end| end - centre)).map(|clip| {
        let values = [
            ("id", id.clone()),
            ("input", input.to_owned()),
            ("clip", clip),
        ];
        fill(include_str!("../templates/servo_model/within.xml"), &values)
    });
    let input = if within.is_some() { "within" } else { input };
    before.extend(within);
    let (parts, moved) = actuator.parts(&id, input);
    let values = [
        ("about", XML_STYLE.comment(&about)),
        ("centre", number(centre)),
        ("hold", before.join("\n")),
        ("switch", hold_switch(&id, export.frame_s())),
        ("clip", clip(actuator.positions).unwrap_or_default()),
        ("parts", parts),
        ("moved", moved),
        ("gain", number(actuator.gain)),
        (
            "offset",
            number(actuator.gain * (centre + actuator.bias) + actuator.offset),
        ),
        ("id", id),
    ];
    let text = fill(include_str!("../templates/servo_model/servo.xml"), &values);
    Ok(ExportedServo::new(text, difference)?
        .lacking(export, "JSBSim", &LEFT_OUT)?
        .warned(long_steps(export))
        .with(
            [shorter, behind_in_larger_strokes(share)]
                .into_iter()
                .flatten(),
        ))
}

/// That the chosen steps are long: JSBSim runs at 120 Hz as a rule, where a quick servo has no shorter ones.
fn long_steps(export: &ServoExport<'_>) -> Option<String> {
    let longest_ms = 1e3 * longest_s(export);
    let step_ms = 1e3 * export.options.step_s?;
    (step_ms > longest_ms).then(|| {
        format!(
            "steps of {} ms are long for this servo: beyond {} ms its motion is wrong by percents of a stroke, as the difference shows",
            four_digits(step_ms),
            four_digits(longest_ms)
        )
    })
}

/// How the delay is counted out.
const DELAY: &str = "Delay in steps: right to a part of one. JSBSim cuts a delay off to whole steps and delays by one of them less; the parts behind it make up for that, and for half a step by which Tustin's rule is early.";

/// That the delay is not the servo's, and why.
fn shorter_delay(export: &ServoExport<'_>, delay_s: f64) -> Option<String> {
    let own_s = export.parameters.delay_s;
    let [here, own] = [delay_s, own_s].map(|s| four_digits(1e3 * s));
    (delay_s < own_s).then(|| format!(
        "the delay is {here} ms in place of {own} ms: the rate limit spreads each step of a held command over the time that it takes, and with this delay strokes and smooth motion together are closest; small smooth motion is early by about the rest"
    ))
}

/// At which rate the system is to run.
fn steps(export: &ServoExport<'_>, difference: &Difference) -> String {
    let step_s = difference.trial.step_s;
    match export.options.step_s {
        Some(_) => format!(
            "Run it at {} Hz, in steps of {} ms, for which the differences below were computed.",
            four_digits(1.0 / step_s),
            four_digits(1e3 * step_s)
        ),
        None => "Run it at 500 Hz or more; at fewer, export with --step-ms, and the differences below are those of your steps.".to_owned(),
    }
}

fn about(
    export: &ServoExport<'_>,
    actuator: &Actuator,
    rate: String,
    difference: &Difference,
) -> Vec<String> {
    let mut about = export.statement(Target::Jsbsim);
    about.extend(export.stops_in_words(
        "the system, as limits of the command and of the position: here the servo comes to the stop slower than it does",
    ));
    about.extend([
        start(
            export.metadata.units(),
            actuator.centre,
            actuator.position(actuator.centre),
        ),
        export.frame(Frame::InFile),
    ]);
    about.extend([
        actuator.in_words(),
        DELAY.to_owned(),
        rate,
        format!(
            "Time: {TIME} {} Set the step before the aircraft is loaded: delays are counted out then.",
            steps(export, difference)
        ),
        NO_NUMBER.to_owned(),
        export.left_out("an actuator of JSBSim", &LEFT_OUT),
        export.difference(difference, Comparison::Emulation("JSBSim")),
    ]);
    about
}
