//! From two records, or two models, to a verdict.

use super::difference::{Curves, Differences};
use super::difference_curves::difference_curves;
use super::different_motions::{Asked, references_of_models_may_explain};
use super::metric_differences::{MetricsOfSide, metric_differences};
use super::options::{ComparisonOptions, DelayErrors};
use super::outcome::{Comparison, ComparisonBounds, DifferencePercent, SCHEMA, Subject};
use super::over_prediction::{Predictor, over_prediction};
use super::pair::{Identified, identified, same_period};
use super::rests_apart::RestsApart;
use super::run_means::RunMeans;
use super::sides::Sides;
use super::verdict::Verdict;
use super::{advice, other_way, shift, shift_alone, words};
use crate::data::Record;
use crate::error::Error;
use crate::nonlinear::Hysteresis;
use crate::results::{Bounds, Metrics, Model, Reason};
use crate::thresholds::{MARGIN, RUNS_FOR_MEAN};

/// Compares two sides, each a record of one or more runs.
///
/// ```
/// use servoid_identification::comparison::{compare, ComparisonOptions, Verdict};
/// use servoid_identification::Record;
/// let u: Vec<f64> = (0..3000).map(|k| if k * k / 9000 % 2 == 0 { 5.0 } else { -5.0 }).collect();
/// let servo = |speed: f64, shift: usize| {
///     let noise = |k: usize| 0.01 * (((k + shift) * 7919 % 101) as f64 - 50.0) / 50.0;
///     let y: Vec<f64> = u.iter().enumerate().scan(5.0, |y, (k, u)| {
///         *y += speed * (u - *y); Some(*y + noise(k))
///     }).collect();
///     Record::of_run(0.002, &u, y)
/// };
/// let (bench, again, loaded) = (servo(0.2, 0)?, servo(0.2, 17)?, servo(0.1, 5)?);
/// let options = ComparisonOptions::default();
/// assert_eq!(compare(&bench, &again, &options)?.verdict, Verdict::Same);
/// let found = compare(&bench, &loaded, &options)?;
/// assert_eq!(found.verdict, Verdict::Different);
/// let bounds = found.bounds.valid().unwrap();
/// assert!(bounds.difference_percent.at_least > 20.0);
/// # Ok::<(), servoid_identification::Error>(())
/// ```
///
/// # Errors
/// A side cannot be identified, or the two differ in sample period.
pub fn compare(a: &Record, b: &Record, options: &ComparisonOptions) -> Result<Comparison, Error> {
    let (mut a, mut b) = identified(a, b, &options.identification, options.withheld)?;
    let level = options.identification.level;
    let both = a.split.as_ref().zip(b.split.as_ref());
    let split = both.filter(|_| a.asymmetric() || b.asymmetric());
    let samples = |side: &Identified<'_>| side.model.structure.settling_samples;
    let points = samples(&a).max(samples(&b));
    let curves = match split {
        Some((a, b)) => [Curves::of_split(a, points), Curves::of_split(b, points)],
        None => [
            Curves::of_model(&a.model, points)?,
            Curves::of_model(&b.model, points)?,
        ],
    };
    let runs = RunMeans::of([&a, &b], split.is_some(), points, level);
    if let Some([gain_a, gain_b]) = split.map(|(a, b)| [a.gain(), b.gain()]) {
        // The errors of a plain model hide a slow end of such a servo.
        [a.model.metrics.dc_gain, b.model.metrics.dc_gain] = [gain_a, gain_b];
    }
    let [error_a, error_b] = options.delay_errors.of_sides();
    a.model = a.model.with_delay_error(error_a);
    b.model = b.model.with_delay_error(error_b);
    let models = [&a.model, &b.model];
    let mut comparison = of_curves(models, &curves, runs.as_ref(), options);
    let of_recordings = runs.and_then(|_| {
        let found = differences(&curves, None, 0.0, options).largest();
        found.valid().map(|found| 100.0 * found.at_most)
    });
    // Bounds of one side go with those of the other, whose reason it is.
    let own = Sides::of([&a, &b], |side| side.alone.level().withdrawn());
    if !own.have_none() {
        comparison.without_bounds = own;
    }
    comparison.turns_the_other_way = other_way::turns(&comparison, [&a, &b]);
    comparison.runs = [a.record.runs().len(), b.record.runs().len()];
    comparison.split = split.is_some();
    comparison.one_structure = a.options == b.options;
    // Where the servo rests and how its strokes differ is read off the same fits as the bounds.
    if let Bounds::Valid((sd_at_rest, _)) = a.sd_at_rest().zip(comparison.bounds) {
        let wait = (points as f64 / MARGIN).ceil() as usize;
        let predictor = Predictor {
            model: &a.model,
            sd_at_rest,
            zero_sd: options.zero_sd,
            scale_sd: options.scale_sd,
            wait: options.wait_samples.unwrap_or(wait),
            level,
            units: [&options.input_unit, &options.output_unit],
        };
        comparison.over_prediction = over_prediction([a.record, b.record], &predictor);
        comparison.levels = Some(Sides::of([&a, &b], Identified::levels));
        comparison.asymmetry = Some(Sides::of([&a, &b], Identified::asymmetry));
    }
    let asked = Asked::of([&a, &b]);
    let of_record = |reason: Reason| reason.is_of_the_record() && !reason.leaves_rests();
    if asked.is_one_motion() && !comparison.bounds.withdrawn().is_some_and(of_record) {
        let of =
            |side: &Identified<'_>| Hysteresis::with_rests_apart(side.record, &side.alone, level);
        let both = [of(&a), of(&b)];
        let apart = both.each_ref().map(|(_, apart)| *apart);
        let means = both.map(|(mean, _)| (mean.found == Some(true)).then_some(mean.size));
        let apart = RestsApart::of(apart, options.scale_sd, level);
        comparison.rests_apart = Some(apart.or_means(means));
    }
    comparison.motions = Some(asked.motions);
    if asked.may_explain(&comparison) {
        comparison.verdict = Verdict::Undecided;
        comparison.descriptions_of_different_motions = true;
    }
    let waits_s = match comparison.of {
        Subject::Servos => [0.0; 2],
        Subject::Runs => options.waits_s,
    };
    say_waits(&mut comparison, waits_s);
    let linear = a.alone.linear && b.alone.linear;
    let turned = match comparison.turns_the_other_way && comparison.has_verdict() {
        true => Some(compare(a.record, &b.record.turned_round(), options)?),
        false => None,
    };
    comparison.summary = words::summary(&comparison, turned.as_ref(), linear, options);
    comparison.advice = advice::gather(
        &comparison,
        [&a.alone, &b.alone],
        &[&a, &b],
        &options.output_unit,
        of_recordings,
    );
    if comparison.descriptions_of_different_motions || !asked.is_one_motion() {
        let finding =
            advice::different_references(&asked.motions, asked.linear, &options.input_unit);
        comparison.advice.insert(0, finding);
    }
    Ok(comparison)
}

