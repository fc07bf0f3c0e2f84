//! Missing inputs that the others make known.
//!
//! A command is held, so a missing one between two equal ones is that command. Where all changes lie on a raster, as
//! those of a PWM frame do, a change in a gap is where the raster says. A gap that may hide a whole hold stays a gap.

use super::Run;

impl Run<'_> {
    /// The run with the missing inputs that the others make known.
    pub(super) fn with_complete_input(&self) -> Run<'_> {
        let mut run = self.borrowed();
        if run.input.iter().any(|u| u.is_nan()) {
            complete_input(run.input.to_mut());
        }
        run
    }

    /// The same, and with those across which it moves evenly (see [`bridge_input`]).
    pub(super) fn with_bridged_input(&self) -> Run<'_> {
        let mut run = self.with_complete_input();
        if run.input.iter().any(|u| u.is_nan()) {
            bridge_input(run.input.to_mut());
        }
        run
    }
}

/// Changes from which the raster of an input is read: those of an input without one are all even apart in one of 2^8
/// cases.
const CHANGES: usize = 8;

/// Fills the gaps (NaN) in the input of one run whose commands are known.
fn complete_input(input: &mut [f64]) {
    let raster = Raster::of(input);
    let mut last: Option<usize> = None;
    for k in 0..input.len() {
        if input[k].is_nan() {
            continue;
        }
        if let Some(last) = last.filter(|last| last + 1 < k) {
            let (before, after) = (input[last], input[k]);
            let change = match before == after {
                true => raster.hides_no_hold(last, k).then_some(k),
                false => raster.change_between(last, k),
            };
            if let Some(change) = change {
                input[last + 1..change].fill(before);
                input[change..k].fill(after);
            }
        }
        last = Some(k);
    }
}

/// How far the course of an input on either side of a gap may miss the other side, for a curve to bridge it \[standard
/// deviations of the input\]. A jump misses it by more, and what moves as fast as a servo follows by less.
const EVEN_WITHIN: f64 = 0.1;

/// Fills the gaps that are left across which the input of one run moves evenly, by a cubic through the two known samples
/// on either side.
fn bridge_input(input: &mut [f64]) {
    let known: Vec<(usize, f64)> = (0..input.len())
        .map(|k| (k, input[k]))
        .filter(|(_, u)| !u.is_nan())
        .collect();
    let count = known.len() as f64;
    let mean = known.iter().map(|(_, u)| u).sum::<f64>() / count;
    let variance = known.iter().map(|(_, u)| (u - mean).powi(2)).sum::<f64>() / count;
    for around in known.windows(4) {
        let [before, last, next, after] = [0, 1, 2, 3].map(|i| around[i]);
        let slope = |a: (usize, f64), b: (usize, f64)| (b.1 - a.1) / (b.0 - a.0) as f64;
        let across = slope(last, next);
        let gap = (next.0 - last.0) as f64;
        let miss = |beside: f64| (beside - across).abs() * gap;
        let farthest = miss(slope(before, last)).max(miss(slope(next, after)));
        if farthest <= EVEN_WITHIN * variance.sqrt() {
            let gap = last.0 + 1..next.0;
            for (k, missing) in gap.clone().zip(&mut input[gap]) {
                *missing = cubic(around, k);
            }
        }
    }
}

/// Lagrange's polynomial through `points`, at `k`.
fn cubic(points: &[(usize, f64)], k: usize) -> f64 {
    let term = |i: usize| {
        let others = (0..points.len()).filter(|j| *j != i);
        let weights = others
            .map(|j| (k as f64 - points[j].0 as f64) / (points[i].0 as f64 - points[j].0 as f64));
        points[i].1 * weights.product::<f64>()
    };
    (0..points.len()).map(term).sum()
}

/// Where the input changes.
struct Raster {
    /// The sample of a change, and the step of the raster that all of them lie on, if they do.
    steps: Option<(usize, usize)>,
    /// Samples between two changes, at least; 1 where that is not known.
    shortest_hold: usize,
}

