//! Pictures of recordings and models.
//!
//! [`figure`] is what a picture shows, as data; [`figures`] makes the paper's figures from recordings
//! and models; [`svg`] draws them. A drawing in another format is another file beside [`svg`].

pub mod figure;
pub mod figures;
pub mod svg;

pub use figure::Figure;
