//! A record without its disturbances.
//!
//! They are found in the errors of a fit, and a fit is better without them. So fit and search take turns until the
//! search finds the same again.

use super::candidate::Candidate;
use super::disturbances::Disturbances;
use super::estimate::Estimate;
use crate::data::column::span;
use crate::data::{HELD, Moments, Quantisation, Record, Run, sensor_step, usual_hold};
use crate::diagnostics::{
    Beside, LevelEffects, Outliers, RunOffsets, RunTrends, Simulated, StartElsewhere, drift, hum,
    outliers, run_offsets, simulated, simulated_whole, slopes_left,
};
use crate::error::Error;
use crate::estimation::Excitation;
use crate::options::{Detrend, Options};
use crate::selection::odd_at_most;
use crate::thresholds::IMMATERIAL_ERROR;
use std::borrow::Cow;

/// Turns of fit and search.
const TURNS: usize = 5;

/// Turns in which the noise model is found that is left beside levels.
const TURNS_OF_LEVELS: usize = 10;

/// A record without its disturbances, and the fit to it.
#[derive(Clone)]
pub(super) struct Undisturbed<'a> {
    pub(super) record: Record<'a>,
    pub(super) disturbances: Disturbances,
    pub(super) candidate: Candidate,
    pub(super) estimate: Estimate,
}

impl<'a> Undisturbed<'a> {
    pub(super) fn of(record: &'a Record, options: &Options) -> Result<Self, Error> {
        let complete = record.with_complete_inputs();
        let first = Self::without(Disturbances::default(), &complete, options)?;
        let mut found = first.in_turns(&complete, options, false)?;
        for explained_by in [Self::with_runs_apart, Self::with_levels_put_right] {
            if let Some(better) = explained_by(&found, &complete, options) {
                found = better.in_turns(&complete, options, false)?;
            }
        }
        Ok(found)
    }

    /// Without where its runs begin, if that is elsewhere than where the servo comes to rest later.
    pub(super) fn without_start(&self, record: &'a Record, options: &Options) -> Option<Self> {
        let Estimate {
            information, fit, ..
        } = &self.estimate;
        let start = StartElsewhere::of(&self.record, &information.moments, fit)?;
        let disturbances = Disturbances {
            start: Some(start),
            ..self.disturbances.clone()
        };
        let complete = record.with_complete_inputs();
        let found = Self::without(disturbances, &complete, options).ok()?;
        found.in_turns(&complete, options, false).ok()
    }

    /// The usual hold, where the response goes on beyond it.
    fn outlasted_hold(&self) -> Option<usize> {
        let choice = self.candidate.plan.choice.as_ref()?;
        let hold = usual_hold(&self.record);
        (choice.settling > hold && hold >= HELD).then_some(hold)
    }

    /// With an offset of each run and no more, where that is a better explanation than a response that goes on beyond the usual hold: runs have few parts as long as that, which
    /// show no offsets, and what it leaves of these looks like a drift.
    fn with_runs_apart(&self, complete: &Record<'a>, options: &Options) -> Option<Self> {
        let hold = self.outlasted_hold()?;
        let found = &self.disturbances;
        let have_offsets_alone = !found.offsets.is_empty() && found.trends.is_empty();
        if options.detrend != Detrend::Auto || have_offsets_alone {
            return None;
        }
        let mut disturbances = Disturbances {
            offsets: RunOffsets::default(),
            trends: RunTrends::default(),
            ..found.clone()
        };
        let record = disturbances.removed_from(complete);
        // What a response of one hold lacks is in all runs, and no offset of one.
        let settling = odd_at_most(hold);
        let Candidate { plan, moments, .. } =
            Candidate::for_settling(&record, settling, options).ok()?;
        let estimate = Estimate::new(&plan, &moments, Some(&record)).ok()?;
        let (moments, fit) = (&estimate.information.moments, &estimate.fit);
        let left = simulated_whole(&record, moments, fit);
        let beside = Beside {
            left: &left,
            taken_out: &[],
            moments,
            fit,
        };
        disturbances.offsets = run_offsets(&left, Some(beside), settling, true);
        self.unless_worse(disturbances, complete, options)
    }

    /// With the levels put right that are off, where that is a better explanation than a response that goes on beyond the usual hold.
    fn with_levels_put_right(&self, complete: &Record<'a>, options: &Options) -> Option<Self> {
        let hold = self.outlasted_hold()?;
        let disturbances = Disturbances {
            levels: self.levels_off(hold, options)?,
            ..self.disturbances.clone()
        };
        self.unless_worse(disturbances, complete, options)
    }

