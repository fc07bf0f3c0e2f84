//! What goes on beside a capture: a person looks, and the step response's band is waited for.

use super::progress::CaptureProgress;
use super::{Talk, interrupt, wrong_usage};
use crate::instrument::live::{LiveIdentification, LiveStep, RunSamples, second_cycle};
use crate::instrument::rig::{Capture, Progress, StopReason};
use crate::plan::Shrinking;
use crate::presentation::scope::state::{FrameSeen, Link};
use crate::presentation::scope::{Scope, ScopeEvent, ScopeState, terminal};
use anyhow::Result;
use clap::Args;
use serde::Serialize;
use servoid_identification::Options;
use servoid_identification::validity::Bounds;
use servoid_protocol::timing::{FRAMES_PER_SECOND, SAMPLE_US};
use servoid_protocol::{SensorScale, ServoScale};
use std::cell::{Cell, RefCell};
use std::sync::Arc;

/// How a capture is watched.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct WatchArgs {
    /// End the run as soon as the step response is known to ± so many percent of the commanded step:
    /// half the width of its band where that is widest, the band that holds the whole curve with 99 %
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true)]
    until_band: Option<f64>,
    /// No live scope: plain lines of progress, as where there is no terminal
    #[arg(long)]
    plain: bool,
}

/// An estimate is made twice a second.
const ESTIMATE_EVERY: u32 = FRAMES_PER_SECOND / 2;

/// Everything that watches the runs of one command.
pub(super) struct Watch {
    talk: Talk,
    scope: bool,
    until_percent: Option<f64>,
    live: Option<LiveIdentification>,
}

/// What came of `--until-band`.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct BandReached {
    asked_percent: f64,
    /// Half of the band's width at its widest; none where no step response could be found, or none with
    /// bounds.
    reached_percent: Option<f64>,
    reached: bool,
    #[serde(skip)]
    found: Found,
}

/// What the runs have shown together.
#[derive(Clone, Copy, Debug)]
enum Found {
    /// No step response.
    Nothing,
    /// One whose errors are not noise.
    NoBounds,
    /// One with a band.
    Band(Shrinking),
}

impl WatchArgs {
    pub(super) fn watch(self, talk: Talk) -> Watch {
        if self.until_band.is_some_and(|p| !(p > 0.0 && p.is_finite())) {
            wrong_usage("--until-band is a percentage of the step, above 0");
        }
        let scope = !talk.quiet && !self.plain && terminal::is_there();
        Watch::new(talk, scope, self.until_band)
    }
}

impl Watch {
    /// Plain lines, as for the runs that other commands make.
    pub(super) fn plainly(talk: Talk) -> Self {
        Self::new(talk, false, None)
    }

    fn new(talk: Talk, scope: bool, until_percent: Option<f64>) -> Self {
        let live = (scope || until_percent.is_some()).then(|| {
            let period_s = f64::from(SAMPLE_US) * 1e-6;
            LiveIdentification::new(period_s, Options::default(), until_percent)
        });
        Self {
            talk,
            scope,
            until_percent,
            live,
        }
    }

    /// Begins to watch a run. `paced` says that the rig's time stands still while nobody listens.
    pub(super) fn begin(
        &self,
        title: String,
        capture: &Capture,
        paced: bool,
    ) -> Result<Watched<'_>> {
        if let Some(live) = &self.live {
            live.begin_run();
        }
        let (servo, sensor) = (capture.rig.servo_scale(), capture.rig.sensor_scale());
        let state = ScopeState::new(title, capture.start, self.until_percent);
        let view = if self.scope {
            View::Scope(Scope::open(state, interrupt::ask)?)
        } else {
            let frames = capture.start.frames();
            View::Lines(CaptureProgress::new(self.talk, frames, servo, sensor))
        };
        let before = u32::from(capture.start.pre_roll_frames);
        Ok(Watched {
            watch: self,
            view,
            servo,
            sensor,
            samples: RefCell::new(RunSamples::new(&capture.rig, &capture.start)),
            estimate_from: before + second_cycle(&capture.start.reference).unwrap_or(0),
            wait: paced && self.until_percent.is_some(),
            shown: RefCell::default(),
            stopping: Cell::new(false),
        })
    }

    /// What came of `--until-band`, with everything that has been captured.
    pub(super) fn band_reached(&self) -> Option<BandReached> {
        let (asked_percent, live) = self.until_percent.zip(self.live.as_ref())?;
        live.ask_anew_and_wait();
        let step = live.latest();
        let found = match step.as_ref().map(|live| &live.step.bounds) {
            None => Found::Nothing,
            Some(Bounds::Withdrawn(_)) => Found::NoBounds,
            Some(Bounds::Valid(bounds)) => Found::Band(Shrinking {
                widest_percent: 100.0 * bounds.widest_half_width(),
                stays_percent: 100.0 * bounds.bias(),
            }),
        };
        Some(BandReached {
            asked_percent,
            reached_percent: match found {
                Found::Band(band) => Some(band.widest_percent),
                Found::Nothing | Found::NoBounds => None,
            },
            reached: step.is_some_and(|s| s.is_within(asked_percent)),
            found,
        })
    }
}

