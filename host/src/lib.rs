//! Measures the motion of R/C servos: step and frequency response, with 99 % bounds.
//!
//! The path of the data, and the rooms that it goes through. A room imports only those before it in this order:
//! [`data`], [`instrument`], [`presentation`], [`plan`], [`analysis`], [`commands`].
//!
//! 1. [`instrument::reference`] resolves a reference: a pulse width for each frame of 20 ms.
//! 2. [`instrument::rig`] drives a rig with it and receives the frames: applied pulses and sensor counts.
//! 3. [`data::recording`] keeps them in a file; [`data::table`] reads files of other programs.
//! 4. [`data::dataset`] makes a record of one or several files.
//! 5. [`servoid_identification`] reduces the record to moments and identifies the model with its bounds.
//! 6. [`data::model_file`] keeps the model.
//! 7. [`presentation`] shows it: summary, plots, report, exports to other programs, and the live scope.
//! 8. [`plan`] forecasts the bounds of a run before it takes place.
//! 9. [`analysis`] is what one asks for: identification with all that may follow it, comparison, validation.
//! 10. [`commands`] is the command line over all of this; the package for Python lies over [`analysis`] too.

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

pub mod analysis;
pub mod commands;
pub mod data;
pub mod instrument;
pub mod plan;
pub mod presentation;
