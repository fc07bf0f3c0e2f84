//! Progress of the search for a servo model, and its end by Ctrl-C.

use super::ctrl_c;
use super::output::Talk;
use indicatif::{ProgressBar, ProgressStyle};
use servoid_identification::servo_model::Watch;
use std::time::Duration;

/// Time between two turns of the sign that the search goes on.
const TURN: Duration = Duration::from_millis(120);

/// A search that a person watches. Ctrl-C ends it, and what was found before it is still shown.
pub(super) struct ServoSearch {
    line: ProgressBar,
}

impl ServoSearch {
    /// Begins to show the search for `what`.
    pub(super) fn begin(what: &str, talk: Talk) -> Self {
        // Without the handler Ctrl-C ends the program, as before.
        let ends = match ctrl_c::listen() {
            Ok(()) => " (Ctrl-C goes on without it)",
            Err(_) => "",
        };
        talk.say(format_args!(
            "looking for {what}, which takes seconds, and minutes of a long recording{ends}"
        ));
        let line = match talk.quiet {
            true => ProgressBar::hidden(),
            false => ProgressBar::new_spinner(),
        };
        // Should the library ever refuse the template, its own style would do.
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed}  {wide_msg}") {
            line.set_style(style);
        }
        line.enable_steady_tick(TURN);
        Self { line }
    }
}

impl Watch for ServoSearch {
    fn tried(&self, sets_of_terms: usize, best_held_out_percent: f64) {
        self.line.set_message(format!(
            "{sets_of_terms} sets of terms tried; the best predicts parts that it has not seen to {best_held_out_percent:.1} %"
        ));
    }

    fn ends(&self) -> bool {
        ctrl_c::asked()
    }
}

impl Drop for ServoSearch {
    fn drop(&mut self) {
        self.line.finish_and_clear();
    }
}
