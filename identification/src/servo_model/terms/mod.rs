//! Which terms the servo has.

mod begun_terms;
mod cut_crests;
pub(super) mod ladder;
pub(super) mod level_crests;
pub(super) mod neighbouring_terms;
pub(super) mod speed_on_ladder;
pub(super) mod stops;
