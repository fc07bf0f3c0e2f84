//! What a servo is looked for in: the stretches of a record, the grid of its motion, and how far a search goes.

use super::descent::coordinates::Point;
use super::stretches::{Stretch, stretches};
use crate::data::Record;
use crate::error::Error;
use servoid_dynamics::Grid;

/// Longest sample period \[s\].
const LONGEST_PERIOD_S: f64 = 0.5;

/// Samples that are needed: a few for each of the blocks.
const FEWEST: usize = 64;

/// Errors beyond this many standard deviations of the output are clipped: a servo that is lost counts, but does not decide.
pub(super) const CLIP: f64 = 0.5;

/// Longest delay that is looked for \[s\], and in samples: the larger of the two.
const LONGEST_DELAY: (f64, f64) = (0.2, 4.0);

/// The longest delay that is looked for in samples so far apart \[s\].
pub(super) fn longest_delay_s(period_s: f64) -> f64 {
    LONGEST_DELAY.0.max(LONGEST_DELAY.1 * period_s)
}

/// The grid on which the motion of the servo `point` is computed.
pub(super) fn fine_grid(point: &Point, record: &Record) -> Grid {
    let stiffness = point.physics(0, |_, value| value).stiffness;
    Grid::for_stiffness(record.sample_period_s(), record.sample_phase_s(), stiffness)
}

/// The stretches of a record that a servo can be found in, and the fold that each of their blocks belongs to.
pub(super) fn usable_stretches(
    record: &Record,
    controllers: &[usize],
) -> Result<(Vec<Stretch>, Vec<usize>), Error> {
    let (parts, fold_of) = stretches(record, controllers);
    let samples: usize = parts.iter().map(|part| part.input.len()).sum();
    if samples < FEWEST {
        return Err(Error::TooShortForAuto {
            samples,
            needed: FEWEST,
            at_rest: None,
        });
    }
    let period_s = record.sample_period_s();
    if period_s > LONGEST_PERIOD_S {
        return Err(Error::PeriodTooLong {
            period_s,
            longest_s: LONGEST_PERIOD_S,
        });
    }
    Ok((parts, fold_of))
}
