//! The error of predictions by frequency.
//!
//! Stretches of 2 s that overlap by half, without their means and under Hann's window, give the power of the motion and of the errors by octaves
//! (Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70). A limit of the speed or a dead band makes errors at multiples of the frequency of a motion: beside
//! a large slow motion, higher octaves show these.

use crate::data::PredictedRun;
use crate::presentation::summary::digits;
use serde::Serialize;
use std::f64::consts::TAU;

/// Length of the stretches \[s\]: their lines are 0.5 Hz apart, and the window is two of them wide.
const STRETCH_S: f64 = 2.0;

/// Edges between octaves \[Hz\].
const EDGES_HZ: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];

/// Motion and errors between two frequencies, as root mean squares \[output\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OctaveError {
    /// Lower edge \[Hz\].
    pub from_hz: f64,
    /// Upper edge \[Hz\]: of the last one half of the sample rate.
    pub to_hz: f64,
    /// The measured motion.
    pub motion_rms: f64,
    /// The error of the linear model; `None` where that predicts nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linear_rms: Option<f64>,
    /// The error of the servo model, where the file has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo_rms: Option<f64>,
}

/// The error of the predictions of `runs` by octaves, from the stretches that all models predict; empty where there is none.
pub(super) fn error_by_octave(runs: &[PredictedRun]) -> Vec<OctaveError> {
    let Some(period_s) = runs.first().map(|run| run.period_s) else {
        return Vec::new();
    };
    let size = (STRETCH_S / period_s).round() as usize;
    let (mut motion, mut linear, mut servo) =
        (Octaves::default(), Octaves::default(), Octaves::default());
    for run in runs {
        let errors = [&run.by_linear, &run.by_servo].map(|by| Some(run.errors_of(by.as_deref()?)));
        let starts = (0..run.measured.len()).step_by((size / 2).max(1));
        for stretch in starts.map(|first| first..first + size) {
            let Some(measured) = run.measured.get(stretch.clone()) else {
                break;
            };
            let of_models = errors
                .each_ref()
                .map(|errors| Some(&errors.as_ref()?[stretch.clone()]));
            let mut values = of_models
                .iter()
                .flatten()
                .copied()
                .chain([measured])
                .flatten();
            if values.any(|value| value.is_nan()) {
                continue;
            }
            motion.add(measured, period_s);
            let [of_linear, of_servo] = of_models;
            of_linear.inspect(|errors| linear.add(errors, period_s));
            of_servo.inspect(|errors| servo.add(errors, period_s));
        }
    }
    let half_rate_hz = 0.5 / period_s;
    let edges = || std::iter::once(0.0).chain(EDGES_HZ);
    let octaves = edges()
        .zip(edges().skip(1).chain([f64::INFINITY]))
        .enumerate();
    octaves
        .take_while(|(_, (from_hz, _))| *from_hz < half_rate_hz)
        .filter_map(|(octave, (from_hz, to_hz))| {
            Some(OctaveError {
                from_hz,
                to_hz: to_hz.min(half_rate_hz),
                motion_rms: motion.rms(octave)?,
                linear_rms: linear.rms(octave),
                servo_rms: servo.rms(octave),
            })
        })
        .collect()
}

/// The table for people; `unit` is that of the output.
pub(super) fn as_table(octaves: &[OctaveError], unit: Option<&str>) -> String {
    let rms = unit.map_or_else(|| "rms".to_owned(), |unit| format!("{unit} rms"));
    let mut text = format!(
        "the error by frequency, with the noise of the sensor and without offsets ({rms}, and % of the motion):\n"
    );
    let named = |of: fn(&OctaveError) -> Option<f64>, name: &'static str| {
        octaves
            .iter()
            .any(|octave| of(octave).is_some())
            .then_some((of, name))
    };
    let servo = named(|octave| octave.servo_rms, "servo model");
    let linear = named(|octave| octave.linear_rms, "linear model");
    let models: Vec<_> = servo.into_iter().chain(linear).collect();
    let heads: String = models
        .iter()
        .map(|(_, name)| format!("{name:>20}"))
        .collect();
    text += &format!("  {:<12}{:>12}{heads}\n", "Hz", "motion");
    for octave in octaves {
        let (from, to) = (octave.from_hz, octave.to_hz);
        let between = match (octave.from_hz > 0.0, EDGES_HZ.contains(&to)) {
            (false, _) => format!("below {}", digits(to, 3)),
            (true, true) => format!("{from} to {to}"),
            (true, false) => format!("above {from}"),
        };
        let motion = octave.motion_rms;
        let of_models = models.iter().filter_map(|(of, _)| of(octave));
        let of_models: String = of_models
            .map(|rms| {
                format!(
                    "{:>12}{:>8}",
                    digits(rms, 3),
                    format!("{:.0} %", 100.0 * rms / motion)
                )
            })
            .collect();
        text += &format!("  {between:<12}{:>12}{of_models}\n", digits(motion, 3));
    }
    text
}

