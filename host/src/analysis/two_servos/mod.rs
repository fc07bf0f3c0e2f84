//! Two servos beside each other, and how far their sensors and delays allow that.

pub(super) mod comparison;
pub(super) mod delay_errors;
pub(super) mod scale_errors;
pub(super) mod servo_comparison;
