//! Help that teaches: examples, completions and manual pages.

use crate::support::{arg, run};
use clap::{Command, CommandFactory, Parser};
use servoid::commands::Cli;

/// The commands, without clap's own 'help'.
fn commands() -> Vec<Command> {
    let mut whole = Cli::command();
    whole.build();
    let own = whole.get_subcommands().filter(|c| c.get_name() != "help");
    own.cloned().collect()
}

/// The lines of a help text that are examples.
fn examples(help: &str) -> Vec<String> {
    let after = help.split_once("\nExample").map_or("", |(_, after)| after);
    let lines = after.lines().map(str::trim);
    lines
        .filter(|line| line.starts_with("servoid "))
        .map(str::to_owned)
        .collect()
}

/// Words as a shell would have them: quotes keep words together, a redirection is the shell's own, and
/// a remark in brackets is none of the command.
fn words(line: &str) -> Vec<String> {
    let line = line.split(" > ").next().unwrap_or_default();
    let line = line.split("  ").next().unwrap_or_default();
    let mut words = vec![String::new()];
    let mut quoted = false;
    for letter in line.chars() {
        match letter {
            '"' | '\'' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            letter => words.last_mut().unwrap().push(letter),
        }
    }
    words
}

#[test]
fn every_command_ends_its_help_with_examples_that_are_commands() {
    let all = commands();
    assert!(all.len() >= 12);
    for command in all {
        let name = command.get_name().to_owned();
        let help = command.clone().render_long_help().to_string();
        let examples = examples(&help);
        assert!(!examples.is_empty(), "{name} has no example:\n{help}");
        let last = help.trim_end().lines().last().unwrap_or_default();
        assert!(last.trim().starts_with("servoid "), "{name}: {last}");
        let mut own = 0;
        for example in examples {
            let parsed = Cli::try_parse_from(words(&example));
            assert!(parsed.is_ok(), "{example}: {}", parsed.unwrap_err());
            own += usize::from(example.split(' ').nth(1) == Some(&name));
        }
        assert!(own > 0, "{name}: its examples show other commands");
    }
}

#[test]
fn completions_know_every_command() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = run(&["completions", shell]);
        for command in commands() {
            assert!(
                script.contains(command.get_name()),
                "{shell}: {}",
                command.get_name()
            );
        }
    }
    let fish = run(&["completions", "fish"]);
    for word in ["jsbsim", "mujoco", "sim:aircraft", "tcp:", "multisine"] {
        assert!(fish.contains(word), "{word}");
    }
}

#[test]
fn manual_pages_are_there_for_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let files = run(&["man", "--out", arg(folder.path())]);
    assert_eq!(files.lines().count(), 1 + commands().len());
    for command in commands() {
        let path = folder
            .path()
            .join(format!("servoid-{}.1", command.get_name()));
        let page = std::fs::read_to_string(&path).unwrap();
        assert!(page.contains(".TH"), "{path:?}");
        // Unfilled, each example on a line of its own.
        let unfilled = page.split_once(".nf\n").unwrap().1.replace('\\', "");
        let help = command.clone().render_long_help().to_string();
        for example in examples(&help) {
            let mut lines = unfilled.lines().map(str::trim);
            assert!(lines.any(|line| line == example), "{path:?}: {example}");
        }
    }
    assert!(run(&["man"]).contains("servoid"));
}

/// A side that is left out would make a page on the other alone.
#[test]
fn two_sides_are_stated_in_one_way() {
    for command in ["report", "compare"] {
        let words = [
            "servoid",
            command,
            "a.csv",
            "--b",
            "b.csv",
            "-o",
            "page.html",
        ];
        assert!(Cli::try_parse_from(words).is_err(), "{command}");
    }
}
