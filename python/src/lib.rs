//! The Python package `servoid`, as far as it is Rust: the library's objects and functions as Python has them.
//!
//! What is here takes arrays and names of files, computes without the interpreter's lock, and hands back a document, the same
//! JSON as the program prints. `servoid/` beside it makes objects with arrays and units of these documents.

// Callers, files and users must not cause a panic.
#![deny(
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::string_slice,
    clippy::unreachable,
    clippy::unwrap_used
)]

mod arguments;
mod arrays;
mod compute;
mod data;
mod error;
mod export;
mod identification;
mod model;
mod program;
mod rig;
mod sides;

/// The part of the package servoid that is Rust.
#[pyo3::pymodule]
mod _servoid {
    #[pymodule_export]
    use crate::arguments::with_arguments_for_options;
    #[pymodule_export]
    use crate::data::Data;
    #[pymodule_export]
    use crate::error::ServoidError;
    #[pymodule_export]
    use crate::identification::{identify, identify_arrays};
    #[pymodule_export]
    use crate::model::Model;
    #[pymodule_export]
    use crate::program::run_program;
    #[pymodule_export]
    use crate::rig::{plan, simulate};
    #[pymodule_export]
    use crate::sides::{compare, compare_models, validate};
}
