//! What differs from hold to hold, and whether the servo rests in them.

pub(super) mod answer_scatter;
pub(super) mod clustered_errors;
pub(super) mod held_run;
pub(super) mod hold_scatter;
pub(super) mod level_answers;
pub(super) mod level_effects;
pub(super) mod level_scatter;
pub(super) mod moves_again;
pub(super) mod moves_with_next_step;
pub(super) mod rests_within_holds;
