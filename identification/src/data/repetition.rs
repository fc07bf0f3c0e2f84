//! Whether an input repeats itself from its first sample to its last.

use crate::data::Run;

/// The shortest period of the input of `run`, of at most `longest` \[samples\]; `None` where it does not repeat itself, stands still, or was at
/// rest before its first sample. Missing values are like any other.
pub(crate) fn of(run: &Run, longest: usize) -> Option<usize> {
    let input = run.input();
    if run.input_at_rest().is_some() {
        return None;
    }
    let same = |a: &f64, b: &f64| a == b || a.is_nan() || b.is_nan();
    // A long rest is like itself some samples later until it ends: its end is looked at first.
    let change = input.iter().position(|u| !same(u, &input[0]));
    let repeats = |period: usize| {
        let at_change = change.filter(|change| *change >= period);
        let mut pairs = input.iter().zip(&input[period..]);
        at_change.is_none_or(|change| same(&input[change - period], &input[change]))
            && pairs.all(|(now, later)| same(now, later))
    };
    (1..=longest.min(input.len() / 2))
        .find(|period| repeats(*period))
        .filter(|period| *period > 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shortest_period_is_found_and_a_rest_before_ends_it() {
        let square = |rest: usize| -> Vec<f64> {
            let level = |k: usize| {
                if (k / 50).is_multiple_of(2) {
                    5.0
                } else {
                    -5.0
                }
            };
            (0..rest).map(|_| 0.0).chain((0..1000).map(level)).collect()
        };
        let period = |input: Vec<f64>| of(&Run::new(input.clone(), input).unwrap(), 400);
        assert_eq!(period(square(0)), Some(100));
        assert_eq!(period(square(20)), None);
        assert_eq!(period(vec![1.0; 1000]), None);
        let mut missing = square(0);
        missing[333] = f64::NAN;
        assert_eq!(period(missing), Some(100));
        let stated = Run::new(square(0), square(0)).unwrap();
        assert_eq!(of(&stated.with_input_at_rest(0.0), 400), None);
    }
}
