//! The layout of all messages, as one number.

use crate::message::{Request, RigMessage};
use postcard_schema::key::Key;

/// Number of the wire protocol. It rises when messages change in a way that the schema does not show.
pub const PROTOCOL_VERSION: u16 = 1;

/// Hash (FNV-1a, 64 bit) over the schema of every message, and over the protocol's version.
///
/// A rig arms only for a host with an equal hash: with unequal ones the same bytes might mean
/// another pulse.
pub const SCHEMA_HASH: u64 =
    u64::from_le_bytes(Key::for_path::<(Request, RigMessage)>("servoid/1").to_bytes());
