//! Causal filtering with a finite impulse response.

/// Below this many products the direct sum is faster than setting up transforms.
const DIRECT_PRODUCTS: usize = 1 << 16;

/// y(k) = sum_i h_i u(k-i), NaN where one of the inputs is missing. Inputs before the first equal
/// `at_rest`, or are missing.
pub fn causal_filter(impulse: &[f64], input: &[f64], at_rest: Option<f64>) -> Vec<f64> {
    let lags = impulse.len();
    let history = lags.saturating_sub(1);
    let at_rest = at_rest.filter(|value| !value.is_nan());
    let present = |value: &f64| if value.is_nan() { 0.0 } else { *value };
    let mut padded = Vec::with_capacity(history + input.len());
    padded.resize(history, at_rest.unwrap_or(0.0));
    padded.extend(input.iter().map(present));
    let mut output = if lags * input.len() <= DIRECT_PRODUCTS {
        padded
            .windows(lags.max(1))
            .map(|window| window.iter().rev().zip(impulse).map(|(u, h)| u * h).sum())
            .collect()
    } else {
        overlap_save(impulse, &padded)
    };
    output.truncate(input.len());
    // Inputs since the last missing one.
    let mut known = at_rest.map_or(0, |_| history);
    for (value, u) in output.iter_mut().zip(input) {
        known = if u.is_nan() { 0 } else { known + 1 };
        if known < lags {
            *value = f64::NAN;
        }
    }
    output
}

/// The fully overlapped part of the convolution of `padded` with `impulse`, by the overlap-save
/// method.
fn overlap_save(impulse: &[f64], padded: &[f64]) -> Vec<f64> {
    let history = impulse.len() - 1;
    let size = (8 * impulse.len()).next_power_of_two().max(1024);
    let (forward, inverse) = (servoid_fft::forward(size), servoid_fft::inverse(size));
    let mut block = forward.make_input_vec();
    let mut response = forward.make_output_vec();
    block[..impulse.len()].copy_from_slice(impulse);
    forward
        .process(&mut block, &mut response)
        .expect("buffers come from the plan");
    let mut spectrum = forward.make_output_vec();
    let mut scratch = forward.make_scratch_vec();
    let mut scratch_back = inverse.make_scratch_vec();
    let mut output = Vec::with_capacity(padded.len());
    let step = size - history;
    for start in (0..padded.len().saturating_sub(history)).step_by(step) {
        let end = (start + size).min(padded.len());
        block[..end - start].copy_from_slice(&padded[start..end]);
        block[end - start..].fill(0.0);
        forward
            .process_with_scratch(&mut block, &mut spectrum, &mut scratch)
            .expect("buffers come from the plan");
        for (value, factor) in spectrum.iter_mut().zip(&response) {
            *value = *value * *factor / size as f64;
        }
        // The imaginary parts at zero and at the Nyquist frequency vanish, as the inverse requires.
        inverse
            .process_with_scratch(&mut spectrum, &mut block, &mut scratch_back)
            .expect("buffers come from the plan");
        output.extend_from_slice(&block[history..end - start]);
    }
    output
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn transforms_agree_with_the_direct_sum() {
        let impulse: Vec<f64> = (0..100).map(|i| (f64::from(i) * 0.37).cos()).collect();
        let input: Vec<f64> = (0..5000).map(|k| f64::from(k * k % 23) - 11.0).collect();
        let fast = causal_filter(&impulse, &input, Some(2.0));
        for k in (0..5000).step_by(7) {
            let direct: f64 = (0..100)
                .map(|i| impulse[i] * if k >= i { input[k - i] } else { 2.0 })
                .sum();
            // Sums of 100 products of about 10, by transforms of 1024 points.
            assert_abs_diff_eq!(fast[k], direct, epsilon = 1e-10);
        }
    }

    #[test]
    fn a_missing_input_removes_as_many_outputs_as_there_are_lags() {
        let mut input = vec![1.0; 10];
        input[4] = f64::NAN;
        let output = causal_filter(&[0.5, 0.25, 0.25], &input, None);
        let missing: Vec<usize> = (0..10).filter(|&k| output[k].is_nan()).collect();
        assert_eq!(missing, [0, 1, 4, 5, 6]);
        assert_eq!(output[9], 1.0);
    }
}
