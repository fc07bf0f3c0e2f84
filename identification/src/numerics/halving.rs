//! The place where something ends, by halving.

/// Halvings after which less than rounding is left of a stretch.
const HALVINGS: usize = 50;

/// Where, between `inside` and `outside`, `within` ends.
pub(crate) fn halved(mut inside: f64, mut outside: f64, within: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(inside, outside);
        if within(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}
