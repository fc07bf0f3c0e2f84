//! Long computations: without the interpreter's lock, and ended by Ctrl-C.

use crate::error::{defect, raised};
use pyo3::prelude::*;
use servoid::instrument::rig::StopReason;
use servoid_identification::servo_model::Watch;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::Builder;
use std::time::Duration;

/// Time between two looks whether Ctrl-C was pressed.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// Whether nobody waits for a computation any more.
#[derive(Clone, Default)]
pub(crate) struct Interrupted(Arc<AtomicBool>);

impl Interrupted {
    /// For who waits, and for who computes.
    fn twice() -> (Self, Self) {
        let interrupted = Self::default();
        (interrupted.clone(), interrupted)
    }

    /// The reason to end a recording, once there is one.
    pub(crate) fn stop(&self) -> Option<StopReason> {
        self.ends().then_some(StopReason::User)
    }
}

impl Watch for Interrupted {
    fn tried(&self, _: usize, _: f64) {}

    fn ends(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Does `work` on a thread of its own and waits for it. Ctrl-C ends the waiting at once. The search for a servo model and a
/// recording end with it; a linear identification, which cannot be stopped, comes to its end unheard.
///
/// # Errors
/// Those of `work`; what a signal raises; a defect where `work` panics.
pub(crate) fn compute<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(Interrupted) -> anyhow::Result<T> + Send + 'static,
) -> PyResult<T> {
    let (interrupted, watched) = Interrupted::twice();
    let (done, result) = mpsc::channel();
    named()
        .spawn(move || announce(&done, || work(watched)))
        .map_err(raised)?;
    wait(py, result, &interrupted)
}

/// [`compute`] of what is borrowed, so that Ctrl-C waits for the end of a linear identification.
///
/// # Errors
/// Those of [`compute`].
pub(crate) fn compute_borrowed<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(Interrupted) -> anyhow::Result<T> + Send,
) -> PyResult<T> {
    let (interrupted, watched) = Interrupted::twice();
    let (done, result) = mpsc::channel();
    std::thread::scope(|scope| {
        named()
            .spawn_scoped(scope, move || announce(&done, || work(watched)))
            .map_err(raised)?;
        wait(py, result, &interrupted)
    })
}

fn named() -> Builder {
    Builder::new().name("servoid".to_owned())
}

/// What comes of a computation that did not panic, or what it panicked with.
type Outcome<T> = std::thread::Result<anyhow::Result<T>>;

fn announce<T>(done: &Sender<Outcome<T>>, work: impl FnOnce() -> anyhow::Result<T>) {
    let found = catch_unwind(AssertUnwindSafe(work));
    // Nobody waits for it after Ctrl-C.
    let _nobody_waits = done.send(found);
}

fn wait<T: Send>(
    py: Python<'_>,
    mut result: Receiver<Outcome<T>>,
    interrupted: &Interrupted,
) -> PyResult<T> {
    loop {
        let (receiver, received) = py.detach(move || {
            let received = result.recv_timeout(LOOK_EVERY);
            (result, received)
        });
        result = receiver;
        match received {
            Ok(Ok(found)) => return found.map_err(raised),
            Ok(Err(_)) | Err(RecvTimeoutError::Disconnected) => return Err(defect()),
            Err(RecvTimeoutError::Timeout) => py.check_signals().inspect_err(|_| {
                interrupted.0.store(true, Ordering::Relaxed);
            })?,
        }
    }
}
