//! Measures the motion of R/C servos: step and frequency response, with 99 % bounds.
//!
//! The rooms of this crate, in the order of the data. Each imports only rooms above it in this table.
//!
//! | folder          | content                                                                          |
//! |-----------------|----------------------------------------------------------------------------------|
//! | [`data`]        | recordings, rig files, model files, CSV tables, and the data set of any of them   |
//! | [`instrument`]  | port, conversation with the rig, reference, calibration, live estimate             |
//! | `presentation/` | [`summary`], [`plots`], [`report`], [`export`], live [`scope`]                     |
//! | `plan/`         | the forecast of a run: [`plan`]                                                    |
//! | `commands/`     | the command line: [`commands`]                                                     |
//!
//! The mathematics is in [`servoid_identification`], the wire protocol in [`servoid_protocol`].

// Files, serial lines and users must not cause a panic.
#![cfg_attr(
    not(test),
    deny(
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::panic,
        clippy::string_slice,
        clippy::unreachable,
        clippy::unwrap_used
    )
)]

pub mod commands;
pub mod data;
pub mod instrument;
pub mod plan;
mod presentation;

pub use commands::{output_files, rig_wizard};
pub use presentation::{
    explanation, export, paper_values, plots, report, scope, summary, template,
};
