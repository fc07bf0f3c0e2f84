//! Samples that are outlying one step ahead: glitches, bursts, a start elsewhere, the ends of heavy tails.
//!
//! The noise v = ε/D(z) is predicted from its past. A sample whose error is beyond a limit is taken as missing, and
//! so are the rows of the regression that contain it. A taken-out sample is no
//! past for the next ones: they are predicted from the samples before it, with the variance that this has
//! (Kalman's filter with the last d values of v as its state), so that one glitch does not make d good samples
//! outlying.
//!
//! The scale is a median, which glitches do not move, and larger in motion where errors are. What is outlying
//! must be rare and unrelated to the motion: where a servo that is not linear misses its model, samples are evidence,
//! not glitches, and none is taken out but single [`spikes`].

use statrs::distribution::{Binomial, DiscreteCDF};

use super::other_strokes::mark_other_strokes;
use super::spikes::{Course, spikes};
use super::taken_out::TakenOut;
use crate::data::Moments;
use crate::diagnostics::noise::uneven_noise::{motion, squared_speed};
use crate::diagnostics::residuals::noise_prediction::NoisePrediction;
use crate::diagnostics::residuals::simulation_error::{Simulated, one_step_errors};
use crate::estimation::GlsFit;
use crate::numerics::{chi_square_upper_tail, median, normal_cdf, normal_upper_quantile};
use crate::thresholds::{
    FALSELY_OUTLYING, MOST_OUTLYING, OUTLYING_BY_CHANCE, RESIDUAL_SIGNIFICANCE,
};

/// Ratio of the median of squares to the variance, of Gaussian noise.
const MEDIAN_OF_SQUARES: f64 = 0.4549;

/// Share of the largest q above which a sample is in motion.
const IN_MOTION: f64 = 0.05;

/// Errors that each counts as where the sensor has steps: the scale is within 5 % of that of even ones.
const SPREAD: u32 = 10;

/// Number of samples.
fn count(taken_out: &[TakenOut]) -> usize {
    taken_out.iter().map(|found| found.samples).sum()
}

/// What is outlying in a record.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Outliers {
    pub(crate) taken_out: Vec<TakenOut>,
    /// The [`spikes`], which no motion makes, whatever model is wrong.
    pub(crate) spikes: Vec<TakenOut>,
    /// Standard deviations beyond which a sample was taken out.
    limit: f64,
    /// Share of samples less than one standard deviation within the limit.
    pub(crate) near_limit: f64,
    /// Excess kurtosis of the samples that are left, each in its standard deviations.
    pub(crate) excess: f64,
    /// Whether those in motion were left in the record, because they are more than chance would put there: the
    /// others help the next fit, but are no finding.
    pub(crate) provisional: bool,
    /// Whether those of several samples are where the servo is faster than chance would have it. A fit that glitches have drawn leaves such
    /// errors, too, so this counts once search and fit agree.
    pub(crate) lasting_are_fast: bool,
    /// Whether a search for smaller ones, too, may find others.
    pub(crate) may_have_smaller: bool,
}

impl Outliers {
    /// Number of samples.
    pub(crate) fn count(&self) -> usize {
        count(&self.taken_out)
    }

    /// Whether strokes of another size than most are answered differently.
    pub(crate) fn other_strokes(&self) -> bool {
        self.taken_out.iter().any(|found| found.other_stroke)
    }

    /// Marks what is a spike.
    fn mark(&mut self, spikes: Vec<TakenOut>) {
        for single in self.taken_out.iter_mut().filter(|found| found.samples == 1) {
            single.spike = spikes
                .iter()
                .any(|spike| (spike.run, spike.sample) == (single.run, single.sample));
        }
        self.spikes = spikes;
    }

    /// The spikes alone: all that is no error of the model.
    pub(crate) fn of_shape(&self) -> Self {
        Self {
            taken_out: self.spikes.clone(),
            ..self.clone()
        }
    }

    /// By how much the variance of an estimate from the samples that are left exceeds that of noise of their
    /// spread. With rejection beyond c the influence is ψ(x) = x 1(|x| < c), and the variance E ψ² / (E ψ')²,
    /// E ψ' = 1 - 2 c f(c) with the density f (Huber 1964).
    pub(crate) fn variance_ratio(&self) -> f64 {
        (1.0 - self.limit * self.near_limit).max(0.5).powi(-2)
    }
}

