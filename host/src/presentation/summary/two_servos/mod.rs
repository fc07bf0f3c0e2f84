//! Two servos beside each other in words.

pub(super) mod comparison;
mod play_of_both;
pub(super) mod servo_comparison;
mod slower_servo;
