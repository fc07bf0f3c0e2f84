//! The thread that draws the scope.
//!
//! A terminal may block for any time, as on a hung connection, and the capture must not wait for it. So events
//! go into one shared state, and the thread draws a copy of it whenever the terminal is ready. A thread that is
//! still blocked when the run is over is abandoned.

use super::drawing::draw;
use super::state::{ScopeEvent, ScopeState};
use super::terminal::{self, Screen};
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Time between two pictures, and the longest time until a key is answered. The eye sees no stutter, and it
/// costs a few percent of a processor.
const PICTURE_EVERY: Duration = Duration::from_millis(50);

/// Longest wait for the last picture. A ready terminal takes one period; ten allow for a slow one.
const LAST_PICTURE: Duration = PICTURE_EVERY.saturating_mul(10);

/// The scope on the terminal. Dropping it gives the terminal back.
pub(crate) struct Scope {
    shared: Arc<Shared>,
    /// Carries no message; it is disconnected when the thread ends.
    thread: Receiver<()>,
}

/// The state between capture and thread, and whether the run is over.
struct Shared(Mutex<(ScopeState, bool)>);

impl Shared {
    fn lock(&self) -> MutexGuard<'_, (ScopeState, bool)> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Scope {
    /// Takes the terminal over. Each key that stops the run calls `on_stop`. After an error the terminal is as it
    /// was.
    pub(crate) fn open(
        state: ScopeState,
        on_stop: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let screen = Screen::take()?;
        let shared = Arc::new(Shared(Mutex::new((state, false))));
        let theirs = Arc::clone(&shared);
        let (ends, thread) = channel();
        std::thread::spawn(move || show(screen, &theirs, &on_stop, ends));
        Ok(Self { shared, thread })
    }

    /// Adds an event; never waits for the terminal.
    pub(crate) fn update(&self, event: ScopeEvent) {
        self.shared.lock().0.apply(event);
    }
}

impl Drop for Scope {
    fn drop(&mut self) {
        self.shared.lock().1 = true;
        let _ended_or_stuck = self.thread.recv_timeout(LAST_PICTURE);
        // A blocked thread has not given it back.
        terminal::give_back();
    }
}

fn show(mut screen: Screen, shared: &Shared, on_stop: &dyn Fn(), ends: Sender<()>) {
    loop {
        // A copy, because drawing may block.
        let (state, over) = shared.lock().clone();
        if over {
            break;
        }
        let drawn = screen.draw(|frame| draw(frame, &state));
        let stop = drawn.and_then(|()| wait_for_keys());
        match stop {
            Ok(Some(stop)) if stop == Stop::Now || !state.stopping => {
                shared.lock().0.stopping = true;
                on_stop();
            }
            Ok(_) => {}
            // The terminal is gone; the capture goes on.
            Err(_) => break,
        }
    }
    drop(screen);
    drop(ends);
}

/// How a key stops the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Stop {
    /// At neutral. Repeats are ignored: a key that is held down comes many times.
    Safely,
    /// As Ctrl-C outside the scope: the second one ends the program at once.
    Now,
}

/// Waits until the next picture is due, or for keys; returns the strongest stop that they ask for.
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
        // Ctrl-Q is the terminal's own key, which lets its output go on after Ctrl-S.
        KeyCode::Char('q' | 'Q') if key.modifiers.contains(KeyModifiers::CONTROL) => None,
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
        let control_q = key(KeyCode::Char('q'), KeyModifiers::CONTROL);
        assert_eq!(control_q, None, "it lets a terminal go on");
        assert_eq!(key(KeyCode::Enter, none), None);
    }
}
