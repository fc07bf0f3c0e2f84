//! The pages of docs/ that answer one question each: their commands run, and print what the pages show.
//!
//! A page has blocks of ```` ```console ````. A line that begins with `$ ` is a command, in a folder with the real recordings of
//! the tests; the lines below it are what it prints. A line `...` stands for lines that the page leaves out. Numbers may differ
//! in their last digits, which depend on the processor: so a page may be off by 2 % unnoticed until `UPDATE_PAGES=1` writes what is printed into
//! it, of a block with `...` line by line.

use crate::support::data;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const PAGES: [&str; 6] = [
    "a-csv-file.md",
    "a-board.md",
    "the-same-servo.md",
    "for-a-simulator.md",
    "no-bounds.md",
    "fast-enough.md",
];

const RECORDINGS: [&str; 3] = [
    "dcmotor_speed_prbs.csv",
    "dcmotor_position_stairs.csv",
    "miuzei_rc_servo_large.csv",
];

/// Lines that are left out.
const LEFT_OUT: &str = "...";

fn page(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../docs")
        .join(name)
}

/// What a command prints, in the order in which a person sees it.
fn printed(folder: &Path, command: &str) -> String {
    let out = folder.join(".printed");
    let file = std::fs::File::create(&out).unwrap();
    let program = Path::new(env!("CARGO_BIN_EXE_servoid")).parent().unwrap();
    let path = std::env::var("PATH").unwrap_or_default();
    let status = Command::new("sh")
        .args(["-c", command])
        .current_dir(folder)
        .env("PATH", format!("{}:{path}", program.display()))
        .env("NO_COLOR", "1")
        .stdin(Stdio::null())
        .stdout(file.try_clone().unwrap())
        .stderr(file)
        .status();
    assert!(status.is_ok(), "{command}");
    std::fs::read_to_string(&out).unwrap()
}

/// Words of a line, numbers apart from what surrounds them.
fn words(line: &str) -> Vec<&str> {
    let around = |c: char| "()[],;:%=".contains(c);
    let words = line.split_whitespace();
    words.map(|word| word.trim_matches(around)).collect()
}

/// Whether two lines are the same but for the last digits of their numbers.
fn alike(expected: &str, found: &str) -> bool {
    let (expected, found) = (words(expected), words(found));
    let same = |(a, b): (&&str, &&str)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 0.02 * a.abs().max(0.05),
        _ => a == b,
    };
    expected.len() == found.len() && expected.iter().zip(&found).all(same)
}

/// Where `found` has each line of `expected`, `None` for what is left out.
///
/// # Errors
/// The first line that is not in its place.
fn places<'a>(expected: &'a [String], found: &[&str]) -> Result<Vec<Option<usize>>, &'a str> {
    let mut places = Vec::new();
    let mut at = 0;
    let mut skips = false;
    for line in expected {
        if line == LEFT_OUT {
            skips = true;
            places.push(None);
            continue;
        }
        let rest = found.get(at..).unwrap_or_default();
        let place = match skips {
            true => rest.iter().position(|other| alike(line, other)),
            false => rest.first().filter(|other| alike(line, other)).map(|_| 0),
        };
        match place {
            Some(place) => {
                places.push(Some(at + place));
                at += place + 1;
            }
            None => return Err(line),
        }
        skips = false;
    }
    match !skips && at < found.len() {
        true => Err("(more lines than the page shows)"),
        false => Ok(places),
    }
}

/// The lines of a page as they are printed.
fn as_printed(expected: &[String], found: &[&str], places: &[Option<usize>]) -> Vec<String> {
    let lines = expected.iter().zip(places);
    lines
        .map(|(line, place)| match place {
            Some(place) => found[*place].to_owned(),
            None => line.clone(),
        })
        .collect()
}

/// One command of a page, and the lines that the page shows below it.
struct Shown {
    command: String,
    lines: Vec<String>,
}

/// The text between blocks, and blocks.
enum Part {
    Text(String),
    Block(Vec<Shown>),
}

