//! What identification costs: moments are linear in the length of the record, everything after
//! them does not depend on it.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use servoid_identification::moments::Moments;
use servoid_identification::{
    Frequencies, NoiseOrder, Options, Record, Settling, identify, identify_moments,
};

/// A first-order servo with white noise, driven by random frames of ten samples.
fn record(samples: usize) -> Record {
    let mut random = ChaCha8Rng::seed_from_u64(samples as u64);
    let mut input = 0.0;
    let mut state = 0.0;
    let (mut u, mut y) = (Vec::new(), Vec::new());
    for k in 0..samples {
        if k % 10 == 0 {
            input = if random.random::<bool>() { 5.0 } else { -5.0 };
        }
        state += 0.06 * (input - state);
        u.push(input);
        y.push(state + 0.1 * (random.random::<f64>() - 0.5));
    }
    Record::from_slices(0.002, &u, &y).expect("a simulated record is sound")
}

fn fixed() -> Options {
    Options {
        settling: Settling::Samples(100),
        frequencies: Frequencies::Count(31),
        noise_order: NoiseOrder::Order(2),
        ..Options::default()
    }
}

fn benches(criterion: &mut Criterion) {
    for samples in [3_600, 100_000, 1_000_000] {
        let record = record(samples);
        let mut group = criterion.benchmark_group(format!("{samples} samples"));
        group
            .throughput(Throughput::Elements(samples as u64))
            .sample_size(10);
        group.bench_function("identify N=100 n=31 d=2", |bencher| {
            bencher.iter(|| identify(black_box(&record), &fixed()).unwrap());
        });
        group.bench_function("moments N=100 d=2", |bencher| {
            bencher.iter(|| Moments::of_record(black_box(&record), 102, 3));
        });
        let moments = Moments::of_record(&record, 102, 3);
        group.bench_function("from moments N=100 n=31 d=2", |bencher| {
            bencher.iter(|| identify_moments(black_box(&moments), &fixed()).unwrap());
        });
        group.finish();
    }
    let record = record(4_200);
    let mut group = criterion.benchmark_group("4200 samples");
    group.sample_size(10);
    group.bench_function("identify, all automatic", |bencher| {
        bencher.iter(|| identify(black_box(&record), &Options::default()).unwrap());
    });
    group.finish();
}

criterion_group!(identification, benches);
criterion_main!(identification);
