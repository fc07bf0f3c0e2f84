//! The scope's own thread.
//!
//! A terminal may stop taking what is drawn for as long as it likes: a hung connection, a window that
//! is held. Nothing of the capture waits for it. What has happened goes into one state, of which the
//! thread draws a copy whenever the terminal is ready for it, and a thread that is still drawing when
//! the run is over is left to itself.

use super::draw::draw;
use super::state::{ScopeEvent, ScopeState};
use super::terminal::{self, Screen};
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// A picture every so often at most, and a key is answered as fast: below what the eye takes for a
/// stutter, and a few percent of a processor.
const PICTURE_EVERY: Duration = Duration::from_millis(50);

/// The thread ends within a picture where the terminal takes it: ten times that, for a slow one.
const LAST_PICTURE: Duration = PICTURE_EVERY.saturating_mul(10);

/// The scope on the terminal. Dropping it gives the terminal back.
pub struct Scope {
    shared: Arc<Shared>,
    /// Nothing ever comes; the other end goes when the thread ends.
    thread: Receiver<()>,
}

/// What the capture says and the thread looks at.
struct Shared(Mutex<(ScopeState, Over)>);

/// Whether there is nothing more to show.
type Over = bool;

impl Shared {
    fn lock(&self) -> MutexGuard<'_, (ScopeState, Over)> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Scope {
    /// Takes the terminal over. `on_stop` is called for each key that asks for the end.
    ///
    /// # Errors
    /// What the system said; the terminal is as it was then.
    pub fn open(state: ScopeState, on_stop: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let screen = Screen::take()?;
        let shared = Arc::new(Shared(Mutex::new((state, false))));
        let theirs = Arc::clone(&shared);
        let (ends, thread) = channel();
        std::thread::spawn(move || show(screen, &theirs, &on_stop, ends));
        Ok(Self { shared, thread })
    }

    /// Tells the scope what has happened; never waits for the terminal.
    pub fn tell(&self, event: ScopeEvent) {
        self.shared.lock().0.apply(event);
    }
}

impl Drop for Scope {
    fn drop(&mut self) {
        self.shared.lock().1 = true;
        // It has said on its own screen what was wrong, if anything was.
        let _ended_or_stuck = self.thread.recv_timeout(LAST_PICTURE);
        // A thread that is stuck in a picture has not done it.
        terminal::give_back();
    }
}

fn show(mut screen: Screen, shared: &Shared, on_stop: &dyn Fn(), ends: Sender<()>) {
    loop {
        // A copy: drawing may take for ever.
        let (state, over) = shared.lock().clone();
        if over {
            break;
        }
        let drawn = screen.draw(|frame| draw(frame, &state));
        let stop = drawn.and_then(|()| wait_for_keys());
        match stop {
            Ok(Some(wish)) if wish == Stop::Now || !state.stopping => {
                shared.lock().0.stopping = true;
                on_stop();
            }
            Ok(_) => {}
            // The terminal is gone; the capture is not.
            Err(_) => break,
        }
    }
    drop(screen);
    drop(ends);
}

/// What a key asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Stop {
    /// The end of the run. Again it means nothing more: a key that is held down comes many times.
    Safely,
    /// The same, as the signal that Ctrl-C is elsewhere: the second one ends the program at once.
    Now,
}

/// Waits until the next picture is due; says what the keys meanwhile asked for.
fn wait_for_keys() -> std::io::Result<Option<Stop>> {
    let mut stop = None;
    if event::poll(PICTURE_EVERY)? {
        while event::poll(Duration::ZERO)? {
            if let Event::Key(key) = event::read()? {
                stop = stop.max(asks_to_stop(&key));
            }
        }
    }
    Ok(stop)
}

fn asks_to_stop(key: &KeyEvent) -> Option<Stop> {
    if key.kind == KeyEventKind::Release {
        return None;
    }
    match key.code {
        KeyCode::Char('q' | 'Q') | KeyCode::Esc => Some(Stop::Safely),
        KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => Some(Stop::Now),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn q_escape_and_control_c_stop_and_nothing_else_does() {
        let key = |code, modifiers| asks_to_stop(&KeyEvent::new(code, modifiers));
        let none = KeyModifiers::NONE;
        assert_eq!(key(KeyCode::Char('q'), none), Some(Stop::Safely));
        assert_eq!(key(KeyCode::Esc, none), Some(Stop::Safely));
        let control_c = key(KeyCode::Char('c'), KeyModifiers::CONTROL);
        assert_eq!(control_c, Some(Stop::Now));
        assert_eq!(key(KeyCode::Char('c'), none), None);
        assert_eq!(key(KeyCode::Enter, none), None);
    }
}
