//! Sums over slices.

/// Running sums of `values`.
pub(crate) fn running_sum(values: &[f64]) -> Vec<f64> {
    values
        .iter()
        .scan(0.0, |sum, value| {
            *sum += value;
            Some(*sum)
        })
        .collect()
}

/// Sum of squares of the distances from the mean.
pub(crate) fn square_about_mean(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|value| (value - mean).powi(2)).sum()
}

/// Largest difference between the elements of two slices, the shorter one continued by zeros.
pub(crate) fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    (0..a.len().max(b.len()))
        .map(|i| (a.get(i).unwrap_or(&0.0) - b.get(i).unwrap_or(&0.0)).abs())
        .fold(0.0, f64::max)
}

/// Adds the sum of `factors` times their sources to `target`, over the common length of all. Four at a time: values are added in the
/// same order as one source after the other, and `target` goes through memory a quarter as often.
pub(crate) fn add_combination<'a>(
    target: &mut [f64],
    factors: &[f64],
    source: impl Fn(usize) -> &'a [f64],
) {
    let length = (0..factors.len()).fold(target.len(), |least, i| least.min(source(i).len()));
    let target = &mut target[..length];
    let source = |i: usize| &source(i)[..length];
    let (fours, rest) = factors.as_chunks::<4>();
    for (of_four, [a, b, c, d]) in fours.iter().enumerate() {
        let first = 4 * of_four;
        let (p, q) = (source(first), source(first + 1));
        let (r, s) = (source(first + 2), source(first + 3));
        for k in 0..length {
            target[k] = target[k] + a * p[k] + b * q[k] + c * r[k] + d * s[k];
        }
    }
    for (factor, i) in rest.iter().zip(4 * fours.len()..) {
        for (sum, value) in target.iter_mut().zip(source(i)) {
            *sum += factor * value;
        }
    }
}

/// Inner product over the common length. Eight independent sums fit vector registers.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let length = a.len().min(b.len());
    let (a, b) = (a[..length].chunks_exact(8), b[..length].chunks_exact(8));
    let rest = a.remainder().iter().zip(b.remainder());
    let rest: f64 = rest.map(|(x, y)| x * y).sum();
    let mut sums = [0.0; 8];
    for (a, b) in a.zip(b) {
        for ((sum, x), y) in sums.iter_mut().zip(a).zip(b) {
            *sum += x * y;
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_combination_is_one_source_after_the_other_to_the_last_digit() {
        let source = |i: usize| -> Vec<f64> {
            (0..37)
                .map(|k| (k as f64 * (0.3 + i as f64)).sin())
                .collect()
        };
        for count in 0..10 {
            let factors: Vec<f64> = (0..count).map(|i| 1.0 / (i as f64 - 2.5)).collect();
            let sources: Vec<Vec<f64>> = (0..count).map(source).collect();
            let mut found = source(20);
            let mut expected = found.clone();
            add_combination(&mut found, &factors, |i| &sources[i]);
            for (factor, source) in factors.iter().zip(&sources) {
                for (sum, value) in expected.iter_mut().zip(source) {
                    *sum += factor * value;
                }
            }
            assert_eq!(found, expected);
        }
    }
}
