//! Any bytes as a recording: they are read or refused, and `recover` makes a recording of them.
#![no_main]

use libfuzzer_sys::fuzz_target;
use servoid_test_support::trials::any_bytes;

fuzz_target!(|bytes: &[u8]| any_bytes::read_as_a_recording(bytes));
