//! The table of docs/servo-model.md.

use super::trial::{Claim, Trial};

/// Its head, and the line below it.
pub(super) const HEAD: &str = "\
| servo | reference | noise | recordings with intervals | intervals inside | band inside, mean | worst recording |
|---|---|---|---|---|---|---|";

/// One row: recordings of one kind of servo under one reference with one noise.
pub(super) fn row(trials: &[&Trial]) -> String {
    let claims: Vec<&Claim> = trials
        .iter()
        .filter_map(|trial| trial.claim.as_ref())
        .collect();
    let case = trials[0].case;
    let count = format!("{} of {}", claims.len(), trials.len());
    let start = format!(
        "| {} | {} | {} | {count} |",
        case.kind, case.reference, case.noise
    );
    if claims.is_empty() {
        return format!("{start} - | - | - |");
    }
    let judged = || claims.iter().flat_map(|claim| &claim.intervals);
    let (all, inside) = (
        judged().count(),
        judged().filter(|(_, inside)| *inside).count(),
    );
    let bands = || claims.iter().map(|claim| 100.0 * claim.band_inside);
    let mean = bands().sum::<f64>() / claims.len() as f64;
    let worst = bands().fold(100.0, f64::min);
    let share = 100.0 * inside as f64 / all as f64;
    format!("{start} {share:.1} % of {all} | {mean:.1} % | {worst:.1} % |")
}

/// Quantities whose interval misses the truth somewhere: name, misses, intervals.
pub(super) fn misses(trials: &[&Trial]) -> Vec<(&'static str, usize, usize)> {
    let mut counts: Vec<(&'static str, usize, usize)> = Vec::new();
    let claims = trials.iter().filter_map(|trial| trial.claim.as_ref());
    for (name, inside) in claims.flat_map(|claim| &claim.intervals) {
        match counts.iter_mut().find(|(known, ..)| known == name) {
            Some((_, misses, all)) => {
                *misses += usize::from(!inside);
                *all += 1;
            }
            None => counts.push((name, usize::from(!inside), 1)),
        }
    }
    counts.retain(|(_, misses, _)| *misses > 0);
    counts
}

/// One recording, for a look at it.
pub(super) fn line(trial: &Trial) -> String {
    let claim = match &trial.claim {
        None => "withdrawn".to_owned(),
        Some(claim) => {
            let missed: Vec<&str> = claim
                .intervals
                .iter()
                .filter(|(_, inside)| !inside)
                .map(|(name, _)| *name)
                .collect();
            format!(
                "band inside {:.1} %, farthest {:.3} deg, missed {missed:?}",
                100.0 * claim.band_inside,
                claim.farthest
            )
        }
    };
    format!(
        "   servo {} run {}: {:?} {:?} -> {:?} and {} more, fit {:.2} %, misfit {:.0}: {claim}",
        trial.case.servo,
        trial.case.run,
        trial.truth.point.terms,
        trial.truth.beyond,
        trial.found.terms,
        trial.found.alternatives.len(),
        trial.found.fit.simulation_percent,
        trial.misfit,
    )
}