fn parts(text: &str) -> Vec<Part> {
    let mut parts = Vec::new();
    let mut block: Option<Vec<Shown>> = None;
    for line in text.lines() {
        match (&mut block, line) {
            (None, "```console") => block = Some(Vec::new()),
            (None, line) => parts.push(Part::Text(line.to_owned())),
            (Some(_), "```") => parts.extend(block.take().map(Part::Block)),
            (Some(shown), line) => match (line.strip_prefix("$ "), shown.last_mut()) {
                (Some(command), _) => shown.push(Shown {
                    command: command.to_owned(),
                    lines: Vec::new(),
                }),
                (None, Some(last)) => last.lines.push(line.to_owned()),
                (None, None) => panic!("a block begins with {line:?} and not with a command"),
            },
        }
    }
    assert!(block.is_none(), "a block has no end");
    parts
}

/// Runs a page; returns it as it should be, and what differs.
fn run_page(name: &str, text: &str) -> (String, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    for recording in RECORDINGS {
        std::fs::copy(data(recording), folder.path().join(recording)).unwrap();
    }
    let (mut updated, mut differences) = (String::new(), Vec::new());
    for part in parts(text) {
        let shown = match part {
            Part::Text(line) => {
                updated += &(line + "\n");
                continue;
            }
            Part::Block(shown) => shown,
        };
        updated += "```console\n";
        for Shown { command, lines } in shown {
            let found = printed(folder.path(), &command);
            let found: Vec<&str> = found.lines().map(str::trim_end).collect();
            let as_shown = lines.iter().any(|line| line == LEFT_OUT);
            let places = places(&lines, &found);
            if let Err(line) = &places {
                let found = found.join("\n");
                differences.push(format!(
                    "{name}: $ {command}\nnot there: {line}\nprinted:\n{found}"
                ));
            }
            updated += &format!("$ {command}\n");
            let lines = match (as_shown, &places) {
                (true, Ok(places)) => as_printed(&lines, &found, places).join("\n"),
                (true, Err(_)) => lines.join("\n"),
                (false, _) => found.join("\n"),
            };
            if !lines.is_empty() {
                updated += &(lines.trim_end().to_owned() + "\n");
            }
        }
        updated = updated.trim_end().to_owned() + "\n```\n";
    }
    (updated, differences)
}

#[test]
fn what_the_pages_show_is_what_the_program_prints() {
    let mut differences = Vec::new();
    for name in PAGES {
        let text = std::fs::read_to_string(page(name)).unwrap();
        let (updated, differs) = run_page(name, &text);
        if std::env::var_os("UPDATE_PAGES").is_some() {
            std::fs::write(page(name), updated).unwrap();
        }
        differences.extend(differs);
    }
    assert!(
        differences.is_empty(),
        "{}\n(UPDATE_PAGES=1 writes blocks without '...' anew)",
        differences.join("\n\n")
    );
}

#[test]
fn a_page_that_shows_something_else_is_noticed() {
    let lines = |text: &str| -> Vec<String> { text.lines().map(str::to_owned).collect() };
    let found = [
        "gain 1.0085 (1.0076 .. 1.0095)",
        "delay 33.56 ms",
        "next: report",
    ];
    for (expected, same) in [
        ("gain 1.0086 (1.0076 .. 1.0095)\n...", true),
        ("...\ndelay 33.60 ms\n...", true),
        ("...\nnext: report", true),
        ("...\ndelay 35.56 ms\n...", false),
        ("gain 1.0085 (1.0076 .. 1.0095)", false),
        ("...\nnext: export", false),
    ] {
        assert_eq!(places(&lines(expected), &found).is_ok(), same, "{expected}");
    }
    // What is alike but for its last digits is taken over.
    let shown = lines("...\ndelay 33.60 ms\n...");
    let places = places(&shown, &found).unwrap();
    assert_eq!(
        as_printed(&shown, &found, &places),
        ["...", "delay 33.56 ms", "..."]
    );
}

#[test]
fn every_option_of_a_simulated_rig_is_in_the_page() {
    let error = "bench?nothing".parse::<servoid_simulator::SimulationOptions>();
    let error = error.unwrap_err().to_string();
    let (_, keys) = error.split_once("there are ").unwrap();
    let text = std::fs::read_to_string(page("a-board.md")).unwrap();
    let keys: Vec<&str> = keys
        .split([',', ' '])
        .filter(|word| !["", "and"].contains(word))
        .collect();
    assert!(keys.len() > 15, "{keys:?}");
    for key in keys {
        let shown = [format!("`{key}`"), format!("`{key}=")];
        assert!(shown.iter().any(|shown| text.contains(shown)), "{key}");
    }
}
