//! A smooth command, which shows how late an export is in motion: a staircase shows its largest difference alone.

use super::recorded_range::{MOVING, held_back};
use super::subject::ServoExport;
use super::trial_command::{Trial, exact, root_mean_square};
use crate::presentation::summary::recorded;
use servoid_dynamics::ServoParameters;
use std::f64::consts::{PI, TAU};

/// The largest speed and the largest drive as a share of their limits: the sine is to stay below both.
const OF_LIMIT: f64 = 0.8;

/// The frequency as a share of that of the servo at small signals, at the most: where it follows.
const OF_BANDWIDTH: f64 = 0.2;

/// What the drive has left for motion at least, as a share of the limit: a load may take all of it at an end of the range.
const LEFT: f64 = 0.05;

/// By how much it stays short of a stop, as a share of the way between them: a servo that is held there has no phase.
const SHORT_OF_STOP: f64 = 0.05;

/// The longest period \[s\]; a servo that needs longer for the strokes of the recording gets smaller ones.
const LONGEST_S: f64 = 2.0;

/// The small sine beside it, as a share of its amplitude.
const SMALL: f64 = 0.1;

/// A sine of more than this share of the other one is no small one.
const LARGEST_SMALL: f64 = 0.5;

/// Periods, of which the first is not compared.
const PERIODS: usize = 3;

/// This share of a step keeps rounding from moving a frame, as in the files that hold a command.
const SLACK: f64 = 0.01;

/// A sine of the recording's range, slow enough for the servo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SmoothCommand {
    step_s: f64,
    frame_s: f64,
    middle: f64,
    amplitude: f64,
    steps_per_period: usize,
}

impl SmoothCommand {
    /// In the range of a trial, below the speed `limit` \[units of the command/s\] of the export and that of the servo.
    pub fn of(export: &ServoExport<'_>, trial: &Trial, limit: Option<f64>) -> Self {
        let top = export.top_speeds().map(|(up, down)| up.min(down));
        let limit = limit.into_iter().chain(top).fold(f64::INFINITY, f64::min);
        let [least, largest] = between_stops(export, trial.ends());
        let (middle, most) = (0.5 * (least + largest), 0.5 * (largest - least));
        let bandwidth = OF_BANDWIDTH * export.parameters.stiffness.sqrt();
        let wanted = (OF_LIMIT * limit / most).min(bandwidth).min(of_drive(
            &export.parameters,
            middle,
            most,
        ));
        let omega = wanted.max(TAU / LONGEST_S);
        Self {
            step_s: trial.step_s,
            frame_s: export.frame_s(),
            middle,
            amplitude: most * wanted / omega,
            steps_per_period: (TAU / omega / trial.step_s).round().max(1.0) as usize,
        }
    }

    /// The command of each step.
    pub fn command(&self) -> Vec<f64> {
        self.sampled(|time_s| time_s)
    }

    /// The same as the servo has it, held for each pulse frame where there is one: the mean of each step, in which a pulse may begin.
    pub fn held(&self) -> Vec<f64> {
        if self.frame_s == 0.0 {
            return self.command();
        }
        let slack_s = SLACK * self.step_s;
        // A pulse has the command of the step in which it begins.
        let of_pulse = |pulse_s: f64| {
            let step = ((pulse_s + slack_s) / self.step_s).floor();
            self.at(step * self.step_s)
        };
        let mean = |step: usize| {
            let time_s = step as f64 * self.step_s;
            let pulse_s = ((time_s - slack_s) / self.frame_s).ceil() * self.frame_s;
            let before = of_pulse(pulse_s - self.frame_s);
            let part = ((pulse_s - time_s) / self.step_s).min(1.0);
            part * before + (1.0 - part) * of_pulse(pulse_s)
        };
        (0..PERIODS * self.steps_per_period).map(mean).collect()
    }

    fn sampled(&self, taken_s: impl Fn(f64) -> f64) -> Vec<f64> {
        let command = |step: usize| self.at(taken_s(step as f64 * self.step_s));
        (0..PERIODS * self.steps_per_period).map(command).collect()
    }

