//! Results for people and other programs.

pub mod explanation;
pub mod export;
pub mod paper_values;
pub mod plots;
pub mod report;
pub mod scope;
pub mod summary;
pub mod template;
