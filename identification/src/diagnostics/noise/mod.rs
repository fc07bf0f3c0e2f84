//! Noise that is not one stationary process: hum and noise that is not even; and the noise at standstill beside that in motion.

pub(super) mod hum;
pub(super) mod standstill_noise;
pub(super) mod uneven_noise;