    /// The sine at this time.
    fn at(&self, time_s: f64) -> f64 {
        self.middle + self.amplitude * (TAU / self.period_s() * time_s).sin()
    }

    fn period_s(&self) -> f64 {
        self.steps_per_period as f64 * self.step_s
    }

    /// By how much later than the servo itself, which gets the held command, an export is with these positions \[s\], and how much higher in the mean
    /// \[unit of the position\].
    fn apart(&self, export: &ServoExport<'_>, positions: &[f64]) -> (f64, f64) {
        let servo = self.exact(export);
        let phase = self.phase(positions) - self.phase(&servo);
        let nearest = phase - TAU * (phase / TAU).round();
        let lag_s = nearest / TAU * self.period_s();
        (lag_s, self.mean(positions) - self.mean(&servo))
    }

    /// The positions of the servo itself under the held command.
    pub fn exact(&self, export: &ServoExport<'_>) -> Vec<f64> {
        exact(&export.parameters, self.step_s, &self.held())
    }

    /// The root mean square of the difference of `positions` from the `exact` ones, over whole periods.
    pub fn root_mean_square(&self, positions: &[f64], exact: &[f64]) -> f64 {
        root_mean_square(positions, exact, self.steps_per_period)
    }

    /// The mean of positions over whole periods.
    fn mean(&self, positions: &[f64]) -> f64 {
        let compared = positions.get(self.steps_per_period..).unwrap_or_default();
        compared.iter().sum::<f64>() / compared.len() as f64
    }

    /// By how much positions lag, of a period of 2 pi.
    fn phase(&self, positions: &[f64]) -> f64 {
        let turn = TAU / self.steps_per_period as f64;
        let compared = positions.iter().enumerate().skip(self.steps_per_period);
        let (in_phase, behind) = compared.fold((0.0, 0.0), |(a, b), (step, position)| {
            let (sin, cos) = (turn * step as f64).sin_cos();
            (a + position * sin, b - position * cos)
        });
        f64::atan2(behind, in_phase).clamp(-PI, PI)
    }

    /// A sine of a tenth, of which a limit of the rate spreads no step, or of as much more as moves a servo that friction, a dead band or play holds so far back; `None` where that is most of the
    /// sine itself.
    fn small(&self, held_back: f64) -> Option<Self> {
        let amplitude = (SMALL * self.amplitude).max(MOVING * held_back);
        (amplitude < LARGEST_SMALL * self.amplitude).then_some(Self { amplitude, ..*self })
    }

    /// How late and how far off in the mean an export is that has these `positions` under a smooth command, a sentence; of a small sine, too, where that moves the servo.
    pub fn in_words(
        &self,
        export: &ServoExport<'_>,
        positions: &dyn Fn(&Self) -> Vec<f64>,
    ) -> String {
        let apart = |command: &Self| {
            let (lag_s, higher) = command.apart(export, &positions(command));
            let way = if lag_s < 0.0 { "early" } else { "late" };
            let late = format!("{:.1} ms {way}", 1e3 * lag_s.abs());
            let off = recorded::beside(higher.abs(), export.parameters.gain * command.amplitude);
            let side = if higher < 0.0 { "low" } else { "high" };
            match off.chars().any(|digit| matches!(digit, '1'..='9')) {
                true => format!(
                    "{late} and {off} {} {side} in the mean",
                    export.output_unit()
                ),
                false => late,
            }
        };
        let small = self.small(held_back(&export.parameters));
        let of_small = small.map_or_else(String::new, |small| {
            let size = match small.amplitude == SMALL * self.amplitude {
                true => "a tenth of that".to_owned(),
                false => {
                    let amplitude = recorded::beside(small.amplitude, self.amplitude);
                    format!("+- {amplitude} {}", export.command_unit())
                }
            };
            format!("; under one of {size} {}", apart(&small))
        });
        let beside = |value| recorded::beside(value, self.amplitude);
        let held = match self.frame_s > 0.0 {
            true => " and is held for each pulse frame",
            false => {
                " and is held for each step, for the servo model as for this file (the sine itself is half a step ahead of that)"
            }
        };
        format!(
            "Smooth command: under a sine of {} +- {} {} at {:.2} Hz, which stays below the limits of speed and drive{held}, the position is {}{of_small}.",
            beside(self.middle),
            beside(self.amplitude),
            export.command_unit(),
            1.0 / self.period_s(),
            apart(self)
        )
    }
}