/// Compares two models without their records: plain step responses and metrics.
///
/// # Errors
/// The two differ in sample period, or a hand-made document does not describe a filter bank.
pub fn compare_models(
    a: &Model,
    b: &Model,
    options: &ComparisonOptions,
) -> Result<Comparison, Error> {
    options.identification.check()?;
    same_period(a.sample_period_s, b.sample_period_s)?;
    let points = a
        .structure
        .settling_samples
        .max(b.structure.settling_samples);
    let curves = [Curves::of_model(a, points)?, Curves::of_model(b, points)?];
    let mut comparison = of_curves([a, b], &curves, None, options);
    comparison.turns_the_other_way = other_way::by_bounds(&comparison);
    let linear = a.linear && b.linear;
    if references_of_models_may_explain(&comparison, options.strokes_of_models, linear) {
        comparison.verdict = Verdict::Undecided;
        comparison.descriptions_of_different_motions = true;
    }
    let left = |model: &Model, wait_s: f64| match model.run_offsets.len() >= RUNS_FOR_MEAN {
        true => 0.0,
        false => wait_s,
    };
    let [wait_a, wait_b] = options.waits_s;
    let waits_s = [left(a, wait_a), left(b, wait_b)];
    say_waits(&mut comparison, waits_s);
    comparison.summary = words::summary(&comparison, None, linear, options);
    comparison.advice = advice::gather(&comparison, [a, b], &[], &options.output_unit, None);
    comparison.advice.push(advice::one_response());
    Ok(comparison)
}

