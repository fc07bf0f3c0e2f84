//! Where the travel of the servo ends: stops, arrivals, and a servo that stops following.

pub(super) mod arrival;
pub(super) mod flat_end;
pub(super) mod moves_beyond;
pub(super) mod outermost_rests;
pub(super) mod rests;
pub(super) mod servo_stopped;
pub(super) mod split;
pub(super) mod split_squares;
pub(super) mod travel_end;
