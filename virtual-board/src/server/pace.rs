//! The speed of simulated time.

use crate::time::{Ticks, from_duration};
use std::time::{Duration, Instant};

/// A larger lag of simulated time is not made up for.
const LONGEST_LAG: Duration = Duration::from_millis(50);

/// The rule by which simulated time follows real time.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    speed: u32,
    /// The two clocks' times at one instant.
    anchor: Option<(Instant, Ticks)>,
}

impl Pace {
    /// As fast as real time.
    pub const REAL_TIME: Self = Self::times(1);

    /// Twice as fast: a host that renews a lease of 2 s each 0.5 s, and repeats an unanswered request after 0.25 s,
    /// does so every 1.5 s of simulated time at the latest.
    pub const FASTEST: Self = Self::times(2);

    const fn times(speed: u32) -> Self {
        Self {
            speed,
            anchor: None,
        }
    }

    /// The latest simulated time allowed, where it is `simulated` now.
    pub fn allowed(&mut self, now: Instant, simulated: Ticks) -> Ticks {
        let &mut (instant, start) = self.anchor.get_or_insert((now, simulated));
        let allowed = start + from_duration(now.saturating_duration_since(instant) * self.speed);
        let lag = from_duration(LONGEST_LAG * self.speed);
        if allowed > simulated + lag {
            self.anchor = Some((now, simulated));
            return simulated + lag / 2;
        }
        allowed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::milliseconds;

    #[test]
    fn simulated_time_keeps_its_ratio() {
        let start = Instant::now();
        for (mut pace, speed) in [(Pace::REAL_TIME, 1), (Pace::FASTEST, 2)] {
            let mut simulated = milliseconds(5);
            for ms in 0..100 {
                let allowed = pace.allowed(start + Duration::from_millis(ms * 10), simulated);
                assert_eq!(allowed, milliseconds(5 + speed * ms * 10));
                simulated = allowed;
            }
        }
    }

    #[test]
    fn what_held_it_up_is_not_made_up_for() {
        let mut pace = Pace::REAL_TIME;
        let start = Instant::now();
        pace.allowed(start, 0);
        // A second later, nothing was simulated.
        let late = start + Duration::from_secs(1);
        assert!(pace.allowed(late, 0) <= milliseconds(50));
        let allowed = pace.allowed(late + Duration::from_millis(30), milliseconds(25));
        assert_eq!(allowed, milliseconds(30));
    }
}
