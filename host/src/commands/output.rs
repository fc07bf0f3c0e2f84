//! Output of commands: results on standard output, remarks on standard error, and files, which never replace others
//! without `--force`.

use crate::analysis::to_json;
use crate::data::dataset::suggested_columns::quoted;
use crate::data::recording::{WriteError, write_file};
use crate::presentation::plots::{Figure, draw};
use anyhow::{Context, Result};
use clap::Args;
use clap::error::ErrorKind;
use serde::Serialize;
use std::borrow::Cow;
use std::fmt::Display;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Letters of a remark, at most: a file may have cells of megabytes, and a remark may quote them.
const LONGEST_REMARK: usize = 10_000;

/// Prints a line on standard error. A closed pipe or a terminal that is gone must not end a run on a servo, so
/// an error is ignored.
pub fn print_remark(line: impl Display) {
    let line = line.to_string();
    let line = harmless(&line);
    let _nobody_listens = match line.char_indices().nth(LONGEST_REMARK) {
        None => writeln!(std::io::stderr(), "{line}"),
        Some((end, _)) => {
            let begin = line.get(..end).unwrap_or_default();
            writeln!(std::io::stderr(), "{begin} ... (and so on)")
        }
    };
}

/// Prints a result on standard output. On a terminal that has colours, and whose user has not declined them (`NO_COLOR`), findings
/// stand out.
///
/// # Errors
/// Those of standard output.
pub fn print_result(result: &str) -> std::io::Result<()> {
    let text = harmless(result);
    let text = match dialoguer::console::colors_enabled() {
        true => Cow::Owned(with_findings_in_colour(&text)),
        false => text,
    };
    std::io::stdout().write_all(text.as_bytes())
}

/// The text, with the lines in colour that begin findings.
fn with_findings_in_colour(text: &str) -> String {
    let line = |line: &str| match line.starts_with(FINDING) {
        true => format!("{FINDING_COLOUR}{}{PLAIN}\n", line.trim_end_matches('\n')),
        false => line.to_owned(),
    };
    text.split_inclusive('\n').map(line).collect()
}

/// What findings begin with.
const FINDING: &str = "  ! ";

/// Bold yellow, and back (ECMA-48, section 8.3.117).
const FINDING_COLOUR: &str = "\x1b[1;33m";
const PLAIN: &str = "\x1b[0m";

/// A text that a terminal only shows. Names of files and what files say may hold commands for it, or turn the
/// direction of the text around; these are written as JSON writes them.
pub(super) fn harmless(text: &str) -> Cow<'_, str> {
    let acts = |letter: char| {
        (letter.is_control() && !matches!(letter, '\n' | '\t'))
            || matches!(letter, '\u{200e}' | '\u{200f}' | '\u{61c}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    if !text.contains(acts) {
        return Cow::Borrowed(text);
    }
    let shown = |letter: char| match acts(letter) {
        true => format!("\\u{:04x}", u32::from(letter)),
        false => letter.to_string(),
    };
    Cow::Owned(text.chars().map(shown).collect())
}

/// Prints an error as clap prints its own, and ends the program with exit code 2. The sentence ends with what to do, so no usage of
/// all commands follows it.
pub(super) fn wrong_usage(error: impl Display) -> ! {
    let sentence = format!("{error}\n");
    clap::Error::raw(ErrorKind::ValueValidation, sentence).exit()
}

/// Why a comparison of these files has no sides, and the command that names them: one file is half of a comparison, and of three nobody knows
/// which run is of which side.
pub(super) fn sides_are_open(command: &str, files: &[PathBuf]) -> String {
    let typed: Vec<String> = files.iter().map(|file| typed_path(file)).collect();
    let (of_a, of_b) = typed.split_at(files.len().div_ceil(2));
    let of_b = match of_b {
        [] => "OTHER.csv".to_owned(),
        some => some.join(" "),
    };
    let count = files.len();
    let named = if count == 1 { "file" } else { "files" };
    let of_one_servo = match command {
        "report" => format!(
            "\n\nWhere all are runs of one servo, they are one side:\n\n  servoid report --a {} -o REPORT.html",
            typed.join(" ")
        ),
        _ => format!(
            "\n\nWhere all are runs of one servo, there is nothing to compare, and one model of them is\n\n  servoid identify {}",
            typed.join(" ")
        ),
    };
    format!(
        "{count} {named} without --a and --b: which are runs of one side, and which of the other? Name them, such as\n\n  \
         servoid {command} --a {} --b {of_b}{of_one_servo}",
        of_a.join(" ")
    )
}

