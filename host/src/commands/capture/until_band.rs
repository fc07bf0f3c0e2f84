//! The result of `--until-band`, and the advice where the band is too wide.

use crate::instrument::live::LiveStep;
use crate::plan::NarrowingBand;
use serde::Serialize;
use servoid_identification::results::{Bounds, Reason, Withdrawn};

/// The band that was asked for, and the band of all runs together.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct BandReached {
    asked_percent: f64,
    /// Half of the band's width at its widest; `None` without a step response, or without bounds.
    reached_percent: Option<f64>,
    reached: bool,
    /// Why a step response has no bounds; `None` where it has, or there is none.
    withdrawn: Option<Withdrawn>,
    #[serde(skip)]
    estimate: BandEstimate,
}

/// The estimate from all runs together.
#[derive(Clone, Copy, Debug)]
enum BandEstimate {
    /// No step response.
    None,
    /// A step response without valid bounds.
    NoBounds(Reason),
    /// A step response with a band.
    Band(NarrowingBand),
}

impl BandReached {
    /// Compares the last estimate, if there is one, with the band that was asked for.
    pub(super) fn of(asked_percent: f64, step: Option<&LiveStep>) -> Self {
        let estimate = match step.map(|live| &live.step.bounds) {
            None => BandEstimate::None,
            Some(Bounds::Withdrawn(reason)) => BandEstimate::NoBounds(*reason),
            Some(Bounds::Valid(bounds)) => BandEstimate::Band(NarrowingBand {
                widest_percent: 100.0 * bounds.widest_half_width(),
                floor_percent: 100.0 * bounds.bias(),
            }),
        };
        Self {
            asked_percent,
            reached_percent: match estimate {
                BandEstimate::Band(band) => Some(band.widest_percent),
                BandEstimate::None | BandEstimate::NoBounds(_) => None,
            },
            withdrawn: match estimate {
                BandEstimate::NoBounds(reason) => Some(Withdrawn(reason)),
                BandEstimate::None | BandEstimate::Band(_) => None,
            },
            reached: step.is_some_and(|step| step.is_within(asked_percent)),
            estimate,
        }
    }

    /// The next step for the user, where the band is still too wide after `runs`.
    pub(super) fn advice(&self, runs: usize) -> Option<String> {
        if self.reached {
            return None;
        }
        let asked = self.asked_percent;
        Some(match self.estimate {
            BandEstimate::Band(band) => format!(
                "the band is still ±{:.2} % of the step, not the ±{asked} % that was asked for; {}",
                band.widest_percent,
                band.advice(asked, runs)
            ),
            BandEstimate::NoBounds(reason) => format!(
                "no band can be given, as {}; 'servoid identify' says what to do",
                reason.because()
            ),
            BandEstimate::None => {
                "no step response could be found: the run was too short; record a longer one"
                    .to_owned()
            }
        })
    }
}
