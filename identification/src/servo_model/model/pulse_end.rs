//! How a document has what pulses add to the delay.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use servoid_dynamics::PulseEnd;

#[derive(Serialize, Deserialize)]
#[serde(remote = "PulseEnd")]
struct Document {
    s_per_command: f64,
    neutral: f64,
}

/// One that is there.
#[derive(Serialize, Deserialize)]
struct Known(#[serde(with = "Document")] PulseEnd);

pub(super) fn serialize<S: Serializer>(end: &Option<PulseEnd>, to: S) -> Result<S::Ok, S::Error> {
    end.map(Known).serialize(to)
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(
    from: D,
) -> Result<Option<PulseEnd>, D::Error> {
    Ok(Option::<Known>::deserialize(from)?.map(|Known(end)| end))
}
