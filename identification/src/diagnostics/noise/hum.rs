//! Periodic disturbances: lines in the spectrum of the errors.
//!
//! Mains hum is no noise of an autoregressive model. Its sine and cosine are taken out of the output: found in the
//! periodogram of the errors (Hann's window), where it is [`ABOVE_NEIGHBOURS`] times the noise at the neighbouring
//! frequencies, and fitted to each run with a phase of its own. What an error of the model leaves has the
//! frequencies of the motion: a line counts only where the reference has none, and where it is not small beside the
//! motion of the same frequency. A servo with unequal speeds, or with a load, is off after each change of the reference, whatever its sign: under
//! equal holds that makes lines at multiples of their rate, where the reference has none. So where the sizes of its changes have a line, and the
//! servo follows it, none counts either.

use std::cell::LazyCell;
use std::f64::consts::{LN_2, PI, TAU};
use std::ops::Deref;

use serde::{Deserialize, Serialize};

use crate::diagnostics::residuals::simulation_error::Simulated;
use crate::estimation::GlsFit;
use crate::thresholds::{ABOVE_NEIGHBOURS, BESIDE_MOTION, HARDLY_FOLLOWED, LINE_OF_REFERENCE};

/// Lines that are taken out at most.
const LINES: usize = 8;

/// Frequencies to each side whose median is the noise there.
const NEIGHBOURS: usize = 24;

/// Frequencies to each side that belong to a line.
const OF_LINE: usize = 4;

/// Cycles in the record below which a line is drift.
const CYCLES: usize = 30;

/// A line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hum {
    /// Frequency \[Hz\].
    pub hz: f64,
    /// Amplitude in the longest run \[output\].
    pub amplitude: f64,
}

/// A line as it is taken out.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HumLine {
    /// \[rad/sample\].
    omega: f64,
    /// Cosine and sine in each run.
    parts: Vec<(f64, f64)>,
    longest: usize,
}

impl HumLine {
    /// Its value in a run.
    pub(crate) fn at(&self, run: usize, k: usize) -> f64 {
        let (sin, cos) = (self.omega * k as f64).sin_cos();
        let (of_cos, of_sin) = self.parts.get(run).copied().unwrap_or((0.0, 0.0));
        of_cos * cos + of_sin * sin
    }

    pub(crate) fn amplitude(&self) -> f64 {
        let (of_cos, of_sin) = self.parts[self.longest];
        of_cos.hypot(of_sin)
    }

    pub(crate) fn described(&self, sample_period_s: f64) -> Hum {
        Hum {
            hz: self.omega / TAU / sample_period_s,
            amplitude: self.amplitude(),
        }
    }
}