impl BandReached {
    /// What to do, where the `runs` were over before the band was narrow enough.
    pub(super) fn advice(&self, runs: usize) -> Option<String> {
        if self.reached {
            return None;
        }
        let asked = self.asked_percent;
        let band = match self.found {
            Found::Band(band) => band,
            Found::NoBounds => {
                return Some(
                    "no band can be given, as the bounds of the model have no level: 'servoid identify' says why".to_owned(),
                );
            }
            Found::Nothing => {
                return Some(
                    "the run was over before a step response could be found in it: record a longer one"
                        .to_owned(),
                );
            }
        };
        Some(format!(
            "the run was over before the band was narrow enough: it is +-{:.2} % of the step, and +-{asked} % was asked for; {}",
            band.widest_percent,
            band.advice(asked, runs)
        ))
    }
}

/// One run under the eyes of a [`Watch`].
pub(super) struct Watched<'a> {
    watch: &'a Watch,
    view: View,
    servo: ServoScale,
    sensor: SensorScale,
    samples: RefCell<RunSamples>,
    /// The frame from which on estimates are made.
    estimate_from: u32,
    /// Whether an estimate is waited for: only where the rig's time stands still meanwhile.
    wait: bool,
    /// The estimate that the scope shows.
    shown: RefCell<Option<Arc<LiveStep>>>,
    stopping: Cell<bool>,
}

enum View {
    Scope(Scope),
    Lines(CaptureProgress),
}

impl Watched<'_> {
    /// Takes in a frame.
    pub(super) fn update(&self, progress: Progress<'_>) {
        match &self.view {
            View::Scope(scope) => scope.tell(ScopeEvent::Frame(self.seen(&progress))),
            View::Lines(lines) => lines.update(progress, self.latest_width()),
        }
        if let Some(live) = &self.watch.live {
            self.estimate(live, &progress);
        }
    }

    fn seen(&self, progress: &Progress<'_>) -> FrameSeen {
        let frame = progress.frame;
        FrameSeen {
            index: frame.index.into(),
            reference_deg: self.servo.degrees(frame.pulse).0,
            positions_deg: frame.samples.map(|counts| self.sensor.degrees(counts).0),
            link: Link {
                rejects: progress.rejects,
                asked_again: progress.asked_again,
                lost: progress.lost,
                status: progress.status.copied(),
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
            if self.wait {
                live.ask_and_wait();
            } else {
                live.ask();
            }
        }
        self.show_new(live);
    }

    fn show_new(&self, live: &LiveIdentification) {
        let View::Scope(scope) = &self.view else {
            return;
        };
        let mut shown = self.shown.borrow_mut();
        if let Some(latest) = live.latest()
            && shown.as_ref().is_none_or(|old| !Arc::ptr_eq(old, &latest))
        {
            scope.tell(ScopeEvent::Step(Arc::clone(&latest)));
            *shown = Some(latest);
        }
    }

    fn latest_width(&self) -> Option<f64> {
        let latest = self.watch.live.as_ref()?.latest()?;
        latest.half_width_percent()
    }

    /// Whether the run is to end, and why.
    pub(super) fn stop(&self) -> Option<StopReason> {
        let reason = if interrupt::asked() {
            Some(StopReason::User)
        } else {
            self.enough().map(StopReason::Enough)
        };
        if reason.is_some()
            && !self.stopping.replace(true)
            && let View::Scope(scope) = &self.view
        {
            scope.tell(ScopeEvent::Stopping);
        }
        reason
    }

    fn enough(&self) -> Option<String> {
        let percent = self.watch.until_percent?;
        self.watch.live.as_ref()?.enough()?;
        Some(format!(
            "the step response is known to +-{percent} % of the step"
        ))
    }

    /// Gives the terminal back.
    pub(super) fn finish(self) {
        if let View::Lines(lines) = &self.view {
            lines.finish();
        }
    }
}
