//! Candidate: all frequencies, n = N.

use super::long_fit::LongFit;
use super::settling_candidates::Choice;
use super::settling_range::grid;
use super::settling_search::Search;
use crate::estimation::{Excitation, FIRST_ORDER, NestedBanks};
use crate::thresholds::WIDE_COMPLETE_BAND;

/// The shortest acceptable N; `None` where the input does not determine a complete bank.
pub(crate) fn choose(search: &Search<'_>) -> Option<Choice> {
    let (moments, longest) = (search.moments, search.longest);
    let long = LongFit::new(search)?;
    let long = match Excitation::of(moments).is_smooth() {
        true => long.with_averages(),
        false => long,
    };
    let grid = grid(longest);
    let choice = Choice::first_accepted(long.candidates(&grid), longest, long.ar.clone())?;
    let banks = NestedBanks::scan(moments, choice.settling, &choice.ar, FIRST_ORDER)?;
    (!is_wide(&banks, choice.settling)).then_some(choice)
}

/// Whether the complete bank of a settling time is undetermined, or its band too wide beside the narrowest.
pub(crate) fn is_wide(banks: &NestedBanks, settling: usize) -> bool {
    let complete = settling - usize::from(settling.is_multiple_of(2));
    banks.excited() < complete
        || banks.largest().half_width() > WIDE_COMPLETE_BAND * banks.narrowest().half_width()
}
