//! One side of a comparison, identified.

use super::motion::ends;
use super::outcome::{Asymmetry, Levels};
use super::welch::half_width_of_mean;
use crate::data::Record;
use crate::diagnostics::TakenOut;
use crate::error::Error;
use crate::estimation::FsfBasis;
use crate::identify::{Identification, identify_runs};
use crate::nonlinear::{DirectionModel, Limits, explains_errors, split_with};
use crate::numerics::{not_negative, pointwise_critical};
use crate::options::{Frequencies, NoiseOrder, Options, Settling};
use crate::results::{Advice, Bounds, Interval, Model, Reason};
use crate::thresholds::RUNS_FOR_MEAN;

/// One side, identified.
pub(super) struct Identified<'a> {
    pub(super) record: &'a Record<'a>,
    /// The record without what its model takes out.
    without_outliers: Record<'a>,
    pub(super) model: Model,
    pub(super) split: Option<DirectionModel>,
    /// How the model was identified, with the structure of both sides.
    pub(super) options: Options,
    /// Whether the response may go on beyond the settling time of that structure.
    pub(super) may_go_on: bool,
    /// The model with a structure of its own. Bounds hold only where its own do. It carries the advice.
    pub(super) alone: Model,
}

impl<'a> Identified<'a> {
    /// `of_other` is why the other side has no bounds by itself. Its structure is the common one then, and what this side loses by it is lost for that
    /// reason.
    fn new(
        record: &'a Record<'a>,
        alone: Identification,
        of_other: Option<Reason>,
        options: &Options,
    ) -> Result<Self, Error> {
        let may_go_on = alone.explanation.may_go_on();
        let mut found = identify_runs(record, options, may_go_on)?;
        let lost = found.model.level().withdrawn().and(of_other);
        if let Some(reason) = alone.model.level().withdrawn().or(lost) {
            found.model.withdraw(reason);
        }
        Self::of(record, found, alone, options)
    }

    /// With the structure that was found for this side alone.
    fn with_its_own_structure(
        record: &'a Record<'a>,
        alone: Identification,
        options: &Options,
    ) -> Result<Self, Error> {
        let own = Options {
            settling: Settling::Samples(alone.model.structure.settling_samples),
            frequencies: Frequencies::Count(alone.model.structure.frequencies),
            ..*options
        };
        Self::of(record, alone.clone(), alone, &own)
    }

    /// A side that was `found` with these options, and `alone` with a structure of its own.
    fn of(
        record: &'a Record<'a>,
        found: Identification,
        alone: Identification,
        options: &Options,
    ) -> Result<Self, Error> {
        let Identification { model, explanation } = found;
        let may_go_on = alone.explanation.may_go_on();
        let by_direction = alone.explanation.may_go_on_by_direction();
        // A record without an answer, such as one with strokes in one direction only, is no error here.
        let basis = model.basis()?;
        let without_outliers = TakenOut::without(&explanation.taken_out, record);
        let split = split_with(
            &without_outliers,
            basis,
            NoiseOrder::Auto,
            model.level(),
            |split| by_direction && explains_errors(&model, split),
        )
        .ok();
        Ok(Self {
            record,
            without_outliers,
            model,
            split,
            options: *options,
            may_go_on,
            alone: alone.model,
        })
    }

