//! Lines that lose, flip, delay and repeat: whole, or what is missing is known; never silently wrong.

use crate::bench::{Bench, frames, run};
use crate::line::Faults;
use proptest::prelude::*;
use servoid_client::{Arrived, Client, ClientError, Connect, Event};
use std::time::Duration;

/// How a run over a line went.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Outcome {
    Whole,
    Partial,
    Refused,
}

fn trial(seed: u64, faults: Faults) -> Outcome {
    let mut bench = Bench::behind(faults, seed);
    let Ok(mut client) = bench.armed() else {
        return Outcome::Refused;
    };
    client.run(run(15), bench.now);
    let events = bench.wait(&mut client);
    assert!(bench.are_true(&events), "seed {seed}: {events:?}");
    let ending = events.iter().find_map(|event| match event {
        Event::RunEnded(ending) => Some(ending.arrived),
        _ => None,
    });
    match ending {
        Some(Arrived::Whole) => {
            assert_eq!(frames(&events).len(), 50, "seed {seed}");
            Outcome::Whole
        }
        Some(_) => Outcome::Partial,
        None => {
            let failed = events.iter().any(|event| matches!(event, Event::Failed(_)));
            assert!(failed, "seed {seed}: it ends without a word");
            Outcome::Partial
        }
    }
}

fn whole(seeds: std::ops::Range<u64>, rate: f64) -> usize {
    let trials = seeds.map(|seed| trial(seed, Faults::of_rate(rate)));
    trials.filter(|outcome| *outcome == Outcome::Whole).count()
}

#[test]
fn one_message_in_a_hundred_costs_nothing() {
    assert_eq!(whole(0..1_000, 0.01), 1_000);
}

#[test]
fn five_messages_in_a_hundred_cost_nothing() {
    assert!(whole(0..1_000, 0.05) >= 999);
}

#[test]
fn a_hopeless_line_is_never_silently_wrong() {
    whole(0..15, 0.3);
}

#[test]
#[ignore = "many seeds: cargo test -p servoid-client -- --ignored"]
fn hopeless_lines_are_never_silently_wrong() {
    whole(15..100, 0.3);
}

#[test]
fn equal_seeds_give_equal_conversations() {
    let conversation = |seed| {
        let mut bench = Bench::behind(Faults::of_rate(0.05), seed);
        let mut client = bench.armed().unwrap();
        client.run(run(15), bench.now);
        (bench.wait(&mut client), bench.sent)
    };
    assert_eq!(conversation(3), conversation(3));
    assert_ne!(conversation(3), conversation(4));
}

proptest! {
    /// Whatever comes at whatever time, nothing panics, and what waits to be sent stays small.
    #[test]
    fn any_bytes_at_any_time(
        pieces in prop::collection::vec((prop::collection::vec(any::<u8>(), 0..60), 0..400u64), 0..60),
        listens_first: bool,
    ) {
        let connect = Connect { session: 1, attempts: 3, listens_first };
        let mut client = Client::connect(&connect, Duration::ZERO);
        let mut now = Duration::ZERO;
        for (bytes, wait) in pieces {
            now += Duration::from_millis(wait);
            client.handle(&bytes, now);
            let sent = std::iter::from_fn(|| client.poll_transmit()).count();
            prop_assert!(sent <= 2);
            while let Some(event) = client.poll_event() {
                let nobody = matches!(event, Event::Failed(ClientError::NobodyThere { .. }));
                prop_assert!(nobody, "{event:?}");
            }
        }
    }

    /// Probabilities of any kind.
    #[test]
    fn any_line_is_never_silently_wrong(
        seed: u64, lost in 0.0..0.2, flipped in 0.0..0.2, late in 0.0..0.5, twice in 0.0..0.5,
    ) {
        trial(seed / 4, Faults { lost, flipped, late, twice });
    }
}
