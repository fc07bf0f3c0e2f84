//! Where a curve passes a level between two samples, by a cubic.

/// Where the curve passes `level` between sample `m`-1 and sample `m`, which lie on different
/// sides of it: by a cubic through the two and their neighbours.
pub(super) fn crossing_before(curve: &[f64], m: usize, level: f64) -> f64 {
    match m {
        0 => 0.0,
        m => (m - 1) as f64 + Crossing::new(curve, m, level).cubic(),
    }
}

/// Four neighbouring values less the level that the curve passes between the second and the third,
/// at the places -1, 0, 1 and 2.
pub(super) struct Crossing([f64; 4]);

impl Crossing {
    /// Before sample 0 the curve is zero. The last sample, which gathers all that comes later, is
    /// not used as a neighbour.
    pub(super) fn new(curve: &[f64], m: usize, level: f64) -> Self {
        let (p1, p2) = (curve[m - 1] - level, curve[m] - level);
        let p0 = if m >= 2 { curve[m - 2] } else { 0.0 } - level;
        let p3 = if m + 1 < curve.len() - 1 {
            curve[m + 1] - level
        } else {
            2.0 * p2 - p1
        };
        Self([p0, p1, p2, p3])
    }

    fn slope(&self) -> f64 {
        self.0[2] - self.0[1]
    }

    /// The crossing of a straight line through the two inner values.
    pub(super) fn linear(&self) -> f64 {
        (-self.0[1] / self.slope()).clamp(0.0, 1.0)
    }

    /// The crossing of the cubic through all four.
    fn cubic(&self) -> f64 {
        let [p0, p1, p2, p3] = self.0;
        self.root(
            (p0 - 2.0 * p1 + p2) / 2.0,
            (p3 - p0 - 3.0 * self.slope()) / 6.0,
        )
    }

    /// The crossings of the parabolas through the first three and the last three.
    pub(super) fn parabolas(&self) -> [f64; 2] {
        let [p0, p1, p2, p3] = self.0;
        [p0 - 2.0 * p1 + p2, p3 - 2.0 * p2 + p1].map(|curvature| self.root(curvature / 2.0, 0.0))
    }

    /// The root between the inner two of Newton's form on the nodes 0, 1, -1, 2.
    fn root(&self, second: f64, third: f64) -> f64 {
        let (p1, p2, slope) = (self.0[1], self.0[2], self.slope());
        let value_at = |t: f64| p1 + t * (slope + (t - 1.0) * (second + (t + 1.0) * third));
        let (mut low, mut high) = (0.0, 1.0);
        let mut t = self.linear();
        // Each step at least keeps the crossing enclosed; Newton on a nearly straight piece of
        // curve leaves less than a millionth of a sample after a few.
        for _ in 0..8 {
            let value = value_at(t);
            if value.abs() < 1e-9 * slope.abs() {
                break;
            }
            if (value > 0.0) == (p2 > p1) {
                high = t;
            } else {
                low = t;
            }
            let derivative = slope + (2.0 * t - 1.0) * second + (3.0 * t * t - 1.0) * third;
            let newton = t - value / derivative;
            t = if newton > low && newton < high {
                newton
            } else {
                f64::midpoint(low, high)
            };
        }
        t
    }
}
