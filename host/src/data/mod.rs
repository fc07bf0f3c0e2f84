//! Files and tables: what comes in and what is kept, as data.

pub mod dataset;
pub mod degrees;
pub mod fingerprint;
pub mod input_file;
pub mod model_file;
pub mod model_metadata;
pub mod recording;
pub mod rig_file;
pub mod sensor_health;
pub mod table;
pub mod timeline;
pub mod units;
