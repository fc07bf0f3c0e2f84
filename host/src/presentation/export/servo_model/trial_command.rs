//! The command under which an export is compared with servoid's own integrator.

use super::recorded_range::recorded;
use super::subject::ServoExport;
use serde::Serialize;
use servoid_dynamics::{Grid, ServoParameters, Start, simulate};

/// A staircase of small and large strokes, held and then broken off, repeated reversals over the whole range, and the strokes in which two
/// searches found the largest difference: any strokes, and one that is held or broken off once.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trial {
    /// Step of time of the exported servo \[s\].
    pub step_s: f64,
    /// The levels of the command \[units of the command\].
    pub levels: Vec<f64>,
    /// For how many steps each level is held.
    pub steps_per_level: usize,
    /// For how many steps each level is held when all come again: too few for the larger strokes to end.
    pub steps_of_broken_off: usize,
    /// For how many steps the largest level and the least are held while they alternate, for each such part.
    pub steps_of_reversals: Vec<usize>,
    /// The strokes before all this, from rest at the first level: those in which a search found the largest difference. Play and friction
    /// remember what came before, and the search begins at rest.
    pub worst: Vec<Held>,
    /// The levels behind those, again from rest at the first level: a stroke from rest that is held or broken off once, in which a search found the
    /// largest difference of such strokes.
    pub worst_broken_off: Vec<Held>,
}

/// A level of the command, and for how long it is held.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Held {
    /// The level \[units of the command\].
    pub level: f64,
    /// The number of steps.
    pub steps: usize,
}

/// The levels as parts of the amplitude: strokes of a tenth and less, and of twice the amplitude.
const LEVELS: [f64; 8] = [0.0, 0.1, -0.05, 1.0, -1.0, -0.9, 0.5, 0.0];

/// Shortest and longest time for which a level is held \[s\].
const HOLD_S: (f64, f64) = (0.2, 5.0);

/// Levels that come again are held for this share of the time: a servo that turns round in the middle of a stroke shows what a limit
/// of the rate lacks more than one that comes to rest.
const BROKEN_OFF: f64 = 0.25;

/// But not for less \[s\]: within its delay no servo shows anything.
const SHORTEST_S: f64 = 0.1;

/// Half periods of the repeated reversals as parts of the time for which a level is held. The longest is one in which the largest strokes
/// nearly end, the shortest one in which a servo with a limit hardly leaves the middle.
const HALF_PERIODS: [f64; 4] = [0.5, 0.25, 0.125, 0.0625];

/// But none is shorter \[s\].
const SHORTEST_HALF_PERIOD_S: f64 = 0.05;

/// Strokes of each such part: where the two directions differ, a servo drifts from the middle to its last course in so many.
pub(super) const REVERSALS: usize = 12;

/// Time constants that a stroke has to settle in.
const SETTLING: f64 = 5.0;

/// How much finer the motion that counts as exact is computed than servoid does elsewhere.
pub(super) const FINER_WHERE_EXACT: f64 = 10.0;

impl Trial {
    /// A trial with steps of `step_s` seconds, of commands that are `possible`.
    pub(super) fn of(export: &ServoExport<'_>, step_s: f64, possible: [f64; 2]) -> Self {
        let (middle, most) = within(recorded(export.model, &export.parameters), possible);
        let amplitude = short(most, most, 3, f64::floor);
        let middle = short(middle, amplitude, 3, f64::round);
        let hold_s = hold_s(export, amplitude);
        let level = |part: &f64| short(middle + part * amplitude, amplitude, 3, f64::round);
        let steps = |hold_s: f64| (hold_s / step_s).round().max(1.0) as usize;
        let half_period = |part: &f64| {
            let wanted_s = (part * hold_s).max(SHORTEST_HALF_PERIOD_S);
            steps(in_frames(export, wanted_s))
        };
        let mut steps_of_reversals: Vec<usize> = HALF_PERIODS.iter().map(half_period).collect();
        steps_of_reversals.dedup();
        Self {
            step_s,
            levels: LEVELS.iter().map(level).collect(),
            steps_per_level: steps(hold_s),
            steps_of_broken_off: steps(in_frames(export, (BROKEN_OFF * hold_s).max(SHORTEST_S))),
            steps_of_reversals,
            worst: Vec::new(),
            worst_broken_off: Vec::new(),
        }
    }

