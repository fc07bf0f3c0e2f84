//! Prompts at a terminal. An option may have answered a question already.

use super::output::{harmless, print_remark, wrong_usage};
use super::rig_wizard::{Checked, Range};
use crate::data::rig_file::PulseTypeName;
use anyhow::{Context, Result, bail};
use dialoguer::theme::{ColorfulTheme, SimpleTheme, Theme};
use dialoguer::{Confirm, Input, Select};
use std::fmt::Display;
use std::io::IsTerminal;
use std::str::FromStr;

/// Who answers the questions that no option has answered.
pub(super) enum Asker {
    /// The user, at a terminal.
    User(Box<dyn Theme>),
    /// Nobody: the defaults are taken.
    Nobody,
}

/// An answer of a type: the error for text that is not of it.
pub(super) trait TypedAnswer: Clone + FromStr + Display {
    const FORM: &'static str;
}

impl TypedAnswer for String {
    const FORM: &'static str = "a name is needed";
}

impl TypedAnswer for u16 {
    const FORM: &'static str = "whole microseconds are needed, such as 1500";
}

impl TypedAnswer for f64 {
    const FORM: &'static str = "a number is needed, such as 10 or -9.5";
}

impl TypedAnswer for PulseTypeName {
    const FORM: &'static str = Self::CHOICES;
}

impl TypedAnswer for Range {
    const FORM: &'static str = super::rig_wizard::RANGE_FORM;
}

/// Whether there is a terminal to ask questions at. Questions go to standard error.
pub(super) fn is_terminal() -> bool {
    std::io::stdin().is_terminal() && std::io::stderr().is_terminal()
}

impl Asker {
    /// The user, or nobody where defaults are wanted; `instead` is the advice where there is no terminal.
    pub(super) fn new(defaults: bool, instead: &str) -> Result<Self> {
        if defaults {
            return Ok(Self::Nobody);
        }
        if !is_terminal() {
            bail!("no questions can be asked, because there is no terminal: {instead}");
        }
        Ok(Self::User(theme()))
    }

    /// Puts an answer into `to`: that of the option if it is given, else that of the user, who is asked again after
    /// a wrong one. Enter keeps the value of `to`.
    pub(super) fn ask<T: TypedAnswer>(
        &self,
        given: Option<T>,
        (option, words): (&str, &str),
        to: &mut T,
        check: impl Fn(&T) -> Checked,
    ) -> Result<()> {
        if let Some(value) = given {
            if let Err(sentence) = check(&value) {
                wrong_usage(format_args!("{option}: {sentence}"));
            }
            *to = value;
            return Ok(());
        }
        let Self::User(theme) = self else {
            return Ok(());
        };
        let read = |text: &str| -> Result<T, String> {
            let value = text.trim().parse().map_err(|_| T::FORM.to_owned())?;
            check(&value).map(|()| value)
        };
        let text: String = Input::with_theme(theme.as_ref())
            .with_prompt(harmless(words))
            .default(to.to_string())
            .allow_empty(true)
            .validate_with(|text: &String| read(text).map(drop))
            .interact_text()
            .context(NO_ANSWER)?;
        *to = read(&text).map_err(anyhow::Error::msg)?;
        Ok(())
    }

    /// One of several; Enter takes the `usual` one, and so does nobody.
    pub(super) fn choose(&self, words: &str, items: &[String], usual: usize) -> Result<usize> {
        let Self::User(theme) = self else {
            return Ok(usual);
        };
        Select::with_theme(theme.as_ref())
            .with_prompt(harmless(words))
            .items(items)
            .default(usual)
            .interact()
            .inspect_err(|_| show_cursor())
            .context(NO_ANSWER)
    }
}

/// Said where a question is left open.
pub(super) const NO_ANSWER: &str = "the question was not answered, and nothing was written";

/// Shows the cursor, which a menu hides and does not show again when it is broken off.
pub(super) fn show_cursor() {
    // An error means that the terminal itself is gone.
    let _shown = dialoguer::console::Term::stderr().show_cursor();
}

/// Yes or no, at a terminal; Enter alone is no. The answer ends with Enter: one that acted on its letter would leave the
/// Enter to the next question.
pub(super) fn confirm(words: &str) -> Result<bool> {
    Confirm::with_theme(theme().as_ref())
        .with_prompt(harmless(words))
        .default(false)
        .wait_for_newline(true)
        .interact()
        .context(NO_ANSWER)
}

/// A typed line, parsed by `read`. After an error its sentence is shown and the question asked again. `None` at
/// the end of the input.
///
/// The terminal itself edits the line. So its mode is unchanged if the program is ended during the question.
pub(super) fn line<T>(words: &str, read: impl Fn(&str) -> Result<T, String>) -> Option<T> {
    loop {
        print_remark(words);
        let mut text = String::new();
        if std::io::stdin().read_line(&mut text).ok()? == 0 {
            return None;
        }
        match read(text.trim()) {
            Ok(value) => return Some(value),
            Err(sentence) => print_remark(sentence),
        }
    }
}

/// Colours, if the terminal has them and the user wants them.
fn theme() -> Box<dyn Theme> {
    match dialoguer::console::colors_enabled_stderr() {
        true => Box::new(ColorfulTheme::default()),
        false => Box::new(SimpleTheme),
    }
}