/// The lines in the errors of `runs`.
pub(crate) fn hum(runs: &[Simulated<'_>], fit: &GlsFit) -> Vec<HumLine> {
    let mut errors: Vec<Vec<f64>> = runs.iter().map(|run| centred(&run.errors)).collect();
    let Some(longest) = (0..errors.len()).max_by_key(|&run| errors[run].len()) else {
        return Vec::new();
    };
    let motion = LazyCell::new(|| centred(&runs[longest].output));
    let reference = LazyCell::new(|| power(&centred(runs[longest].run.input())));
    let changes = LazyCell::new(|| power(&sizes_of_changes(runs[longest].run.input())));
    let mut lines = Vec::new();
    while lines.len() < LINES
        && let Some(omega) = strongest(&errors[longest], &reference)
    {
        let line = HumLine {
            omega,
            parts: errors.iter().map(|errors| parts(errors, omega)).collect(),
            longest,
        };
        if share_followed(fit, omega) > HARDLY_FOLLOWED && has_line(&changes, omega) {
            break;
        }
        let (of_cos, of_sin) = parts(&motion, omega);
        if line.amplitude() < BESIDE_MOTION * of_cos.hypot(of_sin) {
            break;
        }
        for (index, errors) in errors.iter_mut().enumerate() {
            for (k, error) in errors.iter_mut().enumerate().filter(|(_, e)| **e != 0.0) {
                *error -= line.at(index, k);
            }
        }
        lines.push(line);
    }
    lines
}

/// How much each value differs from the one before, about the mean.
fn sizes_of_changes(input: &[f64]) -> Vec<f64> {
    let pairs = input.iter().zip(input.iter().skip(1));
    let sizes = pairs.map(|(before, after)| (after - before).abs());
    centred(&sizes.chain([f64::NAN]).collect::<Vec<f64>>())
}

/// The gain at a frequency, relative to that at rest.
fn share_followed(fit: &GlsFit, omega: f64) -> f64 {
    let theta = fit.theta();
    let (re, im) = fit.coordinates.basis.frequency_response(&theta, omega);
    re.hypot(im) / theta[0].abs()
}

/// About their mean; 0 where missing.
fn centred(values: &[f64]) -> Vec<f64> {
    let present = values.iter().filter(|value| !value.is_nan());
    let (sum, count) = present.fold((0.0, 0usize), |(sum, n), value| (sum + value, n + 1));
    let mean = sum / count.max(1) as f64;
    let about = |value: &f64| if value.is_nan() { 0.0 } else { value - mean };
    values.iter().map(about).collect()
}

/// The periodogram, from frequency 0 up to half the sampling rate.
fn power(values: &[f64]) -> Vec<f64> {
    let forward = servoid_fft::forward(values.len().next_power_of_two());
    let (mut block, mut spectrum) = (forward.make_input_vec(), forward.make_output_vec());
    block[..values.len()].copy_from_slice(&windowed(values));
    forward
        .process(&mut block, &mut spectrum)
        .expect("buffers come from the plan");
    spectrum.iter().map(|value| value.norm_sqr()).collect()
}

/// Frequencies on both sides of a line.
fn beside(power: &[f64], j: usize) -> [&[f64]; 2] {
    let reach = NEIGHBOURS + OF_LINE;
    [
        &power[j - reach..j - OF_LINE],
        &power[j + OF_LINE + 1..=j + reach],
    ]
}

/// Whether [`above_neighbours`] can be beyond [`ABOVE_NEIGHBOURS`]: half of the neighbours are low enough. To count them is
/// cheap, and there are hardly any frequencies where they are.
fn may_be_line(power: &[f64], j: usize) -> bool {
    /// Beyond all rounding.
    const MARGIN: f64 = 1.0 + 1e-9;
    let limit = MARGIN * power[j] * LN_2 / ABOVE_NEIGHBOURS;
    let low = |part: &[f64]| part.iter().map(|p| u32::from(*p < limit)).sum::<u32>();
    beside(power, j).map(low).iter().sum::<u32>() as usize > NEIGHBOURS
}

/// Power over that of the neighbours.
fn above_neighbours(power: &[f64], j: usize) -> f64 {
    let mut beside = beside(power, j).concat();
    let middle = beside.len() / 2;
    let median = *beside.select_nth_unstable_by(middle, f64::total_cmp).1;
    power[j] * LN_2 / median.max(f64::MIN_POSITIVE)
}

/// The frequency of the line that is farthest above its neighbours \[rad/sample\], where the reference has none; `None`
/// where there is none.
fn strongest(errors: &[f64], reference: &impl Deref<Target = Vec<f64>>) -> Option<f64> {
    let count = errors.len();
    let power = power(errors);
    let size = count.next_power_of_two();
    let reach = NEIGHBOURS + OF_LINE;
    let lowest = (CYCLES * size / count.max(1)).max(reach);
    let candidates = lowest..power.len().saturating_sub(reach);
    let line = candidates
        .filter(|j| may_be_line(&power, *j))
        .map(|j| (j, above_neighbours(&power, j)))
        .filter(|(_, ratio)| *ratio > ABOVE_NEIGHBOURS)
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let bin = line?.0;
    let omega = TAU * bin as f64 / size as f64;
    (!has_line(reference, omega)).then(|| refined(errors, omega, TAU / size as f64))
}

/// Whether a periodogram has a line at a frequency.
fn has_line(power: &[f64], omega: f64) -> bool {
    let reach = NEIGHBOURS + OF_LINE;
    // From 0 up to half the rate of sampling.
    let bin = (omega / PI * (power.len() - 1) as f64).round() as usize;
    (bin.saturating_sub(OF_LINE)..=bin + OF_LINE)
        .filter(|j| (reach..power.len().saturating_sub(reach)).contains(j))
        .any(|j| above_neighbours(power, j) > LINE_OF_REFERENCE)
}

/// `values` times Hann's window.
fn windowed(values: &[f64]) -> Vec<f64> {
    let count = values.len() as f64;
    let hann = |k: usize| 1.0 - (TAU * (k as f64 + 0.5) / count).cos();
    (0..)
        .zip(values)
        .map(|(k, value)| value * hann(k))
        .collect()
}

/// The frequency of the largest power within a bin of `omega`, by golden section.
fn refined(errors: &[f64], omega: f64, bin: f64) -> f64 {
    const GOLDEN: f64 = 0.618_034;
    let errors = windowed(errors);
    let power_at = |omega: f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for (k, weighted) in errors.iter().enumerate() {
            let (sin, cos) = (omega * k as f64).sin_cos();
            re += weighted * cos;
            im += weighted * sin;
        }
        re * re + im * im
    };
    let (mut low, mut high) = (omega - bin, omega + bin);
    for _ in 0..30 {
        let width = GOLDEN * (high - low);
        let (a, b) = (high - width, low + width);
        if power_at(a) > power_at(b) {
            high = b
        } else {
            low = a
        }
    }
    f64::midpoint(low, high)
}

/// Cosine and sine by least squares over the values that are there.
fn parts(values: &[f64], omega: f64) -> (f64, f64) {
    let (mut cc, mut cs, mut ss, mut c, mut s) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (k, value) in values
        .iter()
        .enumerate()
        .filter(|(_, value)| **value != 0.0)
    {
        let (sin, cos) = (omega * k as f64).sin_cos();
        cc += cos * cos;
        cs += cos * sin;
        ss += sin * sin;
        c += cos * value;
        s += sin * value;
    }
    let determinant = cc * ss - cs * cs;
    match determinant > 0.0 {
        true => (
            (ss * c - cs * s) / determinant,
            (cc * s - cs * c) / determinant,
        ),
        false => (0.0, 0.0),
    }
}
