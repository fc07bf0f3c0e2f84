//! The error of predictions by frequency.
//!
//! Stretches of up to 20 s that overlap by half, without their means and under Hann's window, give the power of the motion and of the errors by octaves
//! (Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70). A limit of the speed or a dead band makes errors at multiples of the frequency of a motion: beside
//! a large slow motion, higher octaves show these.

use crate::data::PredictedRun;
use crate::presentation::summary::digits;
use serde::Serialize;
use std::f64::consts::TAU;
use std::ops::Range;

/// The longest stretch \[s\]: of slow motion none is needed that is longer.
const LONGEST_S: f64 = 20.0;

/// Runs from which on each counts \[s\]: shorter ones would make all stretches as short.
const LONG_ENOUGH_S: f64 = 5.0;

/// Edges between octaves \[Hz\].
const EDGES_HZ: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];

/// Lines of a stretch below the lowest edge: the window spreads each over four, and a strong slow motion would be in the octave above.
const LINES_BELOW: f64 = 10.0;

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

/// The error of the predictions of `runs` by octaves, where all models predict; empty where no stretch shows any.
pub(super) fn error_by_octave(runs: &[PredictedRun]) -> Vec<OctaveError> {
    let Some(period_s) = runs.first().map(|run| run.period_s) else {
        return Vec::new();
    };
    let predicted: Vec<Signals> = runs.iter().filter_map(Signals::of).collect();
    let seconds = |signals: &Signals| signals.motion.len() as f64 * period_s;
    let lengths = || predicted.iter().map(seconds);
    let enough = lengths().filter(|length| *length >= LONG_ENOUGH_S);
    let Some(stretch_s) = enough.reduce(f64::min).or(lengths().reduce(f64::max)) else {
        return Vec::new();
    };
    let stretch_s = stretch_s.min(LONGEST_S);
    let size = (stretch_s / period_s).round() as usize;
    let power = |signal: &dyn Fn(&Signals) -> Option<&Vec<f64>>| {
        let mut power = Power::new(size, period_s);
        for signal in predicted.iter().filter_map(signal) {
            power.add(signal);
        }
        power
    };
    let motion = power(&|signals| Some(&signals.motion));
    let linear = power(&|signals| signals.linear.as_ref());
    let servo = power(&|signals| signals.servo.as_ref());
    let half_rate_hz = 0.5 / period_s;
    let is_edge = |edge: &f64| *edge >= LINES_BELOW / stretch_s && *edge < half_rate_hz;
    let edges: Vec<f64> = EDGES_HZ.into_iter().filter(is_edge).collect();
    if edges.is_empty() {
        return Vec::new();
    }
    let from = std::iter::once(0.0).chain(edges.iter().copied());
    let to = edges.iter().copied().chain([half_rate_hz]);
    let octave = |(from_hz, to_hz): (f64, f64)| {
        Some(OctaveError {
            from_hz,
            to_hz,
            motion_rms: motion.rms(from_hz..to_hz)?,
            linear_rms: linear.rms(from_hz..to_hz),
            servo_rms: servo.rms(from_hz..to_hz),
        })
    };
    from.zip(to).filter_map(octave).collect()
}

/// What was measured of a run, and the errors of its models, from the first row that all of them have to the last one.
struct Signals {
    motion: Vec<f64>,
    linear: Option<Vec<f64>>,
    servo: Option<Vec<f64>>,
}

impl Signals {
    fn of(run: &PredictedRun) -> Option<Self> {
        let errors = |by: &Option<Vec<f64>>| Some(run.errors_of(by.as_deref()?));
        let [linear, servo] = [&run.by_linear, &run.by_servo].map(errors);
        let mut known: Vec<bool> = run.measured.iter().map(|y| !y.is_nan()).collect();
        for errors in linear.iter().chain(&servo) {
            for (known, error) in known.iter_mut().zip(errors) {
                *known &= !error.is_nan();
            }
        }
        let first = known.iter().position(|known| *known)?;
        let last = known.iter().rposition(|known| *known)?;
        let part = |values: Vec<f64>| Some(across_gaps(values.get(first..=last)?));
        Some(Self {
            motion: part(run.measured.clone())?,
            linear: linear.and_then(part),
            servo: servo.and_then(part),
        })
    }
}

/// The values, the first of which is known, with straight lines across those that are missing.
fn across_gaps(values: &[f64]) -> Vec<f64> {
    let mut filled: Vec<f64> = Vec::with_capacity(values.len());
    let mut missing = 0;
    for value in values {
        if value.is_nan() {
            missing += 1;
            continue;
        }
        if let Some(before) = filled.last().copied() {
            let slope = (value - before) / (missing + 1) as f64;
            filled.extend((1..=missing).map(|k| before + slope * k as f64));
        }
        filled.push(*value);
        missing = 0;
    }
    filled
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
        let with_share = |rms: f64| {
            let share = match motion > 0.0 {
                true => format!("{:.0} %", 100.0 * rms / motion),
                false => "-".to_owned(),
            };
            format!("{:>12}{share:>8}", digits(rms, 3))
        };
        let of_models: String = of_models.map(with_share).collect();
        text += &format!("  {between:<12}{:>12}{of_models}\n", digits(motion, 3));
    }
    text
}

