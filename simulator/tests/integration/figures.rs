//! The simulated servos show the paper's figures, and show them again for the same seed.
//!
//! Without noise and identification: read off the true angle over the paper's staircase (its §4),
//! which starts from rest at -5 degrees.

use servoid_protocol::PulseWidth;
use servoid_protocol::reference::Staircase;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_simulator::{SimulatedFrame, SimulationOptions, simulate};

/// Frames at -5 degrees before the staircase: 1 s.
const REST: usize = 50;

/// From how many samples after an edge on a plateau counts as reached: the paper's settling time.
const WAIT: usize = 60;

fn record(options: &str) -> Vec<SimulatedFrame> {
    let options: SimulationOptions = options.parse().unwrap();
    let staircase = (0..).map_while(|frame| Staircase::PAPER.offset_us(frame));
    let pulses = std::iter::repeat_n(-50, REST)
        .chain(staircase)
        .map(|offset| PulseWidth::NEUTRAL.offset_by(offset));
    simulate(&options, pulses).unwrap().collect()
}

/// True angles over the staircase (deg), cut at its edges: +, -, +, -, ...
fn holds(options: &str) -> Vec<Vec<f64>> {
    let frames = record(options);
    let mut angles = frames[REST..].iter().flat_map(|frame| frame.angles);
    Staircase::PAPER
        .holds()
        .flat_map(|frames| [frames, frames])
        .map(|frames| {
            angles
                .by_ref()
                .take(frames as usize * SAMPLES_PER_FRAME)
                .collect()
        })
        .collect()
}

/// Mean over every second hold from the first (+) or second (-) on, `WAIT` samples after its edge.
fn plateau(holds: &[Vec<f64>], first: usize) -> f64 {
    let settled: Vec<f64> = holds
        .iter()
        .skip(first)
        .step_by(2)
        .flat_map(|hold| hold.iter().skip(WAIT).copied())
        .collect();
    settled.iter().sum::<f64>() / settled.len() as f64
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::MIN, f64::max)
}

fn smallest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::MAX, f64::min)
}

/// Last sample that is further than `band` from where the hold ends.
fn settling(hold: &[f64], band: f64) -> usize {
    let end = hold[hold.len() - 1];
    hold.iter().rposition(|y| (y - end).abs() > band).unwrap() + 1
}

/// The first sample at or above `level`.
fn first_above(hold: &[f64], level: f64) -> usize {
    hold.iter().position(|y| *y >= level).unwrap()
}

#[test]
fn the_bench_servo_overshoots_by_a_fifth_of_a_degree_and_settles_in_sixty_samples() {
    let holds = holds("bench?noise=none");
    // Fig. 12: about 0.2 deg over +5.
    let overshoot = largest(&holds[0]) - 5.0;
    assert!((0.17..=0.19).contains(&overshoot), "{overshoot}");
    let undershoot = -5.0 - smallest(&holds[1]);
    assert!((0.17..=0.19).contains(&undershoot), "{undershoot}");
    // Fig. 5: about 60 samples to within 1 % of the stroke of 10 deg.
    let settled = settling(&holds[0], 0.1);
    assert!((57..=62).contains(&settled), "{settled}");
    // Then it rests, within the dead band and half the play of the command.
    for (hold, command) in holds.iter().zip([5.0, -5.0].into_iter().cycle()).take(14) {
        let rest = hold[hold.len() - 1];
        assert!((rest - command).abs() < 0.04 + 0.02, "{rest}");
    }
}

#[test]
fn the_aircraft_servo_is_stopped_by_the_load_on_one_side() {
    let (bench, aircraft) = (holds("bench?noise=none"), holds("aircraft?noise=none"));
    let (up, down) = (plateau(&aircraft, 0), plateau(&aircraft, 1));
    assert!((3.92..=3.95).contains(&up), "{up}");
    assert!((-5.07..=-5.04).contains(&down), "{down}");
    // Fig. 9: the bench servo over-predicts by 22 % on the + side.
    let over = 100.0 * (plateau(&bench, 0) - up) / plateau(&bench, 0);
    assert!((21.5..=22.5).contains(&over), "{over} %");
}

