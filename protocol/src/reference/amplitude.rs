//! The amplitude of a reference.

/// An amplitude as an offset (µs). One that does not fit is not well formed, and exceeds every limit.
pub(super) fn amplitude(amplitude_us: u16) -> i16 {
    i16::try_from(amplitude_us).unwrap_or(i16::MAX)
}

pub(super) fn is_amplitude(amplitude_us: u16) -> bool {
    (1..=i16::MAX as u16).contains(&amplitude_us)
}
