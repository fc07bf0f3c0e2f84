//! The table of docs/servo-model.md.

use super::trial::{Band, Claim, Judged, Trial};
use crate::results::Bounds;
use std::collections::BTreeMap;

/// Its head, and the line below it.
pub(super) const HEAD: &str = "\
| servo | reference | noise | recordings with intervals | intervals inside | band inside, alike: mean, worst | large strokes: mean, worst |
|---|---|---|---|---|---|---|";

/// One row: recordings of one kind of servo under one reference with one noise.
pub(super) fn row(trials: &[Trial]) -> String {
    let claims: Vec<&Claim> = trials
        .iter()
        .filter_map(|trial| trial.claim.as_ref())
        .collect();
    let case = trials[0].case;
    let start = format!(
        "| {} | {} | {} | {} of {} |",
        case.kind,
        case.reference,
        case.noise,
        claims.len(),
        trials.len()
    );
    if claims.is_empty() {
        return format!("{start} - | - | - |");
    }
    let judged = || claims.iter().flat_map(|claim| &claim.intervals);
    let inside = judged().filter(|judged| judged.holds()).count();
    format!(
        "{start} {inside} of {} | {} | {} |",
        judged().count(),
        mean_and_worst(claims.iter().filter_map(|claim| claim.alike)),
        mean_and_worst(claims.iter().filter_map(|claim| claim.large))
    )
}

/// Share inside of several bands \[%\], and their number.
fn mean_and_worst(bands: impl Iterator<Item = Band>) -> String {
    let shares: Vec<f64> = bands.map(|band| 100.0 * band.inside).collect();
    if shares.is_empty() {
        return "none".to_owned();
    }
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    let worst = shares.iter().copied().fold(100.0, f64::min);
    format!("{mean:.1} %, {worst:.1} % of {}", shares.len())
}

/// Of each quantity whose intervals miss the truth somewhere: in how many recordings, and of how many.
pub(super) fn misses(trials: &[Trial]) -> String {
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    let claims = trials.iter().filter_map(|trial| trial.claim.as_ref());
    for judged in claims.flat_map(|claim| &claim.intervals) {
        let (misses, all) = counts.entry(judged.name).or_default();
        *misses += usize::from(!judged.holds());
        *all += 1;
    }
    counts.retain(|_, (misses, _)| *misses > 0);
    format!("{counts:?}")
}

/// Of each quantity the median of the interval's half width \[its unit\], and of how many.
pub(super) fn widths(trials: &[Trial]) -> String {
    let mut all: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    let claims = trials.iter().filter_map(|trial| trial.claim.as_ref());
    for judged in claims.flat_map(|claim| &claim.intervals) {
        if let (Some(lower), Some(upper)) = (judged.interval.lower, judged.interval.upper) {
            all.entry(judged.name)
                .or_default()
                .push(0.5 * (upper - lower));
        }
    }
    let median = |(name, mut widths): (&str, Vec<f64>)| {
        widths.sort_by(f64::total_cmp);
        format!("{name} {:.4} of {}", widths[widths.len() / 2], widths.len())
    };
    let shown: Vec<String> = all.into_iter().map(median).collect();
    shown.join(", ")
}

/// One recording, for a look at it.
pub(super) fn line(trial: &Trial) -> String {
    let (case, found) = (trial.case, &trial.found);
    let terms = trial.truth.point.terms;
    let others = found.alternatives.iter().map(|other| other.terms);
    let known = match found.terms == terms {
        true => "right",
        false if others.into_iter().any(|other| other == terms) => "not the first",
        false => "not among them",
    };
    let claim = match &trial.claim {
        None => match &found.covariance {
            Bounds::Valid(_) => "withdrawn".to_owned(),
            Bounds::Withdrawn(reason) => format!("withdrawn: {}", reason.because()),
        },
        Some(claim) => {
            let missed = claim.intervals.iter().filter(|judged| !judged.holds());
            let missed: Vec<&Judged> = missed.collect();
            let band = |band: Option<Band>| {
                band.map_or("withdrawn".to_owned(), |band| {
                    let percent = 100.0 * band.inside;
                    format!("{percent:.1} %, farthest {:.3} deg", band.farthest)
                })
            };
            format!(
                "band {}; large strokes {}; missed {missed:?}",
                band(claim.alike),
                band(claim.large)
            )
        }
    };
    format!(
        "servo {} run {}: {terms:?} {:?} -> {:?} and {} more, terms {known}, fit {:.2} %, misfit {:.0}: {claim}",
        case.servo,
        case.run,
        trial.truth.beyond,
        found.terms,
        found.alternatives.len(),
        found.fit.simulation_percent,
        trial.misfit,
    )
}