#[test]
fn the_aircraft_servo_starts_slower_and_swings() {
    let (bench, aircraft) = (holds("bench?noise=none"), holds("aircraft?noise=none"));
    // Figs 10 and 12: slower at first, from -5 through 0 deg ...
    let [free, loaded] = [&bench, &aircraft].map(|h| first_above(&h[0], 0.0));
    assert!(loaded >= free + 3, "{free} and {loaded} samples");
    // ... then a peak above where it ends, and a dip below.
    let peak = largest(&aircraft[0]) - plateau(&aircraft, 0);
    let after_peak = &aircraft[0][first_above(&aircraft[0], largest(&aircraft[0]))..];
    let dip = plateau(&aircraft, 0) - smallest(after_peak);
    assert!((0.3..=0.5).contains(&peak), "{peak}");
    assert!((0.15..=0.3).contains(&dip), "{dip}");
    // The motor gives all it has on the + plateau: the error is beyond 1/Kp = 0.95 deg there.
    let saturated = aircraft[0][WAIT..]
        .iter()
        .filter(|y| 5.0 - **y > (1f64 / 60.0).to_degrees());
    let share = saturated.count() as f64 / (aircraft[0].len() - WAIT) as f64;
    assert!(share > 0.9, "{share}");
}

#[test]
fn a_limp_aircraft_servo_is_blown_to_where_the_load_vanishes() {
    let options: SimulationOptions = "aircraft?noise=none".parse().unwrap();
    let pulses =
        std::iter::repeat_n(Some(PulseWidth::NEUTRAL), 50).chain(std::iter::repeat_n(None, 150));
    let frames: Vec<SimulatedFrame> = simulate(&options, pulses).unwrap().collect();
    let held = frames[49].angles[9];
    assert!(held.abs() < 1.0, "{held}");
    // c1 p = 0 at p = 6 + 0.8 θ = 0. The propeller shakes it by a1/(J Ω²) = 0.016 deg and friction
    // may hold it τc/(c1 · 0.8) = 0.9 deg away at the most.
    let rest = frames[199].angles[9];
    assert!((rest + 7.5).abs() < 0.95, "{rest}");
}

#[test]
fn equal_options_give_equal_recordings_and_another_seed_another_one() {
    for servo in ["bench", "aircraft", "linear"] {
        let take = |seed: u64| record(&format!("{servo}?scatter&seed={seed}"));
        assert_eq!(take(7), take(7));
        let different = take(7)
            .iter()
            .zip(take(8))
            .filter(|(a, b)| a.samples != b.samples)
            .count();
        assert!(different > 350, "{servo}: only {different} frames differ");
    }
}

#[test]
fn the_measured_angle_scatters_about_the_true_one_as_the_noise_says() {
    let errors: Vec<f64> = record("bench?seed=3")
        .iter()
        .flat_map(|f| {
            std::array::from_fn::<f64, SAMPLES_PER_FRAME, _>(|j| f.degrees()[j] - f.angles[j])
        })
        .collect();
    let n = errors.len() as f64;
    let variance = errors.iter().map(|e| e * e).sum::<f64>() / n;
    // White, autoregressive (Yule-Walker), and rounding of four dithered conversions.
    let coloured = 0.015f64.powi(2) * 1.7 / (0.3 * (1.7f64.powi(2) - 1.5f64.powi(2)));
    let expected = 0.02f64.powi(2) + coloured + 0.0366f64.powi(2) / 12.0 / 4.0;
    // n = 4100; relative sd of the variance √(2 · 4.16 / n) = 4.5 % at most (4.16: sum of the
    // squared autocorrelations of the coloured part). Three of them.
    assert!(
        (variance / expected - 1.0).abs() < 0.135,
        "{variance} for {expected}"
    );
}

/// Each part of the scatter moves what it should: by how much, to first order.
#[test]
fn conditions_change_what_they_say() {
    let nominal = holds("linear?noise=none");
    // The clock's phase delays: 2 ms is one sample.
    let late = holds("linear?noise=none&clock-phase-ms=2");
    for k in 0..400 - 1 {
        let shift = late[0][k + 1] - nominal[0][k];
        assert!(shift.abs() < 1e-9, "{k}: {shift}"); // times differ by rounding only
    }
    // Less supply, lower + plateau in the aircraft.
    let [weak, strong] = ["0.9", "1.1"].map(|s| holds(&format!("aircraft?noise=none&supply={s}")));
    assert!(plateau(&weak, 0) < plateau(&strong, 0) - 0.2);
    // More friction, less overshoot.
    let [slick, rough] =
        ["0", "3"].map(|f| largest(&holds(&format!("bench?noise=none&friction={f}"))[0]));
    assert!(rough < slick - 0.005, "{rough} and {slick}");
    // The sensor's gain changes the reading, not the motion.
    let tall = record("bench?noise=none&sensor-gain=1.1");
    let last = tall.last().unwrap();
    assert!((last.degrees()[9] / last.angles[9] - 1.1).abs() < 0.0366 / 2.0 / 5.0);
}
