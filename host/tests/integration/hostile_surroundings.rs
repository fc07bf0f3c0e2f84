//! What a terminal, a file system and other programs do to a capture under way.

use super::support::{arg, refusal, servoid};
use super::terminal::Session;
use rustix::process::{Signal, kill_process};
use servoid::data::recording::{Completeness, Recording};
use std::io::{Seek, SeekFrom, Write};
use std::path::Path;
use std::time::{Duration, Instant};

fn length(file: &Path) -> u64 {
    std::fs::metadata(file).map_or(0, |m| m.len())
}

/// Without the live scope, on a terminal that takes no byte from the first second on: the run has its end, its file
/// has a last line, and one SIGTERM ends the program within two seconds.
#[test]
fn a_blocked_terminal_without_the_scope_holds_nothing_up() {
    for (kind, more) in [("xterm-256color", &["--plain"][..]), ("dumb", &[])] {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("x.csv");
        let port = ["capture", "--port", "sim:bench?realtime", "-o", arg(&file)];
        let mut session = Session::begin_on(kind, &[&port, more].concat());
        session.wait_for("no rows came", |_| length(&file) > 4_000);
        session.hold();
        session.fill();
        session.wait_for("the run does not end", |_| {
            std::fs::read_to_string(&file).is_ok_and(|text| text.contains("\n# end = "))
        });
        let recording = Recording::read(&file).unwrap();
        assert_eq!(recording.completeness, Completeness::Complete, "{kind}");
        let asked = Instant::now();
        kill_process(session.pid(), Signal::TERM).unwrap();
        session.end();
        assert!(
            asked.elapsed() < Duration::from_secs(2),
            "{kind}: {:?}",
            asked.elapsed()
        );
    }
}

/// A named pipe where other versions of this program kept a lock: nobody waits for its writer.
#[test]
fn a_pipe_in_the_place_of_a_lock_holds_nothing_up() {
    let (_near, far) = serialport::TTYPort::pair().unwrap();
    let name = serialport::SerialPort::name(&far).unwrap();
    drop(far);
    let folder = tempfile::tempdir().unwrap();
    let lock = format!("servoid{}.lock", name.replace('/', "-"));
    let pipe = folder.path().join(&lock);
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    let begun = Instant::now();
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_servoid"))
        .args(["info", "--port", &name])
        .env("TMPDIR", folder.path())
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    // Nobody answers on this port, which it finds out in three seconds.
    while child.try_wait().unwrap().is_none() {
        if begun.elapsed() > Duration::from_secs(20) {
            child.kill().unwrap();
            panic!("it waits for the pipe");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(refusal(&["info", "--port", "/dev/nowhere"]).contains("there is no port"));
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 1, "no lock is left behind: {left:?}");
}

/// What a file says, and its name, may hold commands for a terminal: they are shown, and not carried out.
#[test]
fn no_text_of_a_file_reaches_the_terminal_as_a_command() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("a\u{1b}]0;b\u{7}\u{202e}c.csv");
    let capture = ["capture", "--port", "sim:linear", "-o", arg(&file)];
    let outputs = [
        servoid(&capture).output().unwrap(),
        servoid(&[&capture[..], &["--json", "--force"]].concat())
            .output()
            .unwrap(),
        servoid(&["validate", arg(&file), arg(&file)])
            .output()
            .unwrap(),
        servoid(&["info", "--port", "\u{1b}[2J\u{9b}31m"])
            .output()
            .unwrap(),
    ];
    for output in outputs {
        for said in [output.stdout, output.stderr] {
            let said = String::from_utf8(said).unwrap();
            let acts =
                |letter: char| (letter.is_control() && letter != '\n') || letter == '\u{202e}';
            assert!(!said.contains(acts), "{said:?}");
        }
    }
    // A reason in the last line, with a CRC of its own that is right.
    let text = std::fs::read_to_string(&file).unwrap();
    let (rows, last) = text.split_once("# end").unwrap();
    let (_, counted) = last.split_once("rows = ").unwrap();
    let (counted, _) = counted.split_once(", end_crc32").unwrap();
    let end = format!("{rows}# end = \"partial\", rows = {counted}, reason = \"x\\u001b[2Jy\"\n");
    std::fs::write(&file, end).unwrap();
    let output = servoid(&["identify", arg(&file)]).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("x\\u001b[2Jy") && !said.contains('\u{1b}'),
        "{said:?}"
    );
}

/// A gigabyte of nothing, and a cell of megabytes: both are refused with a sentence.
#[test]
fn a_file_with_a_hole_and_a_cell_without_an_end_are_refused_with_a_sentence() {
    let dir = tempfile::tempdir().unwrap();
    let (hole, small_hole, cell) = ("hole.csv", "small.csv", "cell.csv");
    let path = |name: &str| dir.path().join(name);
    for (name, length) in [(hole, 1 << 30), (small_hole, 1 << 20)] {
        let mut file = std::fs::File::create(path(name)).unwrap();
        file.write_all(b"t,u,y\n0,1,2\n").unwrap();
        file.set_len(length).unwrap();
    }
    let long = format!("t,u,y\n0,1,2\n1,{},2\n", "x".repeat(5_000_000));
    std::fs::write(path(cell), long).unwrap();
    for (name, reason) in [
        (hole, "256 MiB"),
        (small_hole, "zero"),
        (cell, "no finite number"),
    ] {
        let file = path(name);
        let columns = ["--input", "u", "--output", "y", "--period", "0.002"];
        let output = servoid(&[&["identify", arg(&file)], &columns[..]].concat())
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{name}: {said}");
        assert!(said.len() < 20_000, "{name}: {} bytes", said.len());
        // The reason may stand behind the text that is cut off.
        assert!(
            said.contains(reason) || said.contains("and so on"),
            "{name}: {said}"
        );
    }
}

/// Another program cuts the file, or writes into it: the end is not "complete", and every row is saved.
#[test]
fn a_file_that_is_damaged_under_way_is_found_and_its_rows_are_saved() {
    for damage in ["cut", "emptied", "overwritten"] {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("x.csv");
        let child = std::process::Command::new(env!("CARGO_BIN_EXE_servoid"))
            .args([
                "capture",
                "--port",
                "sim:bench?realtime",
                "-q",
                "-o",
                arg(&file),
            ])
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        while length(&file) < 8_000 {
            assert!(begun.elapsed() < Duration::from_secs(60), "no rows came");
            std::thread::sleep(Duration::from_millis(20));
        }
        let mut other = std::fs::OpenOptions::new().write(true).open(&file).unwrap();
        match damage {
            "cut" => other.set_len(6_000).unwrap(),
            "emptied" => other.set_len(0).unwrap(),
            _ => {
                other.seek(SeekFrom::Start(5_000)).unwrap();
                other.write_all(b"0123456789").unwrap();
            }
        }
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success(), "{damage}: {said}");
        assert!(
            said.contains("changed by another program"),
            "{damage}: {said}"
        );
        let saved = Recording::read(&dir.path().join("x-rescued-1.csv")).unwrap();
        assert_eq!(saved.completeness, Completeness::Complete, "{damage}");
        assert!(Recording::read(&file).is_err(), "{damage}");
    }
}
