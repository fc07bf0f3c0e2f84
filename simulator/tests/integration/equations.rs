//! The motor servos against their equations, written down once more in one plain loop with the
//! table's numbers in it: a slip in either would show.

use servoid_protocol::PulseWidth;
use servoid_protocol::reference::Staircase;
use servoid_simulator::{SimulationOptions, simulate};

/// Steps of 0.1 ms in a frame, to its first sample, between samples, and in the latency.
const FRAME: usize = 200;
const FIRST: usize = 5;
const SAMPLE: usize = 20;
const LATENCY: usize = 215;

/// Angles (deg) at the samples, for `pulses` (µs) frame by frame.
fn angles(in_aircraft: bool, pulses: &[u16]) -> Vec<f64> {
    let dt = 1e-4;
    let (sag, heavier) = if in_aircraft {
        (0.8635, 1.292)
    } else {
        (1.0, 1.0)
    };
    let (stall, no_load, inertia) = (1.18 * sag, 13.1 * sag, 9.66e-3 * heavier);
    let (dead_band, half_play) = (0.04f64.to_radians(), 0.02f64.to_radians());
    let (mut theta, mut omega, mut filtered, mut output) = (0.0f64, 0.0f64, 0.0f64, 0.0f64);
    let mut samples = Vec::new();
    for k in 0..pulses.len() * FRAME {
        if k % SAMPLE == FIRST {
            samples.push(output.to_degrees());
        }
        filtered += dt / 1e-3 * (omega - filtered);
        let motor = if k < LATENCY {
            0.0
        } else {
            let command = (f64::from(pulses[(k - LATENCY) / FRAME]) - 1500.0) / 10.0;
            let mut error = command.to_radians() - theta;
            if error.abs() < dead_band {
                error = 0.0;
            }
            let duty = (60.0 * error - 0.944 * filtered).clamp(-1.0, 1.0);
            stall * (duty - omega / no_load)
        };
        let load = if in_aircraft {
            let p = 6.0 + 0.8 * theta.to_degrees();
            let turn = 1400.0 / 60.0 * std::f64::consts::TAU * k as f64 * dt;
            0.10 * omega
                + 0.016_74 * p
                + 0.033_21 * (p - 4.04).max(0.0).powi(2)
                + 0.073 * turn.sin()
                + 0.0365 * (4.0 * turn).sin()
        } else {
            0.0
        };
        omega += dt / inertia * (motor - 0.012 * (omega / 0.05).tanh() - load);
        theta += dt * omega;
        output = output.max(theta - half_play).min(theta + half_play);
    }
    samples
}

#[test]
fn the_servos_move_as_their_equations_say() {
    let pulses: Vec<u16> = (0..)
        .map_while(|frame| Staircase::PAPER.offset_us(frame))
        .map(|offset| (1500 + offset) as u16)
        .collect();
    for (name, in_aircraft) in [("bench", false), ("aircraft", true)] {
        let options: SimulationOptions = format!("{name}?noise=none").parse().unwrap();
        let frames = simulate(&options, pulses.iter().map(|us| Some(PulseWidth(*us)))).unwrap();
        let simulated: Vec<f64> = frames.flat_map(|frame| frame.angles).collect();
        let expected = angles(in_aircraft, &pulses);
        assert_eq!(simulated.len(), expected.len());
        for (k, (found, expected)) in simulated.iter().zip(&expected).enumerate() {
            // The two loops round differently; the servo is stable, so that rounding stays near
            // 1e-14 deg, but for the dead band's edge, where it may decide one step: 1e-9 is far
            // above the one and far below anything that a wrong number would do.
            assert!(
                (found - expected).abs() < 1e-9,
                "{name}, sample {k}: {found} for {expected}"
            );
        }
    }
}
