//! What a person sees in a terminal while a capture goes on.
//!
//! ```text
//!  capture --> ScopeEvent --> (channel) --> ScopeState --> draw --> terminal
//!                                              the scope's own thread
//! ```
//!
//! [`state`] is all that is known, [`mod@draw`] a pure picture of it, [`terminal`] takes the terminal over
//! and gives it back whatever happens, and [`Scope`] runs the three on a thread of its own: the capture
//! hands over what it has and never waits for a picture.

pub mod draw;
mod panel;
mod plots;
pub mod state;
pub mod terminal;
mod thread;

pub use state::{ScopeEvent, ScopeState};
pub use thread::Scope;
