//! A column of time stamps that jitter about even times, with gaps and beginnings of runs.

/// The longest gap that is filled with missing samples; beyond it, the rows after it stand apart. A
/// servo has forgotten by then what was before the gap, and a time that is far off must not decide
/// how much memory is taken.
const LONGEST_GAP: f64 = 1000.0;

/// A column of time whose steps are nearly all of one length.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeColumn {
    times: Vec<f64>,
    step: f64,
    scatter: f64,
}

/// Why a column is no column of time for evenly spaced rows.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TimeFault {
    /// No two rows of it are one after the other.
    #[error("no times that rise")]
    Constant,
    /// Nine of ten steps are from the one to the other.
    #[error("uneven steps (nine of ten from {shortest} to {longest})")]
    Uneven {
        /// The step that one of twenty is below.
        shortest: f64,
        /// The step that one of twenty is above.
        longest: f64,
    },
}

/// Farthest that a step may be from the usual one to count as one of the same length, as a share, at
/// first from the middle one, which may be short of the usual one (2 of 2, 3, 2, 3), then from the mean
/// of these: beyond, a row may be missing.
const SAME_STEP: [f64; 2] = [0.7, 0.5];

/// Share of the steps that have to be of one length: the others are gaps and beginnings of runs.
const MOST: f64 = 0.95;

/// Distance of a step from a whole number of steps that still is a gap \[steps\].
const WHOLE: f64 = 0.05;

/// Share of the steps that may be gaps, and the most samples missing in each, where all are whole.
const GAPS: (f64, f64) = (0.4, 10.0);

/// Largest scatter of time stamps about even ones \[steps, rms\]: at a quarter, one of twenty steps is
/// nearer to another sample.
const SCATTER: f64 = 0.2;

/// Distance from two steps at which a stamp still makes up for one before it that was repeated \[steps\].
const LATE: f64 = 0.5;

/// Standard deviations of the scatter by which the difference of two stamps may be off: three of a difference, which has √2 of those of each.
const SCATTER_OF_ENDS: f64 = 4.0;

/// A part of a step by which no result shows that it is rounded: a hundredth of a percent of all times.
const FINEST: f64 = 1e-4;

/// How fast the even time follows the stamps, of the distance at each row: slow against the scatter,
/// fast enough for a clock that drifts.
const FOLLOW: f64 = 0.05;

impl TimeColumn {
    /// Takes a column for one of time if its steps are of one length but for gaps and beginnings of
    /// runs, and its stamps lie close to even ones.
    pub fn new(times: Vec<f64>) -> Result<Self, TimeFault> {
        let mut steps: Vec<f64> = steps(&times).filter(|step| *step > 0.0).collect();
        if steps.is_empty() {
            return Err(TimeFault::Constant);
        }
        let middle = steps.len() / 2;
        let middle = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
        let (mut step, mut count) = (middle, 0.0);
        for farthest in SAME_STEP {
            let same = |s: &&f64| (**s / step - 1.0).abs() < farthest;
            let (sum, found) = steps
                .iter()
                .filter(same)
                .fold((0.0, 0.0), |(sum, count), step| (sum + step, count + 1.0));
            (step, count) = (sum / f64::max(found, 1.0), found);
        }
        let mut found = Self {
            step,
            scatter: 0.0,
            times,
        };
        let all = (found.times.len() - 1) as f64;
        found.scatter = found.measured_scatter();
        let even = count >= MOST * all || found.has_gaps_alone(&steps, all);
        if even && found.scatter <= SCATTER {
            return Ok(found);
        }
        Err(found.fault())
    }

    /// What its steps are like, those of no length too.
    fn fault(&self) -> TimeFault {
        let mut steps: Vec<f64> = steps(&self.times).filter(|step| step.is_finite()).collect();
        steps.sort_by(f64::total_cmp);
        let rounded = |step: Option<&f64>| {
            let step = step.copied().unwrap_or(f64::NAN);
            format!("{step:.3e}").parse().unwrap_or(step)
        };
        let outside = steps.len() / 20;
        TimeFault::Uneven {
            shortest: rounded(steps.get(outside)),
            longest: rounded(steps.iter().rev().nth(outside)),
        }
    }

    /// Takes a column for one of time whose step is known \[its unit\]: `None` if less than half of its
    /// steps are of that length, or its stamps do not lie close to even ones.
    #[must_use]
    pub fn with_step(times: &[f64], step: f64) -> Option<Self> {
        let mut found = Self {
            times: times.to_vec(),
            step,
            scatter: 0.0,
        };
        found.scatter = found.measured_scatter();
        let [_, farthest] = SAME_STEP;
        let one = |(time, before): &(&f64, &f64)| ((*time - *before) / step - 1.0).abs() < farthest;
        let ones = times.iter().skip(1).zip(times).filter(one).count();
        (2 * ones >= times.len().saturating_sub(1) && found.scatter <= SCATTER).then_some(found)
    }

