//! The sensor's calibration through a simulated rig, against what the simulator knows.

use super::*;
use crate::data::rig_file::RigFile;
use crate::instrument::port;
use crate::instrument::rig::RigClient;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use servoid_protocol::PulseWidth;
use servoid_simulator::sensor::SENSOR_SCALE;
use servoid_simulator::{SimulationOptions, simulate};

const PULSES: [u16; 5] = [1100, 1300, 1500, 1700, 1900];

fn mover<'a>(address: &str, rig: RigFile, interrupted: &'a dyn Fn() -> bool) -> Mover<'a> {
    let client = RigClient::connect(port::open(address).unwrap(), address).unwrap();
    Mover::new(client, rig, interrupted)
}

/// Where the shaft really is at each pulse: what an exact protractor shows.
fn protractor() -> Vec<f64> {
    let options: SimulationOptions = "bench?noise=none".parse().unwrap();
    let second = |us: u16| [Some(PulseWidth(us)); 50];
    let pulses = std::iter::once(1500).chain(PULSES).flat_map(second);
    let frames: Vec<_> = simulate(&options, pulses).unwrap().collect();
    frames
        .chunks(50)
        .skip(1)
        .map(|hold| hold[49].angles[9])
        .collect()
}

/// Somebody reads a protractor to 0.3 degrees; the sensor's gain and zero are those of the simulator.
#[test]
#[ignore = "three seconds: cargo test -p servoid --lib -- --ignored the_truth_of_the_simulator"]
fn the_truth_of_the_simulator_lies_within_the_intervals_as_often_as_they_say() {
    const RUNS: u64 = 60;
    let angles = protractor();
    let mut missed = [0; 2];
    for seed in 0..RUNS {
        let (gain, zero_deg) = (0.95 + seed as f64 / 600.0, 0.7);
        let address =
            format!("sim:bench?seed={seed}&sensor-gain={gain}&sensor-zero-deg={zero_deg}");
        let rests = mover(&address, RigFile::default(), &|| false)
            .visit(&PULSES, &|_| false)
            .unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let readings: Vec<Reading> = angles
            .iter()
            .zip(&rests)
            .map(|(angle, rest)| {
                let slip: f64 = StandardNormal.sample(&mut random);
                Reading {
                    angle_deg: angle + 0.3 * slip,
                    counts: rest.counts,
                }
            })
            .collect();
        let found = Calibration::fit(&readings).unwrap();
        let scale = SENSOR_SCALE.degrees_per_count / gain;
        let zero = SENSOR_SCALE.zero_counts - zero_deg / scale;
        let [low, high] = found.degrees_per_count_interval;
        missed[0] += i32::from(!(low..=high).contains(&scale));
        missed[1] += i32::from((found.zero_counts - zero).abs() > found.zero_counts_half_width);
        // Student's t of three degrees of freedom makes 0.3 degrees 0.78 at the zero, on average.
        assert!(found.zero_counts_half_width * scale < 3.0);
    }
    // Five misses or more of 60 at 1 % happen once in 3000.
    assert!(
        missed.iter().all(|missed| *missed <= 4),
        "{missed:?} of {RUNS}"
    );
}

#[test]
fn what_lies_beyond_the_limits_is_not_visited() {
    let mut rig = RigFile::default();
    (rig.limits.shortest_us, rig.limits.longest_us) = (1400, 1600);
    let mut mover = mover("sim:bench", rig, &|| false);
    let error = mover.visit(&[1500, 1601], &|_| false).unwrap_err();
    assert!(error.to_string().contains("1601"), "{error}");
    let rests = mover.visit(&[1400, 1600], &|_| false).unwrap();
    assert_eq!(rests.len(), 2);
    assert_eq!(rests[0].samples, 250);
}

#[test]
fn a_hold_lasts_until_it_is_read_and_may_be_at_neutral() {
    let mut mover = mover("sim:linear", RigFile::default(), &|| false);
    let asked = std::cell::Cell::new(0);
    let rest = mover
        .hold(1500, &|_| {
            asked.set(asked.get() + 1);
            asked.get() > 100
        })
        .unwrap();
    // The simulated sensor's zero, and its noise over 250 samples.
    assert!(
        (rest.counts - SENSOR_SCALE.zero_counts).abs() < 3.0,
        "{rest:?}"
    );
    // The rig is ready for the next position.
    let next = mover.hold(1600, &|_| true).unwrap();
    assert!((next.counts - rest.counts - 10.0 / SENSOR_SCALE.degrees_per_count).abs() < 5.0);
}

#[test]
fn a_user_who_wants_to_stop_is_obeyed() {
    let mut mover = mover("sim:bench", RigFile::default(), &|| true);
    let error = mover.visit(&PULSES, &|_| false).unwrap_err();
    assert!(error.to_string().contains("stopped by the user"), "{error}");
}

#[test]
fn comments_and_other_keys_stay_and_the_remark_is_there_once() {
    let readings: Vec<Reading> = [-20.0, 0.0, 20.0]
        .map(|angle_deg| Reading {
            angle_deg,
            counts: 8000.0 + 100.0 * angle_deg,
        })
        .to_vec();
    let sensor = Calibration::fit(&readings).unwrap();
    let found = Found {
        sensor: Some((&sensor, "three readings")),
        us_per_degree: Some(Estimate::around(10.1, 0.05)),
        limits_us: [Some(1441), None],
    };
    let before = "# mine\nport = \"x\"\n[sensor]\nname = \"H\" # new\n# the zero\nzero_counts = 1.0 # here\n";
    let once = put_into(before, &found).unwrap();
    let after = put_into(&once, &found).unwrap();
    for kept in [
        "# mine",
        "port = \"x\"",
        "name = \"H\" # new",
        " # here",
        "# the zero",
    ] {
        assert!(after.contains(kept), "{after}");
    }
    assert_eq!(
        after.matches("# Calibrated: three readings").count(),
        1,
        "{after}"
    );
    assert!(
        after.contains("us_per_degree = 10.1  # 10.0500 to 10.1500"),
        "{after}"
    );
    let rig = RigFile::parse(&after, "rig.toml".as_ref()).unwrap();
    assert_eq!(rig.sensor.zero_counts, sensor.zero_counts);
    assert_eq!(rig.sensor.scale_sd_percent, sensor.scale_sd_percent);
    assert_eq!(rig.servo.us_per_degree, 10.1);
    let limits = [rig.limits.shortest_us, rig.limits.longest_us];
    assert_eq!(limits, [1441, RigFile::default().limits.longest_us]);
}
