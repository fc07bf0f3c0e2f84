//! The live scope: the picture of a capture in a terminal.
//!
//! ```text
//!  capture --> ScopeEvent --> ScopeState --> draw --> terminal
//!                          the scope's own thread
//! ```
//!
//! [`ScopeState`] holds everything that is shown; [`draw`] depends on nothing else. The scope runs on a thread of
//! its own, so a capture never waits for a picture.

mod drawing;
mod render_thread;
mod state;
mod status_panel;
pub(crate) mod terminal;
mod terminal_plots;

pub use drawing::draw;
pub use state::{FrameSeen, Link, ScopeEvent, ScopeState};
pub use terminal_plots::step_as_text;

pub(crate) use render_thread::Scope;
