//! The cost of a simulated second within a run, with frames going out. At most 0.05 s, so that real
//! time is kept with room to spare.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use servoid_protocol::message::Command;
use servoid_test_support::virtual_board::{SharedBoard, options, staircase};
use std::time::Duration;

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