    /// Each run without outliers as a record of its own.
    pub(super) fn run_records(&self) -> impl Iterator<Item = Result<Record<'_>, Error>> {
        let record = &self.without_outliers;
        let (period_s, phase_s) = (record.sample_period_s(), record.sample_phase_s());
        record.runs().iter().map(move |run| {
            Ok(Record::new(period_s, vec![run.clone()])?.with_sample_phase(phase_s))
        })
    }

    /// A model of each run alone, whose bounds hold if those of the side do.
    pub(super) fn splits_of_runs(&self, basis: FsfBasis) -> Result<Vec<DirectionModel>, Error> {
        self.run_records()
            .map(|run| {
                split_with(&run?, basis, NoiseOrder::Auto, self.model.level(), |_| {
                    false
                })
            })
            .collect()
    }

    pub(super) fn asymmetric(&self) -> bool {
        self.split.as_ref().is_some_and(DirectionModel::asymmetric)
    }

    pub(super) fn asymmetry(&self) -> Asymmetry {
        let symmetry = self.split.as_ref().and_then(|split| split.symmetry.valid());
        Asymmetry {
            p: symmetry.map(|symmetry| symmetry.p),
            largest_percent: symmetry.map(|found| 100.0 * found.largest_difference),
        }
    }

    /// Rest at the ends of the command: from the plateaus, and from the static line where a linear servo, or one with two levels, came there once. Empty where the command is not held until the servo rests, and where the output drifts, so that it rests elsewhere
    /// each time.
    ///
    /// Of three or more runs the intervals are those of the servo: they contain the scatter of the runs.
    pub(super) fn levels(&self) -> Levels {
        let of_all = self.levels_in(self.record, self.split.as_ref());
        let runs = self.levels_of_runs();
        let half = |of: fn(&Levels) -> Interval| {
            let rests: Option<Vec<f64>> = runs.iter().map(|run| of(run).value).collect();
            let rests = rests.filter(|rests| rests.len() >= RUNS_FOR_MEAN)?;
            let level = self.model.level().into_valid()?;
            Some(half_width_of_mean(&rests, level))
        };
        let with_runs = |of: fn(&Levels) -> Interval| match runs.is_empty() {
            true => of(&of_all),
            false => of(&of_all).at_least_as_wide(half(of)),
        };
        Levels {
            plus: with_runs(|levels| levels.plus),
            minus: with_runs(|levels| levels.minus),
            ..of_all
        }
    }

    /// Of each run by itself, where there are enough for a mean.
    fn levels_of_runs(&self) -> Vec<Levels> {
        let runs = self.run_records().collect::<Result<Vec<_>, _>>();
        let runs = runs.unwrap_or_default();
        if runs.len() < RUNS_FOR_MEAN {
            return Vec::new();
        }
        let basis = self.model.basis();
        let splits = basis.and_then(|basis| self.splits_of_runs(basis));
        let splits = splits.unwrap_or_default();
        let of_run = |(number, record)| self.levels_in(record, splits.get(number));
        runs.iter().enumerate().map(of_run).collect()
    }

    /// Of these runs, and the model of the directions of them.
    fn levels_in(&self, record: &Record, split: Option<&DirectionModel>) -> Levels {
        let (low, high) = ends(self.record);
        let cells = Limits::level_table(record, &self.model);
        let mut commands: Vec<f64> = cells.iter().map(|cell| cell.command).collect();
        commands.dedup();
        let rest = |command: f64| {
            if self.drifts() || !commands.contains(&command) {
                return Interval::default();
            }
            let cell = cells
                .iter()
                .find(|cell| cell.command == command && cell.visits > 1);
            match (cell, split) {
                // A line goes through all that was recorded, a long rest before the first stroke too, and a servo with friction may rest elsewhere there.
                (Some(cell), _) => cell.reached,
                (None, Some(split)) if commands.len() <= 2 || self.alone.linear => {
                    split.level_at(command)
                }
                _ => Interval::default(),
            }
        };
        Levels {
            command_plus: high,
            plus: rest(high),
            command_minus: low,
            minus: rest(low),
        }
    }

    /// Whether a straight line was taken out of the output of each run.
    fn drifts(&self) -> bool {
        self.alone.advice.iter().any(Advice::is_of_drift)
    }

    /// Where the servo stands at the ends of the command, low and high: where it rests there or, if it was not seen to, on the static line. One whose
    /// output drifts stands nowhere.
    pub(super) fn stands_at(&self, rests: &Levels) -> Option<[f64; 2]> {
        if self.drifts() {
            return None;
        }
        let on_line = |command: f64| self.split.as_ref()?.level_at(command).value;
        let seen = rests.minus.value.zip(rests.plus.value);
        let both = seen.or_else(|| on_line(rests.command_minus).zip(on_line(rests.command_plus)));
        both.map(<[f64; 2]>::from)
    }

    /// Standard deviation of the rest at the largest and the smallest command.
    pub(super) fn sd_at_rest(&self) -> Bounds<[f64; 2]> {
        let (low, high) = ends(self.record);
        self.model.bounds.as_ref().map(|bounds| {
            let critical = pointwise_critical(bounds.level);
            [high, low].map(|command| match &self.split {
                Some(split) => {
                    let rest = split.level_at(command);
                    rest.upper
                        .zip(rest.lower)
                        .map_or(0.0, |(up, low)| (up - low) / 2.0 / critical)
                }
                None => command.abs() * not_negative(bounds.covariance[0][0]).sqrt(),
            })
        })
    }
}

