//! The live view of a capture, and the estimates of the step response while it runs.

use super::progress_line::ProgressLine;
use super::until_band::BandReached;
use crate::commands::ctrl_c;
use crate::commands::output::{Talk, wrong_usage};
use crate::data::DegreeScale;
use crate::instrument::live::{LiveIdentification, LiveStep, RunSamples, second_cycle};
use crate::instrument::rig::{Capture, Progress, StopReason};
use crate::presentation::scope::{FrameSeen, Link, Scope, ScopeEvent, ScopeState, terminal};
use anyhow::Result;
use clap::Args;
use servoid_identification::Options;
use servoid_protocol::PulseTrain;
use std::cell::{Cell, RefCell};
use std::sync::Arc;

/// How a capture is shown, and when it ends by itself.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct MonitorArgs {
    /// End the run as soon as the step response's band is within ± this percentage of the commanded step. The
    /// band holds the whole curve with 99 % confidence, and the percentage is half its width where it is widest
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, value_parser = crate::commands::value_parsers::finite)]
    until_band: Option<f64>,
    /// Print plain lines of progress instead of the live scope, as without a terminal
    #[arg(long)]
    plain: bool,
}

/// Frames between two estimates: about two estimates a second.
const ESTIMATE_EVERY: u32 = 25;

/// The monitor of all runs of one command.
pub(in crate::commands) struct Monitor {
    talk: Talk,
    scope: bool,
    until_percent: Option<f64>,
    live: Option<LiveIdentification>,
}

impl MonitorArgs {
    /// The monitor of a servo with these pulses.
    pub(super) fn start(self, train: PulseTrain, talk: Talk) -> Monitor {
        if self.until_band.is_some_and(|p| !(p > 0.0 && p.is_finite())) {
            wrong_usage("--until-band must be a percentage of the step, above 0");
        }
        let scope = !talk.quiet && !self.plain && terminal::is_there();
        Monitor::new(talk, scope, train, self.until_band)
    }
}

impl Monitor {
    /// Plain lines of progress, for commands other than `capture`.
    pub(in crate::commands) fn plain(talk: Talk) -> Self {
        Self::new(talk, false, PulseTrain::USUAL, None)
    }

    fn new(talk: Talk, scope: bool, train: PulseTrain, until_percent: Option<f64>) -> Self {
        let period_s = train.sample_s();
        let live = (scope || until_percent.is_some())
            .then(|| LiveIdentification::new(period_s, Options::default(), until_percent));
        Self {
            talk,
            scope,
            until_percent,
            live,
        }
    }

    /// Begins a run. `paced`: the rig's time stands still while nobody reads from it.
    pub(super) fn begin(
        &self,
        title: String,
        capture: &Capture,
        paced: bool,
    ) -> Result<MonitoredRun<'_>> {
        if let Some(live) = &self.live {
            live.begin_run();
        }
        let scale = DegreeScale::of_rig(&capture.rig);
        let state = ScopeState::new(
            title,
            capture.start,
            capture.rig.train(),
            self.until_percent,
        );
        let view = if self.scope {
            LiveView::Scope(Scope::open(state, ctrl_c::ask)?)
        } else {
            let frames = capture.start.frames();
            LiveView::Lines(ProgressLine::new(self.talk, frames, scale.clone()))
        };
        let before = u32::from(capture.start.pre_roll_frames);
        Ok(MonitoredRun {
            monitor: self,
            view,
            scale,
            samples: RefCell::new(RunSamples::new(&capture.rig, &capture.start)),
            estimate_from: before + second_cycle(&capture.start.reference).unwrap_or(0),
            wait: paced && self.until_percent.is_some(),
            shown: RefCell::default(),
            stopping: Cell::new(false),
        })
    }

    /// The band of all runs together, where `--until-band` asks for one.
    pub(super) fn band_reached(&self) -> Option<BandReached> {
        let (asked_percent, live) = self.until_percent.zip(self.live.as_ref())?;
        live.ask_anew_and_wait();
        Some(BandReached::of(asked_percent, live.latest().as_deref()))
    }
}

/// One run, shown and estimated as it goes on.
pub(super) struct MonitoredRun<'a> {
    monitor: &'a Monitor,
    view: LiveView,
    scale: DegreeScale,
    samples: RefCell<RunSamples>,
    /// The first frame with an estimate.
    estimate_from: u32,
    /// Whether to wait for each estimate: only where the rig's time stands still meanwhile.
    wait: bool,
    /// The estimate that the scope shows.
    shown: RefCell<Option<Arc<LiveStep>>>,
    stopping: Cell<bool>,
}

enum LiveView {
    Scope(Scope),
    Lines(ProgressLine),
}

impl MonitoredRun<'_> {
    /// Shows a frame and adds it to the estimate.
    pub(super) fn update(&self, progress: Progress<'_>) {
        match &self.view {
            LiveView::Scope(scope) => scope.update(ScopeEvent::Frame(self.frame_seen(&progress))),
            LiveView::Lines(lines) => lines.update(progress, self.latest_width()),
        }
        if let Some(live) = &self.monitor.live {
            self.estimate(live, &progress);
        }
    }

    fn frame_seen(&self, progress: &Progress<'_>) -> FrameSeen {
        let frame = progress.frame;
        FrameSeen {
            index: frame.index.into(),
            reference_deg: self.scale.reference(frame.pulse),
            positions_deg: frame.samples.map(|counts| self.scale.angle(counts)),
            link: Link {
                rejects: progress.rejects,
                asked_again: progress.asked_again,
                lost: progress.lost,
                status: progress.status.copied(),
                stands_still: progress.stands_still.is_some(),
            },
        }
    }

    fn estimate(&self, live: &LiveIdentification, progress: &Progress<'_>) {
        let (input, output) = self.samples.borrow_mut().take(progress.frame);
        if input.is_empty() {
            return;
        }
        live.push(input, output);
        let index = u32::from(progress.frame.index);
        if index >= self.estimate_from && index.is_multiple_of(ESTIMATE_EVERY) {
            match self.wait {
                true => live.ask_and_wait(),
                false => live.ask(),
            }
        }
        let mut shown = self.shown.borrow_mut();
        if let LiveView::Scope(scope) = &self.view
            && let Some(latest) = live.latest()
            && shown.as_ref().is_none_or(|old| !Arc::ptr_eq(old, &latest))
        {
            scope.update(ScopeEvent::Step(Arc::clone(&latest)));
            *shown = Some(latest);
        }
    }

    fn latest_width(&self) -> Option<f64> {
        let latest = self.monitor.live.as_ref()?.latest()?;
        latest.half_width_percent()
    }

    /// Why the run is to end, once it is.
    pub(super) fn stop(&self) -> Option<StopReason> {
        let reason = match ctrl_c::asked() {
            true => Some(StopReason::User),
            false => self.enough(),
        };
        if reason.is_some()
            && !self.stopping.replace(true)
            && let LiveView::Scope(scope) = &self.view
        {
            scope.update(ScopeEvent::Stopping);
        }
        reason
    }

    fn enough(&self) -> Option<StopReason> {
        let percent = self.monitor.until_percent?;
        self.monitor.live.as_ref()?.enough()?;
        let known = format!("the step response is known to ±{percent} % of the step");
        Some(StopReason::Enough(known))
    }

    /// Gives the terminal back.
    pub(super) fn finish(self) {
        if let LiveView::Lines(lines) = self.view {
            lines.finish();
        }
    }
}
