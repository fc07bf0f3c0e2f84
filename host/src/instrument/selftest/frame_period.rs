//! The length of a frame by this computer's clock.
//!
//! An answer that names frame f as the newest was made after the question was sent and before it came: frame f was complete
//! before the answer came, and frame f + 1 was not before the question was sent. Each answer so excludes periods, whatever the
//! delays of the line are. What is left is an interval.

use std::time::Duration;

/// An answer of the board.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stamp {
    /// Number of the newest complete frame.
    pub(super) frame: u32,
    /// When the question was sent for the first time.
    pub(super) sent: Duration,
    /// When the answer came.
    pub(super) received: Duration,
}

/// Steps of each search; the interval shrinks to two thirds or to a half with each.
const STEPS: u32 = 120;

/// Periods that are looked at, relative to the one that the board states.
const WIDEST: [f64; 2] = [0.1, 10.0];

/// The least and the largest period (s) that the answers allow; `None` where they contradict each other, as where a clock jumped.
pub(super) fn frame_period(stamps: &[Stamp], stated_s: f64) -> Option<[f64; 2]> {
    let first = stamps.first()?.frame;
    let room = |period: f64| {
        let complete_by = stamps.iter().map(|s| {
            let frames = f64::from(s.frame.wrapping_sub(first));
            s.received.as_secs_f64() - frames * period
        });
        let not_before = stamps.iter().map(|s| {
            let frames = f64::from(s.frame.wrapping_sub(first)) + 1.0;
            s.sent.as_secs_f64() - frames * period
        });
        complete_by.fold(f64::INFINITY, f64::min) - not_before.fold(f64::NEG_INFINITY, f64::max)
    };
    let [least, most] = WIDEST.map(|factor| factor * stated_s);
    let best = highest(room, least, most);
    (room(best) >= 0.0).then(|| [border(room, best, least), border(room, best, most)])
}

/// Where a concave function is highest.
fn highest(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..STEPS {
        let third = (high - low) / 3.0;
        if function(low + third) < function(high - third) {
            low += third;
        } else {
            high -= third;
        }
    }
    (low + high) / 2.0
}

/// The last place on the way from `inside` to `outside` at which the function is not negative.
fn border(function: impl Fn(f64) -> f64, mut inside: f64, mut outside: f64) -> f64 {
    for _ in 0..STEPS {
        let middle = (inside + outside) / 2.0;
        if function(middle) >= 0.0 {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Answers of a board with frames of `period` s, over a line that takes between 2 and 30 ms.
    fn stamps(period: f64) -> Vec<Stamp> {
        let mut now = 0.37;
        (0..400_u32)
            .map(|k| {
                let sent = now;
                let answered = sent + 0.001 + 0.001 * f64::from(k * 7 % 5);
                now = answered + 0.001 + 0.001 * f64::from(k * 11 % 25);
                Stamp {
                    frame: (answered / period) as u32,
                    sent: Duration::from_secs_f64(sent),
                    received: Duration::from_secs_f64(now),
                }
            })
            .collect()
    }

    #[test]
    fn the_interval_has_the_period_and_is_narrow() {
        for period in [0.02, 0.0204, 0.01] {
            let [least, most] = frame_period(&stamps(period), 0.02).unwrap();
            assert!(least <= period && period <= most, "{least} {most}");
            assert!(most - least < 0.004 * period, "{least} {most}");
        }
    }

    #[test]
    fn a_clock_that_jumps_is_a_contradiction() {
        let mut stamps = stamps(0.02);
        for stamp in &mut stamps[200..] {
            stamp.frame += 50;
        }
        assert_eq!(frame_period(&stamps, 0.02), None);
        assert_eq!(frame_period(&[], 0.02), None);
    }
}
