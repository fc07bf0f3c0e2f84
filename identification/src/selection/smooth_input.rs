//! Candidate: as many frequencies as the input excites.
//!
//! Where the input lacks high frequencies, a complete bank is determined badly or not at all. For each N the
//! bank is taken whose band of noise and truncation together is narrowest. N itself is chosen as always, except
//! that the truncation bound counts as part of the uncertainty.

use super::long_fit_noise;
use super::settling_candidates::{Choice, SettlingCandidate};
use super::settling_range::grid;
use super::settling_search::Search;
use crate::estimation::{
    Coordinates, CurveVariance, FIRST_ORDER, FsfBasis, GlsFit, GlsOptions, NestedBanks,
    RowInformation,
};
use crate::options::NoiseOrder;
use crate::thresholds::DETECTION;

/// The shortest acceptable N and its n; `None` when the input excites nothing beyond a constant.
pub(crate) fn choose(search: &Search<'_>) -> Option<Choice> {
    let (moments, longest) = (search.moments, search.longest);
    let information = RowInformation::from_moments(moments.clone());
    let fit = |ar: &[f64]| {
        let banks = NestedBanks::scan(moments, longest, ar, FIRST_ORDER)?;
        let basis = FsfBasis::new(longest, banks.narrowest().frequencies).ok()?;
        let coordinates = Coordinates::new(basis);
        let solution = information.solve(&coordinates, ar)?;
        Some((coordinates.impulse(solution.response()), solution.offset()))
    };
    // Where next to no noise is in a record, D of what the bank leaves may leave nothing of the input. Then the errors are taken for white.
    let of_order = |order| long_fit_noise::alternate(moments, order, fit, Clone::clone);
    let (ar, _) = of_order(search.order).or_else(|| of_order(NoiseOrder::Order(0)))?;
    let long = Response::new(&information, longest, &ar)?;
    let candidates = grid(longest).into_iter().filter_map(|settling| {
        Response::new(&information, settling, &ar).map(|response| response.candidate(&long))
    });
    let choice = Choice::first_accepted(candidates, longest, ar.clone())?;
    let chosen = Response::new(&information, choice.settling, &ar)?;
    Some(Choice {
        smooth_input: true,
        frequencies: Some(chosen.frequencies),
        ..choice
    })
}

/// The step response at one settling time, by its narrowest bank.
struct Response {
    frequencies: usize,
    value: Vec<f64>,
    sd: Vec<f64>,
    /// Bound of the error from frequencies left out.
    bias: f64,
}

impl Response {
    fn new(information: &RowInformation, settling: usize, ar: &[f64]) -> Option<Self> {
        let banks = NestedBanks::scan(&information.moments, settling, ar, FIRST_ORDER)?;
        let best = banks.narrowest();
        let coordinates = Coordinates::new(FsfBasis::new(settling, best.frequencies).ok()?);
        let options = GlsOptions {
            order: NoiseOrder::Order(ar.len()),
            start: ar.to_vec(),
            max_iterations: 1,
            corrected: false,
            ..GlsOptions::default()
        };
        let fit = GlsFit::of(information, &coordinates, &options)?;
        let spread = CurveVariance::of_fit(information, &fit, &coordinates.step_map());
        Some(Self {
            frequencies: best.frequencies,
            value: coordinates.basis.step_response(&fit.theta()),
            sd: spread.sd,
            bias: best.truncation_bias,
        })
    }

    /// This settling time beside the longest one.
    fn candidate(&self, long: &Self) -> SettlingCandidate {
        let detected = self.last_moving().map_or(1, |m| m + 2);
        let (settling, longest) = (self.value.len(), long.value.len());
        SettlingCandidate::new(settling, detected, self.contradiction(long), longest)
    }

    /// The last sample at which the response is not yet at its final value.
    fn last_moving(&self) -> Option<usize> {
        let last = self.value.len() - 1;
        let moves = |m: usize| {
            (self.value[m] - self.value[last]).abs() > DETECTION * self.sd[m] + self.bias
        };
        (0..last).rev().find(|&m| moves(m))
    }

    /// Largest difference from `long` in standard deviations. Both are uncertain; the shorter one has reached
    /// its end after N.
    fn contradiction(&self, long: &Self) -> f64 {
        let last = self.value.len() - 1;
        let differences = (0..long.value.len()).map(|m| {
            let here = m.min(last);
            let difference = (self.value[here] - long.value[m]).abs() - self.bias - long.bias;
            difference.max(0.0) / (long.sd[m] + self.sd[here])
        });
        differences.fold(0.0, f64::max)
    }
}