    /// Without these disturbances, if that is the better explanation.
    fn unless_worse(
        &self,
        disturbances: Disturbances,
        complete: &Record<'a>,
        options: &Options,
    ) -> Option<Self> {
        let found = Self::without(disturbances, complete, options).ok()?;
        (found.criterion() < self.criterion()).then_some(found)
    }

    /// How far levels are off, by the errors of a response that is over within a `hold`.
    fn levels_off(&self, hold: usize, options: &Options) -> Option<LevelEffects> {
        let Candidate { plan, moments, .. } =
            Candidate::for_settling(&self.record, odd_at_most(hold), options).ok()?;
        let lags = (moments.input_lags(), moments.output_lags());
        let mut levels = LevelEffects::default();
        for _ in 0..TURNS_OF_LEVELS {
            let record = levels.put_right(&self.record);
            let moments = Moments::of_record(&record, lags.0, lags.1);
            let estimate = Estimate::new(&plan, &moments, Some(&record)).ok()?;
            let (moments, fit) = (&estimate.information.moments, &estimate.fit);
            let runs = simulated(&record, moments, fit);
            levels = match levels.is_empty() {
                true => LevelEffects::begun(&runs, moments, fit)?,
                false => levels.improved(&runs, moments, fit)?,
            };
        }
        Some(levels)
    }

    /// Bayes' criterion for each row, which is comparable between settling times. Errors that are nothing beside the motion, as those of a record
    /// without noise, count alike.
    fn criterion(&self) -> f64 {
        let Estimate {
            information, fit, ..
        } = &self.estimate;
        let rows = fit.rows as f64;
        let least = IMMATERIAL_ERROR.powi(2) * information.moments.output_spread() / rows;
        let found = &self.disturbances;
        let of_runs = found.offsets.len() + found.trends.len();
        let parameters = fit.coordinates.len() + fit.ar.len() + found.levels.len() + of_runs;
        fit.variance.max(least).ln() + parameters as f64 * rows.ln() / rows
    }

    /// Whether a search for smaller outliers, too, may find others.
    pub(super) fn may_have_smaller_outliers(&self) -> bool {
        self.disturbances.outliers.may_have_smaller
    }

    /// Without smaller outliers, too. Errors of a servo that is not linear may be as large, so the record without the larger ones must
    /// have a level, and a linear servo.
    pub(super) fn without_smaller_outliers(
        self,
        record: &'a Record,
        options: &Options,
    ) -> Result<Self, Error> {
        self.in_turns(&record.with_complete_inputs(), options, true)
    }

    /// After turns of search and fit; `smaller` as in [`outliers`].
    fn in_turns(
        self,
        complete: &Record<'a>,
        options: &Options,
        smaller: bool,
    ) -> Result<Self, Error> {
        let mut found = self;
        for _ in 0..TURNS {
            let next = found.searched(complete, options.detrend, smaller);
            if found.disturbances.are_as(&next) {
                found.disturbances.outliers = next.outliers;
                break;
            }
            let Ok(again) = Self::without(next, complete, options) else {
                break;
            };
            found = again;
            // Only a search that finds the same again says that there are none.
            found.disturbances.outliers.may_have_smaller = true;
        }
        let outliers = &found.disturbances.outliers;
        let kept = match outliers {
            found if found.provisional => Outliers::default(),
            found if found.lasting_are_fast => found.of_shape(),
            _ => return Ok(found),
        };
        let disturbances = Disturbances {
            outliers: kept,
            ..found.disturbances
        };
        Self::without(disturbances, complete, options)
    }

    /// With all that may be errors of the model: without the offsets and trends of runs, and spikes, alone.
    pub(super) fn with_errors(
        record: &'a Record,
        options: &Options,
        found: &Disturbances,
    ) -> Result<Self, Error> {
        let complete = record.with_complete_inputs();
        Self::without(found.that_are_no_errors(), &complete, options)
    }

    fn without(
        disturbances: Disturbances,
        complete: &Record<'a>,
        options: &Options,
    ) -> Result<Self, Error> {
        let record = disturbances.removed_from(complete);
        let candidate = Candidate::of_record(&record, options)?;
        let estimate = Estimate::new(&candidate.plan, &candidate.moments, Some(&record))?;
        Ok(Self {
            record,
            disturbances,
            candidate,
            estimate,
        })
    }