/// Leaves a difference undecided that waits may make which its bounds do not contain. Servos that turn the other way differ by more.
fn say_waits(comparison: &mut Comparison, waits_s: [f64; 2]) {
    let is_open = comparison.verdict == Verdict::Different && !comparison.turns_the_other_way;
    if is_open && shift_alone::may_be_waits(comparison, waits_s) {
        comparison.verdict = Verdict::Undecided;
        comparison.may_be_waits = true;
    }
}

/// The differences of the `curves`, of the servos where several `runs` show them; sensors may be `apart` by so many samples.
fn differences(
    curves: &[Curves; 2],
    runs: Option<&RunMeans>,
    apart: f64,
    options: &ComparisonOptions,
) -> Differences {
    let [a, b] = curves;
    let level = options.level_of_noise();
    let of_recordings = Differences::of(a, b, level);
    let differences = match runs.map(|runs| runs.difference(level)) {
        Some((value, half)) => of_recordings.of_servos(&value, &half),
        None => of_recordings,
    };
    differences
        .with_delay_error([a, b], apart)
        .with_scale_error(b, options.scale_beside_noise())
}

/// The metrics of a side, without bounds where those of the comparison are withdrawn.
fn metrics_of_side(model: &Model, withdrawn: Option<Reason>) -> MetricsOfSide {
    let known = |metrics: Metrics| match withdrawn {
        None => metrics,
        Some(reason) => metrics.withdrawn(reason),
    };
    MetricsOfSide {
        metrics: known(model.metrics),
        at_stated_delay: known(model.metrics_at_stated_delay()),
    }
}

fn of_curves(
    models: [&Model; 2],
    curves: &[Curves; 2],
    runs: Option<&RunMeans>,
    options: &ComparisonOptions,
) -> Comparison {
    let level = options.identification.level;
    let [a, b] = models;
    let timing = a.timing();
    let apart_s = match options.delay_errors {
        DelayErrors::Shared(_) => 0.0,
        DelayErrors::Apart(_) => a.delay_error_s() + b.delay_error_s(),
    };
    let apart = apart_s / timing.sample_period_s;
    let differences = differences(curves, runs, apart, options);
    let largest = differences.largest();
    let shift_of = |which: std::ops::Range<usize>| {
        let mut found = shift::shift(&curves[0], &curves[1], which.clone(), level);
        if let Some(runs) = runs {
            let half = runs.shift_half(&curves[0], which);
            found.samples = found.samples.at_least_as_wide(half);
        }
        let later = b.sample_phase_s - a.sample_phase_s;
        let seconds = |samples: f64| samples * timing.sample_period_s + later;
        (
            found.samples.reaching(apart, apart).map(seconds),
            found.remains,
        )
    };
    let difference_curves = difference_curves(&differences, timing, shift_of);
    let (shift, _) = shift_of(0..differences.curves());
    let verdict = largest.map(|found| {
        Verdict::of(
            [found.at_least, found.at_most],
            options.margin_percent / 100.0,
        )
    });
    let sides = models.map(|model| metrics_of_side(model, largest.withdrawn()));
    Comparison {
        schema: SCHEMA,
        verdict: verdict.into_valid().unwrap_or(Verdict::Undecided),
        of: match runs {
            Some(_) => Subject::Servos,
            None => Subject::Runs,
        },
        margin_percent: options.margin_percent,
        bounds: largest.map(|found| ComparisonBounds {
            level,
            difference_percent: DifferencePercent {
                at_least: 100.0 * found.at_least.max(0.0),
                at_most: 100.0 * found.at_most,
                at_s: timing.seconds(found.sample as f64),
                stroke: difference_curves[found.curve].stroke,
            },
            delay_shift_s: shift.ends(),
        }),
        without_bounds: Sides::of([&curves[0], &curves[1]], |side| side.spread.withdrawn()),
        runs: [1, 1],
        delay_shift_s: shift.value,
        delay_shift_definition: shift::DEFINITION.to_owned(),
        split: false,
        one_structure: false,
        motions: None,
        descriptions_of_different_motions: false,
        may_be_waits: false,
        turns_the_other_way: false,
        same_data: false,
        over_prediction: None,
        levels: None,
        rests_apart: None,
        asymmetry: None,
        differences: metric_differences(&sides, runs, apart_s > 0.0, options.scale_error()),
        curves: difference_curves,
        summary: String::new(),
        advice: Vec::new(),
    }
}
