//! Prompts at a terminal. An option may have answered a question already.

use super::output_args::print_remark;
use super::usage::wrong_usage;
use crate::commands::rig_wizard::Checked;
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

/// A question about one value.
pub(super) struct Prompt<'a, T> {
    /// The option that answers it, such as `--neutral`.
    pub option: &'static str,
    /// The question, with its unit.
    pub text: &'a str,
    /// The answer that Enter takes.
    pub default: T,
    /// The error for an answer that is not of the right type.
    pub form: &'static str,
    /// Whether an answer is acceptable.
    pub check: &'a dyn Fn(&T) -> Checked,
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

    /// The answer: of the option if it is given, else of the user, who is asked again after a wrong one.
    pub(super) fn ask<T>(&self, given: Option<T>, question: &Prompt<'_, T>) -> Result<T>
    where
        T: Clone + FromStr + Display,
    {
        let Prompt {
            option,
            text: prompt,
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
            .with_prompt(*prompt)
            .default(default.to_string())
            .allow_empty(true)
            .validate_with(|text: &String| read(text).map(drop))
            .interact_text()
            .context(NO_ANSWER)?;
        read(&text).map_err(anyhow::Error::msg)
    }

    /// One of several; Enter takes the `usual` one, and so does nobody.
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

const NO_ANSWER: &str = "the question was not answered";

/// Yes or no, at a terminal; Enter takes `usual`.
pub(super) fn confirm(words: &str, usual: bool) -> Result<bool> {
    Confirm::with_theme(theme().as_ref())
        .with_prompt(words)
        .default(usual)
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
    if dialoguer::console::colors_enabled_stderr() {
        Box::new(ColorfulTheme::default())
    } else {
        Box::new(SimpleTheme)
    }
}
