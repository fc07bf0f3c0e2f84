//! `servoid completions`

use anyhow::{Context, Result};
use clap::{Args, Command};
use clap_complete::Shell;

/// Print the completions of a shell
///
/// bash: into ~/.local/share/bash-completion/completions/servoid; fish: into
/// ~/.config/fish/completions/servoid.fish; zsh: as _servoid into a folder of $fpath.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid completions bash > ~/.local/share/bash-completion/completions/servoid
  servoid completions fish > ~/.config/fish/completions/servoid.fish")]
pub(super) struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    pub(super) fn run(self, mut program: Command) -> Result<String> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut program, "servoid", &mut script);
        String::from_utf8(script).context("the completions are not text")
    }
}
