//! Recordings of several runs of one servo that differ in gain or delay, or do not: the bounds are those of the servo's mean.

use crate::hard_lines::{Drive, HardLine, Hardship};
use crate::plants::{Noise, Plant};

/// The lines of the table of runs that scatter, those without any scatter last.
#[must_use]
pub fn scattering_runs() -> Vec<HardLine> {
    use Drive::{Prbs, Staircase};
    use Noise::{Ar1, Arma, White};
    let gain = |runs, sd| Hardship::GainScatter { runs, sd };
    let delay = |runs, sd_ms| Hardship::DelayScatter { runs, sd_ms };
    let line = |drive, plant, noise, scale, hardship| HardLine {
        drive,
        plant,
        noise,
        scale,
        hardship,
    };
    vec![
        line(Prbs, Plant::D, Arma, 5.0, gain(4, 0.02)),
        line(Prbs, Plant::D, Arma, 5.0, gain(6, 0.02)),
        line(Staircase, Plant::A, Ar1, 5.0, gain(3, 0.01)),
        line(Staircase, Plant::A, Ar1, 5.0, gain(8, 0.01)),
        line(Staircase, Plant::A, White, 1.0, gain(3, 0.0025)),
        line(Staircase, Plant::A, White, 1.0, gain(5, 0.0025)),
        line(Prbs, Plant::A, White, 1.0, gain(10, 0.0025)),
        line(Staircase, Plant::C, White, 5.0, gain(4, 0.005)),
        line(Staircase, Plant::B, Ar1, 1.0, gain(3, 0.005)),
        line(Staircase, Plant::D, Arma, 2.0, gain(5, 0.01)),
        line(Prbs, Plant::C, Ar1, 5.0, gain(10, 0.02)),
        line(Staircase, Plant::D, Arma, 5.0, gain(3, 0.04)),
        line(Prbs, Plant::B, Ar1, 5.0, gain(5, 0.04)),
        line(Staircase, Plant::A, White, 1.0, delay(3, 0.25)),
        line(Staircase, Plant::A, Ar1, 5.0, delay(4, 0.25)),
        line(Staircase, Plant::B, Arma, 5.0, delay(5, 0.5)),
        line(Staircase, Plant::A, White, 5.0, delay(3, 1.0)),
        line(Prbs, Plant::D, White, 2.0, delay(10, 0.5)),
        line(Prbs, Plant::C, Arma, 5.0, delay(7, 1.0)),
        line(Staircase, Plant::A, White, 1.0, gain(3, 0.0)),
        line(Staircase, Plant::A, White, 1.0, gain(4, 0.0)),
        line(Staircase, Plant::A, White, 1.0, gain(5, 0.0)),
        line(Staircase, Plant::A, White, 1.0, gain(10, 0.0)),
        line(Staircase, Plant::A, Ar1, 5.0, gain(3, 0.0)),
        line(Staircase, Plant::A, Ar1, 5.0, gain(4, 0.0)),
        line(Staircase, Plant::A, Ar1, 5.0, gain(5, 0.0)),
        line(Staircase, Plant::A, Ar1, 5.0, gain(10, 0.0)),
    ]
}
