//! Measures how an R/C servo really moves, and says how sure it is.
//!
//! The path of the data, and where each part of it lives:
//!
//! ```text
//!  Reference -> rig ------> Frame ------> Recording ------> Record -> Model ------> plots, summary
//!  protocol     port, rig   protocol      rig::capture,     dataset   identification  plots,
//!                                         recording                                   summary
//! ```
//!
//! | module        | what it does                                                             |
//! |---------------|--------------------------------------------------------------------------|
//! | [`port`]      | a byte stream to a rig: serial, network, or simulated in this process      |
//! | [`mod@reference`] | what the servo is told, from degrees, seconds and Hertz                |
//! | [`rig`]       | talks to a rig, and captures runs                                          |
//! | [`setup`]     | a rig file for a new rig                                                   |
//! | [`calibration`] | what a rig file says, measured: scales, neutral, ends of the travel       |
//! | [`input`]     | files that come in, whole                                                  |
//! | [`recording`] | recordings on disk, written as they come in and read as what they are      |
//! | [`table`]     | any other CSV file                                                         |
//! | [`timeline`]  | where the rows of such a file lie in time                                 |
//! | [`dataset`]   | from files to a record that can be identified                              |
//! | [`plan`]      | before a run: how wide the band will be, and what it cannot answer          |
//! | [`plots`]     | pictures                                                                   |
//! | [`summary`]   | results as text for a terminal                                             |
//! | [`explain`]   | why a model has the structure that it has                                  |
//! | [`report`]    | one page with everything, to open in a browser                             |
//! | [`origin`]    | units of a model, and what held its command                                |
//! | [`export`]    | models as scripts, headers and fragments for other programs                |
//! | [`paper`]     | the paper's facts beside ours                                              |
//! | [`template`]  | texts with gaps                                                           |
//! | [`output`]    | files that a command leaves behind                                         |
//! | [`commands`]  | the command line, thin                                                     |
//!
//! The mathematics is in [`servoid_identification`], what goes over the wire in
//! [`servoid_protocol`].

// What files, lines and users bring meets no panic here.
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
mod presentation;

pub use commands::{output_files, rig_wizard};
pub use data::{
    dataset, fingerprint, input_file, model_file, model_metadata, recording, rig_file, table,
    timeline, units,
};
pub use instrument::{calibration, live, port, reference, rig};
pub use presentation::{explanation, export, paper_facts, plots, report, scope, summary, template};
