//! The length of the frame and the moments of pulses with which a model is closest to a recording.
//!
//! A length that is wrong by 0.1 % walks through a whole frame within a thousand frames: a search from length to length on a whole recording meets no slope
//! until it is next to the right one. Within half a second lengths do not differ, and errors depend on the moment of the pulse alone. So the recording is predicted
//! with pulses of the stated length at moments all over the frame; along any other length the errors are looked up, block by block, at the moments that
//! it has come to. The best of these are predicted, and from the closest on steps of length and moments are halved, with predictions of the whole recording.

use super::pulse_errors::{ErrorTable, MOMENTS, OF_LENGTH, Predict, in_force, with_pulses};
use servoid_identification::{Error, Record, Run};
use std::ops::RangeInclusive;

/// Lengths about which tables are made, in stated ones: each has all within half a percent. The ceramic resonator of an Arduino keeps within half a percent, and libraries and receivers count frames of 20 ms with one or two more.
const TABLES: [f64; 5] = [1.0, 0.99, 1.01, 0.98, 1.02];

/// About a length with an error that is looked up of less than this times the least may be the closest: it is that at moments that are a part of a frame apart.
const ALIKE: f64 = 1.1;

/// How far a length may be from the stated one, as a share of it.
pub(crate) const OF_STATED: f64 = 0.02 + OF_LENGTH;

/// Of the lengths that are looked up, so many are predicted.
const PREDICTED: usize = 100;

/// From so many of these on steps are halved.
const STARTS: usize = 20;

/// Times that they are.
const HALVED: i32 = 4;

/// Times that they are of the closest of all.
const FURTHER: i32 = 3;

/// The part of a frame to which moments of pulses are known at the least.
pub(crate) const RESOLUTION: f64 = 1.0 / (MOMENTS as f64 * (1 << HALVED) as f64);

/// Steps of one size at the most.
const STEPS: usize = 8;

/// The pulses with which a model is closest.
#[derive(Clone, Debug)]
pub(crate) struct ClosestPulses {
    /// From one pulse to the next \[s\].
    pub(crate) frame_s: f64,
    /// A change of it that moves the pulse at the end of the longest run by a part of a frame \[s\].
    pub(crate) frame_step_s: f64,
    /// Of each run, the first pulse after its first row \[s\]; `None` of a run that cannot be predicted.
    pub(crate) first_pulse_s: Vec<Option<f64>>,
    /// The error of the model (rms) with these pulses \[output\].
    pub(crate) rmse: f64,
    /// The least with frames of the stated length.
    pub(crate) rmse_as_stated: f64,
    /// The largest with frames of the stated length.
    pub(crate) largest_rmse: f64,
}

impl ClosestPulses {
    /// The record with its commands at these pulses, each row with the mean of the command in force; runs that cannot be predicted stay as they are.
    ///
    /// # Errors
    /// As of [`Record::try_with_runs`].
    pub(crate) fn held<'r>(&self, record: &Record<'r>) -> Result<Record<'r>, Error> {
        self.moved(record, with_pulses)
    }

    /// The same with each command in force from its pulse on, within its row.
    ///
    /// # Errors
    /// As of [`Record::try_with_runs`].
    pub(crate) fn in_force<'r>(&self, record: &Record<'r>) -> Result<Record<'r>, Error> {
        let period_s = record.sample_period_s();
        self.moved(record, |run, pulses| in_force(run, period_s, pulses))
    }

    /// With all pulses so many `seconds` later.
    pub(crate) fn later(&self, seconds: f64) -> Self {
        let later = |first_s: &Option<f64>| {
            first_s.map(|first_s| (first_s + seconds).rem_euclid(self.frame_s))
        };
        Self {
            first_pulse_s: self.first_pulse_s.iter().map(later).collect(),
            ..self.clone()
        }
    }

    /// The frame and the first pulse of the first run \[s\].
    pub(crate) fn pulses_of_first_run(&self) -> Option<[f64; 2]> {
        let first_s = self.first_pulse_s.first().copied().flatten()?;
        Some([self.frame_s, first_s])
    }

    /// With each run as `at` pulses, which are counted in rows.
    fn moved<'r>(
        &self,
        record: &Record<'r>,
        at: impl Fn(&Run<'r>, [f64; 2]) -> Option<Run<'r>>,
    ) -> Result<Record<'r>, Error> {
        let rows = |time_s: f64| time_s / record.sample_period_s();
        let moved = |(run, first_s): (&Run<'r>, &Option<f64>)| {
            let moved = first_s.and_then(|first_s| at(run, [self.frame_s, first_s].map(rows)));
            moved.unwrap_or_else(|| run.clone())
        };
        let runs = record.runs().iter().zip(&self.first_pulse_s).map(moved);
        record.try_with_runs(runs.collect())
    }
}