/// The power of a signal by frequency, the mean over stretches.
struct Power {
    window: Vec<f64>,
    lines: Vec<f64>,
    line_hz: f64,
    stretches: usize,
}

impl Power {
    fn new(size: usize, period_s: f64) -> Self {
        let hann = |k: usize| 0.5 - 0.5 * (TAU * k as f64 / size as f64).cos();
        Self {
            window: (0..size).map(hann).collect(),
            lines: vec![0.0; size / 2 + 1],
            line_hz: 1.0 / (size as f64 * period_s),
            stretches: 0,
        }
    }

    fn add(&mut self, signal: &[f64]) {
        let size = self.window.len();
        let forward = servoid_fft::forward(size);
        let squares: f64 = self.window.iter().map(|w| w * w).sum();
        for stretch in signal.windows(size).step_by((size / 2).max(1)) {
            let mean = stretch.iter().sum::<f64>() / size as f64;
            let weighted = stretch.iter().zip(&self.window);
            let mut weighted: Vec<f64> = weighted.map(|(value, w)| w * (value - mean)).collect();
            let mut spectrum = forward.make_output_vec();
            if forward.process(&mut weighted, &mut spectrum).is_err() {
                return;
            }
            for (k, (sum, line)) in self.lines.iter_mut().zip(&spectrum).enumerate() {
                // By Parseval's theorem; all lines but the first and, of an even size, the last stand for two.
                let twice = if k == 0 || 2 * k == size { 1.0 } else { 2.0 };
                *sum += twice * line.norm_sqr() / (size as f64 * squares);
            }
            self.stretches += 1;
        }
    }

    /// Root mean square between two frequencies; `None` of no signal.
    fn rms(&self, hz: Range<f64>) -> Option<f64> {
        let lines = self.lines.iter().enumerate();
        let within = lines.filter(|(k, _)| hz.contains(&(*k as f64 * self.line_hz)));
        let power = within.map(|(_, power)| power).sum::<f64>() / self.stretches as f64;
        (self.stretches > 0).then(|| power.sqrt())
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

    /// Sines of which stretches of 20 s have whole periods: under the window their power is in three lines. An offset counts nowhere.
    #[test]
    fn the_power_of_a_sine_is_in_its_octave() {
        let (slow, fast) = (sine(3.0, 0.8), sine(0.5, 12.0));
        let measured = (0..12_000).map(|k| 7.0 + slow(k) + fast(k)).collect();
        let by_servo = (0..12_000).map(&slow).collect();
        let octaves = error_by_octave(&[run(measured, by_servo)]);
        let root_of_2 = 2f64.sqrt();
        let expected = [
            (0.0, 1.0, 3.0 / root_of_2, 0.0),
            (1.0, 2.0, 0.0, 0.0),
            (2.0, 4.0, 0.0, 0.0),
            (4.0, 8.0, 0.0, 0.0),
            (8.0, 16.0, 0.5 / root_of_2, 0.5 / root_of_2),
            (16.0, 125.0, 0.0, 0.0),
        ];
        assert_eq!(octaves.len(), expected.len());
        for (found, (from_hz, to_hz, motion, servo)) in octaves.iter().zip(expected) {
            assert_eq!((found.from_hz, found.to_hz), (from_hz, to_hz));
            // Rounding of sums of 5000 numbers of size 10; a root of them near 0 has half of the digits.
            assert!((found.motion_rms - motion).abs() < 1e-6, "{found:?}");
            assert!((found.servo_rms.unwrap() - servo).abs() < 1e-6, "{found:?}");
            assert_eq!(found.linear_rms, None);
        }
    }

    /// The squares of all octaves are those of the signal, of white noise to the half of a percent to which 50 000 numbers know their own.
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
    fn a_gap_is_bridged_and_rows_that_a_model_has_not_are_left_out() {
        let motion = sine(1.0, 3.0);
        let mut measured: Vec<f64> = (0..6000).map(&motion).collect();
        measured[3100] = f64::NAN;
        let mut by_servo = vec![0.0; measured.len()];
        by_servo[..400].fill(f64::NAN);
        let octaves = error_by_octave(&[run(measured, by_servo)]);
        let rms = 0.5f64.sqrt();
        // The straight line is off by 1e-3 in one of 5000 rows.
        assert!((octaves[2].motion_rms - rms).abs() < 1e-4, "{octaves:?}");
        assert!((octaves[2].servo_rms.unwrap() - rms).abs() < 1e-4);
    }

    /// A stretch of 3 s has lines 0.33 Hz apart, and nothing is said of octaves below ten of them.
    #[test]
    fn a_short_run_has_the_upper_octaves_alone() {
        let motion = sine(1.0, 3.0);
        let of_seconds = |seconds: f64| {
            let short: Vec<f64> = (0..(seconds / PERIOD_S) as usize).map(&motion).collect();
            error_by_octave(&[run(short.clone(), short)])
        };
        let edges = |octaves: Vec<OctaveError>| -> Vec<f64> {
            octaves.iter().map(|octave| octave.from_hz).collect()
        };
        assert_eq!(edges(of_seconds(3.0)), [0.0, 4.0, 8.0, 16.0]);
        assert!(edges(of_seconds(0.5)).is_empty());
    }
}