/// A file's name without folder and ending, for plots and for the terminal.
pub(super) fn stem(path: &Path) -> String {
    let name = path.file_stem().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}

/// A file's name as one types it in a command.
pub(super) fn typed_path(path: &Path) -> String {
    quoted(&path.display().to_string())
}

/// The form of a command's output.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct Talk {
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
    /// Print the result and errors only: not how files were read, nor what else is said beside the result
    #[arg(long, short)]
    pub quiet: bool,
}

impl Talk {
    /// A remark for the person at the terminal.
    pub(super) fn say(self, remark: impl Display) {
        if !self.quiet {
            print_remark(remark);
        }
    }

    /// The last line of a result as text: the command that one would type next. A script does not need it.
    pub(super) fn next(self, command: impl Display) -> String {
        match self.quiet {
            true => String::new(),
            false => format!("next: {command}\n"),
        }
    }

    /// The result, as text or as JSON.
    pub(super) fn result(self, text: String, value: &impl Serialize) -> Result<String> {
        if self.json { to_json(value) } else { Ok(text) }
    }
}

/// The options of commands that write files.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct Output {
    /// Replace files that exist
    #[arg(long)]
    pub force: bool,
    #[command(flatten)]
    pub talk: Talk,
}

impl Output {
    /// Fails where a file could not be written later: before an hour of work rather than after it.
    pub(super) fn check<'a>(self, files: impl IntoIterator<Item = &'a PathBuf>) -> Result<()> {
        for file in files {
            let folder = file
                .parent()
                .filter(|folder| !folder.as_os_str().is_empty());
            if folder.is_some_and(|folder| !folder.exists()) {
                return Err(WriteError::no_folder(file).into());
            }
            if !self.force && file.exists() {
                return Err(WriteError::exists(file).into());
            }
        }
        Ok(())
    }

    /// The same, and fails where a result would replace what the command reads.
    pub(super) fn check_beside<'a>(
        self,
        file: impl IntoIterator<Item = &'a PathBuf> + Copy,
        read: impl IntoIterator<Item = &'a PathBuf>,
    ) -> Result<()> {
        check_apart(file, read)?;
        self.check(file)
    }

    /// Writes a whole file: after an error, the file that was there stays.
    pub(super) fn write(self, path: &Path, content: &str) -> Result<()> {
        Ok(write_file(path, self.force, content)?)
    }

    /// Writes a result as JSON, if there is a file for it.
    pub(super) fn write_json(self, path: Option<&PathBuf>, value: &impl Serialize) -> Result<()> {
        path.map_or(Ok(()), |path| self.write(path, &to_json(value)?))
    }

    /// Draws figures into a folder, which is made if it is not there.
    pub(super) fn draw(self, folder: &Path, figures: &[Figure]) -> Result<()> {
        make_folder(folder)?;
        let mut files = Vec::new();
        for figure in figures {
            let path = folder.join(format!("{}.svg", figure.name));
            let drawing = draw(figure)
                .map_err(|e| anyhow::anyhow!("the plot {:?} cannot be drawn: {e}", figure.name))?;
            self.write(&path, &drawing)?;
            files.push(path.display().to_string());
        }
        self.talk.say(format_args!("plots: {}", files.join(", ")));
        Ok(())
    }
}

/// Fails where a file to be written is one that is read: it may be the only copy, so not even --force replaces it.
pub(super) fn check_apart<'a>(
    files: impl IntoIterator<Item = &'a PathBuf>,
    read: impl IntoIterator<Item = &'a PathBuf>,
) -> Result<()> {
    let one_name = |path: &PathBuf| path.canonicalize().ok();
    let read: Vec<PathBuf> = read.into_iter().filter_map(one_name).collect();
    let is_read = |file: &&PathBuf| one_name(file).is_some_and(|file| read.contains(&file));
    match files.into_iter().find(is_read) {
        Some(file) => Err(WriteError::is_input(file).into()),
        None => Ok(()),
    }
}

pub(super) fn make_folder(folder: &Path) -> Result<()> {
    let made = std::fs::create_dir_all(folder);
    made.with_context(|| format!("the folder {folder:?} cannot be made"))
}

#[cfg(test)]
mod tests {
    use super::{FINDING_COLOUR, PLAIN, with_findings_in_colour};

    #[test]
    fn the_first_line_of_a_finding_is_coloured_and_nothing_else() {
        let text = "gain 1\n\n  ! not linear\n    look there\n";
        let coloured = with_findings_in_colour(text);
        assert_eq!(
            coloured,
            format!("gain 1\n\n{FINDING_COLOUR}  ! not linear{PLAIN}\n    look there\n")
        );
    }
}
