//! Files as data: recordings, tables, rig files, model files, and the data set of any recordings.

pub mod dataset;
pub mod model_file;
pub mod recording;
pub mod rig_file;
mod seams;
pub mod sensor_preset;
pub mod table;

pub(crate) mod clock_error;
pub(crate) mod degrees;
mod file_error;
pub(crate) mod fingerprint;
mod frozen_sensor;
pub(crate) mod held_out;
pub(crate) mod input_file;
pub(crate) mod model_metadata;
pub(crate) mod neutral;
pub(crate) mod numbered_path;
mod predicted_run;
pub(crate) mod pulse_end;
pub(crate) mod pulse_widths;
pub(crate) mod rest_error;
mod servo_moved;
mod unlike_runs;

pub(crate) mod mixed_units;
mod omitted_fields;
pub(crate) mod timeline;
pub(crate) mod unitless_command;
pub(crate) mod units;

pub use degrees::DegreeScale;
pub use file_error::FileError;
pub use frozen_sensor::{FrozenSensor, StandStill};
pub use held_out::HeldOutPrediction;
pub use model_metadata::ModelMetadata;
pub use predicted_run::PredictedRun;
pub use servo_moved::{FAR_FROM_COMMAND_DEG, Movement, hardly_moved};
pub use units::Units;
