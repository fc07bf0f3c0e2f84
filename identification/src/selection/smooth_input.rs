//! The choice of N and n when the input lacks high frequencies.
//!
//! A complete bank would then be determined badly or not at all. For each N the bank is taken whose
//! band of noise and truncation together is narrowest; N itself is chosen as always, except that
//! the truncation bound counts as part of the uncertainty.

use crate::data::moments::Moments;
use crate::error::Error;
use crate::estimation::fsf_basis::FsfBasis;
use crate::estimation::gls::{self, GlsOptions};
use crate::estimation::least_squares::{Coordinates, RowInformation};
use crate::estimation::nested_banks::NestedBanks;
use crate::estimation::truncation::FIRST_ORDER;
use crate::estimation::variance::CurveVariance;
use crate::options::NoiseOrder;
use crate::selection::settling_time::{
    Choice, DETECTION, MARGIN, SettlingCandidate, chosen, grid, next_noise, noise_change,
};

/// Passes of the long fit over its noise.
const PASSES: usize = 4;

/// The response at one settling time.
struct Scan {
    frequencies: usize,
    value: Vec<f64>,
    sd: Vec<f64>,
    bias: f64,
}

/// Chooses N and n from moments with at least `longest` + 8 lags.
///
/// # Errors
/// The input does not excite anything beyond a constant.
pub(crate) fn choose(
    moments: &Moments,
    longest: usize,
    order: NoiseOrder,
) -> Result<Choice, Error> {
    let not_excited = || Error::NotExcited {
        asked: longest,
        excited: 1,
        highest_hz: 0.0,
    };
    let information = RowInformation::from_moments(moments.clone());
    let mut ar = Vec::new();
    for pass in 0..PASSES {
        let banks =
            NestedBanks::scan(moments, longest, &ar, FIRST_ORDER).ok_or_else(not_excited)?;
        let basis = FsfBasis::new(longest, banks.narrowest().frequencies)?;
        let coordinates = Coordinates::new(basis);
        let solution = information
            .solve(&coordinates, &ar)
            .ok_or_else(not_excited)?;
        let impulse = coordinates.impulse(solution.response());
        let next = next_noise(moments, &impulse, solution.offset(), order, pass == 0);
        let change = noise_change(&ar, &next);
        ar = next;
        if change < 1e-2 {
            break;
        }
    }
    let long = scan(&information, longest, &ar).ok_or_else(not_excited)?;
    let mut candidates = Vec::new();
    let mut frequencies = long.frequencies;
    for settling in grid(longest) {
        let Some(scan) = scan(&information, settling, &ar) else {
            continue;
        };
        let tolerance = |m: usize| DETECTION * scan.sd[m.min(settling - 1)] + scan.bias;
        let end = scan.value[settling - 1];
        let moving = (0..settling - 1)
            .rev()
            .find(|&m| (scan.value[m] - end).abs() > tolerance(m));
        // Both responses are uncertain; the shorter one has reached its end after N.
        let contradiction = (0..longest)
            .map(|m| {
                let here = scan.value[m.min(settling - 1)];
                let sd = long.sd[m] + scan.sd[m.min(settling - 1)];
                ((here - long.value[m]).abs() - scan.bias - long.bias).max(0.0) / sd
            })
            .fold(0.0, f64::max);
        let detected = moving.map_or(1, |m| m + 2);
        let accepted = (settling == longest || contradiction <= DETECTION)
            && settling as f64 >= MARGIN * detected as f64;
        candidates.push(SettlingCandidate {
            settling,
            detected,
            contradiction,
            accepted,
        });
        frequencies = scan.frequencies;
        if accepted {
            break;
        }
    }
    let mut choice = chosen(candidates, longest, ar);
    choice.low_passed = true;
    choice.frequencies = Some(frequencies);
    Ok(choice)
}

fn scan(information: &RowInformation, settling: usize, ar: &[f64]) -> Option<Scan> {
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
    let fit = gls::fit(information, &coordinates, &options)?;
    let spread = CurveVariance::of_fit(information, &fit, &coordinates.step_map());
    Some(Scan {
        frequencies: best.frequencies,
        value: coordinates.basis.step_response(&fit.theta()),
        sd: spread.sd,
        bias: best.truncation_bias,
    })
}
