//! Any bytes as a recording: read as what they are; what is saved of them is a recording.
#![no_main]

use libfuzzer_sys::fuzz_target;
use servoid_test_support::trials::any_bytes;

fuzz_target!(|bytes: &[u8]| any_bytes::read_as_a_recording(bytes));
