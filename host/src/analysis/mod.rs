//! What the commands and the Python package do with data and models: identification with all that may follow it, comparison
//! and validation, each with the document that `--json` prints, files for other programs, and recordings of simulated servos.
//!
//! | room | holds |
//! |---|---|
//! | `recording_advice`, `command_times` | what a recording shows beside any model: units, travel, and when its commands took effect |
//! | `one_servo` | the linear model, the servo model and the low-order model of one recording |
//! | `two_servos` | two of them beside each other |
//! | `against_recordings` | a model against recordings that it was not identified from |

mod against_recordings;
mod command_times;
mod duration_in_words;
mod exported;
mod json;
mod one_servo;
mod recording_advice;
mod simulation;
mod two_servos;

pub use against_recordings::validation::Validated;
pub use exported::{ExportRequest, Exported};
pub use json::to_json;
pub use one_servo::identification::{Identified, IdentifiedDocument, IdentifyRequest};
pub use one_servo::identified::identified;
pub use one_servo::low_order::low_order;
pub use one_servo::model_text::text_of_file;
pub use one_servo::servo_fit::{self, ServoModelSearch};
pub use simulation::SimulatedServo;
pub use two_servos::comparison::{Compared, compared, compared_models};
pub use two_servos::servo_comparison::compared_servos;
