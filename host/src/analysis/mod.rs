//! What the commands and the Python package do with data and models: identification with all that may follow it, comparison
//! and validation, each with the document that `--json` prints, files for other programs, and recordings of simulated servos.

mod angle_units;
mod command_answers;
mod command_edges;
mod commands_at_pulses;
mod comparison;
mod delay_errors;
mod duration_in_words;
mod exported;
mod identification;
mod identified;
mod json;
mod load_at_rest;
mod low_order;
mod misfit;
mod model_text;
mod no_step;
mod noise_at_rest;
mod pulse_frames;
mod sample_period;
mod scale_errors;
mod servo_comparison;
pub mod servo_fit;
mod short_of_command;
mod simulation;
mod travel;
mod validation;

pub use comparison::{Compared, compared, compared_models};
pub use exported::{ExportRequest, Exported};
pub use identification::{Identified, IdentifiedDocument, IdentifyRequest};
pub use identified::identified;
pub use json::to_json;
pub use low_order::low_order;
pub use model_text::text_of_file;
pub use servo_comparison::compared_servos;
pub use simulation::SimulatedServo;
pub use validation::Validated;
