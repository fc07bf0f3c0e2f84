//! The power of a reference by frequency, beside the noise.

use super::request::PlanRequest;
use super::simulated_runs;
use serde::Serialize;
use servoid_identification::results::Model;
use servoid_protocol::{PulseTrain, Reference};
use std::f64::consts::TAU;

/// The power between two frequencies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Octave {
    /// Lower edge (Hz).
    pub from_hz: f64,
    /// Upper edge (Hz).
    pub to_hz: f64,
    /// Root mean square of the reference in it (deg).
    pub rms_deg: f64,
    /// Its share of the reference's power, the mean left out (percent).
    pub share_percent: f64,
    /// Power of the servo's response over the power of the noise (dB).
    pub signal_to_noise_db: f64,
}

/// The power densities at one frequency.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Density {
    /// Frequency (Hz).
    pub hz: f64,
    /// Density of the reference (dB over 1 deg²/Hz).
    pub reference_db: f64,
    /// Density of the servo's response (dB over 1 deg²/Hz).
    pub response_db: f64,
    /// Density of the noise (dB over 1 deg²/Hz).
    pub noise_db: f64,
}

/// The power of a reference by frequency.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spectrum {
    /// Largest offset over the root mean square.
    pub crest_factor: f64,
    /// Root mean square about the mean (deg).
    pub rms_deg: f64,
    /// 99 % of the power lies below this frequency (Hz).
    pub most_below_hz: f64,
    /// Lower end of the octaves in which the servo's response is above the noise (Hz).
    pub above_noise_from_hz: f64,
    /// Upper end of these octaves (Hz); 0 where there are none.
    pub above_noise_up_to_hz: f64,
    /// The first frequency without power, if the kind of reference has one (Hz).
    pub first_gap_hz: Option<f64>,
    /// The power by octaves.
    pub octaves: Vec<Octave>,
    /// Densities on a logarithmic grid, for a plot.
    pub lines: Vec<Density>,
}

/// The lowest edge of the octaves (Hz), and how many there are: up to 128 Hz.
const LOWEST_EDGE_HZ: f64 = 0.25;
const OCTAVES: i32 = 9;

/// Densities in each octave of the plot.
const PER_OCTAVE: i32 = 6;

/// A line of the discrete spectrum: frequency (Hz), mean squares of reference and response (deg²).
struct Power {
    hz: f64,
    reference: f64,
    response: f64,
}

impl Spectrum {
    pub(super) fn of(request: &PlanRequest) -> Self {
        let model = &request.assumed.model;
        let input = simulated_runs::input(request);
        let count = input.len() as f64;
        let mean = input.iter().sum::<f64>() / count;
        let deviations = || input.iter().map(|u| u - mean);
        let rms = (deviations().map(|u| u.powi(2)).sum::<f64>() / count).sqrt();
        let peak = deviations().map(f64::abs).fold(0.0, f64::max);
        let lines = periodogram(&input, mean, model);
        let total: f64 = lines.iter().map(|line| line.reference).sum();
        let octaves = octaves(&lines, model, total);
        let (mut sum, mut most_below_hz) = (0.0, 0.0);
        for line in &lines {
            if sum < 0.99 * total {
                most_below_hz = line.hz;
            }
            sum += line.reference;
        }
        // A short table of steps may have no power in the lowest octaves.
        let is_above = |octave: &&Octave| octave.signal_to_noise_db > 0.0;
        let from_first = octaves.iter().skip_while(|octave| !is_above(octave));
        let mut above = from_first.take_while(is_above);
        let lowest = above.next();
        let highest = above.last().or(lowest);
        Self {
            crest_factor: peak / rms,
            rms_deg: rms,
            most_below_hz,
            above_noise_from_hz: lowest.map_or(0.0, |octave| octave.from_hz),
            above_noise_up_to_hz: highest.map_or(0.0, |octave| octave.to_hz),
            first_gap_hz: first_gap_hz(&request.reference, request.assumed.train),
            octaves,
            lines: densities(&lines, model),
        }
    }
}

