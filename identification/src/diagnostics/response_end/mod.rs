//! How the response ends, and what may come after N.

pub(super) mod rise_at_end;
pub(super) mod slow_end;
pub(super) mod slow_servo;
pub(super) mod tails;
