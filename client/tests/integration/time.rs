//! The deadline that a client gives is exact: looking at the time more often changes nothing.

use crate::bench::{Bench, ms, run};
use crate::line::Faults;

#[test]
fn a_client_that_is_given_the_time_every_millisecond_sends_the_same_at_the_same_times() {
    require_same_times(0..8);
}

#[test]
#[ignore = "many seeds: cargo test -p servoid-client -- --ignored"]
fn many_clients_that_are_given_the_time_every_millisecond_send_the_same_at_the_same_times() {
    require_same_times(8..40);
}

fn require_same_times(seeds: std::ops::Range<u64>) {
    for seed in seeds {
        let conversation = |tick| {
            let mut bench = Bench::behind(Faults::of_rate(0.1), seed);
            bench.tick = tick;
            bench.to_host.cut = ms(700)..ms(1_300);
            let Ok(mut client) = bench.armed() else {
                return (Vec::new(), bench.sent);
            };
            client.run(run(60), bench.now);
            (bench.wait(&mut client), bench.sent)
        };
        assert_eq!(conversation(None), conversation(Some(ms(1))), "seed {seed}");
    }
}

#[test]
fn time_that_stands_still_is_no_time() {
    let mut bench = Bench::new();
    let mut client = bench.armed().unwrap();
    client.run(run(5), bench.now);
    assert!(client.poll_transmit().is_some());
    for _ in 0..1_000 {
        client.handle(&[], bench.now);
    }
    assert_eq!(client.poll_transmit(), None);
    assert!(client.next_deadline() > Some(bench.now));
}