    /// The command of each step.
    #[must_use]
    pub fn command(&self) -> Vec<f64> {
        let lengths = [self.steps_per_level, self.steps_of_broken_off];
        let staircase = |steps: usize| {
            let held = move |level: &f64| std::iter::repeat_n(*level, steps);
            self.levels.iter().flat_map(held)
        };
        let mut command = self.strokes_of_search();
        command.extend(lengths.into_iter().flat_map(staircase));
        let [least, largest] = self.ends();
        for steps in &self.steps_of_reversals {
            for reversal in 0..REVERSALS {
                let end = if reversal % 2 == 0 { largest } else { least };
                command.extend(std::iter::repeat_n(end, *steps));
            }
            // The next part begins at rest.
            command.extend(std::iter::repeat_n(self.middle(), self.steps_per_level));
        }
        command
    }

    /// The strokes of both searches.
    fn strokes_of_search(&self) -> Vec<f64> {
        [
            self.begun_at_rest(&self.worst),
            self.begun_at_rest(&self.worst_broken_off),
        ]
        .concat()
    }

    /// These strokes from rest at the first level; nothing where there are none.
    pub(super) fn begun_at_rest(&self, strokes: &[Held]) -> Vec<f64> {
        let rest = Held {
            level: self.middle(),
            steps: self.steps_per_level,
        };
        let rest = (!strokes.is_empty()).then_some(&rest);
        let all = rest.into_iter().chain(strokes);
        all.flat_map(|held| std::iter::repeat_n(held.level, held.steps))
            .collect()
    }

    /// A level at this part of the amplitude, from -1 to 1.
    pub(super) fn level(&self, part: f64) -> f64 {
        let [least, largest] = self.ends();
        let (middle, amplitude) = ((least + largest) / 2.0, (largest - least) / 2.0);
        short(middle + part * amplitude, amplitude, 3, f64::round)
    }

    /// So many steps as lie, by their logarithm, at this share of the way from the shortest half-period that is searched to the time for which
    /// a level is held; in whole pulse frames where there are any.
    pub(super) fn steps_between(&self, export: &ServoExport<'_>, share: f64) -> usize {
        let longest_s = self.steps_per_level as f64 * self.step_s;
        let shortest_s = rise_s(export).min(longest_s / 4.0);
        let wanted_s = shortest_s * (longest_s / shortest_s).powf(share);
        let held_s = match export.frame_s() {
            frame if frame > 0.0 => (wanted_s / frame).round().max(1.0) * frame,
            _ => wanted_s,
        };
        (held_s / self.step_s).round().max(1.0) as usize
    }

    /// The least and the largest level, between which the repeated reversals go.
    pub(super) fn ends(&self) -> [f64; 2] {
        let levels = || self.levels.iter().copied();
        [
            levels().fold(f64::INFINITY, f64::min),
            levels().fold(f64::NEG_INFINITY, f64::max),
        ]
    }

    /// The same without the repeated reversals and the worst strokes.
    pub(super) fn only_staircase(&self) -> Self {
        Self {
            steps_of_reversals: Vec::new(),
            worst: Vec::new(),
            worst_broken_off: Vec::new(),
            ..self.clone()
        }
    }

    /// The same with strokes that are so many times as large.
    pub(super) fn enlarged(&self, factor: f64) -> Self {
        let middle = self.middle();
        let level = |level: &f64| middle + factor * (level - middle);
        Self {
            levels: self.levels.iter().map(level).collect(),
            ..self.clone()
        }
    }

