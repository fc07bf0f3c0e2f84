//! The means of the runs of both sides: what the servos differ by, as far as their runs scatter.
//!
//! A servo answers a little differently in every run, with its supply, its temperature and the phase of its clock. The noise of
//! the recordings says nothing of that. Each run is identified by itself, and at every point the means of both sides are
//! compared by Welch's interval, whatever it is that scatters.

use super::difference::Curves;
use super::pair::Identified;
use super::scatter_of_curves::variances;
use super::shift::shift;
use super::welch::{Welch, half_width_of_mean};
use crate::error::Error;
use crate::identify::identify_runs;
use crate::numerics::{pointwise_critical, student_critical};
use crate::results::Metrics;
use crate::thresholds::RUNS_FOR_MEAN;

/// Ways in which curves scatter independently, each of which may miss (Bonferroni): how far the servo goes, and when. Of 120 pairs
/// of one servo, 3 were shown to differ without this.
const DIRECTIONS: f64 = 2.0;

/// The curves and metrics of each run of both sides.
pub(super) struct RunMeans {
    sides: [Vec<Curves>; 2],
    metrics: [Vec<Metrics>; 2],
    level: f64,
}

impl RunMeans {
    /// `None` where a side has fewer than three runs, or one that is too short for curves of its own. `split` for up and down
    /// strokes apart; curves of so many `points`.
    pub(super) fn of(
        sides: [&Identified<'_>; 2],
        split: bool,
        points: usize,
        level: f64,
    ) -> Option<Self> {
        let [a, b] = sides.map(|side| {
            let enough = side.record.runs().len() >= RUNS_FOR_MEAN;
            enough.then(|| of_runs(side, split, points).ok())?
        });
        let ((curves_a, metrics_a), (curves_b, metrics_b)) = a.zip(b)?;
        Some(Self {
            sides: [curves_a, curves_b],
            metrics: [metrics_a, metrics_b],
            level,
        })
    }

    /// Mean of the second side less that of the first at every point of all curves, and half the width of its interval, which
    /// holds at all points at once with the probability `level`.
    pub(super) fn difference(&self, level: f64) -> (Vec<f64>, Vec<f64>) {
        let points = self.sides[0][0].value.len();
        let level = 1.0 - (1.0 - level) / DIRECTIONS;
        let [of_a, of_b] = [0, 1].map(|side| self.variances(side));
        let runs = [0, 1].map(|side| self.sides[side].len());
        let at = |m: usize| {
            let [a, b] = [0, 1].map(|side| self.each(side, |curves| curves.value[m]));
            let welch = Welch::of_variances([of_a[m], of_b[m]], runs);
            (mean(&b) - mean(&a), half_width(welch, level))
        };
        (0..points).map(at).unzip()
    }

    /// Half the width of the interval of the delay shift \[samples\]; `None` where a run has none.
    pub(super) fn shift_half(&self, first: &Curves, which: std::ops::Range<usize>) -> Option<f64> {
        let [a, b] = [0, 1].map(|side| {
            let later = |run: &Curves| shift(first, run, which.clone(), self.level).samples.value;
            self.sides[side]
                .iter()
                .map(later)
                .collect::<Option<Vec<f64>>>()
        });
        Some(half_width(Welch::new(&a?, &b?), self.level))
    }

    /// Half the width of the interval of the difference of a metric, which has this place among [`Metrics::named`]; `None` where a run has
    /// no such metric.
    pub(super) fn metric_half(&self, place: usize) -> Option<f64> {
        let [a, b] = [0, 1].map(|side| self.metric_of_runs(side, place));
        Some(half_width(Welch::new(&a?, &b?), self.level))
    }

    /// The same of that metric of one side, 0 or 1, as the mean of its runs.
    pub(super) fn metric_half_of(&self, side: usize, place: usize) -> Option<f64> {
        let runs = self.metric_of_runs(side, place)?;
        Some(half_width_of_mean(&runs, self.level))
    }

    fn metric_of_runs(&self, side: usize, place: usize) -> Option<Vec<f64>> {
        let runs = self.metrics[side].iter();
        runs.map(|run| run.named()[place].1.value).collect()
    }

    fn variances(&self, side: usize) -> Vec<f64> {
        let curves = &self.sides[side];
        let of_runs: Vec<&[f64]> = curves.iter().map(|run| run.value.as_slice()).collect();
        variances(&of_runs, curves[0].points)
    }

    fn each(&self, side: usize, of: impl Fn(&Curves) -> f64) -> Vec<f64> {
        self.sides[side].iter().map(of).collect()
    }
}

/// Half the width of the interval of a difference with so many runs on each side that scatter alike, in standard deviations of a run.
pub(super) fn half_width_by_runs(runs: usize, level: f64) -> f64 {
    let level = 1.0 - (1.0 - level) / DIRECTIONS;
    let degrees = 2.0 * (runs as f64 - 1.0);
    let critical = student_critical(pointwise_critical(level), &[degrees])[0];
    critical * (2.0 / runs as f64).sqrt()
}

/// Half the width of Welch's interval; zero where nothing scatters.
fn half_width(welch: Option<Welch>, level: f64) -> f64 {
    welch.map_or(0.0, |welch| welch.half_width(level))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The curves and the metrics of each run alone, by the structure of the comparison.
fn of_runs(
    side: &Identified<'_>,
    split: bool,
    points: usize,
) -> Result<(Vec<Curves>, Vec<Metrics>), Error> {
    let models = side
        .run_records()
        .map(|run| Ok(identify_runs(&run?, &side.options, side.may_go_on)?.model))
        .collect::<Result<Vec<_>, Error>>()?;
    let curves = match split {
        true => {
            let models = side.splits_of_runs(side.model.basis()?)?;
            models
                .iter()
                .map(|model| Curves::of_split(model, points))
                .collect()
        }
        false => models
            .iter()
            .map(|model| Curves::of_model(model, points))
            .collect::<Result<_, _>>()?,
    };
    Ok((curves, models.iter().map(|model| model.metrics).collect()))
}
