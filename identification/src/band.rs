//! Critical values: how many standard deviations make a band.

use statrs::distribution::{Continuous, ContinuousCDF, StudentsT};
use statrs::function::erf::{erfc, erfc_inv};

/// Abscissae and weights of the 24-point Gauss-Legendre rule on [-1, 1], positive half.
const GAUSS_LEGENDRE_24: [(f64, f64); 12] = [
    (0.064_056_892_862_605_63, 0.127_938_195_346_752_16),
    (0.191_118_867_473_616_3, 0.125_837_456_346_828_3),
    (0.315_042_679_696_163_4, 0.121_670_472_927_803_39),
    (0.433_793_507_626_045_14, 0.115_505_668_053_725_6),
    (0.545_421_471_388_839_5, 0.107_444_270_115_965_63),
    (0.648_093_651_936_975_6, 0.097_618_652_104_113_89),
    (0.740_124_191_578_554_4, 0.086_190_161_531_953_27),
    (0.820_001_985_973_902_9, 0.073_346_481_411_080_31),
    (0.886_415_527_004_401, 0.059_298_584_915_436_78),
    (0.938_274_552_002_732_8, 0.044_277_438_817_419_81),
    (0.974_728_555_971_309_5, 0.028_531_388_628_933_66),
    (0.995_187_219_997_021_4, 0.012_341_229_799_987_2),
];

/// Φ(x), the standard normal distribution function.
#[must_use]
pub fn normal_cdf(x: f64) -> f64 {
    0.5 * erfc(-x / std::f64::consts::SQRT_2)
}

/// x with Φ(-x) = `tail`.
#[must_use]
pub fn normal_upper_quantile(tail: f64) -> f64 {
    std::f64::consts::SQRT_2 * erfc_inv(2.0 * tail)
}

/// Two-sided critical value of one normal quantity: 2.5758 for 0.99.
#[must_use]
pub fn pointwise_critical(level: f64) -> f64 {
    normal_upper_quantile((1.0 - level) / 2.0)
}

/// c such that a Gaussian curve stays within c standard deviations at all its points at once with
/// probability of at least `level`, from the correlations of neighbouring points (Hunter 1976;
/// Worsley 1982):
///
/// ```text
/// P(max|Z| > c) <= 2 Φ(-c) + sum_m P(|Z_{m+1}| > c, |Z_m| <= c)
/// ```
///
/// No sampling and no seed; 0-9 % above the exact value, and never above Bonferroni's.
#[must_use]
pub fn simultaneous_critical(neighbour_correlation: &[f64], level: f64) -> f64 {
    let target = (1.0 - level).ln();
    let excess = |c: f64| exceedance_bound(neighbour_correlation, c).ln() - target;
    // ln P is smooth and concave in c: the secant rule from two points near the solution.
    let points = (neighbour_correlation.len() + 1) as f64;
    let mut older = pointwise_critical(level);
    let mut newer = normal_upper_quantile((1.0 - level) / (2.0 * points)).max(older + 1e-3);
    let (mut older_excess, mut newer_excess) = (excess(older), excess(newer));
    for _ in 0..30 {
        if newer_excess.abs() < 1e-10 || older_excess == newer_excess {
            break;
        }
        let next = newer - newer_excess * (newer - older) / (newer_excess - older_excess);
        (older, older_excess) = (newer, newer_excess);
        newer = next;
        newer_excess = excess(newer);
    }
    newer
}

/// The right side of Hunter and Worsley's inequality.
fn exceedance_bound(neighbour_correlation: &[f64], c: f64) -> f64 {
    // P(|Z'| > c, |Z| <= c) = 2 int_c^inf φ(x) P(|Z| <= c | x) dx; nothing is left beyond c + 6.
    const WIDTH: f64 = 6.0;
    let nodes: Vec<(f64, f64)> = GAUSS_LEGENDRE_24
        .iter()
        .flat_map(|&(x, w)| [(-x, w), (x, w)])
        .map(|(x, w)| {
            let x = c + WIDTH / 2.0 * (1.0 + x);
            let density = (-x * x / 2.0).exp() / std::f64::consts::TAU.sqrt();
            (x, w * WIDTH / 2.0 * density)
        })
        .collect();
    let pairs: f64 = neighbour_correlation
        .iter()
        .map(|r| {
            let r = r.abs();
            let q = (1.0 - r * r).sqrt().max(1e-12);
            nodes
                .iter()
                .map(|&(x, weight)| {
                    let below = (-c - r * x) / q;
                    // Φ(-8.3) is below the rounding of what it is taken from.
                    let below = if below < -8.3 { 0.0 } else { normal_cdf(below) };
                    weight * (normal_cdf((c - r * x) / q) - below)
                })
                .sum::<f64>()
        })
        .sum();
    2.0 * normal_cdf(-c) + 2.0 * pairs
}

/// Student's t quantile with the tail probability of the normal quantile `normal`, for many
/// degrees of freedom at once.
#[must_use]
pub fn student_critical(normal: f64, degrees_of_freedom: &[f64]) -> Vec<f64> {
    let smallest = degrees_of_freedom
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min);
    let exact = |degrees: f64| student_quantile(normal, degrees);
    if degrees_of_freedom.len() <= NODES || smallest < 8.0 {
        return degrees_of_freedom
            .iter()
            .map(|&degrees| exact(degrees))
            .collect();
    }
    // The quantile is a smooth function of 1/ν (Cornish and Fisher's expansion): a polynomial
    // through a few points serves all.
    let range = 1.0 / smallest;
    let nodes: Vec<(f64, f64)> = (0..NODES)
        .map(|k| {
            let angle = std::f64::consts::PI * (k as f64 + 0.5) / NODES as f64;
            let x = range / 2.0 * (1.0 - angle.cos());
            (x, exact(1.0 / x))
        })
        .collect();
    degrees_of_freedom
        .iter()
        .map(|&degrees| lagrange(&nodes, 1.0 / degrees))
        .collect()
}