/// Mean squares of every line but the mean, of one run without a window.
fn periodogram(input: &[f64], mean: f64, model: &Model) -> Vec<Power> {
    let mut signal: Vec<f64> = input.iter().map(|u| u - mean).collect();
    let transform = servoid_fft::forward(signal.len());
    let mut spectrum = transform.make_output_vec();
    // The buffers were made for it.
    if transform.process(&mut signal, &mut spectrum).is_err() {
        return Vec::new();
    }
    let count = input.len() as f64;
    let impulse = model.impulse_response();
    let lines = spectrum.iter().enumerate().skip(1);
    lines
        .map(|(l, value)| {
            // Half of the power of a line is at its negative frequency. The last line has none.
            let both = if 2 * l == input.len() { 1.0 } else { 2.0 };
            let hz = l as f64 / count / model.sample_period_s;
            let reference = both * value.norm_sqr() / (count * count);
            Power {
                hz,
                reference,
                response: reference * squared_size(&impulse, hz * model.sample_period_s),
            }
        })
        .collect()
}

/// |Σ h_k e^(-jωk)|² at a frequency in turns for each sample.
fn squared_size(h: &[f64], turns: f64) -> f64 {
    let step = TAU * turns;
    let (sin, cos) = step.sin_cos();
    // e^(-jωk) by recursion: one sine for all terms.
    let ((mut c, mut s), (mut re, mut im)) = ((1.0, 0.0), (0.0, 0.0));
    for h in h {
        re += h * c;
        im -= h * s;
        (c, s) = (c * cos - s * sin, s * cos + c * sin);
    }
    re * re + im * im
}

/// Density of the noise (deg²/Hz): 2 Ts σ²/|D|².
fn noise_density(model: &Model, hz: f64) -> f64 {
    let d: Vec<f64> = std::iter::once(1.0)
        .chain(model.noise.ar.iter().copied())
        .collect();
    2.0 * model.sample_period_s * model.noise.sigma.powi(2)
        / squared_size(&d, hz * model.sample_period_s)
}

fn db(power: f64) -> f64 {
    10.0 * power.log10()
}

fn within(lines: &[Power], from_hz: f64, to_hz: f64) -> (f64, f64) {
    let lines = lines.iter().filter(|l| (from_hz..to_hz).contains(&l.hz));
    lines.fold((0.0, 0.0), |(u, y), l| (u + l.reference, y + l.response))
}

fn octaves(lines: &[Power], model: &Model, total: f64) -> Vec<Octave> {
    let edge = |octave: i32| LOWEST_EDGE_HZ * 2f64.powi(octave);
    // The lowest octave includes all power below it.
    (0..OCTAVES)
        .map(|octave| {
            let from_hz = if octave == 0 { 0.0 } else { edge(octave) };
            let to_hz = edge(octave + 1);
            let (reference, response) = within(lines, from_hz, to_hz);
            let middle = (from_hz.max(LOWEST_EDGE_HZ) * to_hz).sqrt();
            let noise = noise_density(model, middle) * (to_hz - from_hz);
            Octave {
                from_hz,
                to_hz,
                rms_deg: reference.sqrt(),
                share_percent: 100.0 * reference / total,
                // The floor of -200 dB stands for an octave without power.
                signal_to_noise_db: db((response / noise).max(1e-20)),
            }
        })
        .collect()
}

fn densities(lines: &[Power], model: &Model) -> Vec<Density> {
    let edge = |k: i32| LOWEST_EDGE_HZ * 2f64.powf(f64::from(k) / f64::from(PER_OCTAVE));
    (0..OCTAVES * PER_OCTAVE)
        .filter_map(|k| {
            let (from, to) = (edge(k), edge(k + 1));
            let (reference, response) = within(lines, from, to);
            let hz = (from * to).sqrt();
            // A short run has no line in some of these intervals.
            (reference > 0.0).then(|| Density {
                hz,
                reference_db: db(reference / (to - from)),
                response_db: db(response / (to - from)),
                noise_db: db(noise_density(model, hz)),
            })
        })
        .collect()
}

/// A value held for a time T has no power at 1/T.
fn first_gap_hz(reference: &Reference, train: PulseTrain) -> Option<f64> {
    let hold_frames = match reference {
        Reference::Stairs(stairs) => stairs.hold_frames,
        Reference::Prbs(prbs) => prbs.chip_frames,
        Reference::Sweep(_) | Reference::Multisine(_) => 1,
        Reference::Staircase(_) | Reference::Steps(_) => return None,
    };
    Some(1.0 / (f64::from(hold_frames) * train.frame_s()))
}
