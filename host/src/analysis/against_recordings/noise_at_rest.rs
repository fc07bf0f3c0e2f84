//! The noise of a recording, from the errors of a model where the servo rests.
//!
//! At rest a wrong model is off by a constant, so what scatters about the mean of each rest is noise. Drift that is slower than a rest is not in it.

use servoid_identification::Run;

/// A model is at rest while its output stays within this part of its range.
const STILL: f64 = 0.005;

/// Samples of a rest, at least: a shorter one says more of its own mean than of the noise.
const SHORTEST: usize = 8;

/// Samples at rest that show the noise: to 7 %, a standard deviation.
const FEWEST: usize = 100;

/// The noise of the runs (rms), where `simulated` by a model rests; `None` where that is too seldom.
pub(crate) fn noise_at_rest(runs: &[Run<'_>], simulated: &[Vec<f64>]) -> Option<f64> {
    let known = || simulated.iter().flatten().copied().filter(|s| !s.is_nan());
    let highest = known().fold(f64::NEG_INFINITY, f64::max);
    let lowest = known().fold(f64::INFINITY, f64::min);
    let still = STILL * (highest - lowest);
    let (mut square, mut degrees) = (0.0, 0);
    for (run, simulated) in runs.iter().zip(simulated) {
        for errors in rests(run, simulated, still) {
            let mean = errors.iter().sum::<f64>() / errors.len() as f64;
            square += errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>();
            degrees += errors.len() - 1;
        }
    }
    (degrees >= FEWEST).then(|| (square / degrees as f64).sqrt())
}

/// The errors of each stretch over which the model stays within `still` of where the stretch begins.
fn rests(run: &Run<'_>, simulated: &[f64], still: f64) -> Vec<Vec<f64>> {
    let mut rests: Vec<Vec<f64>> = Vec::new();
    let mut current: Vec<f64> = Vec::new();
    let mut from = f64::NAN;
    for (measured, simulated) in run.output().iter().zip(simulated) {
        let error = measured - simulated;
        let stays = (simulated - from).abs() <= still && !error.is_nan();
        if !stays {
            rests.push(std::mem::take(&mut current));
            from = *simulated;
        }
        current.extend((!error.is_nan()).then_some(error));
    }
    rests.push(current);
    rests.retain(|rest| rest.len() >= SHORTEST);
    rests
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A servo that a model misses by 3 in motion and by 1 at rest, with noise of ±0.2 from sample to sample.
    #[test]
    fn noise_is_what_scatters_at_rest() {
        let noise = |k: usize| if k.is_multiple_of(2) { 0.2 } else { -0.2 };
        let simulated: Vec<f64> = (0..1000).map(|k| (k % 100).min(20) as f64).collect();
        let missed = |k: usize| if k % 100 < 20 { 3.0 } else { 1.0 };
        let measured: Vec<f64> = (simulated.iter().enumerate())
            .map(|(k, s)| s + missed(k) + noise(k))
            .collect();
        let run = Run::new(vec![0.0; 1000], measured).unwrap();
        let found = noise_at_rest(&[run], &[simulated]).unwrap();
        assert!((found - 0.2).abs() < 0.01, "{found}");
        let few = Run::new(vec![0.0; 50], vec![1.0; 50]).unwrap();
        assert_eq!(noise_at_rest(&[few], &[vec![1.0; 50]]), None);
    }
}
