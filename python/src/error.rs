//! Errors as exceptions, with the sentences of the library.

use crate::arguments::in_python;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::{PyErr, create_exception};

create_exception!(
    servoid,
    ServoidError,
    PyValueError,
    "What is wrong with data or a request: the failure, its reason, and what to do."
);

/// An error as an exception: causes on one line, behind the sentence that they explain, and options by the names of their
/// arguments.
pub(crate) fn raised(error: impl Into<anyhow::Error>) -> PyErr {
    ServoidError::new_err(in_python(&format!("{:#}", error.into())))
}

/// A defect of servoid itself.
pub(crate) fn defect() -> PyErr {
    PyRuntimeError::new_err(
        "servoid has a defect: it could not finish this computation; please report it with the data",
    )
}
