//! The recorded data, and the moments that all estimates are made from.

pub mod holds;
pub mod moments;
pub mod quantisation;
pub mod record;
pub mod timing;
