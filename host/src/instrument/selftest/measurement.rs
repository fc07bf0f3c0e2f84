//! The conversation of a self-test.

use super::edges::change;
use super::frame_period::{Stamp, frame_period};
use super::measured::{Level, MeasuredBoard, MeasuredPulse, Unseen};
use crate::instrument::rig::{ClientError, RigClient, TalkError};
use servoid_protocol::loopback::{Loopback, LoopbackFrame, PROBES_BEFORE_EDGE};
use servoid_protocol::message::{Command, Refusal};
use servoid_protocol::schema::SCHEMA_HASH;
use servoid_protocol::{Counts, PulseWidth};
use std::ops::RangeInclusive;
use std::time::Duration;

/// How much a self-test measures.
#[derive(Clone, Copy, Debug)]
pub struct SelfTestExtent {
    /// Time for which frames are counted before there are pulses, and the processor's load is measured.
    pub counting: Duration,
    /// Widths of the pulses (µs).
    pub pulses_us: &'static [u16],
}

impl SelfTestExtent {
    /// All of it: 6 s. The pulses are within what every servo takes, should one be there against all advice.
    pub const FULL: Self = Self {
        counting: Duration::from_secs(2),
        pulses_us: &[1_000, 1_250, 1_500, 1_750, 2_000],
    };
}

/// A probe is looked for this far from the edge that was asked for (µs).
const REACH_US: u16 = 80;

/// Between two questions: no part of a frame, so that they fall on all of its phases.
const PAUSE: Duration = Duration::from_millis(13);

/// A new pulse or probe takes effect at the next frame edge, and shows two frames later.
const SETTLING: Duration = Duration::from_millis(45);

/// The board measures its reference voltage sixteen times before it says anything.
const REFERENCE_TAKES: Duration = Duration::from_secs(2);

/// Frames until a change of pulse or probe must show.
const SETTLED_FRAMES: u32 = 25;

/// Conversions of the pin read as high above this share of the supply: half of the divider's.
const HIGH_SHARE: f64 = 0.33;

/// Codes of one conversion.
const CODES: f64 = 4_095.0;

