//! The cost of identification. The names state the required times, on an idle core.

use std::hint::black_box;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use servoid_dynamics::{DriveLimit, Friction, Grid, Load, ServoParameters, Start, simulate};
use servoid_identification::servo_model::{ServoModelOptions, fit};
use servoid_identification::{
    Frequencies, MomentStream, Moments, NoiseOrder, Options, Prior, Record, Run, Settling,
    identify, identify_moments,
};
use servoid_test_support::servos::{Limit, limited, measured, sizes};

const PERIOD: f64 = 0.002;

/// Lags for N = 100 and d = 2.
const LAGS: (usize, usize) = (102, 3);

/// A servo of second order (60 rad/s, damping 0.5, 8 ms of dead time) under autoregressive noise, and
/// the staircase that drives it: holds of 800, 700, ... 100 ms up and down, over and over.
struct Servo {
    random: ChaCha8Rng,
    /// The newest inputs, one for each sample of dead time.
    late: [f64; 4],
    position: f64,
    speed: f64,
    noise: (f64, f64),
    sample: usize,
}

impl Servo {
    fn new() -> Self {
        Self {
            random: ChaCha8Rng::seed_from_u64(20),
            late: [-5.0; 4],
            position: -5.0,
            speed: 0.0,
            noise: (0.0, 0.0),
            sample: 0,
        }
    }

    fn staircase(sample: usize) -> f64 {
        let mut left = sample % 3600;
        for hold in (1..=8).rev().map(|tenths| 50 * tenths) {
            if left < 2 * hold {
                return if left < hold { 5.0 } else { -5.0 };
            }
            left -= 2 * hold;
        }
        unreachable!("the holds add up to 3600 samples")
    }
}

impl Iterator for Servo {
    type Item = (f64, f64);

    fn next(&mut self) -> Option<(f64, f64)> {
        const STEPS: u32 = 4;
        let input = Self::staircase(self.sample);
        self.sample += 1;
        let white: f64 = StandardNormal.sample(&mut self.random);
        self.noise = (
            1.5 * self.noise.0 - 0.7 * self.noise.1 + 0.02 * white,
            self.noise.0,
        );
        let output = self.position + self.noise.0;
        let target = self.late[3];
        self.late.rotate_right(1);
        self.late[0] = input;
        for _ in 0..STEPS {
            let step = PERIOD / f64::from(STEPS);
            self.speed += step * (3600.0 * (target - self.position) - 60.0 * self.speed);
            self.position += step * self.speed;
        }
        Some((input, output))
    }
}

fn slices(samples: usize) -> (Vec<f64>, Vec<f64>) {
    Servo::new().take(samples).unzip()
}

fn record(samples: usize) -> Record<'static> {
    let (u, y) = slices(samples);
    Record::of_run(PERIOD, u, y).expect("a simulated record is sound")
}

fn fixed() -> Options {
    Options {
        settling: Settling::Samples(100),
        frequencies: Frequencies::Count(31),
        noise_order: NoiseOrder::Order(2),
        ..Options::default()
    }
}

fn whole(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("from slices to model, N=100 n=31 d=2");
    group.sample_size(20);
    for (samples, limit) in [(3_600, "2 ms"), (1_000_000, "60 ms")] {
        let (u, y) = slices(samples);
        group.throughput(Throughput::Elements(samples as u64));
        group.bench_function(format!("{samples} samples in at most {limit}"), |bencher| {
            bencher.iter(|| {
                let record = Record::of_run(PERIOD, black_box(&u), &y).unwrap();
                identify(&record, &fixed()).unwrap()
            });
        });
    }
    group.finish();
}

fn linear(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("moments, cost linear in the samples");
    group.sample_size(10);
    for samples in [10_000, 100_000, 1_000_000] {
        let record = record(samples);
        group.throughput(Throughput::Elements(samples as u64));
        group.bench_function(format!("{samples} samples"), |bencher| {
            bencher.iter(|| Moments::of_record(black_box(&record), LAGS.0, LAGS.1));
        });
    }
    group.finish();
}

fn independent(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("from moments to model, whatever the samples");
    group.sample_size(20);
    for samples in [3_600, 100_000, 1_000_000] {
        let moments = Moments::of_record(&record(samples), LAGS.0, LAGS.1);
        group.bench_function(format!("moments of {samples} samples"), |bencher| {
            bencher.iter(|| identify_moments(black_box(&moments), &fixed()).unwrap());
        });
    }
    group.finish();
}

