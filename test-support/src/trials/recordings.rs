//! Recordings of simulated servos as the program makes them: rest, the reference, rest.

use servoid::instrument::rig::roll_frames;
use servoid_identification::{Record, Run};
use servoid_protocol::PulseTrain;
use servoid_protocol::PulseWidth;
use servoid_protocol::reference::Reference;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_simulator::{SimulationOptions, simulate};

/// Pulse change for a degree of the rig that is assumed without a rig file (µs).
pub const US_PER_DEGREE: f64 = 10.0;

/// Time between samples (s), and from an edge to the first one (s).
const TIMING: (f64, f64) = (0.002, 0.0005);

/// `reference`, as recorded on the simulated servo `servo` (as after `sim:`, without a seed) with this
/// seed.
pub fn recording(servo: &str, reference: Reference, seed: u64) -> Record<'static> {
    let separator = if servo.contains('?') { '&' } else { '?' };
    let options: SimulationOptions = format!("{servo}{separator}seed={seed}")
        .parse()
        .expect("options of the simulator");
    let roll = || std::iter::repeat_n(0, roll_frames(PulseTrain::USUAL).into());
    let pulses: Vec<i16> = roll().chain(reference.offsets_us()).chain(roll()).collect();
    let applied = pulses
        .iter()
        .map(|&offset| PulseWidth::NEUTRAL.offset_by(offset));
    let frames = simulate(&options, applied).expect("options of the simulator");
    let output: Vec<f64> = frames.flat_map(|frame| frame.degrees()).collect();
    let input: Vec<f64> = pulses
        .iter()
        .flat_map(|&offset| [f64::from(offset) / US_PER_DEGREE; SAMPLES_PER_FRAME])
        .collect();
    let rest = usize::from(roll_frames(PulseTrain::USUAL)) * SAMPLES_PER_FRAME;
    let all = Run::new(input, output).expect("one length");
    let (begin, end) = (rest, all.len() - rest);
    let part = |samples| all.part(samples).into_owned();
    Record::new(TIMING.0, vec![part(begin..end)])
        .expect("it moves")
        .with_sample_phase(TIMING.1)
        .with_rest(vec![part(0..begin), part(end..all.len())])
}
