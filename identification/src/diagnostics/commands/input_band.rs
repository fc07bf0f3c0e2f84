//! From which frequency on an input has power, and when it comes back.

use crate::data::{Record, Run};
use crate::diagnostics::residuals::filtered_rows::present;
use crate::numerics::dot;

/// Share of the power of an input below the frequency that is named as its beginning. A logarithmic sweep over two decades has as much in the first 5 % above its
/// lowest frequency.
const BELOW: f64 = 1e-2;

/// Correlation of an input with itself at which it has come back, and the one below which it was away. A sum of sines of whole periods that are not whole numbers of rows has
/// .95 and more.
const BACK: f64 = 0.9;
const AWAY: f64 = 0.5;

/// Samples that are looked at for that, in those of the longest period.
const LOOKED_AT: usize = 20;

/// The shortest time of up to `longest` after which an input of `record` comes back, but for rounding, noise of its column and the part of a row \[samples\]; `None` where none does.
pub(crate) fn comes_back(record: &Record, longest: usize) -> Option<usize> {
    let of_run = |run: &Run| {
        let input = &run.input()[..run.len().min(LOOKED_AT * longest)];
        let known = || input.iter().filter(|u| !u.is_nan());
        let mean = known().sum::<f64>() / known().count().max(1) as f64;
        let centred: Vec<f64> = input.iter().map(|u| present(u - mean)).collect();
        let correlation = |lag: &usize| {
            let (now, before) = (&centred[*lag..], &centred[..centred.len() - lag]);
            dot(now, before) / (dot(now, now) * dot(before, before)).sqrt()
        };
        let longest = longest.min(centred.len() / 2);
        let away = (1..=longest).find(|lag| correlation(lag) < AWAY)?;
        (away..=longest).find(|lag| correlation(lag) > BACK)
    };
    record.runs().iter().filter_map(of_run).min()
}

/// The lowest frequency of the inputs of `record` \[rad/s\]; `None` where they have no power.
pub(crate) fn lowest_excited(record: &Record) -> Option<f64> {
    let longest = record.runs().iter().map(Run::len).max()?;
    let size = longest.next_power_of_two();
    let forward = servoid_fft::forward(size);
    let (mut block, mut spectrum) = (forward.make_input_vec(), forward.make_output_vec());
    let mut power = vec![0.0; spectrum.len()];
    for run in record.runs() {
        let known: Vec<f64> = run
            .input()
            .iter()
            .copied()
            .filter(|u| !u.is_nan())
            .collect();
        let mean = known.iter().sum::<f64>() / known.len().max(1) as f64;
        block.fill(0.0);
        for (place, u) in block.iter_mut().zip(run.input()) {
            *place = present(u - mean);
        }
        (forward.process(&mut block, &mut spectrum)).expect("buffers come from the plan");
        for (sum, value) in power.iter_mut().zip(&spectrum) {
            *sum += value.norm_sqr();
        }
    }
    let all: f64 = power.iter().sum();
    let below = power.iter().scan(0.0, |sum, value| {
        *sum += value;
        Some(*sum)
    });
    let bin = below.take_while(|sum| *sum < BELOW * all).count();
    let spacing = std::f64::consts::TAU / (size as f64 * record.sample_period_s());
    (all > 0.0).then_some(bin as f64 * spacing)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The time at which lines at all multiples of .2 Hz come back, 5 s, is 487.8 rows of 10.25 ms: it is back for nearly all of it one row before. A sweep does not come back.
    #[test]
    fn a_sum_of_sines_comes_back_between_rows_and_a_sweep_does_not() {
        let lines = |k: usize| -> f64 {
            let line =
                |i: i32| (1.2566 * f64::from(i) * 0.01025 * k as f64 + f64::from(i * i)).sin();
            (1..=50).map(line).sum()
        };
        let sweep = |k: usize| (2e-3 * k as f64 + 2e-5 * (k * k) as f64).sin();
        let found = |input: Vec<f64>| {
            let record = Record::of_run(0.01025, input.clone(), input).unwrap();
            comes_back(&record, 1000)
        };
        assert_eq!(found((0..4000).map(lines).collect()), Some(487));
        assert_eq!(found((0..4000).map(sweep).collect()), None);
    }
}
