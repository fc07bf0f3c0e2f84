//! The live scope: the picture of a capture in a terminal.
//!
//! ```text
//!  capture --> ScopeEvent --> ScopeState --> drawing --> terminal
//!                          the scope's own thread
//! ```
//!
//! [`state`] holds everything that is shown. [`drawing`] draws it and depends on nothing else. [`terminal`] takes
//! the terminal over and gives it back in every case. [`Scope`] runs the three on a thread of its own, so a
//! capture never waits for a picture.

mod charts;
pub mod drawing;
mod render_thread;
pub mod state;
mod status_panel;
pub mod terminal;

pub use render_thread::Scope;
pub use state::{ScopeEvent, ScopeState};
