//! Results as text for a terminal.

mod at_frequencies;
mod beyond_linear;
mod both_models;
mod comparison;
mod first_finding;
mod headline;
mod key_figures;
mod layout;
#[cfg(test)]
mod limited_servo;
mod linear_model;
mod low_order;
mod measured_limits;
mod metrics;
mod model_sentence;
mod numbers;
mod quantity_table;
mod servo_comparison;
mod servo_model;
mod servo_remarks;
mod servo_sentence;
mod sixty_degrees;
mod speed_words;
mod strokes;
mod top_speeds;
mod validation;
mod what_to_record;
mod whole_stroke;

pub use at_frequencies::{
    AskedSine, GainAndPhase, at_frequencies, sine_of_linear_model, sine_of_machine,
};
pub(crate) use beyond_linear::STROKES_OF_ONE_DIRECTION;
pub use beyond_linear::{of_flight_model, of_limits, of_strokes};
pub use both_models::{answer_of_servo_model, of_both_models};
pub use comparison::of_comparison;
pub use linear_model::{Extent, of_model};
pub(crate) use linear_model::{facts, level_text};
pub(crate) use metrics::TableRow;
pub use model_sentence::model_sentence;
pub(crate) use servo_comparison::{how_servo_models_are_compared, servo_model_rows};
pub use servo_comparison::{of_servo_models, sentence_on_servo_models};
pub use servo_model::of_servo_model;
pub(crate) use servo_sentence::LOOKS_LIKE_A_LOAD;
pub(crate) use servo_sentence::unlikely_speed;
pub use servo_sentence::{is_called_linear, servo_sentence};
pub(crate) use sixty_degrees::{per_60_degrees, sixty_degrees};
pub(crate) use speed_words::reached_speed;
pub(crate) use strokes::{of_one_size, stroke_in_words};
pub use validation::of_validation;

pub(crate) use comparison::{
    NOT_COMPARED, facts_of_comparison, how_compared, table_of_comparison, verdict,
};
pub(crate) use first_finding::first_finding;
pub(crate) use headline::{headline_of_comparison, headline_of_model, headline_of_servo};
pub(crate) use key_figures::{
    KEY_FIGURES, KeyFigure, of_both, of_both_machines, of_comparison as key_figures_of_comparison,
    of_machine, of_response,
};
pub(crate) use layout::{first_sentence, listed_words, wrapped};
pub(crate) use low_order::low_order_sentence;
pub(crate) use metrics::{difference_rows, metric_rows, withheld_line};
pub(crate) use numbers::{decimals, digits, four_digits, head_of_bounds, percent, probability};
pub(crate) use quantity_table::{QuantityRow, quantities, quantity_rows};
pub(crate) use servo_model::{kind_in_words, terms_in_words};
pub(crate) use servo_remarks::{ServoRemarks, run_offsets_in_words};
pub(crate) use servoid_identification::results::with_unit;