/// Samples are made as they are needed and not kept: the memory is that of the stream alone.
fn live(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("live, frames of ten samples in constant memory");
    group.sample_size(10);
    let settling = 151;
    let empty = || MomentStream::new(PERIOD, settling + 8, 9);
    let (u, y) = slices(3_600);
    group.throughput(Throughput::Elements(1_000_000));
    group.bench_function("1e6 samples pushed", |bencher| {
        bencher.iter(|| {
            let mut stream = empty();
            let frames = u.chunks(10).zip(y.chunks(10)).cycle();
            for (input, output) in frames.take(100_000) {
                stream.push(black_box(input), output);
            }
            stream
        });
    });
    let mut stream = empty();
    stream.push(&u, &y);
    let options = Options {
        settling: Settling::Samples(settling),
        ..Options::default()
    };
    group.throughput(Throughput::Elements(1));
    group.bench_function("one look, N=n=151, in at most 20 ms", |bencher| {
        bencher.iter_batched(
            || stream.clone(),
            |stream| identify_moments(&stream.moments(), &options).unwrap(),
            BatchSize::SmallInput,
        );
    });
    group.finish();
}

fn automatic(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("from slices to model, all automatic");
    group.sample_size(10);
    for samples in [3_600, 1_000_000] {
        let record = record(samples);
        for (name, prior) in [("", Prior::None), (", stable prior", Prior::Stable)] {
            let options = Options {
                prior,
                ..Options::default()
            };
            group.bench_function(format!("{samples} samples{name}"), |bencher| {
                bencher.iter(|| identify(black_box(&record), &options).unwrap());
            });
        }
    }
    group.finish();
}

/// The servo as a machine: a linear one and one whose speed is limited, 3600 samples every 2 ms, and one with friction and
/// a weight in 33 runs of 152 samples every 20 ms.
fn servo_model(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("servo model, all automatic");
    group.sample_size(10);
    for (name, record) in [
        ("linear, 3600 samples, in at most 1 s", record(3_600)),
        (
            "limited, 3600 samples, in at most 1 s",
            speed_limited(3_600),
        ),
        ("5016 samples in 33 runs, in at most 5 s", loaded_runs()),
    ] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| fit(black_box(&record), &ServoModelOptions::default()).unwrap());
        });
    }
    group.finish();
}

/// 60 degrees a second at the most upwards, 80 downwards.
fn speed_limited(samples: usize) -> Record<'static> {
    let mut input = sizes(1.0, 120);
    input.truncate(samples);
    let clean = limited(0.7, 50.0, Limit::Rate(60.0, 80.0), &input, 0.0);
    let output = measured(&clean, 1.0, 3);
    Record::of_run(PERIOD, input, output).expect("a simulated record is sound")
}

fn loaded_runs() -> Record<'static> {
    const RUN: usize = 152;
    const RUN_PERIOD: f64 = 0.02;
    let servo = ServoParameters {
        delay_s: 0.03,
        offset: 0.5,
        limit: Some(DriveLimit {
            up: 9e3,
            down_to_up: 1.2,
            motor_damping: 30.0,
            at_one_stiffness: false,
        }),
        friction: Some(Friction {
            coulomb: 1200.0,
            of_gears: 0.0,
            at_rest: None,
        }),
        load: Load::Pendulum {
            gravity: 1500.0,
            from: 40.0,
            radians: 1f64.to_radians(),
        },
        ..ServoParameters::linear(900.0, 45.0)
    };
    let grid = Grid::for_stiffness(RUN_PERIOD, 0.0, servo.stiffness);
    let mut random = ChaCha8Rng::seed_from_u64(33);
    let run = |_| {
        let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
        let levels: Vec<f64> = (0..RUN).step_by(38).map(|_| 40.0 * noise()).collect();
        let input: Vec<f64> = (0..RUN).map(|k| levels[k / 38]).collect();
        let mut output = Vec::new();
        simulate(
            &servo,
            &grid,
            &Start::at_rest(0.0, Some(0.0)),
            &input,
            |_, y| output.push(y + 0.1 * noise()),
        );
        Run::new(input, output).expect("a simulated run is sound")
    };
    Record::new(RUN_PERIOD, (0..33).map(run).collect()).expect("a simulated record is sound")
}

criterion_group!(
    identification,
    whole,
    linear,
    independent,
    live,
    automatic,
    servo_model
);
criterion_main!(identification);
