//! Questions at a terminal, of which each may have been answered by an option.

use super::wrong_usage;
use crate::commands::output_files;
use crate::commands::rig_wizard::Checked;
use anyhow::{Context, Result, bail};
use dialoguer::theme::{ColorfulTheme, SimpleTheme, Theme};
use dialoguer::{Confirm, Input, Select};
use std::fmt::Display;
use std::io::IsTerminal;
use std::str::FromStr;

/// Who answers what no option has answered.
pub(super) enum Asker {
    /// The user, at a terminal.
    User(Box<dyn Theme>),
    /// Nobody: defaults stand.
    Nobody,
}

/// A question about one value.
pub(super) struct Question<'a, T> {
    /// The option that answers it, such as `--neutral`.
    pub option: &'static str,
    /// The question, with its unit.
    pub words: &'a str,
    /// What an empty answer means.
    pub default: T,
    /// What an answer has to look like, where its type alone says so, and not enough.
    pub form: &'static str,
    /// Whether an answer can be.
    pub check: &'a dyn Fn(&T) -> Checked,
}

/// Whether somebody sits at a terminal who can be asked: questions go to standard error.
pub(super) fn is_terminal() -> bool {
    std::io::stdin().is_terminal() && std::io::stderr().is_terminal()
}

impl Asker {
    /// The user, or nobody where defaults are wanted; `instead` is what to do without a terminal.
    pub(super) fn new(defaults: bool, instead: &str) -> Result<Self> {
        if defaults {
            return Ok(Self::Nobody);
        }
        if !is_terminal() {
            bail!("there is no terminal to ask questions at: {instead}");
        }
        Ok(Self::User(theme()))
    }

    /// The answer, by an option if there is one; a wrong one at the terminal is asked for again.
    pub(super) fn ask<T>(&self, given: Option<T>, question: &Question<'_, T>) -> Result<T>
    where
        T: Clone + FromStr + Display,
    {
        let Question {
            option,
            words,
            default,
            form,
            check,
        } = question;
        if let Some(value) = given {
            if let Err(sentence) = check(&value) {
                wrong_usage(format_args!("{option}: {sentence}"));
            }
            return Ok(value);
        }
        let Self::User(theme) = self else {
            return Ok(default.clone());
        };
        let read = |text: &str| -> Result<T, String> {
            let value = text.trim().parse().map_err(|_| (*form).to_owned())?;
            check(&value).map(|()| value)
        };
        let text: String = Input::with_theme(theme.as_ref())
            .with_prompt(*words)
            .default(default.to_string())
            .allow_empty(true)
            .validate_with(|text: &String| read(text).map(drop))
            .interact_text()
            .context(NO_ANSWER)?;
        read(&text).map_err(anyhow::Error::msg)
    }

    /// One of several; the `usual` one is what Enter takes, and what stands where nobody is asked.
    pub(super) fn choose(&self, words: &str, items: &[String], usual: usize) -> Result<usize> {
        let Self::User(theme) = self else {
            return Ok(usual);
        };
        Select::with_theme(theme.as_ref())
            .with_prompt(words)
            .items(items)
            .default(usual)
            .interact()
            .context(NO_ANSWER)
    }
}

/// Why there is no answer, if not for a wrong one.
const NO_ANSWER: &str = "the question was not answered";

/// Yes or no, at a terminal; `usual` is what Enter says.
pub(super) fn confirm(words: &str, usual: bool) -> Result<bool> {
    Confirm::with_theme(theme().as_ref())
        .with_prompt(words)
        .default(usual)
        .interact()
        .context(NO_ANSWER)
}

/// What `read` makes of a line that is typed; one of which it makes nothing is asked for again, with the
/// sentence that it has. `None` when nothing more can be typed.
///
/// The terminal itself edits the line, so that a program that is told to end while somebody thinks leaves
/// no terminal in another mode behind.
pub(super) fn line<T>(words: &str, read: impl Fn(&str) -> Result<T, String>) -> Option<T> {
    loop {
        output_files::tell(words);
        let mut text = String::new();
        if std::io::stdin().read_line(&mut text).ok()? == 0 {
            return None;
        }
        match read(text.trim()) {
            Ok(value) => return Some(value),
            Err(sentence) => output_files::tell(sentence),
        }
    }
}

/// Colours where the terminal has them and the user wants them.
fn theme() -> Box<dyn Theme> {
    if dialoguer::console::colors_enabled_stderr() {
        Box::new(ColorfulTheme::default())
    } else {
        Box::new(SimpleTheme)
    }
}
