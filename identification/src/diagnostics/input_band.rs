//! From which frequency on an input has power.

use crate::data::Record;
use crate::diagnostics::filtered_rows::present;

/// Share of the power of an input below the frequency that is named as its beginning. A logarithmic sweep over two decades has as much in the first 5 % above its
/// lowest frequency.
const BELOW: f64 = 1e-2;

/// The lowest frequency of the inputs of `record` \[rad/s\]; `None` where they have no power.
pub(crate) fn lowest_excited(record: &Record) -> Option<f64> {
    let longest = record.runs().iter().map(crate::data::Run::len).max()?;
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
