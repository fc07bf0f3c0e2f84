//! Means of parts of a sequence, in which what lasts shows and noise does not.

/// Middles and means of stretches of `length` values, those with fewer than half of them left out.
pub(crate) fn part_means(values: &[f64], length: usize) -> Vec<(f64, f64)> {
    let mean = |(number, part): (usize, &[f64])| {
        let present = || part.iter().filter(|v| !v.is_nan());
        let count = present().count();
        let middle = (number * length) as f64 + part.len() as f64 / 2.0;
        (2 * count >= length).then(|| (middle, present().sum::<f64>() / count as f64))
    };
    values.chunks(length).enumerate().filter_map(mean).collect()
}
