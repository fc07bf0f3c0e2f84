//! Any bytes from the line, at both ends: a decoded message encodes to the same bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use servoid_protocol::{Decoder, Request, RigMessage, framing};

fuzz_target!(|bytes: &[u8]| {
    let (mut to_rig, mut to_host) = (Decoder::new(), Decoder::new());
    for &byte in bytes {
        if let Some(request) = to_rig.push::<Request>(byte) {
            let mut wire = [0; framing::MAX_WIRE];
            let wire = framing::encode(&request, &mut wire).expect("it came in a frame");
            let again = wire.iter().filter_map(|b| to_rig.push::<Request>(*b)).last();
            assert_eq!(again, Some(request));
        }
        if let Some(message) = to_host.push::<RigMessage>(byte) {
            let mut wire = [0; framing::MAX_WIRE];
            framing::encode(&message, &mut wire).expect("it came in a frame");
        }
    }
    // The receiver finds its feet again, whatever came before.
    let request = Request { session: 1, id: 2, command: servoid_protocol::Command::KeepAlive };
    let mut wire = [0; framing::MAX_WIRE];
    let wire = framing::encode(&request, &mut wire).expect("it is short");
    let last = wire.iter().filter_map(|b| to_rig.push::<Request>(*b)).last();
    assert_eq!(last, Some(request));
});