/// What is outlying among the errors of `fit`; steps of the sensor of size `step` are noise. With `smaller` ones, the limit is the
/// [lower](lower_limit) one where there are any.
pub(crate) fn outliers(
    runs: &[Simulated<'_>],
    moments: &Moments,
    fit: &GlsFit,
    step: f64,
    smaller: bool,
) -> Outliers {
    let motions: Vec<Vec<f64>> = (runs.iter())
        .map(|run| motion(&squared_speed(run), &fit.ar))
        .collect();
    let Some(scale) = Scale::of(runs, &motions, fit, step) else {
        return Outliers::default();
    };
    let moving = IN_MOTION * scale.largest_motion;
    let seen_beyond = |limit: f64| {
        let mut seen = Seen::beyond(limit);
        for (index, (run, motion)) in runs.iter().zip(&motions).enumerate() {
            let mut filter = NoisePrediction::new(&fit.ar, scale.even, limit);
            for (k, error) in run.own_errors().iter().enumerate() {
                if let Some(size) = filter.next(*error, scale.in_motion * motion[k]) {
                    let in_motion = motion[k] > moving;
                    seen.sample((index, k), size, (motion[k], in_motion));
                }
            }
        }
        mark_other_strokes(&mut seen.outlying, runs, &motions, moving);
        seen
    };
    let few = |count: usize| count as f64 <= MOST_OUTLYING * moments.samples() as f64;
    let are_no_errors = |seen: &Seen| few(seen.count()) && seen.is_unrelated_to_motion();
    let limit = outlying(moments.samples());
    let mut seen = seen_beyond(limit);
    let lower = match !seen.outlying.is_empty() && are_no_errors(&seen) {
        true => lower_limit(&seen.sizes),
        false => limit,
    };
    let may_have_smaller = lower < limit;
    if smaller && may_have_smaller {
        let more = seen_beyond(lower);
        if are_no_errors(&more) {
            seen = more;
        }
    }
    let mut found = Outliers {
        limit: seen.limit,
        near_limit: seen.near as f64 / seen.sizes.len().max(1) as f64,
        excess: excess(seen.sizes.iter().copied().filter(|size| *size < seen.limit)),
        may_have_smaller,
        ..Outliers::default()
    };
    if seen.outlying.is_empty() {
        return found;
    }
    let spikes = spikes_of(runs, &motions, moving);
    let (rare, unrelated) = (few(seen.count()), seen.is_unrelated_to_motion());
    found.lasting_are_fast = seen.lasting_are_fast();
    found.taken_out = seen.outlying;
    if few(spikes.len()) {
        found.mark(spikes);
    }
    if rare && unrelated {
        return found;
    }
    if !found.spikes.is_empty() {
        return found.of_shape();
    }
    if !rare {
        return Outliers {
            excess: excess(seen.sizes.iter().copied()),
            ..Outliers::default()
        };
    }
    found.taken_out = seen.at_rest;
    found.provisional = true;
    found
}

/// The standard deviations beyond which a sample of so many is outlying: [`OUTLYING_BY_CHANCE`] of Gaussian noise are.
fn outlying(samples: usize) -> f64 {
    normal_upper_quantile(0.5 * OUTLYING_BY_CHANCE / samples.max(1) as f64)
}

/// The limit beyond which samples of these sizes (in standard deviations) are outlying where some are: the lowest at which Gaussian noise has
/// no more than [`FALSELY_OUTLYING`] of those beyond it (Benjamini and Hochberg 1995), and the [usual](outlying) one at the most.
///
/// Smaller outliers have to go, too: a point of a response rests on as many samples as the reference has edges, and two outliers among
/// these draw the point so far that neither is outlying.
fn lower_limit(sizes: &[f64]) -> f64 {
    let usual = outlying(sizes.len());
    let count = sizes.len() as f64;
    let most = (MOST_OUTLYING * count) as usize;
    let mut largest = sizes.to_vec();
    let falling = |a: &f64, b: &f64| b.total_cmp(a);
    if most < largest.len() {
        largest.select_nth_unstable_by(most, falling);
        largest.truncate(most);
    }
    largest.sort_unstable_by(falling);
    let falsely = |size: f64| count * 2.0 * normal_cdf(-size);
    let beyond = largest.iter().zip(1..);
    let possible =
        beyond.filter(|(size, found)| falsely(**size) <= FALSELY_OUTLYING * f64::from(*found));
    possible.last().map_or(usual, |(size, _)| size.min(usual))
}

/// Excess kurtosis of errors of these sizes; 0 where their tails are no heavier than Gaussian ones.
fn excess(sizes: impl Iterator<Item = f64>) -> f64 {
    let powers = sizes.map(|size| [1.0, size.powi(2), size.powi(4)]);
    let [count, squares, fourths] =
        powers.fold([0.0; 3], |[a, b, c], [d, e, f]| [a + d, b + e, c + f]);
    (count * fourths / (squares * squares) - 3.0).max(0.0)
}

/// What the errors one step ahead are, counted sample by sample.
#[derive(Default)]
struct Seen {
    /// Standard deviations from which on a sample is outlying.
    limit: f64,
    /// The errors of all of them, in standard deviations.
    sizes: Vec<f64>,
    /// The q of all of them.
    motions: Vec<f64>,
    /// Those in motion.
    moving: usize,
    /// Those less than one standard deviation within the limit.
    near: usize,
    /// Stretches of outlying samples.
    outlying: Vec<TakenOut>,
    /// How many samples of each of them are in motion.
    outlying_in_motion: Vec<usize>,
    /// Sum of the q of each of them.
    outlying_motion: Vec<f64>,
    /// Outlying samples at rest.
    at_rest: Vec<TakenOut>,
}

impl Seen {
    fn beyond(limit: f64) -> Self {
        Self {
            limit,
            ..Self::default()
        }
    }

    /// Counts sample `k` of run `index`, both from 0, whose error is `size` standard deviations in a motion of this q.
    fn sample(&mut self, (index, k): (usize, usize), size: f64, (motion, in_motion): (f64, bool)) {
        self.sizes.push(size);
        self.motions.push(motion);
        self.moving += usize::from(in_motion);
        self.near += usize::from((self.limit - 1.0..self.limit).contains(&size));
        if size < self.limit {
            return;
        }
        let single = TakenOut {
            run: index + 1,
            sample: k,
            samples: 1,
            spike: false,
            other_stroke: false,
        };
        if !in_motion {
            self.at_rest.push(single);
        }
        match self.outlying.last_mut() {
            Some(last) if last.run == single.run && last.sample + last.samples == k => {
                last.samples += 1;
            }
            _ => {
                self.outlying_in_motion.push(0);
                self.outlying_motion.push(0.0);
                self.outlying.push(single);
            }
        }
        if let Some(moving) = self.outlying_in_motion.last_mut() {
            *moving += usize::from(in_motion);
        }
        if let Some(sum) = self.outlying_motion.last_mut() {
            *sum += motion;
        }
    }

    /// Number of outlying samples.
    fn count(&self) -> usize {
        count(&self.outlying)
    }

    /// Whether chance would put as many of them into the motion, most of each counting: an answer that is missed is outlying before the
    /// servo has gathered speed. Those of strokes of another size are no question of chance.
    fn is_unrelated_to_motion(&self) -> bool {
        let share = self.moving as f64 / self.sizes.len().max(1) as f64;
        let stretches = self.outlying.iter().zip(&self.outlying_in_motion);
        let stretches = stretches.filter(|(found, _)| !found.other_stroke);
        let chance = Binomial::new(share, stretches.clone().count() as u64);
        let moving = stretches.filter(|(found, moving)| 2 * **moving > found.samples);
        let in_motion = moving.count() as u64;
        in_motion == 0
            || chance.is_ok_and(|chance| chance.sf(in_motion - 1) > RESIDUAL_SIGNIFICANCE)
    }

    /// Whether those of several samples are where q is larger than chance would have it. Spikes of the sensor are single samples, at any q, and would
    /// hide among them the few stretches in which a servo runs into its limit.
    ///
    /// The share of all samples whose q is at least that of a stretch is even between 0 and 1 by chance, so -2 Σ ln of it has the χ²
    /// distribution with two degrees of freedom for each stretch (Fisher 1925).
    fn lasting_are_fast(&self) -> bool {
        let stretches = self.outlying.iter().zip(&self.outlying_motion);
        let lasting: Vec<f64> = stretches
            .filter(|(found, _)| found.samples > 1 && !found.other_stroke)
            .map(|(found, sum)| sum / found.samples as f64)
            .collect();
        let mut motions = self.motions.clone();
        motions.sort_unstable_by(f64::total_cmp);
        let share = |q: &f64| {
            let slower = motions.partition_point(|motion| motion < q);
            (motions.len() - slower).max(1) as f64 / motions.len() as f64
        };
        let fast = -2.0 * lasting.iter().map(|q| share(q).ln()).sum::<f64>();
        chi_square_upper_tail(fast, 2 * lasting.len()) < RESIDUAL_SIGNIFICANCE
    }
}

/// The [`spikes`] among the errors, where q is above `moving` in motion.
fn spikes_of<'a>(runs: &'a [Simulated<'a>], motions: &[Vec<f64>], moving: f64) -> Vec<TakenOut> {
    let course = |(simulated, motion): (&'a Simulated<'a>, &Vec<f64>)| Course {
        measured: simulated.run.output(),
        errors: simulated.own_errors(),
        in_motion: motion.iter().map(|q| *q > moving).collect(),
    };
    let courses: Vec<Course<'_>> = runs.iter().zip(motions).map(course).collect();
    let single = |(run, sample): (usize, usize)| TakenOut {
        run: run + 1,
        sample,
        samples: 1,
        spike: true,
        other_stroke: false,
    };
    spikes(&courses).into_iter().map(single).collect()
}

/// The variance of errors one step ahead, from medians.
struct Scale {
    even: f64,
    /// Further variance for each unit of q.
    in_motion: f64,
    largest_motion: f64,
}

impl Scale {
    /// `None` where there is no noise.
    fn of(runs: &[Simulated<'_>], motions: &[Vec<f64>], fit: &GlsFit, step: f64) -> Option<Self> {
        let samples = motions.iter().map(Vec::len).sum();
        let mut rows: Vec<(f64, f64)> = Vec::with_capacity(samples);
        for (run, motion) in runs.iter().zip(motions) {
            let errors = one_step_errors(run.own_errors(), &fit.ar);
            rows.extend(
                motion
                    .iter()
                    .copied()
                    .zip(errors)
                    .filter(|row| !row.1.is_nan()),
            );
        }
        let largest_motion = rows.iter().map(|row| row.0).fold(0.0, f64::max);
        let chosen = |in_motion: bool| {
            let is_chosen =
                move |row: &&(f64, f64)| (row.0 > IN_MOTION * largest_motion) == in_motion;
            rows.iter().filter(is_chosen)
        };
        let square = |in_motion: bool| {
            let errors = chosen(in_motion).map(|row| row.1);
            median_variance(errors, step)
        };
        let moving = square(true);
        let even = square(false).or(moving)?;
        let even = even + undithered(even, step);
        let in_motion = moving.and_then(|square| {
            let motion = median(chosen(true).map(|row| row.0).collect())?;
            Some(((square - even) / motion).max(0.0))
        });
        let in_motion = in_motion.unwrap_or(0.0);
        (even > 0.0).then_some(Self {
            even,
            in_motion,
            largest_motion,
        })
    }
}

/// The variance of Gaussian errors with the median of these, of a sensor with steps of `step`. `None` where there are none.
///
/// At rest they are few values, a step apart, and their median is one of these. So each counts as [`SPREAD`] errors, evenly over
/// a step around it, which add the variance of rounding once more.
fn median_variance(errors: impl Iterator<Item = f64>, step: f64) -> Option<f64> {
    let within = (0..SPREAD).map(|k| step * ((f64::from(k) + 0.5) / f64::from(SPREAD) - 0.5));
    let squares: Vec<f64> = match step > 0.0 {
        true => errors
            .flat_map(|error| within.clone().map(move |part| (error + part).powi(2)))
            .collect(),
        false => errors.map(|error| error * error).collect(),
    };
    let variance = median(squares)? / MEDIAN_OF_SQUARES;
    Some((variance - step * step / 12.0).max(0.0))
}

/// What steps of a sensor add to the variance of errors at rest that have this `even` one. Errors of less than a step are mostly none, and their
/// median says nothing of the others.
fn undithered(even: f64, step: f64) -> f64 {
    match even < step * step {
        true => step * step,
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    /// Sizes of Gaussian errors at the middle of as many equal shares.
    fn gaussian(count: u32) -> Vec<f64> {
        let share = |k: u32| (f64::from(k) + 0.5) / f64::from(count);
        (0..count)
            .map(|k| normal_upper_quantile(share(k) / 2.0))
            .collect()
    }

    #[test]
    fn the_limit_is_lower_where_there_are_outliers() {
        assert_abs_diff_eq!(lower_limit(&gaussian(3600)), outlying(3600));
        // One outlier hides no other.
        let one = [gaussian(3599), vec![6.0]].concat();
        assert_abs_diff_eq!(lower_limit(&one), outlying(3600));
        // Beyond 4, Gaussian noise has 0.23 of 3600: less than a hundredth of 36.
        let many: Vec<f64> = (0..36).map(|k| 4.0 + 0.06 * f64::from(k)).collect();
        assert_abs_diff_eq!(lower_limit(&[gaussian(3564), many].concat()), 4.0);
        // More than a twentieth are no outliers, and no reason to cut the others.
        let most = [gaussian(900), vec![5.0; 100]].concat();
        assert_abs_diff_eq!(lower_limit(&most), outlying(1000));
        assert_abs_diff_eq!(lower_limit(&[]), outlying(0));
    }

    /// Noise of 0.06 at a rest of a sensor with steps of 0.05: its readings are few, and their median is one of them.
    #[test]
    fn the_scale_of_rounded_noise_is_that_of_the_noise_and_the_rounding() {
        let exact = 0.06f64.powi(2) + 0.05f64.powi(2) / 12.0;
        let sd = |rest: f64, step: f64| {
            let noise =
                (0..4001).map(|k| 0.06 * normal_upper_quantile((f64::from(k) + 0.5) / 4001.0));
            let rounded = noise.map(move |noise| ((rest + noise) / 0.05).round() * 0.05 - rest);
            (median_variance(rounded, step).unwrap() / exact).sqrt()
        };
        for rest in [0.0, 0.007, 0.012, 0.02, 0.025] {
            // Of ten to a step; the first harmonic of rounding is left, too.
            assert_abs_diff_eq!(sd(rest, 0.05), 1.0, epsilon = 0.06);
        }
        assert!(
            sd(0.0, 0.0) > 1.15 && sd(0.02, 0.0) < 0.8,
            "{} {}",
            sd(0.007, 0.0),
            sd(0.02, 0.0)
        );
    }

    #[test]
    fn the_excess_is_that_of_the_tails_that_are_left() {
        // The middles of shares lack the last bit of the tails.
        assert!(excess(gaussian(3600).into_iter()) < 0.02);
        // 1 % of 4: m4 = .99 3 + 2.56, m2 = .99 + .16.
        let tails = [gaussian(3564), vec![4.0; 36]].concat();
        let exact: f64 = (0.99 * 3.0 + 2.56) / (0.99f64 + 0.16).powi(2) - 3.0;
        assert_abs_diff_eq!(excess(tails.into_iter()), exact, epsilon = 0.02);
    }

    /// A motion of 30 rows in each 100; the rows from `start` on, counted from the beginning of the motion, are outlying in 12 of 100 holds.
    fn unrelated(start: usize, rows: usize) -> bool {
        let mut seen = Seen::beyond(outlying(10_000));
        for k in 0..10_000 {
            let in_hold = k % 100;
            let is_outlying = k / 100 % 8 == 0 && (start..start + rows).contains(&in_hold);
            let size = if is_outlying { 6.0 } else { 1.0 };
            let in_motion = (5..35).contains(&in_hold);
            seen.sample((0, k), size, (f64::from(u8::from(in_motion)), in_motion));
        }
        seen.is_unrelated_to_motion()
    }

    /// A stick that moves at all times, by q from 0 to 1; single samples in each 400 are spikes, and `lasting` ones are outlying, too.
    fn lasting_are_fast(lasting: impl Fn(u32) -> bool) -> bool {
        let mut seen = Seen::beyond(outlying(10_000));
        for k in 0..10_000u32 {
            let motion = (f64::from(k / 50) * 0.618_034).fract();
            let is_outlying = k % 400 == 25 || lasting(k);
            let size = if is_outlying { 6.0 } else { 1.0 };
            seen.sample((0, k as usize), size, (motion, motion > IN_MOTION));
        }
        seen.lasting_are_fast()
    }

    #[test]
    fn stretches_at_the_highest_speeds_do_not_hide_among_spikes() {
        // Of 200 pieces, those of the highest q are 144 and 55.
        let within =
            |k: u32, pieces: &[u32]| (10..30).contains(&(k % 50)) && pieces.contains(&(k / 50));
        assert!(lasting_are_fast(|k| within(k, &[55, 144])));
        assert!(!lasting_are_fast(|k| within(k, &[20, 100])));
        assert!(!lasting_are_fast(|_| false));
    }

    #[test]
    fn outliers_that_begin_before_the_motion_and_go_on_in_it_belong_to_it() {
        assert!(unrelated(60, 10));
        assert!(unrelated(0, 6));
        assert!(!unrelated(3, 10));
        assert!(!unrelated(10, 1));
    }
}
