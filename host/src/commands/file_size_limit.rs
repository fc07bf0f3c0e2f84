//! The largest file that the system allows this program (`ulimit -f`).

use anyhow::Result;

/// From now on a write beyond the largest file that is allowed is an error, which is said and leaves nothing
/// half-written. Without this the system ends the program by a signal.
///
/// # Errors
/// The signal cannot be caught.
#[cfg(unix)]
pub(super) fn beyond_it_is_an_error() -> Result<()> {
    use anyhow::Context;
    use signal_hook::consts::SIGXFSZ;
    let nobody_asks = std::sync::Arc::default();
    let caught = signal_hook::flag::register(SIGXFSZ, nobody_asks);
    caught.map(|_| ()).context("SIGXFSZ cannot be caught")
}

/// Other systems have no such signal.
///
/// # Errors
/// None.
#[cfg(not(unix))]
pub(super) fn beyond_it_is_an_error() -> Result<()> {
    Ok(())
}
