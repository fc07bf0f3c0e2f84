//! Ctrl-C, and the signals that a system sends to end a program.

use super::output::print_remark;
use super::partial_recording::PartialRecording;
use super::prompts;
use crate::presentation::scope::terminal;
use anyhow::{Context, Result};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

static ASKED: AtomicBool = AtomicBool::new(false);
static LISTENS: AtomicBool = AtomicBool::new(false);
static IN_TIME: AtomicBool = AtomicBool::new(false);
static LEAVES_PARTIAL: AtomicBool = AtomicBool::new(false);

/// Time for a run to stop and its file to be closed, from the signal on. Whatever blocks then, such as a terminal
/// or a file system, is left to itself.
const GRACE: Duration = Duration::from_secs(1);

/// 128 + SIGINT, as shells report a program that Ctrl-C has ended.
const INTERRUPTED: i32 = 130;

/// From now on [`asked`] reports the first Ctrl-C, SIGTERM or SIGHUP, and the second one ends the program at once.
pub(super) fn listen() -> Result<()> {
    // A process may run several commands, and has one handler.
    if LISTENS.swap(true, Ordering::SeqCst) {
        return Ok(());
    }
    ctrlc::set_handler(ask).context("Ctrl-C cannot be caught")
}

/// From now on [`asked`] reports the first Ctrl-C, SIGTERM or SIGHUP, and the program ends within a second of it.
/// Further signals change nothing, so that two at once cannot leave a recording without its last line.
pub(super) fn listen_in_a_run() -> Result<()> {
    IN_TIME.store(true, Ordering::SeqCst);
    listen()
}

/// From now on Ctrl-C ends a command that asks questions and has written nothing, with its cursor shown again: a menu hides it.
pub(super) fn listen_at_questions() -> Result<()> {
    if LISTENS.swap(true, Ordering::SeqCst) {
        return Ok(());
    }
    ctrlc::set_handler(|| {
        prompts::show_cursor();
        print_remark(prompts::NO_ANSWER);
        std::process::exit(INTERRUPTED);
    })
    .context("Ctrl-C cannot be caught")
}

/// The effect of such a signal, or of a key that stands for one.
pub(super) fn ask() {
    let again = ASKED.swap(true, Ordering::SeqCst);
    if !IN_TIME.load(Ordering::SeqCst) {
        if again {
            end();
        }
    } else if !again {
        std::thread::spawn(|| {
            std::thread::sleep(GRACE);
            end();
        });
    }
}

/// Whether a program that has to end now leaves a recording that is not whole.
pub(super) fn leaves_partial(is_so: bool) {
    LEAVES_PARTIAL.store(is_so, Ordering::SeqCst);
}

fn end() -> ! {
    terminal::give_back();
    std::process::exit(match LEAVES_PARTIAL.load(Ordering::SeqCst) {
        true => PartialRecording::EXIT_CODE.into(),
        false => INTERRUPTED,
    });
}

/// Whether the program has been asked to end.
pub(super) fn asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}
