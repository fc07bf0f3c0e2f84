//! Results as text for a terminal.
//!
//! | room | holds |
//! |---|---|
//! | `wording` | numbers, units and layout, of which all sentences are made |
//! | `response` | the linear and the low-order model |
//! | `servo` | the servo as a machine |
//! | `two_servos` | two models beside each other |

mod both_models;
mod headline;
mod key_figures;
mod response;
mod servo;
mod two_servos;
mod validation;
mod wording;

pub use both_models::{answer_of_servo_model, of_both_models};
pub use response::at_frequencies::{
    AskedSine, GainAndPhase, at_frequencies, sine_of_linear_model, sine_of_machine,
};
pub(crate) use response::beyond_linear::STROKES_OF_ONE_DIRECTION;
pub use response::beyond_linear::{of_flight_model, of_limits, of_strokes};
pub use response::linear_model::{Extent, of_model};
pub(crate) use response::linear_model::{facts, level_text};
pub(crate) use response::metrics::TableRow;
pub use response::model_sentence::model_sentence;
pub(crate) use servo::clauses::{LOOKS_LIKE_A_LOAD, shows_load};
pub(crate) use servo::doubts::unlikely_speed;
#[cfg(test)]
pub(crate) use servo::limited_servo::{limited_record, limited_servo};
pub use servo::linear_beside::is_called_linear;
pub use servo::servo_model::of_servo_model;
pub use servo::servo_sentence::servo_sentence;
pub use two_servos::comparison::of_comparison;
pub(crate) use two_servos::servo_comparison::{
    how_servo_models_are_compared, servo_model_rows, what_is_below,
};
pub use two_servos::servo_comparison::{of_servo_models, sentence_on_servo_models};
pub use validation::of_validation;
pub(crate) use wording::sixty_degrees::{per_60_degrees, sixty_degrees};
pub(crate) use wording::strokes::{of_one_size, stroke_in_words};

pub(crate) use headline::{headline_of_comparison, headline_of_model, headline_of_servo};
pub(crate) use key_figures::{
    KEY_FIGURES, KeyFigure, of_both, of_both_machines, of_comparison as key_figures_of_comparison,
    of_machine, of_response,
};
pub(crate) use response::first_finding::first_finding;
pub(crate) use response::low_order::low_order_sentence;
pub(crate) use response::metrics::{difference_rows, metric_rows, withheld_line};
pub(crate) use servo::quantity_table::{QuantityRow, quantities, quantity_rows};
pub(crate) use servo::servo_model::{error_in_words, kind_in_words, terms_in_words};
pub(crate) use servo::servo_remarks::{
    ServoRemarks, missed_rests_in_words, run_offsets_in_words, stall_in_words,
};
pub(crate) use servoid_identification::results::with_unit;
pub(crate) use two_servos::comparison::{
    NOT_COMPARED, facts_of_comparison, how_compared, table_of_comparison, verdict,
};
pub(crate) use wording::layout::{findings, first_sentence, listed_words, wrapped};
pub(crate) use wording::numbers::{
    decimals, digits, four_digits, head_of_bounds, percent, probability,
};
pub(crate) use wording::recorded;
