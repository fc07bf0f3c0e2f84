//! Files and tables: what comes in and what is kept, as data.

pub mod dataset;
pub mod model_file;
pub mod recording;
pub mod rig_file;
pub mod table;

pub(crate) mod degrees;
pub(crate) mod fingerprint;
pub(crate) mod input_file;
pub(crate) mod model_metadata;
pub(crate) mod sensor_health;
pub(crate) mod timeline;
pub(crate) mod units;

pub use degrees::DegreeScale;
pub use model_metadata::ModelMetadata;
pub use units::Units;
