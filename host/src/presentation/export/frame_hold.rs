//! What is not known of the hold of a command: in a pulse frame, and between the rows of a recording.
//!
//! A servo on pulses sees a command with the next pulse. Where the recorded commands were written at their pulses, as servoid does, that wait is
//! no part of the model's delay, and a simulation adds it by a hold. Where they were written at any other time, its mean is in the delay.

use super::text::number;
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::summary::four_digits;
use servoid_identification::servo_model::WaitsForPulses;

/// How far a frame is moved to be a whole number of steps, as a share of it: clocks of loggers and servos differ by as much.
const OF_FRAME: f64 = 0.02;

/// A frame as a program with steps has it.
pub(crate) struct FrameInSteps {
    pub(crate) metadata: ModelMetadata,
    /// That it is another one than that of the servo, as a sentence.
    pub(crate) remark: Option<String>,
    /// That pulses come within its steps, as a sentence.
    pub(crate) warning: Option<String>,
}

/// The condition under which a stated frame is right, and why.
pub(super) const WHEN_TO_STATE: &str = "only where the commands were recorded at their pulses, as servoid does; elsewhere that wait is in the model already, most of it in the delay";

impl ModelMetadata {
    /// That no hold is assumed, which is right of most recordings, and when it is not.
    #[must_use]
    pub fn frame_remark(&self) -> Option<String> {
        (self.pulse_frame_s.is_none())
            .then(|| format!("no frame hold is assumed: state --frame-ms {WHEN_TO_STATE}"))
    }

    /// That the wait for pulses which the servo model found is in the linear model.
    #[must_use]
    pub fn wait_remark(waits: WaitsForPulses) -> String {
        format!(
            "the commands of the recording waited for pulses {}: half of that on average is in this model, so no --frame-ms is right of it; in the servo model it is not",
            waits.in_words()
        )
    }

    /// What the rows of a command that moves on between them leave open of the delay.
    pub(super) fn open_delay(&self) -> Option<String> {
        (self.moving_command).then(|| {
            format!(
                "Delay: that of a servo that was held at the command of each row. The command of the recording moves on with every row: if the servo followed it between them, its delay is up to {} ms longer than in this file.",
                number((self.sensor_delay_uncertainty_s * 1e7).round() / 1e4)
            )
        })
    }

    /// With a frame of a whole number of steps, where one is near. A pulse within a step has the mean of two commands there, which a limit of the rate does not pass on as such: behind reversals that go on, the position moves away from that of the servo.
    pub(crate) fn with_frame_in_steps(self, step_s: f64) -> FrameInSteps {
        let frame_s = self.pulse_frame_s.unwrap_or_default();
        let whole_s = (frame_s / step_s).round() * step_s;
        let off = (whole_s / frame_s - 1.0).abs();
        let in_ms = |time_s: f64| four_digits(1e3 * time_s);
        let is_whole = frame_s <= 0.0 || off < f64::EPSILON.sqrt();
        if is_whole {
            return self.with_frame_as_it_is();
        }
        if off < OF_FRAME {
            let mut moved = self;
            moved.pulse_frame_s = Some(whole_s);
            return FrameInSteps {
                remark: Some(format!(
                    "the frame of {} ms is one of {} ms in this file, a whole number of its steps",
                    in_ms(frame_s),
                    in_ms(whole_s)
                )),
                ..moved.with_frame_as_it_is()
            };
        }
        FrameInSteps {
            warning: Some(format!(
                "pulses come within the steps of this file: in reversals that go on it moves farther away from the servo than is stated; steps of {} ms divide the frame (--step-ms)",
                in_ms(frame_s / (frame_s / step_s).ceil())
            )),
            ..self.with_frame_as_it_is()
        }
    }

    /// With its frame as it is, of a program whose commands are held by whoever steps it.
    pub(crate) fn with_frame_as_it_is(self) -> FrameInSteps {
        FrameInSteps {
            metadata: self,
            remark: None,
            warning: None,
        }
    }

    /// That a stated hold may count twice, in a model whose delay is `delay_s` where that is known: no more than this is counted twice.
    pub(super) fn frame_warning(&self, delay_s: Option<f64>) -> Option<String> {
        let most_s = delay_s.map_or(f64::INFINITY, |delay_s| delay_s.max(0.0));
        match self.pulse_frame_s {
            // Rows that are stated to be the commands of the servo contain no wait.
            Some(frame_s) if self.frame_is_stated && frame_s > 0.0 && !self.exact_command => {
                Some(format!(
                    "the stated frame of {} ms is right {WHEN_TO_STATE}, and commands with this hold are then {}{} ms too late",
                    four_digits(1e3 * frame_s),
                    if most_s < 0.5 * frame_s { "up to " } else { "" },
                    four_digits(1e3 * most_s.min(0.5 * frame_s))
                ))
            }
            _ => None,
        }
    }
}