/// Both sides with one structure: the longer settling time of the two, as far as the references of
/// both distinguish lags. Where a side that has bounds by itself loses them with that, as a servo that is not linear may, each keeps its own structure, and
/// so it does where that time is longer than one side, which is not linear, responds for.
/// Neither has bounds where those of one are `withheld`.
pub(super) fn identified<'a>(
    a: &'a Record<'a>,
    b: &'a Record<'a>,
    options: &Options,
    withheld: [Option<Reason>; 2],
) -> Result<(Identified<'a>, Identified<'a>), Error> {
    same_period(a.sample_period_s(), b.sample_period_s())?;
    let found = [a, b].map(|record| identify_runs(record, options, false));
    let [alone_a, alone_b] = found;
    let found = [alone_a?, alone_b?];
    let distinct = found.iter().filter_map(|side| {
        let choice = side.explanation.settling.as_ref()?;
        // An odd number of lags, as every complete bank has.
        Some((choice.repeats_after? - 1) | 1)
    });
    let distinct = distinct.min().unwrap_or(usize::MAX);
    let structure = [&found[0].model.structure, &found[1].model.structure];
    let longer = structure[0]
        .settling_samples
        .max(structure[1].settling_samples);
    let common = Options {
        settling: Settling::Samples(longer.min(distinct)),
        frequencies: match options.frequencies {
            // Where one side is low-passed, both are seen through its bank.
            Frequencies::Auto
                if structure
                    .iter()
                    .any(|s| s.frequencies < s.settling_samples - 1) =>
            {
                Frequencies::Count(structure[0].frequencies.min(structure[1].frequencies))
            }
            other => other,
        },
        ..*options
    };
    let is_too_long = found.iter().any(|side| {
        let limited = side.explanation.settling.as_ref();
        limited.is_some_and(|choice| choice.within_holds && longer > choice.longest)
    });
    let [mut alone_a, mut alone_b] = found;
    for (alone, reason) in [&mut alone_a, &mut alone_b].into_iter().zip(withheld) {
        if let Some(reason) = reason {
            alone.model.withdraw(reason);
        }
    }
    let [of_a, of_b] = [&alone_a, &alone_b].map(|alone| alone.model.level().withdrawn());
    let together = [
        Identified::new(a, alone_a.clone(), of_b, &common)?,
        Identified::new(b, alone_b.clone(), of_a, &common)?,
    ];
    let is_lost = |side: &Identified<'_>| side.model.level().withdrawn().is_some();
    let loses_bounds = of_a.or(of_b).is_none() && together.iter().any(is_lost);
    let [side_a, side_b] = if is_too_long || loses_bounds {
        [
            Identified::with_its_own_structure(a, alone_a, options)?,
            Identified::with_its_own_structure(b, alone_b, options)?,
        ]
    } else {
        together
    };
    Ok((side_a, side_b))
}

/// Periods that differ by this part of them are one: two crystals of 50 ppm differ by as much, a response moves by as little of its time, and
/// another rate differs far more.
const SAME_PERIOD: f64 = 1e-4;

pub(super) fn same_period(expected: f64, found: f64) -> Result<(), Error> {
    if ((found - expected) / expected).abs() > SAME_PERIOD {
        return Err(Error::PeriodMismatch { expected, found });
    }
    Ok(())
}
