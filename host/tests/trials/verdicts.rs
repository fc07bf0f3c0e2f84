//! Pairs of recordings of one simulated servo, and what the comparison says of them.
//!
//! One servo recorded twice must not be called different. The recordings differ in their noise and,
//! where the options ask for `scatter`, in what no rig can hold still between runs.

use servoid_identification::Record;
use servoid_identification::comparison::{Comparison, ComparisonOptions, Verdict, compare};
use servoid_protocol::PulseWidth;
use servoid_protocol::reference::Staircase;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_simulator::{SimulationOptions, simulate};

/// Frames at neutral before the staircase (1 s), which the record leaves out as the program does.
const REST: usize = 50;

/// Pulse change for a degree of the rig that is assumed without a rig file (µs).
const US_PER_DEGREE: f64 = 10.0;

/// Time between samples (s), and from an edge to the first one (s).
const TIMING: (f64, f64) = (0.002, 0.0005);

/// The paper's staircase, as recorded on the simulated servo `servo` (as after `sim:`, without a
/// seed) with this seed.
pub fn recording(servo: &str, seed: u64) -> Record {
    let separator = if servo.contains('?') { '&' } else { '?' };
    let options: SimulationOptions = format!("{servo}{separator}seed={seed}")
        .parse()
        .expect("options of the simulator");
    let offsets: Vec<i16> = (0..)
        .map_while(|frame| Staircase::PAPER.offset_us(frame))
        .collect();
    let pulses = std::iter::repeat_n(0, REST)
        .chain(offsets.iter().copied())
        .map(|offset| PulseWidth::NEUTRAL.offset_by(offset));
    let frames = simulate(&options, pulses).expect("options of the simulator");
    let output: Vec<f64> = frames
        .skip(REST)
        .flat_map(|frame| frame.degrees())
        .collect();
    let input: Vec<f64> = offsets
        .iter()
        .flat_map(|&offset| [f64::from(offset) / US_PER_DEGREE; SAMPLES_PER_FRAME])
        .collect();
    Record::from_slices(TIMING.0, &input, &output)
        .expect("one length")
        .with_sample_phase(TIMING.1)
}

/// Compares recordings of seeds 2k and 2k + 1 for each k in `pairs`, in as many threads as there are
/// processors.
pub fn compare_pairs(servo: [&str; 2], pairs: std::ops::Range<u64>) -> Vec<Comparison> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|first| {
                let own = pairs.clone().skip(first as usize).step_by(threads as usize);
                let one = move |k| {
                    let (a, b) = (recording(servo[0], 2 * k), recording(servo[1], 2 * k + 1));
                    compare(&a, &b, &ComparisonOptions::default()).expect("well excited")
                };
                scope.spawn(move || own.map(one).collect::<Vec<_>>())
            })
            .collect();
        let done = workers.into_iter().map(|worker| worker.join());
        done.flat_map(|found| found.expect("no comparison panics"))
            .collect()
    })
}

/// How many of them were called this.
pub fn count(found: &[Comparison], verdict: Verdict) -> usize {
    found.iter().filter(|c| c.verdict == verdict).count()
}