impl Raster {
    fn of(input: &[f64]) -> Self {
        let changes: Vec<usize> = (1..input.len())
            .filter(|&k| !input[k - 1].is_nan() && !input[k].is_nan() && input[k - 1] != input[k])
            .collect();
        let holds = || changes.windows(2).map(|pair| pair[1] - pair[0]);
        let step = holds().fold(0, greatest_common_divisor);
        Self {
            steps: (changes.len() >= CHANGES && step > 1).then(|| (changes[0], step)),
            shortest_hold: holds().min().unwrap_or(1),
        }
    }

    /// Whether no hold of another command fits between the samples `last` and `next`. An input that moves from sample to
    /// sample has no holds: there, one that is back where it was is taken to have rested.
    fn hides_no_hold(&self, last: usize, next: usize) -> bool {
        self.shortest_hold == 1 || next - last <= self.shortest_hold
    }

    /// The first sample of the command at `next`, where the raster has one place for it after `last`.
    fn change_between(&self, last: usize, next: usize) -> Option<usize> {
        let (origin, step) = self.steps?;
        let mut places = (last + 1..=next).filter(|k| k.abs_diff(origin) % step == 0);
        places.next().filter(|_| places.next().is_none())
    }
}

/// By Euclid's algorithm; that of 0 and a number is the number.
fn greatest_common_divisor(a: usize, b: usize) -> usize {
    match a {
        0 => b,
        _ => greatest_common_divisor(b % a, a),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAP: f64 = f64::NAN;

    /// Commands, each held for five samples.
    fn held(commands: &[f64]) -> Vec<f64> {
        commands.iter().flat_map(|u| [*u; 5]).collect()
    }

    #[test]
    fn gaps_within_a_hold_and_at_a_change_on_the_raster_are_filled() {
        let whole = held(&[0.0, 1.0, 0.0, 2.0, 2.0, 1.0, 3.0, 0.0, 1.0, 0.0, 2.0]);
        for (first, length) in [(7, 1), (6, 3), (9, 1), (10, 1), (8, 4), (21, 4)] {
            let mut input = whole.clone();
            input[first..first + length].fill(GAP);
            complete_input(&mut input);
            assert_eq!(input, whole, "{length} samples from {first} on");
        }
    }

    #[test]
    fn a_gap_that_may_hide_a_hold_stays() {
        let mut input = held(&[0.0, 1.0, 0.0, 2.0, 2.0, 1.0, 3.0, 0.0, 1.0, 0.0, 2.0]);
        // The command 1 was given and taken back in this gap, or 0 was held.
        input[5..10].fill(GAP);
        complete_input(&mut input);
        assert!(input[5..10].iter().all(|u| u.is_nan()));
        // Two places of the raster.
        input[29..36].fill(GAP);
        complete_input(&mut input);
        assert!(input[29..36].iter().all(|u| u.is_nan()));
    }

    #[test]
    fn a_cubic_bridges_a_gap_in_a_smooth_input_and_none_at_a_jump() {
        let smooth: Vec<f64> = (0..400).map(|k| (0.03 * f64::from(k)).sin()).collect();
        let mut input = smooth.clone();
        input[17] = GAP;
        input[100..102].fill(GAP);
        bridge_input(&mut input);
        let largest = |a: &[f64]| {
            let misses = a.iter().zip(&smooth).map(|(a, b)| (a - b).abs());
            misses.fold(0.0, f64::max)
        };
        // h² / 8 times the largest second derivative, with h of three samples.
        assert!(
            largest(&input) <= (0.03f64 * 3.0).powi(2) / 8.0,
            "{input:?}"
        );
        let mut jump = smooth;
        jump.iter_mut().skip(200).for_each(|u| *u += 1.0);
        jump[200] = GAP;
        bridge_input(&mut jump);
        assert!(jump[200].is_nan());
    }

    #[test]
    fn without_a_raster_a_change_in_a_gap_is_not_known() {
        let mut input: Vec<f64> = (0..40).map(|k| (0.3 * f64::from(k)).sin()).collect();
        input[17] = GAP;
        complete_input(&mut input);
        assert!(input[17].is_nan());
        let mut few = held(&[0.0, 1.0, 2.0]);
        few[5] = GAP;
        complete_input(&mut few);
        assert!(few[5].is_nan());
    }
}
