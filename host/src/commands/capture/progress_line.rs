//! Progress of a capture without the live scope.

use crate::commands::output::Talk;
use crate::data::DegreeScale;
use crate::instrument::rig::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use servoid_protocol::timing::{FRAMES_PER_SECOND, SAMPLES_PER_FRAME};

/// A progress bar in a terminal; elsewhere one line for each second of the run.
pub(super) struct ProgressLine {
    bar: ProgressBar,
    talk: Talk,
    scale: DegreeScale,
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
        Self { bar, talk, scale }
    }

    /// Shows a frame. `band_percent` is half the width of the step response's band, if there is one.
    pub(super) fn update(&self, progress: Progress<'_>, band_percent: Option<f64>) {
        let frame = progress.frame;
        let done = u64::from(frame.index) + 1;
        let reference = self.scale.reference(frame.pulse);
        let newest = frame.samples.last();
        let position = newest.map_or(f64::NAN, |&counts| self.scale.angle(counts));
        let band = band_percent.map(|p| format!("; band +-{p:.2} % of the step"));
        let band = band.unwrap_or_default();
        let message = format!(
            "reference {reference:+.1} deg, position {position:+.2} deg; link: {} messages unreadable, {} frames asked again{band}",
            progress.rejects.total(),
            progress.asked_again
        );
        if !self.bar.is_hidden() {
            self.bar.set_position(done);
            self.bar.set_message(message);
        } else if done.is_multiple_of(u64::from(FRAMES_PER_SECOND)) {
            let total = u64::from(progress.frames_total);
            let [done, total] = [done, total].map(|frames| frames * SAMPLES_PER_FRAME as u64);
            self.talk
                .say(format_args!("{done} of {total} samples, {message}"));
        }
    }

    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
