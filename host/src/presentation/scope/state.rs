//! Everything that the scope shows.

use crate::instrument::live::LiveStep;
use servoid_protocol::PulseTrain;
use servoid_protocol::Rejects;
use servoid_protocol::message::{Start, Status};
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use std::collections::VecDeque;
use std::sync::Arc;

/// Length of the trace (s): two and a half of the paper's longest cycles.
pub(super) const WINDOW_S: f64 = 4.0;

/// Number of past band widths that are shown.
const WIDTHS: usize = 6;

/// News from the capture.
#[derive(Clone, Debug)]
pub enum ScopeEvent {
    /// A frame was written to the disk.
    Frame(FrameSeen),
    /// A new estimate of the step response.
    Step(Arc<LiveStep>),
    /// The capture is being stopped.
    Stopping,
}

/// A frame in degrees, and the state of the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameSeen {
    /// Its index in the run.
    pub index: u32,
    /// The reference (deg).
    pub reference_deg: f64,
    /// The measured position (deg).
    pub positions_deg: [f64; SAMPLES_PER_FRAME],
    /// The state of the link.
    pub link: Link,
}

/// The state of the link and of the rig.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Link {
    /// Messages from the rig that could not be read, by class.
    pub rejects: Rejects,
    /// Frames that were requested again.
    pub asked_again: u32,
    /// Frames that have been given up.
    pub lost: u32,
    /// The newest status message of the rig.
    pub status: Option<Status>,
    /// Whether the sensor's reading has stood still though the command changed.
    pub stands_still: bool,
}

/// One sample of the trace.
#[derive(Clone, Copy, Debug)]
pub(super) struct TracePoint {
    /// Time since the run began (s).
    pub time_s: f64,
    pub reference_deg: f64,
    pub position_deg: f64,
}

/// Everything that the scope shows.
#[derive(Clone, Debug)]
pub struct ScopeState {
    /// The title line: the port and the file.
    pub(super) title: String,
    /// The run.
    start: Start,
    /// The pulses that the servo gets.
    train: PulseTrain,
    /// Half width of the band at which the run ends (percent of the step), if it is to end there.
    pub(super) until_percent: Option<f64>,
    /// Frames on the disk.
    pub frames: u32,
    /// The newest [`WINDOW_S`] seconds.
    pub(super) trace: VecDeque<TracePoint>,
    pub(super) link: Link,
    /// The newest estimate of the step response.
    pub(super) step: Option<Arc<LiveStep>>,
    /// Half widths of its band so far (percent of the step), the newest last.
    pub(super) widths: VecDeque<f64>,
    /// Whether the capture is being stopped.
    pub(super) stopping: bool,
}

/// The part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    RestBefore,
    Reference,
    RestAfter,
}

impl ScopeState {
    /// The state before the first frame.
    #[must_use]
    pub fn new(title: String, start: Start, train: PulseTrain, until_percent: Option<f64>) -> Self {
        Self {
            title,
            train,
            start,
            until_percent,
            frames: 0,
            trace: VecDeque::new(),
            link: Link::default(),
            step: None,
            widths: VecDeque::new(),
            stopping: false,
        }
    }

    /// Adds an event.
    pub fn apply(&mut self, event: ScopeEvent) {
        match event {
            ScopeEvent::Frame(frame) => self.add_frame(&frame),
            ScopeEvent::Step(step) => {
                if self.widths.len() == WIDTHS {
                    self.widths.pop_front();
                }
                self.widths.extend(step.half_width_percent());
                self.step = Some(step);
            }
            ScopeEvent::Stopping => self.stopping = true,
        }
    }

    fn add_frame(&mut self, frame: &FrameSeen) {
        self.frames = frame.index + 1;
        self.link = frame.link;
        let begin = f64::from(frame.index) * self.train.frame_s();
        let sample_s = self.train.sample_s();
        let times = (0..).map(|sample| begin + f64::from(sample) * sample_s);
        let points = times
            .zip(frame.positions_deg)
            .map(|(time_s, position_deg)| TracePoint {
                time_s,
                reference_deg: frame.reference_deg,
                position_deg,
            });
        self.trace.extend(points);
        let oldest = self.time_s() - WINDOW_S;
        self.trace.retain(|point| point.time_s >= oldest);
    }

    /// Time since the run began (s).
    pub(super) fn time_s(&self) -> f64 {
        f64::from(self.frames) * self.train.frame_s()
    }

    /// Frames that the run will have.
    pub(super) fn frames_total(&self) -> u32 {
        self.start.frames()
    }

    /// Time to the end of the run (s), if nothing ends it early.
    pub(super) fn left_s(&self) -> f64 {
        f64::from(self.frames_total().saturating_sub(self.frames)) * self.train.frame_s()
    }

    /// The part of the run that is done, 0 to 1.
    pub(super) fn done(&self) -> f64 {
        let total = self.frames_total().max(1);
        (f64::from(self.frames) / f64::from(total)).clamp(0.0, 1.0)
    }

    /// The part of the run that is under way.
    pub(super) fn phase(&self) -> Phase {
        let before = u32::from(self.start.pre_roll_frames);
        if self.frames < before {
            Phase::RestBefore
        } else if self.frames < before + self.start.reference.frames() {
            Phase::Reference
        } else {
            Phase::RestAfter
        }
    }

    /// Whether the band is as narrow as was wanted.
    pub(super) fn enough(&self) -> bool {
        let wanted = self.step.as_ref().zip(self.until_percent);
        wanted.is_some_and(|(step, percent)| step.is_within(percent))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instrument::rig::roll_frames;
    use servoid_protocol::Reference;
    use servoid_protocol::reference::Staircase;

    #[test]
    fn the_window_moves_and_the_counters_count() {
        let start = Start {
            run: 1,
            pre_roll_frames: roll_frames(PulseTrain::USUAL),
            reference: Reference::Staircase(Staircase::PAPER),
            post_roll_frames: roll_frames(PulseTrain::USUAL),
        };
        let mut state = ScopeState::new("x".to_owned(), start, PulseTrain::USUAL, None);
        assert_eq!((state.phase(), state.left_s()), (Phase::RestBefore, 8.8));
        for index in 0..440 {
            state.apply(ScopeEvent::Frame(FrameSeen {
                index,
                reference_deg: 5.0,
                positions_deg: [4.0; SAMPLES_PER_FRAME],
                link: Link::default(),
            }));
            if index == 200 {
                assert_eq!(state.phase(), Phase::Reference);
            }
        }
        assert_eq!(
            (state.frames, state.left_s(), state.done()),
            (440, 0.0, 1.0)
        );
        assert_eq!(state.phase(), Phase::RestAfter);
        let span = state.time_s() - state.trace[0].time_s;
        // Whole samples: the last one is the present one.
        let period_s = PulseTrain::USUAL.sample_s();
        assert!((span + period_s - WINDOW_S).abs() < 1e-9, "{span}");
    }
}
