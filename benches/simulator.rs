//! How fast a run of the paper is simulated: 415 frames, 8.3 s of the servo's time.

#![allow(missing_docs)] // code that criterion's macros generate

use criterion::{Criterion, criterion_group, criterion_main};
use servoid_protocol::PulseWidth;
use servoid_protocol::reference::Staircase;
use servoid_simulator::{InProcessRig, SimulationOptions, simulate};
use std::hint::black_box;
use std::time::Duration;

/// Frames at neutral beside the 360 of the staircase.
const REST: usize = 55;

fn speed(criterion: &mut Criterion) {
    for servo in ["bench", "aircraft", "linear"] {
        let options: SimulationOptions = servo.parse().expect("a servo's name");
        criterion.bench_function(&format!("recording, {servo}"), |bencher| {
            bencher.iter(|| {
                let staircase = (0..).map_while(|frame| Staircase::PAPER.offset_us(frame));
                let pulses = std::iter::repeat_n(0, REST)
                    .chain(staircase)
                    .map(|offset| PulseWidth::NEUTRAL.offset_by(offset));
                let frames = simulate(&options, pulses).expect("checked options");
                black_box(frames.last())
            });
        });
        criterion.bench_function(&format!("idle rig and line, {servo}"), |bencher| {
            bencher.iter(|| {
                let mut rig = InProcessRig::new(&options).expect("checked options");
                rig.read(black_box(&mut [0; 64]), Duration::from_millis(8300))
            });
        });
    }
}

criterion_group!(benches, speed);
criterion_main!(benches);
