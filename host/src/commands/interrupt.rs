//! Ctrl-C.

use anyhow::{Context, Result};
use std::sync::atomic::{AtomicBool, Ordering};

static ASKED: AtomicBool = AtomicBool::new(false);

/// From now on the first Ctrl-C is a request that [`asked`] reports, and the second one ends the
/// program at once.
pub(super) fn listen() -> Result<()> {
    ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::SeqCst) {
            // 128 + SIGINT: what shells report of a program that Ctrl-C has ended.
            std::process::exit(130);
        }
    })
    .context("Ctrl-C cannot be watched for")
}

/// Whether Ctrl-C has been pressed.
pub(super) fn asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}
