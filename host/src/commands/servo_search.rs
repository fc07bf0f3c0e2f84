//! Progress of the search for a servo model, and its end by Ctrl-C.

use super::ctrl_c;
use super::output::Talk;
use crate::analysis::ServoModelSearch;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use servoid_identification::servo_model::Watch;
use std::time::Duration;

/// Time between two turns of the sign that the search goes on.
const TURN: Duration = Duration::from_millis(120);

/// The option that leaves the search out.
#[derive(Args, Clone, Copy, Debug)]
pub(super) struct NoServoModel {
    /// Do not look for the servo as a machine, which takes minutes of a long recording
    #[arg(long, conflicts_with = "servo_model")]
    no_servo_model: bool,
}

impl NoServoModel {
    /// When the servo is looked for as a machine, where that may be `asked` for, too.
    pub(super) fn or(self, asked: bool) -> ServoModelSearch {
        ServoModelSearch::asked(match self.no_servo_model {
            true => Some(false),
            false => asked.then_some(true),
        })
    }
}

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
