//! Results for people and other programs.

pub mod export;
pub mod plots;
pub mod report;
pub mod scope;
pub mod summary;

pub(crate) mod explanation;
pub(crate) mod paper_values;
pub(crate) mod template;
