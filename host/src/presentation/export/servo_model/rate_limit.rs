//! The rate limit that comes closest to a drive that must first build up speed.

use super::subject::ServoExport;
use super::trial_command::Trial;
use crate::presentation::summary::four_digits;
use servoid_identification::servo_model::QuantityKind;

/// Each rate that is tried is this part of the last.
pub(super) const FACTOR: f64 = 0.97;

/// So many times as large are the strokes in which a limit of a top speed that the recording does not determine is held against none. The
/// strokes of the recording may ask for either: beside a servo without any limit, with play of 1.2 of 36 degrees, a limit left 0.81 of the
/// difference that there is without one, and held the servo back by half of a stroke that was 1.6 times as large.
const LARGER: f64 = 1.6;

/// A rate limit beside a servo.
#[derive(Clone, Copy)]
pub(super) struct RateFit {
    /// The rate as a share of the top speed; `None` without a limit.
    pub share: Option<f64>,
    /// The root mean square of the difference.
    pub difference: f64,
}

/// The share of the top speed that, as a rate limit, gives the least mean square of the difference from the servo in the strokes of the
/// staircase: in repeated reversals a rate that suits them is too low for strokes. `respond` has the positions for a share of the speed
/// `top`, which may be none. In strokes that end before the drive reaches its top speed it is well below 1. It may be below the highest speed
/// that the servo reached: a limit acts from the beginning of a stroke to its end, and the mean over the stroke counts. A top speed that
/// the recording does not determine is a limit only if it is one in larger strokes, too, by the servo model.
pub(super) fn best_share(
    export: &ServoExport<'_>,
    trial: &Trial,
    top: Option<f64>,
    respond: impl Fn(Option<f64>, &Trial) -> Vec<f64>,
) -> RateFit {
    let within = |trial: &Trial| {
        let exact = trial.exact(&export.parameters);
        let (trial, respond) = (trial.clone(), &respond);
        move |share: Option<f64>| RateFit {
            share,
            difference: trial.root_mean_square(&respond(share, &trial), &exact),
        }
    };
    let staircase = trial.only_staircase();
    let tried = within(&staircase);
    let limited = top.and_then(|top| {
        let limited = shares(trial, top).map(|share| tried(Some(share)));
        limited.min_by(|a, b| a.difference.total_cmp(&b.difference))
    });
    let Some(limited) = limited else {
        return tried(None);
    };
    let larger = within(&staircase.enlarged(LARGER));
    let is_free =
        !export.top_speed_is_known() && larger(None).difference < larger(limited.share).difference;
    match is_free {
        true => tried(None),
        false => limited,
    }
}

/// The shares that are tried: from the top speed down to the rate at which the largest stroke takes the whole time of a level. A top
/// speed that the recording does not determine may be a thousand times what any stroke shows, so it begins no higher than one stroke in a
/// step.
fn shares(trial: &Trial, top: f64) -> impl Iterator<Item = f64> {
    let of_step = trial.largest_stroke() / trial.step_s / top;
    let quickest = of_step.min(1.0);
    let slowest = of_step / trial.steps_per_level as f64;
    std::iter::successors(Some(quickest), |share| Some(FACTOR * share))
        .take_while(move |share| *share == quickest || *share >= slowest)
}

/// What a rate below the top speed means for strokes that the recording did not have; `None` where it is the top speed or where there is no
/// limit.
pub(super) fn behind_in_larger_strokes(share: Option<f64>) -> Option<String> {
    let share = share.filter(|share| *share < FACTOR)?;
    Some(format!(
        "the rate limit is {} % of the top speed, which suits strokes of the recorded size: in larger ones this file falls behind the servo",
        four_digits(100.0 * share)
    ))
}

impl ServoExport<'_> {
    /// Whether the recording determines the top speeds.
    pub(super) fn top_speed_is_known(&self) -> bool {
        let speeds = [
            QuantityKind::TopSpeedUpwards,
            QuantityKind::TopSpeedDownwards,
        ];
        let is_open = |kind| {
            let found = self.model.quantity(kind);
            found.is_some_and(|found| !found.determined)
        };
        !speeds.into_iter().any(is_open)
    }
}