/// The sum of the squared errors of a run, by its place, with pulses of a length and at a moment \[s\].
type ErrorOfRun<'a> = &'a dyn Fn(usize, [f64; 2]) -> Option<f64>;

/// Pulses of a length in all runs.
#[derive(Clone)]
struct Pulses {
    frame_s: f64,
    /// Of each run, a pulse near its middle \[s\]: with another length, pulses of both halves of the run move the least.
    middle_s: Vec<f64>,
    /// Of each run, the sum of the squared errors.
    squares: Vec<f64>,
}

/// The errors of all runs of a record with pulses of about one length, looked up.
struct LookedUp<'a, 'r> {
    /// That of each run that can be predicted.
    tables: Vec<Option<ErrorTable<'a, 'r>>>,
    about_s: f64,
    /// From one length to the next \[s\]: pulses at the ends of the longest run come by half of the way from one moment to the next.
    step_s: f64,
}

impl<'a, 'r> LookedUp<'a, 'r> {
    /// About all lengths of [`TABLES`]; none where no run can be predicted.
    fn of_all(record: &'a Record<'r>, stated_s: f64, predict: Predict<'_, 'r>) -> Vec<Self> {
        let lengths = TABLES.into_iter().map(|share| share * stated_s);
        lengths
            .filter_map(|about_s| Self::of(record, about_s, predict))
            .collect()
    }

    fn of(record: &'a Record<'r>, about_s: f64, predict: Predict<'_, 'r>) -> Option<Self> {
        let period_s = record.sample_period_s();
        let table = |(number, run)| ErrorTable::of(run, number, [about_s, period_s], predict);
        let tables: Vec<_> = (0..).zip(record.runs()).map(table).collect();
        let seconds = tables.iter().flatten().map(ErrorTable::seconds);
        let longest_s = seconds.reduce(f64::max)?;
        Some(Self {
            tables,
            about_s,
            step_s: about_s * about_s / (MOMENTS as f64 * longest_s),
        })
    }

    /// The least (rms) \[output\].
    fn least_error(&self) -> Option<f64> {
        let best = best_of(self.tried(), 1).pop()?;
        Some((best.sum() / self.samples()).sqrt())
    }

    fn known(&self) -> Vec<&ErrorTable<'a, 'r>> {
        self.tables.iter().flatten().collect()
    }

    fn samples(&self) -> f64 {
        self.known().iter().map(|table| table.samples).sum()
    }

    /// With frames of this length, each run at the moments at which it is closest.
    fn closest(&self, frame_s: f64) -> Pulses {
        let of_runs = self.known().into_iter().map(|table| table.closest(frame_s));
        let (middle_s, squares) = of_runs.unzip();
        Pulses {
            frame_s,
            middle_s,
            squares,
        }
    }

    /// The closest of all lengths that are tried.
    fn refined(&self, error: ErrorOfRun) -> Option<Pulses> {
        // Looked up errors are those of moments beside the right ones: which of the best is the best, predictions say.
        let predicted = |pulses: Pulses| pulses.predicted(pulses.frame_s, error);
        let best = best_of(self.tried(), PREDICTED).into_iter();
        let starts = best_of(best.filter_map(predicted).collect(), STARTS).into_iter();
        let refined = starts.filter_map(|start| start.refined(self.step_s, error));
        refined.min_by(|a, b| a.sum().total_cmp(&b.sum()))
    }

    /// With all lengths that are tried.
    fn tried(&self) -> Vec<Pulses> {
        let steps = (OF_LENGTH * self.about_s / self.step_s).ceil() as i32;
        let lengths = (-steps..=steps).map(|k| self.about_s + f64::from(k) * self.step_s);
        lengths.map(|frame_s| self.closest(frame_s)).collect()
    }
}

/// The least error (rms) of `record` from what is predicted with frames of about `stated_s` \[output\], as far as errors that are looked up say: at moments that are a part of a frame apart. `None` where no run can be predicted.
pub(crate) fn least_error<'r>(
    record: &Record<'r>,
    stated_s: f64,
    predict: Predict<'_, 'r>,
) -> Option<f64> {
    let all = LookedUp::of_all(record, stated_s, predict);
    let errors = all.iter().filter_map(LookedUp::least_error);
    errors.reduce(f64::min)
}

/// Which lengths are searched in full, of those about which errors that are looked up are [`ALIKE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lengths {
    /// The stated one before others: errors of a model that is off may be least anywhere.
    StatedFirst,
    /// All: nothing is stated.
    Any,
}

