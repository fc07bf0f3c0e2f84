//! Bringing the rig to neutral.

use crate::line::Line;
use crate::request::Answer;
use crate::task::{Asking, Next, Task};
use servoid_protocol::message::{Arm, Command, Refusal};
use std::time::Duration;

/// How often arming is tried where the sensor reads outside its range, and the pause in between: five
/// frames. A board that was switched on a moment ago has not read its sensor yet, and one disturbed
/// sample is no broken sensor.
const SENSOR_ATTEMPTS: u32 = 3;
const SENSOR_PAUSE: Duration = Duration::from_millis(100);

/// Arms the rig.
pub(crate) struct Arming {
    arm: Arm,
    tries: u32,
    pause_until: Option<Duration>,
}

impl Arming {
    pub(crate) fn begin(arm: Arm, line: &mut Line) -> Self {
        line.ask(Command::Arm(arm));
        Self {
            arm,
            tries: 1,
            pause_until: None,
        }
    }
}

impl Task for Arming {
    fn on_answer(&mut self, command: &Command, answer: Option<Answer>, line: &mut Line) -> Next {
        match answer {
            Some(Answer::Refused(Refusal::SensorOutOfRange)) if self.tries < SENSOR_ATTEMPTS => {
                self.pause_until = Some(line.now + SENSOR_PAUSE);
                Next::Stay
            }
            _ => Asking.on_answer(command, answer, line),
        }
    }

    fn on_time(&mut self, line: &mut Line) -> Next {
        if self.pause_until.is_some_and(|until| line.now >= until) {
            self.pause_until = None;
            self.tries += 1;
            line.ask(Command::Arm(self.arm));
        }
        Next::Stay
    }

    fn deadline(&self, _line: &Line) -> Option<Duration> {
        self.pause_until
    }
}
