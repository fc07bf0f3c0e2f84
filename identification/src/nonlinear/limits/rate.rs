//! Rate limit: whether the speed of a stroke grows with its size, as in a linear servo.
//!
//! All strokes of a linear servo have the same time scale, so that the speed v in the middle of a stroke is
//! proportional to its commanded size A. Two statistics test this: the slope b of ln v over ln A (standard
//! deviation by MacKinnon and White's HC3), and the hinge v = c min(A, A₀) against v = c A by an F test.
//!
//! ```text
//! proportional   b is not significantly below 0.95, and no hinge lies below 0.9 of the largest size
//! rate limit     otherwise, when v is constant above the hinge: five strokes or more, sizes that
//!                differ by a fifth, slope significantly below 0.25
//! grows less     otherwise: torque or acceleration is limited, or speed saturates gradually
//! ```
//!
//! The sizes are those commanded, because the noise of the measured travel is also in the speed. The shape
//! of a single stroke does not distinguish a rate limit from a slow servo, and is not used.

use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};

use super::open_question::OpenQuestion;
use crate::data::Stroke;
use crate::numerics::pointwise_critical;
use crate::results::Interval;
use crate::thresholds::{
    HINGE, RATE_LIMIT_LEVEL, RATE_SLOPES, SIZES_FOR_RATE, STOPPED, STROKES_AT_LIMIT,
    STROKES_FOR_RATE,
};

/// The finding for the strokes of one direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RateVerdict {
    /// Speed grows with the size of the stroke: no limit in the recorded range.
    Proportional,
    /// Speed is limited to the given value.
    Limited,
    /// Speed grows less than the size; the given speed is that of the largest strokes.
    GrowsLess,
    /// Too few strokes, or all of one size.
    CannotTell,
}

/// The speed of the strokes of one direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rate {
    /// The finding.
    pub verdict: RateVerdict,
    /// Mid-travel speed (35 to 65 %) of the fastest group of strokes \[output per second\]; when limited, that over the part of the travel in which they are
    /// fastest (20 to 50 %, 35 to 65 % or 50 to 80 %): the limit.
    pub speed: Interval,
    /// b: 1 when proportional, 0 when constant.
    pub exponent: Interval,
    /// Number of isolated strokes.
    pub strokes: usize,
    /// Number of isolated strokes that were stopped, and left out.
    #[serde(default)]
    pub stopped: usize,
    /// Smallest and largest commanded size; zero without strokes.
    pub sizes: (f64, f64),
    /// The finding as a sentence.
    pub statement: String,
    /// What to record where this recording does not show it, as a sentence; `None` where it does.
    #[serde(default)]
    pub remedy: Option<String>,
}

/// No stroke exceeds a limit by so much: those that are left out show that the speed is one of their places, as under a load that changes with the angle.
const BEYOND_LIMIT: f64 = 1.15;

/// Sizes of strokes are equal but for rounding where they differ by less, as a share.
const EQUAL_SIZES: f64 = 1e-6;

