//! Differences between a rig and a program that were not built for each other.

use crate::error::ClientError;
use serde::Serialize;
use servoid_protocol::pulse_train::PulseType;
use servoid_protocol::schema::{PROTOCOL_VERSION, SCHEMA_HASH};
use servoid_protocol::timing::{FRAME_US, SAMPLE_US};
use servoid_protocol::{Hello, PulseTrain};

/// One thing in which they differ.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Mismatch {
    /// Its name in [`Hello`].
    pub field: &'static str,
    /// The rig's.
    pub rig: String,
    /// This program's.
    pub servoid: String,
    /// Its consequence.
    pub meaning: &'static str,
}

/// Every field of `hello` that this program needs to be other than it is; none where the two go
/// together.
pub fn mismatches(hello: &Hello) -> Vec<Mismatch> {
    let update = match hello.protocol_version > PROTOCOL_VERSION {
        true => "the rig is the newer one: update servoid",
        false => "the rig is the older one: flash this version's firmware with 'servoid flash'",
    };
    let fields = [
        (
            "protocol_version",
            hello.protocol_version.to_string(),
            PROTOCOL_VERSION.to_string(),
            update,
        ),
        (
            "schema_hash",
            format!("{:016x}", hello.schema_hash),
            format!("{SCHEMA_HASH:016x}"),
            "the messages have other fields: the rig will not arm, because the same bytes might mean another pulse",
        ),
        (
            "frame_us",
            hello.frame_us.to_string(),
            FRAME_US.to_string(),
            "a PWM frame is of another length: every time in a recording would be wrong",
        ),
        (
            "sample_us",
            hello.sample_us.to_string(),
            SAMPLE_US.to_string(),
            "samples come at another rate: every time in a recording would be wrong",
        ),
    ];
    let is_timing = |field| field == "frame_us" || field == "sample_us";
    let differing = fields.into_iter().filter(|(field, rig, servoid, _)| {
        rig != servoid && !(is_timing(*field) && has_timing_of_a_train(hello))
    });
    differing
        .map(|(field, rig, servoid, meaning)| Mismatch {
            field,
            rig,
            servoid,
            meaning,
        })
        .collect()
}

/// Whether the rig states the timing of pulses that this program knows: not necessarily of the usual ones.
fn has_timing_of_a_train(hello: &Hello) -> bool {
    let trains = [PulseType::Wide, PulseType::Narrow].map(|pulses| {
        [1, 2, 5, 10].map(|per_frame| PulseTrain {
            pulses,
            period_us: (hello.frame_us / per_frame) as u16,
        })
    });
    let sound = |train: &PulseTrain| train.is_sound() && require_train(hello, train).is_ok();
    trains.as_flattened().iter().any(sound)
}

/// Refuses a rig that states another timing than that of this train.
pub(crate) fn require_train(hello: &Hello, train: &PulseTrain) -> Result<(), ClientError> {
    let differs = |field, rig: u32, host: u32| {
        (rig != host).then(|| ClientError::TimingDiffers {
            field,
            rig: rig.to_string(),
            host: host.to_string(),
            meaning: "it makes other pulses than those that it was armed for",
        })
    };
    let frame = differs("frame_us", hello.frame_us, train.frame_us());
    let sample = differs("sample_us", hello.sample_us, train.sample_us().into());
    frame.or(sample).map_or(Ok(()), Err)
}

/// Refuses a rig that differs in anything that a recording depends on.
pub(crate) fn require_match(hello: &Hello) -> Result<(), ClientError> {
    if hello.schema_hash != SCHEMA_HASH {
        return Err(ClientError::SchemaDiffers {
            rig: hello.schema_hash,
            host: SCHEMA_HASH,
        });
    }
    match mismatches(hello).into_iter().next() {
        None => Ok(()),
        Some(first) => Err(ClientError::TimingDiffers {
            field: first.field,
            rig: first.rig,
            host: first.servoid,
            meaning: first.meaning,
        }),
    }
}
