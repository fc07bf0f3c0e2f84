//! The self-test: pulses that go on only while the board sees them at its own sensor's pin.
//!
//! A servo that is on the line by mistake gets three pulses, unless somebody has wired the line to `PA4` as well: they end
//! when the board does not see them. A rig with its sensor makes none at all, since a sensor does not read zero.

use crate::board::CapturedFrame;
use servoid_protocol::lease::LEASE_FRAMES;
use servoid_protocol::loopback::{Loopback, PROBES_AFTER_EDGE, PROBES_BEFORE_EDGE};
use servoid_protocol::message::Refusal;
use servoid_protocol::{Counts, PulseTrain};

/// Consecutive frames in which the pulse was not seen that end the self-test. The first frame may still have none on the line.
const UNSEEN_FRAMES: u8 = 3;

/// A sample with the line high reads more than this part of full scale, with it low less than half of that. The divider of
/// the wiring gives 0.66.
const HIGH_PARTS: u16 = 4;

/// The self-test under way.
#[derive(Clone, Debug)]
pub(crate) struct SelfTest {
    pub(crate) asked: Loopback,
    unseen: u8,
}

impl SelfTest {
    /// The self-test that was asked for, on a board whose newest frame is `newest`.
    pub(crate) fn new(
        asked: Loopback,
        newest: &CapturedFrame,
        full_scale: Counts,
    ) -> Result<Self, Refusal> {
        let probed = [PROBES_AFTER_EDGE, PROBES_BEFORE_EDGE];
        let [shortest, longest] = PulseTrain::USUAL.pulses.board_limits();
        let sane = (shortest..=longest).contains(&asked.pulse)
            && probed.iter().any(|range| range.contains(&asked.probe_us));
        if !sane {
            return Err(Refusal::BadLimits);
        }
        if newest.supply.is_low {
            return Err(Refusal::SupplyLow);
        }
        if !shows_the_line(newest, full_scale) {
            return Err(Refusal::SensorOutOfRange);
        }
        Ok(Self { asked, unseen: 0 })
    }

    /// Takes a frame; whether the self-test goes on.
    pub(crate) fn goes_on(
        &mut self,
        frame: &CapturedFrame,
        heard_at: u32,
        full_scale: Counts,
    ) -> bool {
        self.unseen = match shows_the_line(frame, full_scale) {
            true => 0,
            false => self.unseen.saturating_add(1),
        };
        self.unseen < UNSEEN_FRAMES && !frame.supply.is_low && is_held(frame, heard_at)
    }
}

/// Whether the lease that began with frame `heard_at` still runs at `frame`.
pub(crate) fn is_held(frame: &CapturedFrame, heard_at: u32) -> bool {
    frame.number.wrapping_sub(heard_at) < u32::from(LEASE_FRAMES)
}

/// Whether the samples are those of the pulse line: the first one high where there was a pulse, all others low.
fn shows_the_line(frame: &CapturedFrame, full_scale: Counts) -> bool {
    let high = full_scale.0 / HIGH_PARTS;
    let (first, rest) = match frame.samples.split_first() {
        Some((first, rest)) => (first.0, rest),
        None => return false,
    };
    let first_is_right = match frame.pulse {
        Some(_) => first > high,
        None => first < high / 2,
    };
    first_is_right && rest.iter().all(|sample| sample.0 < high / 2)
}