impl Rate {
    /// Of the strokes of one direction.
    pub(crate) fn new(direction: &str, strokes: &[Stroke], level: f64) -> Self {
        let all = strokes;
        let mut strokes = unstopped(all);
        let stopped = all.len() - strokes.len();
        strokes.sort_by(|a, b| a.size.abs().total_cmp(&b.size.abs()));
        let size = |stroke: &Stroke| stroke.size.abs();
        let sizes = match (strokes.first(), strokes.last()) {
            (Some(small), Some(large)) => (size(small), size(large)),
            _ => (0.0, 0.0),
        };
        let mut rate = Self {
            verdict: RateVerdict::CannotTell,
            speed: mean_speed(&strokes, level),
            exponent: Interval::default(),
            strokes: strokes.len(),
            stopped,
            sizes,
            statement: String::new(),
            remedy: None,
        };
        if strokes.len() < STROKES_FOR_RATE || sizes.1 < SIZES_FOR_RATE * sizes.0 {
            let seen = match strokes.len() {
                0 => "no stroke that began and ended at rest".to_owned(),
                count if sizes.1 - sizes.0 <= EQUAL_SIZES * sizes.1 => {
                    format!("{count} isolated strokes, all of {:.3}", sizes.1)
                }
                count => format!(
                    "{count} isolated strokes of {:.3} to {:.3}",
                    sizes.0, sizes.1
                ),
            };
            let (stopped, within) = match stopped {
                0 => (String::new(), ""),
                count => (
                    format!(" and {count} that ended at a stop or fell short of what others reach"),
                    " and within the free travel",
                ),
            };
            let open = OpenQuestion {
                finding: format!(
                    "This recording does not determine whether the speed {direction} is limited, because it has \
                     {seen}{stopped}"
                ),
                remedy: format!(
                    "Record at least {STROKES_FOR_RATE} strokes in each direction, the largest at least \
                     {SIZES_FOR_RATE} times the smallest, each held until it has settled{within}."
                ),
            };
            (rate.statement, rate.remedy) = (open.statement(), Some(open.remedy));
            return rate;
        }
        let logs: Vec<(f64, f64)> = strokes
            .iter()
            .map(|s| (size(s).ln(), s.speed.ln()))
            .collect();
        let slope = Slope::new(&logs);
        let critical = pointwise_critical(RATE_LIMIT_LEVEL);
        rate.exponent = slope.interval(pointwise_critical(level));
        let hinge = Hinge::new(&logs);
        let of_size = |wanted: &dyn Fn(f64) -> bool| -> Vec<Stroke> {
            strokes
                .iter()
                .filter(|s| wanted(size(s)))
                .copied()
                .collect()
        };
        let above = of_size(&|size| size > hinge.knee);
        let bent = hinge.p < 1.0 - RATE_LIMIT_LEVEL && hinge.knee < HINGE * sizes.1;
        if slope.value + critical * slope.sd >= RATE_SLOPES.0 && !bent {
            rate.verdict = RateVerdict::Proportional;
            rate.speed = mean_speed(&of_size(&|size| size == sizes.1), level);
        } else if is_constant(&above, critical) {
            rate.verdict = RateVerdict::Limited;
            // Acceleration and braking reach farthest into the smaller ones.
            let near_largest = |stroke: &&Stroke| size(stroke) * STROKES_AT_LIMIT.1 >= sizes.1;
            let largest = above.iter().filter(near_largest).count();
            let taken = largest.max(STROKES_AT_LIMIT.0).min(above.len());
            rate.speed = top_speed(&above[above.len() - taken..], level);
            let fastest = all.iter().map(|s| s.speed).fold(0.0, f64::max);
            if rate
                .speed
                .value
                .is_some_and(|limit| fastest > BEYOND_LIMIT * limit)
            {
                return rate.exceeded(direction, fastest);
            }
        } else {
            rate.verdict = RateVerdict::GrowsLess;
            rate.speed = mean_speed(
                &of_size(&|size| size * STROKES_AT_LIMIT.1 >= sizes.1),
                level,
            );
        }
        rate.statement = rate.sentence(direction);
        rate
    }

    /// The same where a stroke was faster than what seemed to be the limit.
    fn exceeded(self, direction: &str, fastest: f64) -> Self {
        let open = OpenQuestion {
            finding: format!(
                "This recording does not determine whether the speed {direction} is limited, because strokes that ended at a stop or fell short of what others reach went at up to {fastest:.1} per \
                 second, faster than the others"
            ),
            remedy: "Record strokes of several sizes about one middle: under a load that changes with the angle, speeds depend on where a stroke begins.".to_owned(),
        };
        Self {
            verdict: RateVerdict::CannotTell,
            speed: Interval::default(),
            statement: open.statement(),
            remedy: Some(open.remedy),
            ..self
        }
    }

    fn sentence(&self, direction: &str) -> String {
        let speed = self.speed.value.unwrap_or(0.0);
        let exponent = self.exponent.value.unwrap_or(0.0);
        match self.verdict {
            RateVerdict::Proportional => format!(
                "No rate limit {direction}, to {speed:.1} per second at least: the speed grows with the stroke."
            ),
            RateVerdict::Limited => {
                format!("Rate limit {direction} of {speed:.1} per second.")
            }
            _ => {
                // Strokes that bend at a size have no one power.
                let power = match exponent < RATE_SLOPES.0 {
                    true => format!(" (to the power {exponent:.2})"),
                    false => String::new(),
                };
                format!(
                    "The speed {direction} grows less than the stroke{power}, up to a mean of {speed:.1} per second in the middle of the largest strokes: \
                     torque, acceleration or speed is limited."
                )
            }
        }
    }
}