    /// What of a course of the position is that of the staircase, without the strokes of the search and the repeated reversals.
    #[must_use]
    pub fn staircase<'a>(&self, positions: &'a [f64]) -> &'a [f64] {
        let begin = self.strokes_of_search().len();
        let steps = self.levels.len() * (self.steps_per_level + self.steps_of_broken_off);
        positions.get(begin..begin + steps).unwrap_or(positions)
    }

    /// What of a course of the position is that of the stroke of the search that is held or broken off once.
    pub(super) fn broken_off<'a>(&self, positions: &'a [f64]) -> &'a [f64] {
        let begin = self.begun_at_rest(&self.worst).len();
        let end = self.strokes_of_search().len();
        positions.get(begin..end).unwrap_or_default()
    }

    /// The position at the beginning of each step, by servoid's integrator with steps of a tenth of its usual ones.
    #[must_use]
    pub fn exact(&self, servo: &ServoParameters) -> Vec<f64> {
        exact(servo, self.step_s, &self.command())
    }

    /// The middle of the levels.
    pub(super) fn middle(&self) -> f64 {
        self.levels.first().copied().unwrap_or(0.0)
    }

    /// The largest difference of two courses of the position after the first level, on which other programs may not begin at
    /// rest.
    #[must_use]
    pub fn largest_difference<'a>(&self, a: &'a [f64], b: &'a [f64]) -> f64 {
        let after = |course: &'a [f64]| course.get(self.steps_per_level..).unwrap_or_default();
        largest(after(a), after(b)).0
    }

    /// The root mean square of the same difference.
    #[must_use]
    pub fn root_mean_square(&self, a: &[f64], b: &[f64]) -> f64 {
        root_mean_square(a, b, self.steps_per_level)
    }

    /// The largest stroke of the command.
    pub(super) fn largest_stroke(&self) -> f64 {
        self.largest_of(|level| level)
    }

    /// The largest stroke of the position, from rest to rest: a load makes it smaller, and a stop cuts off what is beyond it.
    pub(super) fn largest_travel(&self, servo: &ServoParameters) -> f64 {
        self.largest_of(|level| servo.resting_output(level))
    }

    /// The largest that is commanded between the stops, as far as the servo would go without a load.
    pub(super) fn largest_commanded(&self, servo: &ServoParameters) -> f64 {
        let [least, most] = servo.range();
        self.largest_of(|level| level.max(least).min(most) * servo.gain)
    }

    fn largest_of(&self, position: impl Fn(f64) -> f64) -> f64 {
        let strokes = self.levels.windows(2).filter_map(|pair| match pair {
            [from, to] => Some((position(*to) - position(*from)).abs()),
            _ => None,
        });
        strokes.fold(0.0, f64::max)
    }
}

/// The largest difference of two courses, and where it is.
pub(super) fn largest(a: &[f64], b: &[f64]) -> (f64, usize) {
    let pairs = a.iter().zip(b).enumerate();
    // A NaN must not be lost.
    pairs.fold((0.0, 0), |(most, at), (place, (a, b))| {
        let apart = (a - b).abs();
        if apart <= most {
            (most, at)
        } else {
            (apart, place)
        }
    })
}

/// The position at the beginning of each step of `step_s` with these commands, from rest under the first, by servoid's integrator with steps of a
/// tenth of its usual ones.
pub(super) fn exact(servo: &ServoParameters, step_s: f64, command: &[f64]) -> Vec<f64> {
    finely(servo, step_s, command, FINER_WHERE_EXACT)
}

/// The same with steps that are `finer` times as fine as usual.
pub(super) fn finely(
    servo: &ServoParameters,
    step_s: f64,
    command: &[f64],
    finer: f64,
) -> Vec<f64> {
    let usual = Grid::for_stiffness(1.0, 0.0, servo.stiffness);
    let longest_s = usual.period_s / usual.steps as f64 / finer;
    let grid = Grid::new(step_s, 0.0, longest_s);
    let first = command.first().copied().unwrap_or(0.0);
    let start = Start::at_rest(servo.resting_output(first), Some(first));
    let mut position = Vec::new();
    simulate(servo, &grid, &start, command, |_, y| position.push(y));
    position
}

