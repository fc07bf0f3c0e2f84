//! The recorded data, and the moments that all estimates are made from.

pub mod column;
mod holds;
mod moments;
mod quantisation;
mod record;
mod references;
pub(crate) mod repetition;
mod timing;
mod white_noise;
mod wrong_columns;

pub use holds::only_stroke;
pub(crate) use holds::{
    EXACTLY, HELD, Hold, Stroke, between_ends, hold_lengths, holds, last_quarter, leaves_neutral,
    mean_output, measured_within, share_held, shorter_exact_hold, stroke_sizes, strokes,
    usual_exact_hold, usual_hold,
};
pub use moments::{MomentStream, Moments};
pub use quantisation::Quantisation;
pub(crate) use quantisation::{common_step, sensor_step};
pub use record::{Record, Run};
pub(crate) use references::References;
pub use timing::Timing;
pub(crate) use white_noise::white_noise;
