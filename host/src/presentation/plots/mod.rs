//! Pictures of recordings and models.
//!
//! [`figure`] is what a picture shows, as data. [`paper_figures`] makes the paper's figures from recordings
//! and models, those over time in [`signals`] and those of responses in [`response`]; [`structure`],
//! [`residuals`], [`scatter`] and [`difference`] make what a reader needs to trust them. [`svg`] draws them; a
//! drawing in another format is another file beside it.

pub mod difference;
pub mod figure;
pub mod named;
pub mod paper_figures;
pub mod residuals;
pub mod response;
pub mod scatter;
pub mod signals;
pub mod structure;
pub mod svg;

pub use figure::Figure;
