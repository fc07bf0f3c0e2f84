//! Any bytes as a recording: read as what they are; what is saved of them is a recording.
#![no_main]

#[path = "../../host/tests/trials/any_bytes.rs"]
mod any_bytes;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| any_bytes::read_as_a_recording(bytes));
