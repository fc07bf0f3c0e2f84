//! Measures the motion of R/C servos: step and frequency response, with 99 % bounds.
//!
//! The rooms of this crate, in the order of the data. Each imports only rooms above it in this table.
//!
//! | folder          | content                                                                          |
//! |-----------------|----------------------------------------------------------------------------------|
//! | `data/`         | [`recording`]s, CSV [`table`]s, their [`timeline`], and the [`dataset`] of both   |
//! | `instrument/`   | [`port`], [`rig`] client, [`mod@reference`], [`calibration`], [`live`] estimate    |
//! | [`presentation`]| summary, plots, report, export, live scope                                         |
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
mod data;
mod instrument;
pub mod plan;
pub mod presentation;

pub use data::{
    dataset, degrees, fingerprint, input_file, model_file, model_metadata, recording, rig_file,
    sensor_health, table, timeline, units,
};
pub use instrument::{calibration, live, port, reference, rig};
