//! A rig that says what cannot be true of the run that it was asked for.

use crate::bench::{Bench, frames, run};
use servoid_client::{ClientError, Contradiction, Event};
use servoid_protocol::message::{EndReason, Ended, RigMessage};
use servoid_protocol::{Frame, PulseWidth};

/// The frame of the lies about frames.
const FALSE_FRAME: u16 = 20;

fn with_pulse(message: RigMessage, change: fn(u16) -> u16) -> RigMessage {
    match message {
        RigMessage::Frame(frame) if frame.index == FALSE_FRAME => RigMessage::Frame(Frame {
            pulse: PulseWidth(change(frame.pulse.0)),
            ..frame
        }),
        other => other,
    }
}

fn with_end(message: RigMessage, change: fn(u16) -> u16) -> RigMessage {
    match message {
        RigMessage::Ended(mut ended) => {
            ended.frames = change(ended.frames);
            RigMessage::Ended(ended)
        }
        other => other,
    }
}

/// What the client says to it, and the frames that it hands on.
fn follow(alters: fn(RigMessage) -> RigMessage) -> (Contradiction, usize) {
    let mut bench = Bench::new();
    let mut client = bench.armed().unwrap();
    bench.alters = alters;
    client.run(run(15), bench.now);
    let events = bench.wait(&mut client);
    let found = events.iter().find_map(|event| match event {
        Event::Failed(ClientError::Contradiction(found)) => Some(*found),
        _ => None,
    });
    (
        found.unwrap_or_else(|| panic!("{:?}", events.last())),
        frames(&events).len(),
    )
}

#[test]
fn a_pulse_that_was_not_commanded_is_named_and_not_recorded() {
    type Lie = fn(RigMessage) -> RigMessage;
    let lies: [(Lie, u16); 4] = [
        (|m| with_pulse(m, |_| 2_500), 2_500),
        (|m| with_pulse(m, |_| 65_535), 65_535),
        (|m| with_pulse(m, |pulse| 2 * pulse), 2_900),
        (|m| with_pulse(m, |pulse| pulse + 1), 1_451),
    ];
    for (lie, reported) in lies {
        let (found, frames) = follow(lie);
        let expected = Contradiction::OtherPulse {
            index: FALSE_FRAME,
            pulse: PulseWidth(reported),
            commanded: PulseWidth(1_450),
        };
        assert_eq!(found, expected);
        assert_eq!(frames, usize::from(FALSE_FRAME));
    }
}

#[test]
fn a_frame_behind_the_last_one_is_named_and_costs_no_frame_before_it() {
    let (found, frames) = follow(|message| match message {
        RigMessage::Frame(frame) if frame.index == FALSE_FRAME => RigMessage::Frame(Frame {
            index: 60_000,
            ..frame
        }),
        other => other,
    });
    let expected = Contradiction::FrameBeyondRun {
        index: 60_000,
        frames: 50,
    };
    assert_eq!(found, expected);
    assert_eq!(frames, usize::from(FALSE_FRAME));
}

#[test]
fn an_end_of_another_length_is_no_end() {
    let of = |reported| Contradiction::OtherLength {
        reported,
        frames: 50,
        arrived: 50,
    };
    assert_eq!(follow(|m| with_end(m, |frames| frames - 1)), (of(49), 50));
    assert_eq!(follow(|m| with_end(m, |frames| frames + 1)), (of(51), 50));
}

/// Fewer frames than were asked for, and everything else as it should be.
#[test]
fn a_run_that_is_cut_short_is_not_complete() {
    let (found, _) = follow(|message| match message {
        RigMessage::Frame(frame) if frame.index == FALSE_FRAME => RigMessage::Ended(Ended {
            run: frame.run,
            reason: EndReason::Complete,
            frames: FALSE_FRAME,
            frames_lost_on_board: 0,
            check: 0,
        }),
        other => other,
    });
    let expected = Contradiction::OtherLength {
        reported: FALSE_FRAME,
        frames: 50,
        arrived: u32::from(FALSE_FRAME),
    };
    assert_eq!(found, expected);
}