/// The power of a signal by octaves.
#[derive(Default)]
struct Octaves {
    power: [f64; EDGES_HZ.len() + 1],
    stretches: usize,
}

impl Octaves {
    fn add(&mut self, stretch: &[f64], period_s: f64) {
        let size = stretch.len();
        let window = |k: usize| 0.5 - 0.5 * (TAU * k as f64 / size as f64).cos();
        let weights: Vec<f64> = (0..size).map(window).collect();
        let mean = stretch.iter().sum::<f64>() / size as f64;
        let weighted = stretch.iter().zip(&weights);
        let mut weighted: Vec<f64> = weighted.map(|(value, w)| w * (value - mean)).collect();
        let forward = servoid_fft::forward(size);
        let mut lines = forward.make_output_vec();
        if forward.process(&mut weighted, &mut lines).is_err() {
            return;
        }
        // By Parseval's theorem; all lines but the first and, of an even size, the last stand for two.
        let squares: f64 = weights.iter().map(|w| w * w).sum();
        for (k, line) in lines.iter().enumerate() {
            let hz = k as f64 / (size as f64 * period_s);
            let octave = EDGES_HZ.partition_point(|edge| *edge <= hz);
            let twice = if k == 0 || 2 * k == size { 1.0 } else { 2.0 };
            self.power[octave] += twice * line.norm_sqr() / (size as f64 * squares);
        }
        self.stretches += 1;
    }

    fn rms(&self, octave: usize) -> Option<f64> {
        let mean = self.power.get(octave)? / self.stretches as f64;
        (self.stretches > 0).then(|| mean.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 0.004;

    fn sine(amplitude: f64, hz: f64) -> impl Fn(usize) -> f64 {
        move |k| amplitude * (TAU * hz * PERIOD_S * k as f64).sin()
    }

    fn run(measured: Vec<f64>, by_servo: Vec<f64>) -> PredictedRun {
        PredictedRun {
            period_s: PERIOD_S,
            measured,
            by_linear: None,
            by_servo: Some(by_servo),
        }
    }

    /// Sines far from the edges of their octaves: under the window all of their power stays there. An offset counts nowhere.
    #[test]
    fn the_power_of_a_sine_is_in_its_octave() {
        let (slow, fast) = (sine(3.0, 3.0), sine(0.5, 12.0));
        let measured = (0..2000).map(|k| 7.0 + slow(k) + fast(k)).collect();
        let by_servo = (0..2000).map(&slow).collect();
        let octaves = error_by_octave(&[run(measured, by_servo)]);
        let root_of_2 = 2f64.sqrt();
        let expected = [
            (0.0, 1.0, 0.0, 0.0),
            (1.0, 2.0, 0.0, 0.0),
            (2.0, 4.0, 3.0 / root_of_2, 0.0),
            (4.0, 8.0, 0.0, 0.0),
            (8.0, 16.0, 0.5 / root_of_2, 0.5 / root_of_2),
            (16.0, 125.0, 0.0, 0.0),
        ];
        assert_eq!(octaves.len(), expected.len());
        for (found, (from_hz, to_hz, motion, servo)) in octaves.iter().zip(expected) {
            assert_eq!((found.from_hz, found.to_hz), (from_hz, to_hz));
            // Rounding of sums of 500 numbers of size 10.
            assert!((found.motion_rms - motion).abs() < 1e-9, "{found:?}");
            assert!((found.servo_rms.unwrap() - servo).abs() < 1e-9, "{found:?}");
            assert_eq!(found.linear_rms, None);
        }
    }

    /// The squares of all octaves are those of the signal: white noise of 1, 200 stretches of 500 numbers, is known to 1/sqrt(2 · 200 · 500 / 2).
    #[test]
    fn octaves_add_up_to_the_signal() {
        use rand::{RngExt, SeedableRng};
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let noise: Vec<f64> = (0..50_000)
            .map(|_| random.random_range(-1.0..1.0))
            .collect();
        let squares = 1.0 / 3.0;
        let zeros = vec![0.0; noise.len()];
        let octaves = error_by_octave(&[run(noise, zeros)]);
        let sum: f64 = octaves.iter().map(|octave| octave.motion_rms.powi(2)).sum();
        assert!((sum / squares - 1.0).abs() < 0.03, "{sum}");
    }

    #[test]
    fn stretches_that_are_not_known_are_left_out_and_short_runs_have_none() {
        let motion = sine(1.0, 3.0);
        let mut measured: Vec<f64> = (0..3000).map(&motion).collect();
        measured[100] = f64::NAN;
        let zeros = vec![0.0; measured.len()];
        let octaves = error_by_octave(&[run(measured, zeros)]);
        assert!((octaves[2].motion_rms - 0.5f64.sqrt()).abs() < 1e-9);
        let short: Vec<f64> = (0..499).map(&motion).collect();
        assert!(error_by_octave(&[run(short.clone(), short)]).is_empty());
    }
}
