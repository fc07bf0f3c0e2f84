//! Waits for pulses that a whole recording has in common.
//!
//! Where pulses come on a clock of their own, a command that changes between two of them waits for the next. Changes that are whole frames apart wait equally
//! long, so that every time of a recording contains one wait, which no row shows and another recording has otherwise.

use super::about::About;
use super::command_changes::command_changes;
use servoid_identification::Run;

/// The time between two pulses of a receiver, or of the servo library of a microcontroller \[s\].
pub(crate) const FRAME_S: f64 = 0.02;

/// Changes at so many moments of a frame wait alike, or in two ways, which no recording shows. Where they are at more, answers scatter, errors follow the motion, and servo models have no intervals
/// (docs/servo-model.md).
const UNSEEN_MOMENTS: usize = 2;

/// Moments that are closer than this part of a frame are one.
const ONE_MOMENT: f64 = 0.05;

/// Has `about` know the wait that these `runs` have in common, where nothing states that no command waits. One that moves on with every row waits otherwise each time.
pub(super) fn note_common_wait(runs: &[Run<'_>], period_s: f64, about: &mut About) {
    if !(about.exact_command || about.moving_command) {
        about.common_wait_s = common_wait_s(runs, period_s);
    }
}

/// By how much the mean wait of the changes of one of these runs may differ from that in another recording of the same commands, at most \[s\]: a frame where all changes are whole frames
/// apart, half a frame where half of them are in its middle, and 0 where they are at many moments, which shows.
fn common_wait_s(runs: &[Run<'_>], period_s: f64) -> f64 {
    let of_run = |run: &Run| {
        let phases = change_phases(run.input(), period_s);
        match moments(&phases) <= UNSEEN_MOMENTS {
            true => FRAME_S * spread_of_mean(phases),
            false => 0.0,
        }
    };
    runs.iter().map(of_run).fold(0.0, f64::max)
}

/// At how many moments of a frame the command changes.
fn moments(phases: &[f64]) -> usize {
    let mut found: Vec<f64> = Vec::new();
    for phase in phases {
        let is_near = |other: &f64| {
            let apart = (phase - other).abs();
            apart.min(1.0 - apart) < ONE_MOMENT
        };
        if !found.iter().any(is_near) {
            found.push(*phase);
        }
    }
    found.len()
}

/// When the command changes, in frames from one of them on, 0 to 1.
fn change_phases(command: &[f64], period_s: f64) -> Vec<f64> {
    // A billionth keeps rounding from making the end of one frame of the beginning of the next.
    let phase = |row: usize| (row as f64 * period_s / FRAME_S + 1e-9).fract();
    command_changes(command).map(phase).collect()
}

/// The mean wait is φ - F(φ) and a constant, for pulses that come at φ in each frame and F the share of changes before φ in it: largest less smallest, which is the
/// statistic of Kuiper (Proceedings of the Koninklijke Nederlandse Akademie van Wetenschappen A 63, 1960).
fn spread_of_mean(mut phases: Vec<f64>) -> f64 {
    phases.sort_by(f64::total_cmp);
    let changes = phases.len() as f64;
    let above = phases
        .iter()
        .zip(1..)
        .map(|(phase, n)| f64::from(n) / changes - phase);
    let below = phases
        .iter()
        .zip(0..)
        .map(|(phase, n)| phase - f64::from(n) / changes);
    above
        .reduce(f64::max)
        .zip(below.reduce(f64::max))
        .map_or(0.0, |(above, below)| above + below)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean wait for pulses at each of 200 moments of a frame, tried one by one.
    fn by_trial(command: &[f64], period_s: f64) -> f64 {
        let phases = change_phases(command, period_s);
        let mean_wait = |pulse: f64| {
            let waits = phases.iter().map(|phase| (pulse - phase).rem_euclid(1.0));
            waits.sum::<f64>() / phases.len() as f64
        };
        let means: Vec<f64> = (0..200)
            .map(|k| mean_wait((f64::from(k) + 0.5) / 200.0))
            .collect();
        let extent = means.iter().fold([1.0f64, 0.0f64], |[low, high], m| {
            [low.min(*m), high.max(*m)]
        });
        FRAME_S * (extent[1] - extent[0])
    }

    fn held(holds: impl Iterator<Item = usize>) -> Vec<f64> {
        let of_hold = |(length, k): (usize, usize)| vec![[3.0, -3.0][k % 2]; length];
        holds.zip(0..).flat_map(of_hold).collect()
    }

    #[test]
    fn the_spread_is_that_of_the_mean_waits_for_pulses_at_any_moment() {
        let whole = held([50, 30, 40, 50, 20, 60].into_iter());
        let halves = held([25, 35, 25, 45, 25].into_iter());
        let any = held((0..60).map(|k| 20 + k * 7919 % 41));
        for (command, expected_s) in [(&whole, 0.02), (&halves, 0.01), (&any, 0.0)] {
            let run = Run::new(command.clone(), command.clone()).unwrap();
            let found_s = common_wait_s(&[run], 0.002);
            assert!((found_s - expected_s).abs() <= 1e-9, "{found_s}");
            // The trials are a two-hundredth of a frame apart.
            let spread_s = FRAME_S * spread_of_mean(change_phases(command, 0.002));
            let tried_s = by_trial(command, 0.002);
            assert!((spread_s - tried_s).abs() <= 2e-4, "{spread_s} {tried_s}");
        }
    }

    #[test]
    fn a_command_that_never_changes_waits_for_nothing() {
        assert!(change_phases(&[1.0; 9], 0.002).is_empty());
        assert!(spread_of_mean(Vec::new()) <= 0.0);
    }
}
