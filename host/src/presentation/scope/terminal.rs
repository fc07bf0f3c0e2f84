//! Taking the terminal over, and giving it back whatever happens.

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

/// What a terminal needs to take a few bytes, a slow connection between included.
const PATIENCE: Duration = Duration::from_millis(500);

/// Whether the terminal is ours. It is for the whole process: there is one terminal, and a panic or a
/// signal on any thread has to give it back.
static TAKEN: AtomicBool = AtomicBool::new(false);

/// Whether there is a terminal on which pictures can be drawn and keys read.
#[must_use]
pub fn is_there() -> bool {
    let dumb = std::env::var_os("TERM").is_none_or(|term| term == "dumb");
    let all = stdin().is_terminal() && stdout().is_terminal() && stderr().is_terminal();
    all && !dumb
}

/// The terminal, while it is ours; dropping it gives it back.
pub struct Screen {
    terminal: Terminal<CrosstermBackend<Stdout>>,
}

impl Screen {
    /// Takes the terminal over: raw mode, and the alternate screen, so that what was there before is
    /// there again afterwards.
    ///
    /// # Errors
    /// What the system said; the terminal is as it was then.
    pub fn take() -> std::io::Result<Self> {
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
    ///
    /// # Errors
    /// What the system said.
    pub fn draw(&mut self, picture: impl FnOnce(&mut ratatui::Frame<'_>)) -> std::io::Result<()> {
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

/// Gives the terminal back if it is ours; may be called from anywhere, and often. A terminal that
/// takes nothing is not waited for.
pub fn give_back() {
    if TAKEN.swap(false, Ordering::SeqCst) {
        let (ends, ended) = channel::<()>();
        std::thread::spawn(move || {
            // Where the terminal itself is gone there is nothing to give back.
            let _cooked = disable_raw_mode();
            let _shown = execute!(stdout(), LeaveAlternateScreen, Show);
            drop(ends);
        });
        // If it is still at it, the terminal gets it when it takes something again.
        let _done_or_stuck = ended.recv_timeout(PATIENCE);
    }
}

/// A panic's message is to be read on the screen that stays.
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
