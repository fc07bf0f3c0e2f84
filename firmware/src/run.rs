//! The present run.

use crate::board::CapturedFrame;
use crate::frame_history::History;
use crate::limits::{Limits, UNHEALTHY_SAMPLES};
use servoid_protocol::message::{Activity, EndReason, Ended, Frame, RunCheck, Start};
use servoid_protocol::{Counts, PulseWidth};

/// The progress of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Progress {
    /// Its first pulse has not been set.
    Requested,
    /// Its first pulse was set after frame `after`.
    Asked { after: u32 },
    /// Its first pulse was on the line in frame `first` of the board.
    Begun { first: u32 },
}

/// A run that has not ended.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone))]
pub(crate) struct Run {
    start: Start,
    frames: u16,
    progress: Progress,
    /// Index of the next frame: all below were captured or lost.
    next: u16,
    lost: u16,
    unhealthy: u8,
    check: RunCheck,
}

impl Run {
    /// A run of `frames` frames.
    pub(crate) fn new(start: Start, frames: u16) -> Self {
        Self {
            start,
            frames,
            progress: Progress::Requested,
            next: 0,
            lost: 0,
            unhealthy: 0,
            check: RunCheck::new(),
        }
    }

    /// Its progress.
    pub(crate) fn activity(&self) -> Activity {
        Activity::Running {
            run: self.start.run,
            frames: self.next,
        }
    }

    /// The report of its end, if it ends now.
    pub(crate) fn ended(&self, reason: EndReason) -> Ended {
        Ended {
            run: self.start.run,
            reason,
            frames: self.next,
            frames_lost_on_board: self.lost,
            check: self.check.value(),
        }
    }

    /// The pulse for the next frame.
    pub(crate) fn next_pulse(&self, limits: &Limits) -> PulseWidth {
        limits.pulse(self.start.offset_us(u32::from(self.next)).unwrap_or(0))
    }

    /// Takes a frame; returns the reason if the run ends with it.
    pub(crate) fn on_frame(
        &mut self,
        frame: &CapturedFrame,
        limits: &Limits,
        history: &mut History,
    ) -> Option<EndReason> {
        if let Some(index) = self.index_of(frame, limits) {
            while self.next < self.frames && u32::from(self.next) < index {
                self.lose(history);
            }
            if self.next < self.frames {
                self.take(frame, history);
            }
        }
        if frame.supply.is_low {
            Some(EndReason::SupplyLow)
        } else if self.sensor_failed(&frame.samples, limits) {
            Some(EndReason::SensorOutOfRange)
        } else if self.next >= self.frames {
            Some(EndReason::Complete)
        } else {
            None
        }
    }

    /// The frame's index in the run, or `None` before the run's first pulse is on the line.
    ///
    /// If the board set the first pulse too late for its frame, the pulse is set again. The run begins when it is
    /// really on the line.
    fn index_of(&mut self, frame: &CapturedFrame, limits: &Limits) -> Option<u32> {
        let first = match self.progress {
            Progress::Begun { first } => first,
            Progress::Asked { after } if frame.pulse == Some(self.next_pulse(limits)) => {
                after.wrapping_add(1)
            }
            _ => {
                self.progress = Progress::Asked {
                    after: frame.number,
                };
                return None;
            }
        };
        self.progress = Progress::Begun { first };
        Some(frame.number.wrapping_sub(first))
    }

    /// Stores a frame of the run, with the pulse that was applied. A frame without a pulse counts as lost.
    fn take(&mut self, caught: &CapturedFrame, history: &mut History) {
        let Some(pulse) = caught.pulse.filter(|pulse| pulse.0 != 0) else {
            self.lose(history);
            return;
        };
        self.check.update(&Frame {
            run: self.start.run,
            index: self.next,
            pulse,
            samples: caught.samples,
        });
        history.push(Some((pulse, caught.samples)));
        self.next = self.next.saturating_add(1);
    }

    fn lose(&mut self, history: &mut History) {
        history.push(None);
        self.next = self.next.saturating_add(1);
        self.lost = self.lost.saturating_add(1);
    }

    fn sensor_failed(&mut self, samples: &[Counts], limits: &Limits) -> bool {
        for &sample in samples {
            if limits.is_healthy(sample) {
                self.unhealthy = 0;
            } else {
                self.unhealthy = self.unhealthy.saturating_add(1);
                if self.unhealthy >= UNHEALTHY_SAMPLES {
                    return true;
                }
            }
        }
        false
    }
}