/// The commands of a range between which the servo meets no stop.
fn between_stops(export: &ServoExport<'_>, [least, largest]: [f64; 2]) -> [f64; 2] {
    let [lower, upper] = export.parameters.range();
    let short = SHORT_OF_STOP * (largest.min(upper) - least.max(lower));
    [least.max(lower + short), largest.min(upper - short)]
}

/// The frequency of a sine of this amplitude about `middle` at which the drive is used up to its share \[rad/s\]; infinite without a limit.
fn of_drive(servo: &ServoParameters, middle: f64, amplitude: f64) -> f64 {
    let Some(limit) = servo.drive_limit() else {
        return f64::INFINITY;
    };
    let weakest = limit.both_ways().into_iter().fold(f64::INFINITY, f64::min);
    let load = [middle - amplitude, middle, middle + amplitude]
        .map(|angle| servo.load.at(angle).abs())
        .into_iter()
        .fold(0.0, f64::max);
    let friction = servo.friction.map_or(0.0, |friction| {
        friction.coulomb + friction.of_gears * (weakest + load)
    });
    let left = (OF_LIMIT * weakest - load - friction).max(LEFT * weakest);
    // Inertia and the motor's damping B take the amplitude times w sqrt(w^2 + B^2).
    let damping = limit.motor_damping * limit.motor_damping;
    let moved = 2.0 * left / amplitude;
    let square = moved * moved / 2.0 / (damping + damping.hypot(moved));
    square.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_dynamics::{DriveLimit, Load};

    #[test]
    fn a_sine_uses_the_drive_up_to_its_share() {
        let servo = ServoParameters {
            limit: Some(DriveLimit {
                up: 1000.0,
                down_to_up: 0.8,
                motor_damping: 3.0,
                at_one_stiffness: false,
            }),
            load: Load::Constant(100.0),
            ..ServoParameters::linear(900.0, 60.0)
        };
        let (amplitude, omega) = (20.0, of_drive(&servo, 5.0, 20.0));
        let drive = |turn: f64| {
            let (sin, cos) = turn.sin_cos();
            amplitude * omega * (3.0 * cos - omega * sin)
        };
        let most = (0..1000)
            .map(|k| drive(TAU * f64::from(k) / 1e3))
            .fold(0.0, f64::max);
        // 0.8 of 800, of which the load takes 100.
        assert!((most - 540.0).abs() < 0.1, "{most}");
        let held = ServoParameters {
            load: Load::Constant(2000.0),
            ..servo
        };
        assert!(of_drive(&held, 5.0, 20.0) > 0.0);
    }

    #[test]
    fn a_later_sine_is_as_late_as_it_is() {
        let smooth = SmoothCommand {
            step_s: 0.002,
            frame_s: 0.02,
            middle: 1500.0,
            amplitude: 300.0,
            steps_per_period: 500,
        };
        let later = |seconds: f64| smooth.phase(&smooth.sampled(|time_s| time_s - seconds));
        let lag = (later(0.0074) - later(0.0)) / TAU * smooth.period_s();
        // Rounding of a thousand terms.
        assert!((lag - 0.0074).abs() < 1e-9, "{lag}");
        // The mean wait of a hold of ten steps is that of 0 to 9 of them.
        let held = (smooth.phase(&smooth.held()) - later(0.0)) / TAU * smooth.period_s();
        assert!((held - 0.009).abs() < 1e-4, "{held}");
    }
}