/// The strokes without those that were stopped, whose speed is not that of the commanded stroke.
fn unstopped(strokes: &[Stroke]) -> Vec<Stroke> {
    let gain = |stroke: &Stroke| stroke.travel / stroke.size.abs();
    let mut gains: Vec<f64> = strokes.iter().map(gain).collect();
    gains.sort_by(f64::total_cmp);
    // Most strokes may meet a stop, but not those with the farthest travel for their size.
    let free = gains.get(3 * gains.len() / 4).copied().unwrap_or(0.0);
    let went_free = |stroke: &&Stroke| gain(stroke) >= STOPPED * free;
    strokes.iter().filter(went_free).copied().collect()
}

/// Whether the speed no longer grows with the size.
fn is_constant(above: &[Stroke], critical: f64) -> bool {
    let size = |stroke: &Stroke| stroke.size.abs();
    let smallest = above.iter().map(size).fold(f64::INFINITY, f64::min);
    let largest = above.iter().map(size).fold(0.0, f64::max);
    if above.len() < STROKES_AT_LIMIT.0 || largest <= STROKES_AT_LIMIT.1 * smallest {
        return false;
    }
    let logs: Vec<(f64, f64)> = above
        .iter()
        .map(|s| (size(s).ln(), s.mid_speed.ln()))
        .collect();
    let slope = Slope::new(&logs);
    slope.value + critical * slope.sd < RATE_SLOPES.1
}

/// Mean mid-travel speed with Student's interval.
fn mean_speed(strokes: &[Stroke], level: f64) -> Interval {
    mean_of(strokes.iter().map(|stroke| stroke.mid_speed), level)
}

/// The same over that part of the travel in which the strokes are fastest.
fn top_speed(strokes: &[Stroke], level: f64) -> Interval {
    let of_part = |part: usize| mean_of(strokes.iter().map(|stroke| stroke.speeds[part]), level);
    let all = [0, 1, 2].map(of_part);
    let fastest = all.into_iter().max_by(|a, b| {
        let [a, b] = [a, b].map(|interval| interval.value.unwrap_or(0.0));
        a.total_cmp(&b)
    });
    fastest.unwrap_or_default()
}

fn mean_of(speeds: impl ExactSizeIterator<Item = f64> + Clone, level: f64) -> Interval {
    let count = speeds.len() as f64;
    if speeds.len() == 0 {
        return Interval::default();
    }
    let mean = speeds.clone().sum::<f64>() / count;
    let square: f64 = speeds.map(|speed| (speed - mean).powi(2)).sum();
    let half = match StudentsT::new(0.0, 1.0, count - 1.0) {
        Ok(t) if count > 1.0 => {
            t.inverse_cdf(0.5 + level / 2.0) * (square / (count - 1.0) / count).sqrt()
        }
        _ => f64::INFINITY,
    };
    Interval::around(mean, Some(half))
}

/// Slope of a line through points.
struct Slope {
    value: f64,
    sd: f64,
}

impl Slope {
    fn new(points: &[(f64, f64)]) -> Self {
        let count = points.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let (x0, y0) = (mean(|p| p.0), mean(|p| p.1));
        let sxx: f64 = points.iter().map(|p| (p.0 - x0).powi(2)).sum();
        let value = points.iter().map(|p| (p.0 - x0) * (p.1 - y0)).sum::<f64>() / sxx;
        // HC3: residuals divided by one minus their leverage. They need not have equal variances.
        let variance: f64 = points
            .iter()
            .map(|p| {
                let d = p.0 - x0;
                let residual = p.1 - y0 - value * d;
                let leverage = 1.0 / count + d * d / sxx;
                (d * residual / (1.0 - leverage).max(1e-9)).powi(2)
            })
            .sum();
        Self {
            value,
            sd: variance.sqrt() / sxx,
        }
    }

    fn interval(&self, critical: f64) -> Interval {
        Interval::around(self.value, Some(critical * self.sd))
    }
}

/// v = c min(A, knee) in logarithms.
struct Hinge {
    knee: f64,
    /// Probability of an improvement over v = c A at least as large if there is no hinge.
    p: f64,
}