    /// Whether all steps of another length are gaps of whole steps. Stamps that are coarser than the
    /// steps look so too; but those stay close to a straight line.
    fn has_gaps_alone(&self, steps: &[f64], all: f64) -> bool {
        let whole = |step: &f64| {
            let steps = step / self.step;
            (steps - steps.round()).abs() < WHOLE && steps < GAPS.1
        };
        let single = |step: &&f64| **step < 1.5 * self.step;
        let (wholes, singles) = (
            steps.iter().filter(|step| whole(step)).count() as f64,
            steps.iter().filter(single).count() as f64,
        );
        let [Some(first), Some(last)] = [self.times.first(), self.times.last()] else {
            return false;
        };
        let mean = (last - first) / all;
        let straight = self.times.iter().zip(0_u32..).all(|(time, row)| {
            let line = first + mean * f64::from(row);
            (time - line).abs() <= self.step
        });
        wholes >= MOST * all && singles >= (1.0 - GAPS.0) * all && !straight
    }

    /// The usual step, as the roundest number that the stamps allow: two files of one logger have one step, and the rounding of written times
    /// is no digit of it. 0.02 comes back as 0.020000000000003126 from differences, and 10 as 9.999833 from 6000 stamps of whole numbers.
    pub fn step(&self) -> f64 {
        let known_to = self.known_to().min(FINEST * self.step);
        roundest(self.step, known_to)
            .or_else(|| format!("{:.6e}", self.step).parse().ok())
            .unwrap_or(self.step)
    }

    /// How far the usual step may be from the true one: what the first and the last stamp are rounded by, and how far both scatter, over all steps.
    fn known_to(&self) -> f64 {
        let steps = self.times.len().saturating_sub(1).max(1) as f64;
        (self.written_to() + SCATTER_OF_ENDS * self.scatter * self.step) / steps
    }

    /// How far the times lie from even ones, root of the mean square \[steps\].
    pub fn scatter(&self) -> f64 {
        self.scatter
    }

    /// Half the time over which the rows lie about even ones, if evenly, without what the writing of the times rounds \[steps\].
    pub fn half_spread(&self) -> f64 {
        let rounding = self.written_to() / self.step;
        // An interval of length 1 has the variance 1/12.
        let variance = self.scatter.powi(2) - rounding.powi(2) / 12.0;
        (3.0 * variance.max(0.0)).sqrt()
    }

    /// The last place that times are written to: a power of ten, or 0 where that is finer than the steps by far.
    fn written_to(&self) -> f64 {
        let is_whole = |unit: f64| {
            let mut stamps = self.times.iter().filter(|time| time.is_finite());
            stamps.all(|time| {
                let count = time / unit;
                (count - count.round()).abs() < 1e-3
            })
        };
        let mut units = (-9..=6).rev().map(|power| 10f64.powi(power));
        units
            .find(|unit| *unit <= self.step && is_whole(*unit))
            .filter(|unit| *unit > 1e-4 * self.step)
            .unwrap_or_default()
    }

    fn measured_scatter(&self) -> f64 {
        let mut ahead = 0.0;
        let (mut square, mut count) = (0.0, 0);
        for row in 1..self.times.len() {
            if let Step::Samples(_) = self.step_before(row, &mut ahead) {
                square += ahead * ahead;
                count += 1;
            }
        }
        (square / f64::from(count.max(1))).sqrt()
    }

    /// What lies before a row; `ahead` is how far the row before it lies ahead of even ones \[steps\], and
    /// becomes that of this row.
    pub(super) fn step_before(&self, row: usize, ahead: &mut f64) -> Step {
        let time = |row: usize| self.times.get(row).copied().unwrap_or(f64::NAN);
        let steps = (time(row) - time(row - 1)) / self.step;
        if steps.is_nan() {
            // An empty cell is no sign of a gap.
            return Step::Samples(1);
        }
        if steps == 0.0 && ((time(row + 1) - time(row)) / self.step - 2.0).abs() < LATE {
            // The stamp of the row before, and the next one is where it should be: this one was written late.
            *ahead -= 1.0;
            return Step::Samples(1);
        }
        if steps <= 0.0 || steps >= LONGEST_GAP {
            *ahead = 0.0;
            return match steps <= 0.0 {
                true => Step::NewRun,
                false => Step::LongGap,
            };
        }
        let place = *ahead + steps;
        let samples = place.round().max(1.0);
        *ahead = (place - samples) * (1.0 - FOLLOW);
        Step::Samples(samples as usize)
    }
}

/// The number with the fewest digits that is so near to a positive one; `None` where it needs more than seven.
fn roundest(number: f64, within: f64) -> Option<f64> {
    let with_digits = |digits: usize| format!("{number:.digits$e}").parse::<f64>().ok();
    let mut found = (0..7).filter_map(with_digits);
    found.find(|found| (found - number).abs() <= within)
}

/// From each time to the next.
fn steps(times: &[f64]) -> impl Iterator<Item = f64> {
    let pairs = times.iter().skip(1).zip(times);
    pairs.map(|(time, before)| time - before)
}

/// What lies between a row and the row before it.
pub(super) enum Step {
    /// So many samples.
    Samples(usize),
    /// More samples than are worth counting.
    LongGap,
    /// The beginning of another run.
    NewRun,
}
