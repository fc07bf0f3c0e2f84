//! A servo that is slower than the longest settling time, or an output that the input only sets in motion.
//!
//! Over a window, an output behind a lag of time constant T and gain K changes by
//!
//! ```text
//! y(end) - y(start) = (K/T) ∫ u - (1/T) ∫ y + c,
//! ```
//!
//! whatever went before. Where windows beside each other are explained like that, and T is long, N is too short for the servo, and whatever else is found may
//! be its consequence. Where T is as long as the record, the record does not distinguish the output from the integral of the input.

use faer::Mat;

use crate::data::{Record, Run};
use crate::diagnostics::residuals::residual_tests::ScoreTest;
use crate::numerics::dot;
use crate::thresholds::{EXPLAINED_BY_LAG, LAG_BESIDE_SETTLING};

/// Windows of a record.
const WINDOWS: usize = 64;

/// The shortest window \[samples\]: the noise of its ends counts twice.
const SHORTEST: usize = 8;

/// What makes the response longer than any settling time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SlowServo {
    /// T \[s\]; `None` where the output is as good as the integral of the input.
    pub(crate) time_constant_s: Option<f64>,
    /// K/T: the speed of the output for each unit of the input \[output/input/s\].
    pub(crate) speed_per_input: f64,
    /// Share of the changes of the output that this explains.
    pub(crate) explained: f64,
}

impl SlowServo {
    /// That of a record whose longest settling time has so many samples.
    pub(crate) fn of(record: &Record, longest: usize) -> Option<Self> {
        let length = (record.samples() / WINDOWS).max(SHORTEST);
        let period = record.sample_period_s();
        let windows: Vec<[f64; 4]> = (record.runs().iter())
            .flat_map(|run| windows(run, length, period))
            .collect();
        let ([of_input, of_output, _], explained) = regress(&windows)?;
        let rate = -of_output;
        let duration = period * record.runs().iter().map(Run::len).max()? as f64;
        let time_constant_s = (rate * duration > 1.0).then(|| 1.0 / rate);
        let settling = longest as f64 * period;
        let is_slow = rate < LAG_BESIDE_SETTLING / settling;
        (explained > EXPLAINED_BY_LAG && is_slow).then_some(Self {
            time_constant_s,
            speed_per_input: of_input,
            explained,
        })
    }
}

/// ∫u, ∫y, the time and the change of y of each window without a gap.
fn windows(run: &Run, length: usize, period: f64) -> Vec<[f64; 4]> {
    let starts = (0..run.len().saturating_sub(length)).step_by(length);
    let of = |start: usize| {
        let (u, y) = (run.input(), run.output());
        let within = start..start + length;
        let integral = |values: &[f64]| period * values[within.clone()].iter().sum::<f64>();
        // An input holds until the next sample; an output between two has their mean.
        let change = y[start + length] - y[start];
        [
            integral(u),
            integral(y) + 0.5 * period * change,
            period * length as f64,
            change,
        ]
    };
    let known = |window: &[f64; 4]| window.iter().all(|value| !value.is_nan());
    starts.map(of).filter(known).collect()
}

/// Coefficients of the first three columns in the last, and the share of squares that they explain.
fn regress(windows: &[[f64; 4]]) -> Option<([f64; 3], f64)> {
    let product = |i: usize, j: usize| windows.iter().map(|row| row[i] * row[j]).sum::<f64>();
    let moments = Mat::from_fn(3, 3, product);
    let score = [0, 1, 2].map(|i| product(i, 3));
    let solved = ScoreTest::new(&moments, &moments, &score)?;
    let found: [f64; 3] = solved.coefficients.as_slice().try_into().ok()?;
    let mean = windows.iter().map(|row| row[3]).sum::<f64>() / windows.len() as f64;
    let spread: f64 = windows.iter().map(|row| (row[3] - mean).powi(2)).sum();
    let explained = dot(&found, &score);
    Some((found, 1.0 - (product(3, 3) - explained) / spread))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Levels of a second behind a lag of `time_constant` \[s\], or integrated.
    fn found(time_constant: f64) -> Option<SlowServo> {
        let level = |k: u32| f64::from(k / 500 * 7 % 5) - 2.0;
        let input: Vec<f64> = (0..10_000).map(level).collect();
        let mut y = 0.0;
        let follows = |u: &f64| {
            let before = y;
            y += 0.002 * (u - before / time_constant);
            before
        };
        let output: Vec<f64> = input.iter().map(follows).collect();
        SlowServo::of(&Record::of_run(0.002, input, output).unwrap(), 599)
    }

    #[test]
    fn a_slow_lag_has_its_time_constant_and_an_integrator_none() {
        let slow = found(4.0).unwrap();
        let time = slow.time_constant_s.unwrap();
        assert!((time - 4.0).abs() < 0.05, "{slow:?}");
        assert!((slow.speed_per_input - 1.0).abs() < 0.02, "{slow:?}");
        let integrator = found(f64::INFINITY).unwrap();
        assert_eq!(integrator.time_constant_s, None);
        assert_eq!(found(0.05), None);
    }
}