/// The closest pulses to the runs of a record, in frames of `stated_s` to [`OF_STATED`] of that. `None` where no run can be predicted.
pub(crate) fn closest_pulses<'r>(
    record: &Record<'r>,
    (stated_s, lengths): (f64, Lengths),
    predict: Predict<'_, 'r>,
) -> Option<ClosestPulses> {
    let all = LookedUp::of_all(record, stated_s, predict);
    let of_stated = all.first()?;
    let errors: Vec<Option<f64>> = all.iter().map(LookedUp::least_error).collect();
    let least = errors.iter().flatten().copied().reduce(f64::min)?;
    let may_be_closest = |error: &Option<f64>| error.is_some_and(|error| error < ALIKE * least);
    let most = match lengths {
        Lengths::StatedFirst => 1,
        Lengths::Any => all.len(),
    };
    let known = of_stated.known();
    let error = |run: usize, pulses: [f64; 2]| {
        let table = known.get(run)?;
        Some(table.squares(&predict(table.run, table.number, pulses)?))
    };
    // The stated length first: no other is preferred that is no closer.
    let as_stated = of_stated.closest(stated_s).refined(0.0, &error)?;
    let about = all.iter().zip(&errors);
    let about = about.filter(|(_, error)| may_be_closest(error)).take(most);
    let others = about.filter_map(|(looked_up, _)| looked_up.refined(&error));
    let refined = std::iter::once(as_stated.clone()).chain(others);
    let found = refined.min_by(|a, b| a.sum().total_cmp(&b.sum()))?;
    // A fast servo goes a tenth of a degree in a step of the others.
    let found = found.halved(HALVED + 1..=HALVED + FURTHER, of_stated.step_s, &error);
    let rms = |squares: f64| (squares / of_stated.samples()).sqrt();
    let mut middle_s = found.middle_s.iter();
    let first = of_stated.tables.iter().map(|table| {
        let middle_s = table.as_ref().and_then(|_| middle_s.next())?;
        Some(middle_s.rem_euclid(found.frame_s))
    });
    let largest = known.iter().map(|table| table.largest());
    Some(ClosestPulses {
        frame_s: found.frame_s,
        frame_step_s: of_stated.step_s,
        first_pulse_s: first.collect(),
        rmse: rms(found.sum()),
        rmse_as_stated: rms(as_stated.sum()),
        largest_rmse: rms(largest.sum()),
    })
}

/// So many with the smallest errors.
fn best_of(mut all: Vec<Pulses>, count: usize) -> Vec<Pulses> {
    all.sort_by(|a, b| a.sum().total_cmp(&b.sum()));
    all.truncate(count);
    all
}

impl Pulses {
    fn sum(&self) -> f64 {
        self.squares.iter().sum()
    }

    /// With another length, and errors of predictions.
    fn predicted(&self, frame_s: f64, error: ErrorOfRun) -> Option<Self> {
        let moments = self.middle_s.iter().enumerate();
        let squares = moments.map(|(run, middle_s)| error(run, [frame_s, *middle_s]));
        Some(Self {
            frame_s,
            middle_s: self.middle_s.clone(),
            squares: squares.collect::<Option<_>>()?,
        })
    }

    /// With steps of length and moments that are taken as long as they help, and then halved.
    fn refined(&self, frame_step_s: f64, error: ErrorOfRun) -> Option<Self> {
        let closest = self.predicted(self.frame_s, error)?;
        Some(closest.halved(1..=HALVED, frame_step_s, error))
    }

    /// The same with steps that are halved so many times.
    fn halved(&self, times: RangeInclusive<i32>, frame_step_s: f64, error: ErrorOfRun) -> Self {
        let mut closest = self.clone();
        let steps_s = [frame_step_s, self.frame_s / MOMENTS as f64];
        for halved in times {
            let steps_s = steps_s.map(|step_s| step_s * 0.5_f64.powi(halved));
            for _ in 0..STEPS {
                let before = closest.sum();
                closest.step(steps_s, error);
                if closest.sum() >= before {
                    break;
                }
            }
        }
        closest
    }

