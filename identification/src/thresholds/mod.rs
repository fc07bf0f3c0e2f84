//! The thresholds that decide what is chosen, found or withdrawn, in one table of a few pages.
//!
//! Each entry says what it protects and where the evidence for its value is: a table of docs/method.md, docs/coverage.md, docs/assumptions.md or
//! the test that fails when it is moved. How a test is built (its lags, blocks and windows, and the least data that it can be computed
//! from) and tolerances of the arithmetic (passes, rounding) stay in the files that need them. So do the thresholds of what the host
//! finds in files and recordings, such as commands that were written between the rows.
//!
//! One record is judged by several of these tests. How often a record of a linear servo is given any finding of
//! them is measured by the example `coverage`, stated in docs/coverage.md ("False alarms in all") and held by the
//! test `bands_of_automatic_structure_hold_as_often_as_they_say`.

mod comparison;
mod disturbances;
mod errors;
mod findings;
mod input;
mod nonlinear;
mod servo_model;
mod settling;

pub use comparison::*;
pub use disturbances::*;
pub use errors::*;
pub use findings::*;
pub use input::*;
pub use nonlinear::*;
pub use servo_model::*;
pub use settling::*;
