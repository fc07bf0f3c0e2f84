//! The words and numbers that all sentences are made of.

pub(super) mod layout;
pub(super) mod numbers;
pub(crate) mod recorded;
pub(super) mod sixty_degrees;
pub(super) mod speed_words;
pub(super) mod strokes;