/// Nodes of the interpolation over 1/ν.
const NODES: usize = 8;

/// Student's t quantile with the tail probability of the normal quantile `x`.
fn student_quantile(x: f64, degrees: f64) -> f64 {
    // Cornish and Fisher's expansion (Abramowitz & Stegun 26.7.5).
    let square = x * x;
    let terms = [
        x * (square + 1.0) / 4.0,
        x * ((5.0 * square + 16.0) * square + 3.0) / 96.0,
        x * (((3.0 * square + 19.0) * square + 17.0) * square - 15.0) / 384.0,
        x * ((((79.0 * square + 776.0) * square + 1482.0) * square - 1920.0) * square - 945.0)
            / 92160.0,
    ];
    let start = x + terms
        .iter()
        .rev()
        .fold(0.0, |sum, term| (sum + term) / degrees);
    // Beyond this its first omitted term is below 1e-12 for any level in use.
    if degrees > 1e4 {
        return start;
    }
    let Ok(student) = StudentsT::new(0.0, 1.0, degrees) else {
        return start;
    };
    // Newton's rule on the logarithm of the tail over that of t: nearly straight for heavy tails.
    let target = normal_cdf(-x).ln();
    let mut t = start;
    for _ in 0..50 {
        let tail = student.sf(t);
        let step = (tail.ln() - target) * tail / (student.pdf(t) * t);
        t *= step.exp();
        if step.abs() < 1e-11 {
            break;
        }
    }
    t
}

fn lagrange(nodes: &[(f64, f64)], x: f64) -> f64 {
    nodes
        .iter()
        .enumerate()
        .map(|(i, &(xi, yi))| {
            let others = nodes.iter().enumerate().filter(|&(j, _)| j != i);
            yi * others
                .map(|(_, &(xj, _))| (x - xj) / (xi - xj))
                .product::<f64>()
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn quantiles_agree_with_printed_tables() {
        assert_abs_diff_eq!(pointwise_critical(0.99), 2.575_829_303_5, epsilon = 1e-9);
        assert_abs_diff_eq!(pointwise_critical(0.95), 1.959_963_984_5, epsilon = 1e-9);
        // Student's t, 0.995: 10 and 30 degrees of freedom (printed to four digits).
        let normal = pointwise_critical(0.99);
        let t = student_critical(normal, &[10.0, 30.0, 1.0]);
        assert_abs_diff_eq!(t[2], 63.657, epsilon = 5e-4);
        assert_abs_diff_eq!(t[0], 3.1693, epsilon = 5e-5);
        assert_abs_diff_eq!(t[1], 2.7500, epsilon = 5e-5);
    }

    #[test]
    fn the_interpolated_quantiles_are_the_exact_ones() {
        let degrees: Vec<f64> = (0..200).map(|k| 8.0 * 1.06f64.powi(k)).collect();
        for normal in [2.0, 2.5758, 4.1] {
            let many = student_critical(normal, &degrees);
            for (degrees, value) in degrees.iter().zip(&many) {
                let one = student_critical(normal, &[*degrees])[0];
                // A ten-thousandth of a standard deviation is beyond any use of a band.
                assert_abs_diff_eq!(one, *value, epsilon = 1e-4);
            }
        }
    }

    #[test]
    fn independent_points_need_a_little_less_than_bonferroni_and_equal_ones_nothing_extra() {
        let independent = simultaneous_critical(&[0.0; 150], 0.99);
        // Exact for independent points: Φ(c)^151-like; 1 - 0.99^(1/151) two-sided.
        let exact = normal_upper_quantile((1.0 - 0.99f64.powf(1.0 / 151.0)) / 2.0);
        let bonferroni = normal_upper_quantile(0.01 / 302.0);
        assert!(exact - 1e-6 <= independent && independent <= bonferroni + 1e-6);
        let equal = simultaneous_critical(&[1.0; 150], 0.99);
        assert_abs_diff_eq!(equal, pointwise_critical(0.99), epsilon = 1e-6);
    }

    #[test]
    fn a_random_walk_stays_inside_as_often_as_promised() {
        use rand::SeedableRng;
        use rand_distr::{Distribution, StandardNormal};
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(11);
        let r = 0.9f64;
        let c = simultaneous_critical(&[r; 100], 0.9);
        let runs = 4000;
        let inside = (0..runs)
            .filter(|_| {
                let mut z: f64 = StandardNormal.sample(&mut random);
                (0..=100).all(|_| {
                    let ok = z.abs() <= c;
                    let e: f64 = StandardNormal.sample(&mut random);
                    z = r * z + (1.0 - r * r).sqrt() * e;
                    ok
                })
            })
            .count();
        // At least 90 %, and not wastefully more; 4000 runs have a standard deviation of 0.5 %.
        let share = inside as f64 / f64::from(runs);
        assert!((0.885..0.95).contains(&share), "{share}");
    }
}