    /// The disturbances of `complete` in its errors.
    fn searched(&self, complete: &Record, detrend: Detrend, smaller: bool) -> Disturbances {
        let Estimate {
            information, fit, ..
        } = &self.estimate;
        let moments = &information.moments;
        let settling = self.candidate.plan.basis.settling();
        let mut next = Disturbances {
            outliers: self.disturbances.outliers.clone(),
            levels: self.disturbances.levels.clone(),
            start: self.disturbances.start.clone(),
            ..Disturbances::default()
        };
        // Each is looked for in the errors that the ones before leave.
        let first = next.removed_from(complete);
        let (without_trends, without_offsets, without_hum);
        let mut errors = simulated_whole(&first, moments, fit);
        let drifts = match detrend {
            Detrend::None | Detrend::Offset => false,
            Detrend::Auto => drift(&errors),
            Detrend::Linear => true,
        };
        if drifts {
            next.trends = self.slopes(complete);
        }
        let drifts = !next.trends.is_empty();
        if drifts {
            without_trends = next.removed_from(complete);
            errors = simulated_whole(&without_trends, moments, fit);
        }
        let offsets = |errors: &[Simulated<'_>], wanted: bool| {
            let taken_out = self.disturbances.offsets.as_slice();
            // Before any are taken out, they are noise to the noise model, which hides them.
            let white = (taken_out.is_empty()).then(|| fit.in_white_noise(information));
            let fit = white.flatten().map_or(Cow::Borrowed(fit), Cow::Owned);
            let left = simulated_whole(&self.record, moments, &fit);
            let beside = Beside {
                left: &left,
                taken_out,
                moments,
                fit: &fit,
            };
            // Slopes are found beside the response, too: both at once would take what is one error out twice.
            run_offsets(errors, (!drifts).then_some(beside), settling, wanted)
        };
        next.offsets = match detrend {
            Detrend::None => Vec::new(),
            Detrend::Auto => offsets(&errors, false),
            Detrend::Offset | Detrend::Linear => offsets(&errors, true),
        };
        if !next.offsets.is_empty() {
            without_offsets = next.removed_from(complete);
            errors = simulated_whole(&without_offsets, moments, fit);
        }
        let rmse = self.estimate.rmse();
        let step = sensor_step(complete).unwrap_or(0.0);
        // Rounding that noise hardly dithers repeats itself with the reference.
        if Quantisation::of(complete, 0.0).is_none_or(|found| rmse > found.step) {
            next.hum = hum(&errors, fit);
        }
        let outliers_before = std::mem::take(&mut next.outliers);
        if !(next.hum.is_empty() && outliers_before.taken_out.is_empty()) {
            without_hum = next.removed_from(complete);
            errors = simulated_whole(&without_hum, moments, fit);
        }
        let found = outliers(&errors, moments, fit, step, smaller);
        // Under a smooth input the bank of a few frequencies lacks some of the motion, and large errors are that, as where a sweep ends. No motion makes a spike.
        next.outliers = match found.count() > 0 && Excitation::of(moments).is_smooth() {
            true => found.of_shape(),
            false => found,
        };
        next
    }

    /// The slopes of the runs: those that were taken out, and what the errors say that is left. None where a line changes by more than all that was measured: it is not in
    /// that, and beside a response that is longer than the servo's, slopes may be anything.
    fn slopes(&self, complete: &Record) -> RunTrends {
        let Estimate {
            information, fit, ..
        } = &self.estimate;
        let moments = &information.moments;
        let left = slopes_left(&simulated_whole(&self.record, moments, fit), moments, fit);
        let taken_out = &self.disturbances.trends;
        let taken_out = |run: usize| taken_out.get(run).copied().unwrap_or(0.0);
        let slopes = (0..).zip(left).map(|(run, left)| taken_out(run) + left);
        let slopes: RunTrends = slopes.collect();
        let most = span(complete.outputs().filter(|y| !y.is_nan())).unwrap_or_default();
        let change = |(run, slope): (&Run<'_>, &f64)| slope.abs() * run.len() as f64;
        let mut changes = complete.runs().iter().zip(&slopes).map(change);
        match changes.all(|change| change <= most) {
            true => slopes,
            false => RunTrends::default(),
        }
    }
}
