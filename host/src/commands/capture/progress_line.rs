//! Progress of a capture without the live scope.
//!
//! A terminal may take nothing for any time, and the run must not wait for it. So a thread of its own writes, and what
//! it cannot take is left out.

use crate::commands::output::Talk;
use crate::data::DegreeScale;
use crate::instrument::rig::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use servoid_protocol::Frame;
use servoid_protocol::timing::{FRAMES_PER_SECOND, SAMPLES_PER_FRAME};
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::time::Duration;

/// Lines or positions of the bar that wait for the terminal, at most.
const WAITING: usize = 64;

/// Longest wait for the last of them.
const LAST_WORD: Duration = Duration::from_millis(300);

/// A progress bar in a terminal; elsewhere one line for each second of the run.
pub(super) struct ProgressLine {
    lines: SyncSender<Line>,
    /// Carries no message; it is disconnected when the thread ends.
    thread: Receiver<()>,
    has_bar: bool,
}

/// What is shown of a frame.
struct Line {
    frame: Frame,
    frames_total: u32,
    unreadable: u32,
    asked_again: u32,
    band_percent: Option<f64>,
    stands_still: bool,
}

impl ProgressLine {
    pub(super) fn new(talk: Talk, frames: u32, scale: DegreeScale) -> Self {
        let bar = match talk.quiet {
            true => ProgressBar::hidden(),
            false => ProgressBar::new(frames.into()),
        };
        let template = "{bar:30} {pos}/{len} frames, {eta} left  {wide_msg}";
        // Should the library ever refuse the template, its own style would do.
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        let has_bar = !bar.is_hidden();
        let (lines, received) = sync_channel(WAITING);
        let (ends, thread) = channel();
        std::thread::spawn(move || {
            show(&bar, talk, &scale, &received);
            drop(ends);
        });
        Self {
            lines,
            thread,
            has_bar,
        }
    }

    /// Shows a frame, where the terminal takes it. `band_percent` is half the width of the step response's band, if
    /// there is one.
    pub(super) fn update(&self, progress: Progress<'_>, band_percent: Option<f64>) {
        let done = u32::from(progress.frame.index) + 1;
        if self.has_bar || done.is_multiple_of(FRAMES_PER_SECOND) {
            let _shown_or_left_out = self.lines.try_send(Line {
                frame: *progress.frame,
                frames_total: progress.frames_total,
                unreadable: progress.rejects.total(),
                asked_again: progress.asked_again,
                band_percent,
                stands_still: progress.stands_still.is_some(),
            });
        }
    }

    /// Waits for the last line, unless the terminal is blocked.
    pub(super) fn finish(self) {
        drop(self.lines);
        let _ended_or_stuck = self.thread.recv_timeout(LAST_WORD);
    }
}

fn show(bar: &ProgressBar, talk: Talk, scale: &DegreeScale, lines: &Receiver<Line>) {
    while let Ok(line) = lines.recv() {
        let done = u64::from(line.frame.index) + 1;
        let message = line.message(scale);
        if bar.is_hidden() {
            let [done, total] =
                [done, line.frames_total.into()].map(|frames| frames * SAMPLES_PER_FRAME as u64);
            talk.say(format_args!("{done} of {total} samples, {message}"));
        } else {
            bar.set_position(done);
            bar.set_message(message);
        }
    }
    bar.finish_and_clear();
}

impl Line {
    fn message(&self, scale: &DegreeScale) -> String {
        let reference = scale.reference(self.frame.pulse);
        let newest = self.frame.samples.last();
        let position = newest.map_or(f64::NAN, |&counts| scale.angle(counts));
        let band = self
            .band_percent
            .map(|p| format!("; band ±{p:.2} % of the step"));
        let band = band.unwrap_or_default();
        let still = match self.stands_still {
            true => "; THE SENSOR'S READING STANDS STILL",
            false => "",
        };
        format!(
            "reference {reference:+.1} deg, position {position:+.2} deg; link: {} messages unreadable, {} frames asked again{band}{still}",
            self.unreadable, self.asked_again
        )
    }
}
