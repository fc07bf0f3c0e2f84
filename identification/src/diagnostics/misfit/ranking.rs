//! Estimators by how well they predict parts of a record that they have not seen.

use super::estimators::plain;
use super::evidence::Prediction;
use crate::data::{MomentStream, Moments, Record};
use crate::diagnostics::residuals::simulation_error::square;
use crate::estimation::{
    Coordinates, FIRST_ORDER, FsfBasis, GlsFit, GlsOptions, NestedBanks, RowInformation,
};
use crate::options::NoiseOrder;
use crate::results::fit_percent;
use crate::thresholds::{DETERMINED_BY_PARTS, PREDICTION_TIE};

/// Fit of a prediction that is no better than the mean of what it predicts \[%\]. Where that is all
/// that can be had, parts of the record cannot stand for one another (one step in each, say), and
/// their ranking would be one of accidents.
const NO_PREDICTION: f64 = 0.0;

/// Steps in which the settling time is lengthened.
const LENGTHENINGS: usize = 3;

/// Parts of the record that are left out in turn.
const PARTS: usize = 4;

/// Settling times to be tried, from the one chosen for noise up to `longest`: about evenly spaced in
/// their logarithm.
pub(crate) fn settlings(chosen: usize, longest: usize) -> Vec<usize> {
    let ratio = (longest.max(chosen) as f64 / chosen as f64).powf(1.0 / LENGTHENINGS as f64);
    let mut settlings: Vec<usize> = (0..=LENGTHENINGS)
        .map(|k| (chosen as f64 * ratio.powi(k as i32)) as usize | 1)
        .collect();
    settlings.dedup();
    settlings
}

/// Ranks estimators by cross-validation, best first, as far as they predict anything. `settlings` are
/// the N to be tried.
pub(crate) fn rank(
    record: &Record,
    settlings: &[usize],
    frequencies: Option<usize>,
    order: NoiseOrder,
) -> Vec<Prediction> {
    let lags = order.highest();
    let longest = settlings.iter().copied().max().unwrap_or(0);
    let parts = moments_of_parts(record, longest + lags, lags + 1);
    let mut total = parts[0].clone();
    for part in &parts[1..] {
        total.add(part);
    }
    let mut ranked = Vec::new();
    let shortest = banks(&total, settlings[0], frequencies).into_iter().next();
    if !shortest.is_some_and(|basis| parts_determine(&total, &parts, basis)) {
        return ranked;
    }
    for &settling in settlings {
        for basis in banks(&total, settling, frequencies) {
            for generalised in [false, true] {
                let options = if generalised {
                    GlsOptions {
                        order,
                        tolerance: 1e-3,
                        max_iterations: 10,
                        ..GlsOptions::default()
                    }
                } else {
                    plain()
                };
                let coordinates = Coordinates::new(basis);
                let predicted = cross_validate(&total, &parts, &coordinates, &options);
                if let Some(percent) = predicted.filter(|percent| *percent > NO_PREDICTION) {
                    ranked.push(Prediction {
                        settling,
                        frequencies: basis.frequencies(),
                        generalised,
                        cross_validated_percent: percent,
                    });
                }
            }
        }
    }
    ranked.sort_by(|a, b| {
        b.cross_validated_percent
            .total_cmp(&a.cross_validated_percent)
    });
    // Of those that predict about as well as the best, the simplest: shortest, then smallest.
    let simplest = ranked
        .iter()
        .enumerate()
        .take_while(|(_, p)| {
            p.cross_validated_percent > ranked[0].cross_validated_percent - PREDICTION_TIE
        })
        .min_by_key(|(_, p)| (p.settling, p.frequencies, p.generalised))
        .map(|(index, _)| index);
    if let Some(index) = simplest {
        ranked[..=index].rotate_right(1);
    }
    ranked
}

/// The complete bank and the one that predicts best by itself, or the one asked for.
fn banks(total: &Moments, settling: usize, frequencies: Option<usize>) -> Vec<FsfBasis> {
    if let Some(frequencies) = frequencies {
        return FsfBasis::new(settling, frequencies).into_iter().collect();
    }
    let mut banks: Vec<FsfBasis> = FsfBasis::full(settling).into_iter().collect();
    if let Some(scan) = NestedBanks::scan(total, settling, &[], FIRST_ORDER) {
        banks.extend(FsfBasis::new(settling, scan.best_predictor()));
    }
    banks
}

/// Whether the bank is still determined without any one of the parts, or never is. A step that the
/// others lack cannot be predicted from them, and what could be ranked by predicting it are only the
/// banks that are too small to lack it.
fn parts_determine(total: &Moments, parts: &[Moments], basis: FsfBasis) -> bool {
    let coordinates = Coordinates::new(basis);
    let determined = |moments: Moments| {
        GlsFit::of(
            &RowInformation::from_moments(moments),
            &coordinates,
            &plain(),
        )
        .is_some_and(|fit| fit.solution.condition <= DETERMINED_BY_PARTS)
    };
    let mut present = parts.iter().filter(|part| part.rows() > 0);
    !determined(total.clone()) || present.all(|part| determined(total.without(part)))
}

/// Fit of simulations of each part by an estimate from the others \[%\].
fn cross_validate(
    total: &Moments,
    parts: &[Moments],
    coordinates: &Coordinates,
    options: &GlsOptions,
) -> Option<f64> {
    let mut error = 0.0;
    for part in parts.iter().filter(|part| part.rows() > 0) {
        let others = RowInformation::from_moments(total.without(part));
        let fit = GlsFit::of(&others, coordinates, options)?;
        if fit.solution.condition > DETERMINED_BY_PARTS {
            return None; // Not determined by the parts that are left.
        }
        error += square(&RowInformation::from_moments(part.clone()), &fit);
    }
    Some(fit_percent(error, total.output_spread()))
}

/// The moments of the rows of each quarter of the record, all relative to the same centre. Rows
/// keep their history across the boundaries; runs do not.
fn moments_of_parts(record: &Record, input_lags: usize, output_lags: usize) -> Vec<Moments> {
    let mut stream = MomentStream::new(record.sample_period_s(), input_lags, output_lags);
    let mut parts: Vec<Moments> = Vec::new();
    let mut before: Option<Moments> = None;
    let (mut seen, samples) = (0, record.samples());
    for run in record.runs() {
        stream.begin_run(run.input_at_rest());
        let mut start = 0;
        while start < run.len() {
            let boundary = samples * (parts.len() + 1) / PARTS;
            let end = run.len().min(start + boundary - seen);
            stream.push(&run.input()[start..end], &run.output()[start..end]);
            seen += end - start;
            start = end;
            if seen == boundary {
                let now = stream.moments();
                parts.push(
                    before
                        .as_ref()
                        .map_or_else(|| now.clone(), |before| now.without(before)),
                );
                before = Some(now);
            }
        }
    }
    parts
}