/// Why a self-test has no result.
#[derive(Debug, thiserror::Error)]
pub enum SelfTestError {
    /// The board does not answer as it should.
    #[error(transparent)]
    Talk(#[from] TalkError),
    /// The user has stopped it.
    #[error("the self-test was stopped, and the pulses with it")]
    Stopped,
}

/// Measures a board; `stop` says when the user wants to end it, `show` gets the part of it that is done.
///
/// # Errors
/// Where the board falls silent, or the user stops it.
pub fn measure(
    client: &mut RigClient,
    extent: SelfTestExtent,
    stop: &dyn Fn() -> bool,
    show: &mut dyn FnMut(&'static str),
) -> Result<MeasuredBoard, SelfTestError> {
    let mut test = Test {
        client,
        extent,
        stop,
        stamps: Vec::new(),
        frames: Vec::new(),
        requests: 0,
        pulse: PulseWidth::NEUTRAL,
        unseen: None,
    };
    let measured = test.measure(show);
    // Where the line is gone, the lease ends the pulses.
    let ended = test.client.request(Command::Disarm);
    let measured = measured?;
    ended?;
    Ok(measured)
}

struct Test<'a> {
    client: &'a mut RigClient,
    extent: SelfTestExtent,
    stop: &'a dyn Fn() -> bool,
    stamps: Vec<Stamp>,
    /// Frames with pulses, each once.
    frames: Vec<LoopbackFrame>,
    requests: u32,
    pulse: PulseWidth,
    unseen: Option<Unseen>,
}

impl Test<'_> {
    fn measure(
        &mut self,
        show: &mut dyn FnMut(&'static str),
    ) -> Result<MeasuredBoard, SelfTestError> {
        show("counting frames");
        let repeated_before = self.client.requests_repeated();
        let unreadable_before = self.client.rejects().total();
        let status_before = self.client.status()?;
        let vitals_before = self.client.vitals()?;
        self.count_frames()?;
        let vitals_after = self.client.vitals()?;
        let pin_before = self.client.status()?.sensor;
        let health = self.health()?;
        show("looking for the pulses");
        let (probe_holds_us, pulses) = self.pulses()?;
        let vitals_at_end = self.client.vitals()?;
        let status_after = self.client.status()?;
        let hello = *self.client.hello();
        let stated_s = f64::from(hello.frame_us) * 1e-6;
        let with_pulse = || self.frames.iter().filter(|frame| frame.pulse.is_some());
        let full_scale = f64::from(hello.full_scale_counts);
        Ok(MeasuredBoard {
            hello,
            status_before,
            status_after,
            health,
            vitals_before,
            vitals_after,
            vitals_at_end,
            frame_ms: frame_period(&self.stamps, stated_s).map(|bounds| bounds.map(|s| 1e3 * s)),
            pin_before: f64::from(pin_before.0) / full_scale,
            unseen: self.unseen,
            pulses,
            probe_holds_us,
            sampled_us: with_pulse().map(|frame| frame.sampled_us).min(),
            high: level(with_pulse().filter_map(|f| f.samples.first()), full_scale),
            low: level(
                with_pulse().flat_map(|f| f.samples.iter().skip(1)),
                full_scale,
            ),
            requests: self.requests,
            requests_repeated: self.client.requests_repeated() - repeated_before,
            unreadable: self.client.rejects().total() - unreadable_before,
        })
    }

    fn count_frames(&mut self) -> Result<(), SelfTestError> {
        let until = self.client.now() + self.extent.counting;
        while self.client.now() < until {
            self.require_going_on()?;
            self.client.pause(PAUSE)?;
            let sent = self.client.now();
            let frames = self.client.status()?.frames_since_start;
            if let Some(frame) = frames.checked_sub(1) {
                self.stamp(frame, sent);
            }
        }
        Ok(())
    }

    /// The health, once the reference voltage has been measured; a board that measures none has time for it too.
    fn health(&mut self) -> Result<servoid_protocol::Health, SelfTestError> {
        let until = self.client.now() + REFERENCE_TAKES;
        loop {
            let health = self.client.health()?;
            if health.bandgap != 0 || self.client.now() >= until {
                return Ok(health);
            }
        }
    }

    fn stamp(&mut self, frame: u32, sent: Duration) {
        self.requests += 1;
        let received = self.client.now();
        self.stamps.push(Stamp {
            frame,
            sent,
            received,
        });
    }

    fn require_going_on(&self) -> Result<(), SelfTestError> {
        match (self.stop)() {
            true => Err(SelfTestError::Stopped),
            false => Ok(()),
        }
    }

    /// When a probe holds its input, after its trigger (µs), and the widths of all pulses.
    fn pulses(&mut self) -> Result<(Option<f64>, Vec<MeasuredPulse>), SelfTestError> {
        let frame_us = f64::from(self.client.hello().frame_us);
        let before_edge = *PROBES_BEFORE_EDGE.end() - REACH_US..=*PROBES_BEFORE_EDGE.end();
        let rise = self.edge(PulseWidth::NEUTRAL, before_edge, false)?;
        let mut pulses = Vec::new();
        for &asked_us in self.extent.pulses_us {
            let range = asked_us - REACH_US..=asked_us + REACH_US;
            let fall = self.edge(PulseWidth(asked_us), range, true)?;
            let width = |(rise, fall): (f64, f64)| fall - (rise - frame_us);
            let width_us = rise.zip(fall).map(width);
            pulses.push(MeasuredPulse { asked_us, width_us });
        }
        Ok((rise.map(|rise| frame_us - rise), pulses))
    }

    /// The trigger at which a probe begins to see the line changed, from `before`.
    fn edge(
        &mut self,
        pulse: PulseWidth,
        range: RangeInclusive<u16>,
        before: bool,
    ) -> Result<Option<f64>, SelfTestError> {
        self.pulse = pulse;
        change(range, before, |at_us| {
            let code = self.probe(at_us)?;
            Ok(code.map(|code| f64::from(code) > HIGH_SHARE * CODES))
        })
    }

    /// The code of a probe at this instant; `None` where the board does not see its pulses, or makes no probe.
    fn probe(&mut self, at_us: u16) -> Result<Option<u16>, SelfTestError> {
        let mut first = None;
        let mut pause = SETTLING;
        while self.unseen.is_none() {
            self.require_going_on()?;
            let Some(frame) = self.ask(at_us)? else {
                break;
            };
            let probe = frame.probe.filter(|probe| probe.at_us == at_us);
            if frame.pulse == Some(self.pulse)
                && let Some(probe) = probe
            {
                return Ok(Some(probe.code));
            }
            let since = frame
                .number
                .wrapping_sub(*first.get_or_insert(frame.number));
            if since > SETTLED_FRAMES {
                return Ok(None);
            }
            self.client.pause(std::mem::replace(&mut pause, PAUSE))?;
        }
        Ok(None)
    }

    fn ask(&mut self, probe_us: u16) -> Result<Option<LoopbackFrame>, SelfTestError> {
        let loopback = Loopback {
            schema_hash: SCHEMA_HASH,
            pulse: self.pulse,
            probe_us,
        };
        let sent = self.client.now();
        match self.client.loopback(loopback) {
            Ok(frame) => {
                self.stamp(frame.number, sent);
                if self.frames.last().map(|last| last.number) != Some(frame.number) {
                    self.frames.push(frame);
                }
                Ok(Some(frame))
            }
            Err(TalkError::Rig(ClientError::Refused {
                refusal: Refusal::SensorOutOfRange,
                ..
            })) => {
                self.unseen = Some(match self.frames.as_slice() {
                    [] => Unseen::NotLowBefore,
                    frames if frames.iter().all(|frame| frame.pulse.is_none()) => Unseen::StayedLow,
                    _ => Unseen::Lost,
                });
                Ok(None)
            }
            Err(error) => Err(error.into()),
        }
    }
}

/// Mean and standard deviation; `None` without samples.
fn level<'a>(samples: impl Iterator<Item = &'a Counts>, full_scale: f64) -> Option<Level> {
    let counts: Vec<f64> = samples.map(|sample| f64::from(sample.0)).collect();
    let number = counts.len() as f64;
    let mean = counts.iter().sum::<f64>() / number;
    let square = counts
        .iter()
        .map(|count| (count - mean).powi(2))
        .sum::<f64>();
    (!counts.is_empty()).then(|| Level {
        share: mean / full_scale,
        sd_counts: (square / number).sqrt(),
    })
}
