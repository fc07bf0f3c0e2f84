//! The terminal, taken over and given back in every case.

use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;
use ratatui::crossterm::cursor::Show;
use ratatui::crossterm::execute;
use ratatui::crossterm::terminal::{
    EnterAlternateScreen, LeaveAlternateScreen, disable_raw_mode, enable_raw_mode,
};
use std::io::{IsTerminal, Stdout, stderr, stdin, stdout};
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::time::Duration;

/// Time for a terminal to take a few bytes, on a slow connection too.
const PATIENCE: Duration = Duration::from_millis(500);

/// Whether the terminal is taken over. A process has one terminal, and a panic or a signal on any thread has to
/// give it back.
static TAKEN: AtomicBool = AtomicBool::new(false);

/// Whether there is a terminal for pictures and keys.
pub(crate) fn is_there() -> bool {
    let dumb = std::env::var_os("TERM").is_none_or(|term| term == "dumb");
    let all = stdin().is_terminal() && stdout().is_terminal() && stderr().is_terminal();
    all && !dumb
}

/// The terminal while it is taken over; dropping it gives it back.
pub(super) struct Screen {
    terminal: Terminal<CrosstermBackend<Stdout>>,
}

impl Screen {
    /// Takes the terminal over: raw mode, and the alternate screen, which leaves the old content untouched.
    /// After an error the terminal is as it was.
    pub(super) fn take() -> std::io::Result<Self> {
        give_back_on_panic();
        TAKEN.store(true, Ordering::SeqCst);
        let taken = enable_raw_mode()
            .and_then(|()| execute!(stdout(), EnterAlternateScreen))
            .and_then(|()| Terminal::new(CrosstermBackend::new(stdout())));
        match taken {
            Ok(terminal) => Ok(Self { terminal }),
            Err(error) => {
                give_back();
                Err(error)
            }
        }
    }

    /// Draws, unless the terminal has been given back meanwhile.
    pub(super) fn draw(
        &mut self,
        picture: impl FnOnce(&mut ratatui::Frame<'_>),
    ) -> std::io::Result<()> {
        if TAKEN.load(Ordering::SeqCst) {
            self.terminal.draw(picture)?;
        }
        Ok(())
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        give_back();
    }
}

/// Gives the terminal back if it is taken over; may be called from anywhere, and often. Does not wait for a
/// blocked terminal.
pub(crate) fn give_back() {
    if TAKEN.swap(false, Ordering::SeqCst) {
        let (ends, ended) = channel::<()>();
        std::thread::spawn(move || {
            // Errors mean that the terminal itself is gone.
            let _cooked = disable_raw_mode();
            let _shown = execute!(stdout(), LeaveAlternateScreen, Show);
            drop(ends);
        });
        // A blocked terminal gets it as soon as it takes bytes again.
        let _done_or_stuck = ended.recv_timeout(PATIENCE);
    }
}

/// Gives the terminal back before a panic prints its message: the message has to be on the screen that stays.
fn give_back_on_panic() {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            give_back();
            before(panic);
        }));
    });
}
