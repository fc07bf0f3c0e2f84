//! Two servos beside each other in words.

pub(super) mod comparison;
pub(super) mod servo_comparison;
