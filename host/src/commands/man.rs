//! `servoid man`

use super::output::make_folder;
use crate::data::recording::write_file;
use anyhow::{Context, Result};
use clap::{Args, Command};
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};
use std::path::PathBuf;

/// Print the manual page, or write the pages of all commands into a folder
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid man > servoid.1
  servoid man --out ~/.local/share/man/man1")]
pub(super) struct ManArgs {
    /// Folder for the pages of all commands: servoid.1, servoid-capture.1 and so on
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace files that exist
    #[arg(long)]
    force: bool,
}

impl ManArgs {
    pub(super) fn run(self, mut whole: Command) -> Result<String> {
        // Gives the subcommands their full names and inherited options.
        whole.build();
        let Some(folder) = &self.out else {
            return page(whole);
        };
        make_folder(folder)?;
        let commands = whole.get_subcommands().filter(|c| c.get_name() != "help");
        let mut files = String::new();
        for command in std::iter::once(&whole).chain(commands) {
            let name = command.get_display_name().unwrap_or(command.get_name());
            let path = folder.join(format!("{name}.1"));
            write_file(&path, self.force, &page(command.clone())?)?;
            files += &format!("{}\n", path.display());
        }
        Ok(files)
    }
}

/// The page of one command. Its examples keep their lines.
fn page(command: Command) -> Result<String> {
    let examples = command.get_after_help().map(ToString::to_string);
    let mut text = Vec::new();
    Man::new(command.after_help(None::<&str>))
        .manual("servoid")
        .render(&mut text)
        .context("the manual page cannot be written")?;
    let page = String::from_utf8(text).context("the manual page is not text")?;
    Ok(page + &examples.as_deref().map_or_else(String::new, as_they_are))
}

/// The examples as a section of unfilled lines.
fn as_they_are(examples: &str) -> String {
    let mut roff = Roff::new();
    roff.control("SH", ["EXAMPLES"]).control("nf", []);
    for line in examples.lines().skip(1) {
        roff.text([roman(line)]);
    }
    roff.control("fi", []).to_roff()
}
