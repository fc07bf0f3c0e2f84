//! The lowest point of a smooth function of a handful of numbers (Broyden, Fletcher, Goldfarb and Shanno 1970).

use faer::Mat;

use crate::numerics::{dot, times};

/// Largest number of steps. A good start needs about fifteen.
const STEPS: usize = 60;
/// Largest change of a number in one step: they are logarithms.
const LONGEST_STEP: f64 = 1.5;
/// Decrease of -2 ln likelihood that no longer matters.
const CONVERGED: f64 = 1e-2;

/// The function at a place. The gradient costs more than the value, and a place that is too high has no use for it.
pub(super) trait Point {
    fn value(&self) -> f64;
    fn gradient(&self) -> Vec<f64>;
}

/// Goes down from `start`. `function` gives `None` where it cannot be computed.
pub(super) fn descend<P: Point>(
    function: impl Fn(&[f64]) -> Option<P>,
    start: &[f64],
) -> Option<(Vec<f64>, P)> {
    let size = start.len();
    let mut at = start.to_vec();
    let mut best = function(&at)?;
    let mut gradient = best.gradient();
    let unit = |scale: f64| Mat::from_fn(size, size, |i, j| if i == j { scale } else { 0.0 });
    let mut inverse = unit(1.0 / dot(&gradient, &gradient).sqrt().max(1.0));
    for _ in 0..STEPS {
        let mut step: Vec<f64> = times(&inverse, &gradient).iter().map(|s| -s).collect();
        let mut slope = dot(&step, &gradient);
        if slope >= 0.0 {
            inverse = unit(1.0 / dot(&gradient, &gradient).sqrt().max(1.0));
            step = times(&inverse, &gradient).iter().map(|s| -s).collect();
            slope = dot(&step, &gradient);
        }
        let longest = step.iter().fold(0.0, |a: f64, s| a.max(s.abs()));
        let shorten = (LONGEST_STEP / longest).min(1.0);
        step.iter_mut().for_each(|s| *s *= shorten);
        slope *= shorten;
        let Some((factor, next, found)) = along(&function, &at, &step, best.value(), slope) else {
            break;
        };
        let decrease = best.value() - found.value();
        (at, best) = (next, found);
        if decrease < CONVERGED {
            break;
        }
        let before = std::mem::replace(&mut gradient, best.gradient());
        let moved: Vec<f64> = step.iter().map(|s| factor * s).collect();
        let turned: Vec<f64> = gradient.iter().zip(&before).map(|(a, b)| a - b).collect();
        update(&mut inverse, &moved, &turned);
    }
    Some((at, best))
}

/// The first of ever shorter steps that descends enough (Armijo).
fn along<P: Point>(
    function: &impl Fn(&[f64]) -> Option<P>,
    at: &[f64],
    step: &[f64],
    best: f64,
    slope: f64,
) -> Option<(f64, Vec<f64>, P)> {
    let halves = std::iter::successors(Some(1.0), |factor| Some(factor / 3.0)).take(8);
    halves.into_iter().find_map(|factor: f64| {
        let next: Vec<f64> = at.iter().zip(step).map(|(x, s)| x + factor * s).collect();
        let found = function(&next).filter(|p| p.value() <= best + 1e-4 * factor * slope)?;
        Some((factor, next, found))
    })
}

/// H becomes (I - s y'/y's) H (I - y s'/y's) + s s'/y's, where the curvature along the step is positive.
fn update(inverse: &mut Mat<f64>, moved: &[f64], turned: &[f64]) {
    let curvature = dot(moved, turned);
    if curvature <= 1e-12 {
        return;
    }
    let turned_by_inverse = times(inverse, turned);
    let stretch = 1.0 + dot(turned, &turned_by_inverse) / curvature;
    *inverse = Mat::from_fn(moved.len(), moved.len(), |i, j| {
        inverse[(i, j)]
            + (stretch * moved[i] * moved[j]
                - turned_by_inverse[i] * moved[j]
                - moved[i] * turned_by_inverse[j])
                / curvature
    });
}

#[cfg(test)]
mod tests {
    use super::{CONVERGED, Point, descend};

    struct Valley([f64; 2]);

    impl Point for Valley {
        fn value(&self) -> f64 {
            let (a, b) = self.parts();
            a * a + 100.0 * b * b
        }

        fn gradient(&self) -> Vec<f64> {
            let (a, b) = self.parts();
            vec![-2.0 * a - 400.0 * self.0[0] * b, 200.0 * b]
        }
    }

    impl Valley {
        fn parts(&self) -> (f64, f64) {
            let [x, y] = self.0;
            (1.0 - x, y - x * x)
        }
    }

    #[test]
    fn the_bottom_of_a_bent_valley_is_found() {
        let rosenbrock = |x: &[f64]| Some(Valley([x[0], x[1]]));
        let (at, lowest) = descend(rosenbrock, &[-1.2, 1.0]).unwrap();
        assert!(lowest.value() < CONVERGED, "{at:?}: {}", lowest.value());
    }
}
