//! What a simulated second costs: a run under way, frames going out. At most 0.05 s, so that real
//! time is kept with room to spare.

#[path = "../tests/image/support.rs"]
#[allow(dead_code)] // the tests use the rest
mod support;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use servoid_protocol::message::Command;
use std::time::Duration;
use support::{SharedBoard, options, staircase};

fn running(servo: &str) -> SharedBoard {
    let board = SharedBoard::new(&options(servo, &[]));
    let mut client = board.connect();
    let job = staircase();
    job.arm(&mut client).unwrap();
    client.request(Command::Start(job.start)).unwrap();
    board
}

fn a_simulated_second(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("a simulated second");
    group.sample_size(10);
    group.throughput(Throughput::Elements(1));
    for servo in ["bench", "aircraft", "linear"] {
        group.bench_function(servo, |bencher| {
            bencher.iter_batched(
                || running(servo),
                |board| board.pass(Duration::from_secs(1)),
                BatchSize::PerIteration,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, a_simulated_second);
criterion_main!(benches);