    /// A step of each moment and then one of the length, where it helps.
    fn step(&mut self, [frame_step_s, moment_step_s]: [f64; 2], error: ErrorOfRun) {
        let moments = self.middle_s.iter_mut().zip(&mut self.squares);
        for (run, (middle_s, least)) in moments.enumerate() {
            for tried_s in [*middle_s - moment_step_s, *middle_s + moment_step_s] {
                let tried = error(run, [self.frame_s, tried_s]);
                if let Some(tried) = tried.filter(|tried| tried < least) {
                    (*middle_s, *least) = (tried_s, tried);
                }
            }
        }
        if frame_step_s > 0.0 {
            for tried_s in [self.frame_s - frame_step_s, self.frame_s + frame_step_s] {
                let tried = self.predicted(tried_s, error);
                if let Some(tried) = tried.filter(|tried| tried.sum() < self.sum()) {
                    *self = tried;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lag of 30 ms in rows of 10 ms.
    fn lagged(input: &[f64]) -> Vec<f64> {
        let mut state = 0.0;
        let step = |input: &f64| {
            let before = state;
            state += (input - state) / 3.0;
            before
        };
        input.iter().map(step).collect()
    }

    /// A run of `rows` whose commands change in every second row, as no sine does.
    fn commanded<'r>(rows: usize) -> Run<'r> {
        let command = |row: usize| ((row / 2 * 7919) % 101) as f64;
        let input: Vec<f64> = (0..rows).map(command).collect();
        Run::new(input, vec![0.0; rows]).unwrap()
    }

    /// Pulses walk through a frame every 11 s, and each run begins at another moment of it.
    #[test]
    fn length_and_moments_are_found_to_a_part_of_a_step() {
        let (stated_s, frame_s, first_s) = (0.02, 0.020_037, [0.0031, 0.0174]);
        let runs = first_s.iter().zip([6000, 3000]).map(|(first_s, rows)| {
            let run = commanded(rows);
            let held = with_pulses(&run, [frame_s, *first_s].map(|time_s| 100.0 * time_s)).unwrap();
            Run::new(run.input().to_vec(), lagged(held.input())).unwrap()
        });
        let record = Record::new(0.01, runs.collect()).unwrap();
        let predict = |run: &Run<'_>, _, pulses: [f64; 2]| {
            let held = with_pulses(run, pulses.map(|time_s| 100.0 * time_s))?;
            Some(lagged(held.input()))
        };
        let found = closest_pulses(&record, (stated_s, Lengths::StatedFirst), &predict).unwrap();
        // A sixteenth of a step, which walks by a twenty-fourth of a frame until the end of the longest run; and as much of the moment.
        let step_s = stated_s / 24.0 / 16.0;
        assert!(
            (found.frame_s - frame_s).abs() < 2.0 * step_s * stated_s / 60.0,
            "{found:?}"
        );
        for (found_s, first_s) in found.first_pulse_s.iter().zip(first_s) {
            assert!(
                (found_s.unwrap() - first_s).abs() < 2.0 * step_s,
                "{found_s:?} {first_s}"
            );
        }
        // Looked up at moments that are a twenty-fourth of a frame apart.
        let error = least_error(&record, stated_s, &predict).unwrap();
        assert!(error < 0.5 * found.rmse_as_stated, "{error} {found:?}");
        // What is left of a step is a share of what a whole frame makes.
        assert!(found.rmse < 0.2 * found.rmse_as_stated, "{found:?}");
        assert!(found.rmse_as_stated < found.largest_rmse, "{found:?}");
    }

    /// Behind such errors of the output all lengths are within [`ALIKE`] as far as errors say that are looked up.
    #[test]
    fn a_length_beside_the_stated_one_is_found_behind_noise() {
        let (frame_s, first_s) = (0.02017, 0.0031);
        let run = commanded(700);
        let at_pulses = |run: &Run<'_>, pulses: [f64; 2]| {
            let held = with_pulses(run, pulses.map(|time_s| 100.0 * time_s))?;
            Some(lagged(held.input()))
        };
        let noise = (0..).map(|k| 40.0 * f64::sin((k * k) as f64));
        let clean = at_pulses(&run, [frame_s, first_s]).unwrap();
        let output = clean.into_iter().zip(noise).map(|(y, noise)| y + noise);
        let run = Run::new(run.input().to_vec(), output.collect::<Vec<f64>>()).unwrap();
        let record = Record::new(0.01, vec![run]).unwrap();
        let predict = |run: &Run<'_>, _, pulses: [f64; 2]| at_pulses(run, pulses);
        let looked_up = LookedUp::of_all(&record, 0.02, &predict);
        let errors: Vec<f64> = looked_up.iter().filter_map(LookedUp::least_error).collect();
        let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(
            errors.iter().all(|error| *error < ALIKE * least),
            "{errors:?}"
        );
        let found = closest_pulses(&record, (0.02, Lengths::Any), &predict).unwrap();
        // Half of a step, which walks by half of the way from one moment to the next until the ends of the run.
        let within_s = 0.5 * found.frame_step_s;
        assert!((found.frame_s - frame_s).abs() < within_s, "{found:?}");
    }

    #[test]
    fn the_stated_length_is_kept_where_no_other_is_closer() {
        let run = commanded(500);
        let run = Run::new(run.input().to_vec(), lagged(run.input())).unwrap();
        let record = Record::new(0.01, vec![run]).unwrap();
        let stated = (0.02, Lengths::StatedFirst);
        let found =
            closest_pulses(&record, stated, &|run, _, _| Some(vec![1.0; run.len()])).unwrap();
        assert_eq!(found.frame_s, 0.02);
        assert!(closest_pulses(&record, stated, &|_, _, _| None).is_none());
    }
}
