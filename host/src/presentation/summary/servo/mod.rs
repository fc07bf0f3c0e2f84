//! The servo as a machine in words: its sentence, its quantities, and what is said beside them.

pub(super) mod clauses;
pub(super) mod doubts;
pub(super) mod kind_of_servo;
#[cfg(test)]
pub(super) mod limited_servo;
pub(super) mod linear_beside;
pub(super) mod measured_limits;
pub(super) mod quantity_table;
pub(super) mod servo_model;
pub(super) mod servo_remarks;
pub(super) mod servo_sentence;
pub(super) mod top_speeds;
pub(super) mod what_to_record;
pub(super) mod whole_stroke;