impl Hinge {
    fn new(points: &[(f64, f64)]) -> Self {
        const STEPS: usize = 200;
        let count = points.len() as f64;
        let rss = |knee: f64| {
            let over = |p: &(f64, f64)| p.1 - p.0.min(knee);
            let mean = points.iter().map(over).sum::<f64>() / count;
            points.iter().map(|p| (over(p) - mean).powi(2)).sum::<f64>()
        };
        let low = points.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
        let (knee, best) = (0..=STEPS)
            .map(|k| low + (high - low) * k as f64 / STEPS as f64)
            .map(|knee| (knee, rss(knee)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((high, 0.0));
        let statistic = (rss(high) - best) / (best / (count - 2.0));
        let p = FisherSnedecor::new(1.0, count - 2.0).map_or(1.0, |f| f.sf(statistic.max(0.0)));
        Self {
            knee: knee.exp(),
            p,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strokes(speed: impl Fn(f64) -> f64) -> Vec<Stroke> {
        let size = |k: usize| 2.0 + 2.0 * (k % 5) as f64;
        (0..20)
            .map(|k| {
                // One percent of scatter, the same for every law.
                let v = speed(size(k)) * (1.0 + 0.01 * (k as f64 * 2.7).sin());
                Stroke {
                    at: 0,
                    size: size(k),
                    travel: size(k),
                    speed: v,
                    mid_speed: v,
                    speeds: [v; 3],
                }
            })
            .collect()
    }

    #[test]
    fn the_law_of_the_speed_is_recognised() {
        let verdict = |speed: &dyn Fn(f64) -> f64| Rate::new("up", &strokes(speed), 0.99);
        assert_eq!(verdict(&|a| 30.0 * a).verdict, RateVerdict::Proportional);
        let limited = verdict(&|a| (30.0 * a).min(100.0));
        assert_eq!(limited.verdict, RateVerdict::Limited);
        assert!(limited.speed.contains(100.0));
        assert_eq!(
            verdict(&|a| 30.0 * a.sqrt()).verdict,
            RateVerdict::GrowsLess
        );
        let one_size = &strokes(|a| 30.0 * a)[..1].repeat(9);
        let cannot = Rate::new("up", one_size, 0.99);
        assert_eq!(cannot.verdict, RateVerdict::CannotTell);
        let remedy = cannot.remedy.unwrap();
        assert!(remedy.starts_with("Record at least 6 strokes"), "{remedy}");
        assert!(cannot.statement.ends_with(&remedy[1..]), "{remedy}");
        assert_eq!(limited.remedy, None);
    }

    #[test]
    fn a_speed_that_other_strokes_exceed_is_no_limit() {
        let mut all = strokes(|a| (30.0 * a).min(100.0));
        let of_load = |all: &mut Vec<Stroke>, speed: f64| {
            // A load helps two of the largest, and holds them half way.
            for stroke in all.iter_mut().filter(|stroke| stroke.size > 9.0).take(2) {
                (stroke.travel, stroke.speed) = (0.5 * stroke.size, speed);
            }
            Rate::new("down", all, 0.99)
        };
        assert_eq!(of_load(&mut all, 105.0).verdict, RateVerdict::Limited);
        let found = of_load(&mut all, 150.0);
        assert_eq!(found.verdict, RateVerdict::CannotTell);
        assert_eq!(found.speed.value, None);
        assert!(
            found.statement.contains("up to 150.0 per second"),
            "{}",
            found.statement
        );
    }

    #[test]
    fn strokes_that_meet_a_stop_are_no_evidence_of_their_speed() {
        // Strokes commanded beyond 6 end there: the largest that went free was of 6.
        let stopped: Vec<Stroke> = strokes(|a| (30.0 * a).min(200.0))
            .into_iter()
            .map(|stroke| Stroke {
                at: 0,
                travel: stroke.travel.min(6.0),
                ..stroke
            })
            .collect();
        let rate = Rate::new("up", &stopped, 0.99);
        assert_eq!((rate.strokes, rate.stopped), (12, 8));
        assert_eq!(rate.verdict, RateVerdict::Proportional);
        assert!(
            rate.speed.value.is_some_and(|speed| speed < 185.0),
            "{rate:?}"
        );
        // Hardly any did.
        let few: Vec<Stroke> = stopped.iter().filter(|s| s.size >= 6.0).copied().collect();
        let rate = Rate::new("up", &few, 0.99);
        assert_eq!(rate.verdict, RateVerdict::CannotTell);
        assert!(
            rate.statement.contains("ended at a stop"),
            "{}",
            rate.statement
        );
    }
}
