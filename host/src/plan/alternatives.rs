//! All references beside each other.

use super::answerable_questions;
use super::band_width::{RunsNeeded, shows_step};
use super::expectation::Expectation;
use super::needed_runs::Effort;
use super::request::PlanRequest;
use crate::instrument::reference::{Kind, ReferenceSpec};
use serde::Serialize;

/// Simulated identifications behind each reference: references differ by far more than one identification
/// scatters.
const SIMULATIONS: u64 = 1;

/// How many runs are tried for the wanted band.
const EFFORT: Effort = Effort {
    simulations: 1,
    doublings: 1,
};

/// A reference with default options, at the amplitude that was asked for.
#[derive(Clone, Debug, Serialize)]
pub struct Alternative {
    /// Its name.
    pub reference: &'static str,
    /// Duration of one run, with its rest (s).
    pub run_s: f64,
    /// Half width of the whole curve's band, where it is widest (percent of the step); `None` where it
    /// cannot be identified, or not with bounds, and where these are wider than the step itself.
    pub widest_percent: Option<f64>,
    /// The same after one minute of such runs, which makes references of different length comparable.
    pub widest_percent_in_a_minute: Option<f64>,
    /// Whether these figures hold for a linear servo only.
    pub only_if_linear: bool,
    /// The runs for the wanted band; `None` also where a reasonable number of runs does not reach it.
    pub needed: Option<RunsNeeded>,
    /// The runs that were tried, and their band, where that does not reach the wanted one.
    pub closest: Option<RunsNeeded>,
    /// The questions that it answers beside the linear response.
    pub answers: Vec<&'static str>,
}

/// All references, the narrowest band per minute first. The request's own reference may be among them; its
/// `expected` result is not computed again.
pub(super) fn alternatives(
    request: &PlanRequest,
    expected: &Expectation,
    needed: Option<Result<RunsNeeded, RunsNeeded>>,
) -> Vec<Alternative> {
    let (low, high) = request.reference.extremes_us();
    let amplitude_us = f64::from(high.max(low.saturating_neg()));
    let kinds = [
        Kind::Staircase,
        Kind::Stairs,
        Kind::Prbs,
        Kind::Sweep,
        Kind::Multisine,
    ];
    let specs = kinds.map(|kind| ReferenceSpec {
        kind,
        amplitude_deg: Some(amplitude_us / request.us_per_degree.abs()),
        train: request.assumed.train,
        ..ReferenceSpec::default()
    });
    // A reference that cannot have this amplitude is left out.
    let requests = specs.iter().filter_map(|spec| {
        let resolved = spec.resolve(request.us_per_degree).ok()?;
        Some(PlanRequest {
            reference: resolved.reference,
            runs: 1,
            ..request.clone()
        })
    });
    let planned = |other: PlanRequest| {
        if other.reference == request.reference && request.runs == 1 {
            return alternative(&other, Some(expected), needed);
        }
        let expected = Expectation::of_simulations(&other, SIMULATIONS).ok();
        let band = (expected.as_ref()).and_then(|expected| expected.band.into_valid());
        let needed = band.and_then(|band| other.runs_needed(&band, EFFORT));
        alternative(&other, expected.as_ref(), needed)
    };
    let mut all: Vec<Alternative> = std::thread::scope(|scope| {
        let threads: Vec<_> = requests
            .map(|other| scope.spawn(move || planned(other)))
            .collect();
        let ended = threads.into_iter().filter_map(|thread| thread.join().ok());
        ended.collect()
    });
    let width = |a: &Alternative| a.widest_percent_in_a_minute.unwrap_or(f64::INFINITY);
    all.sort_by(|a, b| {
        let by_width = width(a).total_cmp(&width(b));
        a.only_if_linear.cmp(&b.only_if_linear).then(by_width)
    });
    all
}

/// One line of the table; `expected` is `None` where the reference cannot be identified.
fn alternative(
    request: &PlanRequest,
    expected: Option<&Expectation>,
    needed: Option<Result<RunsNeeded, RunsNeeded>>,
) -> Alternative {
    let run_s = request.run_s();
    let band = expected.and_then(|e| e.band.into_valid());
    let answers = expected.map(|e| answerable_questions::of(&e.example, &e.record));
    let answered = answers
        .into_iter()
        .flatten()
        .filter(|answer| answer.answered);
    Alternative {
        reference: request.reference.name(),
        run_s,
        widest_percent: (band.map(|b| b.widest_percent)).filter(|width| shows_step(*width)),
        widest_percent_in_a_minute: (band.and_then(|_| in_a_minute(request)))
            .filter(|width| shows_step(*width)),
        only_if_linear: request.relies_on_linearity(),
        needed: needed.and_then(Result::ok),
        closest: needed.and_then(Result::err),
        answers: answered.map(|answer| answer.question).collect(),
    }
}

/// The width after as many runs as come nearest to a minute, and what of that the noise makes of a whole one.
fn in_a_minute(request: &PlanRequest) -> Option<f64> {
    const MINUTE_S: f64 = 60.0;
    let runs = (MINUTE_S / request.run_s()).round().max(1.0);
    let request = PlanRequest {
        runs: runs as usize,
        ..request.clone()
    };
    let found = Expectation::of_simulations(&request, SIMULATIONS).ok()?;
    let band = found.band.into_valid()?;
    Some(
        band.narrowing()
            .widest_after(MINUTE_S / (runs * request.run_s())),
    )
}
