//! The scope's own thread.

use super::draw::draw;
use super::state::{ScopeEvent, ScopeState};
use super::terminal::Screen;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// A picture every so often at most, and a key is answered as fast: below what the eye takes for a
/// stutter, and a few percent of a processor.
const PICTURE_EVERY: Duration = Duration::from_millis(50);

/// The scope on the terminal. Dropping it gives the terminal back.
pub struct Scope {
    events: Option<Sender<ScopeEvent>>,
    thread: Option<JoinHandle<()>>,
}

impl Scope {
    /// Takes the terminal over. `on_stop` is called for each key that asks for the end.
    ///
    /// # Errors
    /// What the system said; the terminal is as it was then.
    pub fn open(state: ScopeState, on_stop: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let screen = Screen::take()?;
        let (events, queue) = channel();
        let thread = std::thread::spawn(move || show(screen, &queue, state, &on_stop));
        Ok(Self {
            events: Some(events),
            thread: Some(thread),
        })
    }

    /// Tells the scope what has happened; never waits.
    pub fn tell(&self, event: ScopeEvent) {
        if let Some(events) = &self.events {
            // A scope that has failed leaves a capture without a picture, which is no reason to end it.
            let _nobody_looks = events.send(event);
        }
    }
}

impl Drop for Scope {
    fn drop(&mut self) {
        // The thread ends when nobody can tell it anything any more.
        self.events = None;
        if let Some(thread) = self.thread.take() {
            // It has said on its own screen what was wrong, if anything was.
            let _panicked = thread.join();
        }
    }
}

fn show(
    mut screen: Screen,
    queue: &Receiver<ScopeEvent>,
    mut state: ScopeState,
    on_stop: &dyn Fn(),
) {
    loop {
        loop {
            match queue.try_recv() {
                Ok(event) => state.apply(event),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return,
            }
        }
        let drawn = screen.draw(|frame| draw(frame, &state));
        let stop = drawn.and_then(|()| wait_for_keys());
        match stop {
            Ok(Some(wish)) if wish == Stop::Now || !state.stopping => {
                state.stopping = true;
                on_stop();
            }
            Ok(_) => {}
            // The terminal is gone; the capture is not.
            Err(_) => return,
        }
    }
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