/// What of a range, which is its middle and half of its width, is possible.
fn within((middle, most): (f64, f64), [least, largest]: [f64; 2]) -> (f64, f64) {
    let (low, high) = (middle - most, middle + most);
    match low >= least && high <= largest {
        true => (middle, most),
        false => {
            let (low, high) = (low.max(least), high.min(largest));
            ((low + high) / 2.0, (high - low) / 2.0)
        }
    }
}

/// 1/ω of the servo at small signals: one without limits rises in about twice that, and swings with a half-period of three times that.
fn rise_s(export: &ServoExport<'_>) -> f64 {
    1.0 / export.parameters.stiffness.sqrt()
}

/// The real part of the slower pole \[1/s\].
fn slower_pole(servo: &ServoParameters) -> f64 {
    let half = servo.damping / 2.0;
    half - (half * half - servo.stiffness).max(0.0).sqrt()
}

/// Long enough for the largest stroke; whole pulse frames where there are any.
fn hold_s(export: &ServoExport<'_>, amplitude: f64) -> f64 {
    let parameters = &export.parameters;
    let slower = slower_pole(parameters);
    let speed = export
        .top_speeds()
        .map_or(f64::INFINITY, |(up, down)| up.min(down));
    let stroke = 2.0 * amplitude;
    // Under full drive to the middle, and against it to the end.
    let accelerated = parameters.drive_limit().map_or(0.0, |limit| {
        2.0 * (stroke / (limit.up * limit.down_to_up.min(1.0))).sqrt()
    });
    let wanted = parameters.delay_s + stroke / speed + accelerated + SETTLING / slower;
    in_frames(export, wanted.clamp(HOLD_S.0, HOLD_S.1))
}

/// At least so long, in whole pulse frames.
fn in_frames(export: &ServoExport<'_>, seconds: f64) -> f64 {
    let unit = match export.frame_s() {
        frame if frame > 0.0 => frame,
        _ => 0.05,
    };
    (seconds / unit - 1e-9).ceil() * unit
}

/// A multiple of a power of ten, so that a number is short in a comment: `digits` digits of `size` stay, and the rest is cut
/// off by `whole`.
fn short(value: f64, size: f64, digits: i32, whole: fn(f64) -> f64) -> f64 {
    let exponent = size.log10().floor() as i32 + 1 - digits;
    // A quotient of two whole numbers is the nearest number to the decimal one.
    match exponent < 0 {
        true => whole(value * 10f64.powi(-exponent)) / 10f64.powi(-exponent),
        false => whole(value / 10f64.powi(exponent)) * 10f64.powi(exponent),
    }
}

/// The root mean square of the difference of `a` and `b` behind so many steps.
pub(super) fn root_mean_square(a: &[f64], b: &[f64], steps: usize) -> f64 {
    let pairs = a.iter().zip(b).skip(steps);
    let count = pairs.len() as f64;
    let squares: f64 = pairs.map(|(a, b)| (a - b) * (a - b)).sum();
    (squares / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_dynamics::Stops;

    #[test]
    fn a_stop_cuts_strokes_of_the_position() {
        let trial = Trial {
            step_s: 0.01,
            levels: vec![0.0, 10.0, -10.0, 4.0],
            steps_per_level: 10,
            steps_of_broken_off: 2,
            steps_of_reversals: vec![3],
            worst: Vec::new(),
            worst_broken_off: Vec::new(),
        };
        let travel = |gain: f64, lower: Option<f64>, upper: Option<f64>| {
            trial.largest_travel(&ServoParameters {
                gain,
                stops: Stops { lower, upper },
                ..ServoParameters::linear(900.0, 60.0)
            })
        };
        assert_eq!(travel(2.0, None, None), 40.0);
        assert_eq!(travel(2.0, None, Some(12.0)), 32.0);
        assert_eq!(travel(-2.0, Some(-4.0), Some(12.0)), 16.0);
    }
}
