//! Ctrl-C, and the signals that a system sends to end a program.

use crate::presentation::scope::terminal;
use anyhow::{Context, Result};
use std::sync::atomic::{AtomicBool, Ordering};

static ASKED: AtomicBool = AtomicBool::new(false);

/// From now on [`asked`] reports the first Ctrl-C, SIGTERM or SIGHUP, and the second one ends the program at once.
pub(super) fn listen() -> Result<()> {
    ctrlc::set_handler(ask).context("Ctrl-C cannot be caught")
}

/// The effect of such a signal, or of a key that stands for one.
pub(super) fn ask() {
    if ASKED.swap(true, Ordering::SeqCst) {
        terminal::give_back();
        // 128 + SIGINT, as shells report a program that Ctrl-C has ended.
        std::process::exit(130);
    }
}

/// Whether the program has been asked to end.
pub(super) fn asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}
