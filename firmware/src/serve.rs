//! The loop that connects a rig to its board and its link.

use crate::board::{Board, Link};
use crate::rig::Rig;
use core::task::Poll;
use embassy_futures::poll_once;
use embassy_futures::select::{Either, select};
use servoid_protocol::{Decoder, Request, framing};

/// Runs the rig for ever.
///
/// Frames come first: the pulse for the next one must be in its register before the edge. Received bytes are taken
/// after each frame, so neither side can starve the other.
pub async fn serve<B: Board, L: Link>(board: &mut B, link: &mut L) -> ! {
    let mut rig = Rig::new(&board.identity());
    let mut decoder = Decoder::new();
    // Room for the longest request.
    let mut bytes = [0; framing::MAX_WIRE];
    loop {
        let received = match select(board.next_frame(), link.receive(&mut bytes)).await {
            Either::First(frame) => {
                board.set_train(rig.train());
                board.set_pulse(rig.on_frame(&frame));
                board.set_probe(rig.probe_us());
                board.feed_watchdog();
                match poll_once(link.receive(&mut bytes)) {
                    Poll::Ready(received) => Some(received),
                    Poll::Pending => None,
                }
            }
            Either::Second(received) => Some(received),
        };
        if let Some(received) = received.and_then(|count| bytes.get(..count)) {
            on_bytes(&mut rig, &mut decoder, received);
            if rig.wants_vitals() {
                rig.set_vitals(board.vitals());
            }
        }
        board.show_armed(rig.is_armed());
        flush(&mut rig, link);
    }
}

fn on_bytes(rig: &mut Rig, decoder: &mut Decoder, bytes: &[u8]) {
    let rejects_before = decoder.rejects().total();
    for &byte in bytes {
        if let Some(request) = decoder.push::<Request>(byte) {
            rig.on_request(&request);
        }
    }
    rig.count_rejects(decoder.rejects().total().saturating_sub(rejects_before));
}

fn flush<L: Link>(rig: &mut Rig, link: &mut L) {
    let mut wire = [0; framing::MAX_WIRE];
    rig.send(|message| match framing::encode(message, &mut wire) {
        Ok(bytes) => link.try_send(bytes),
        // No message is too long. Should one ever be, it is dropped, or it would block the queue.
        Err(framing::TooLong) => true,
    });
}

#[cfg(test)]
mod tests;
