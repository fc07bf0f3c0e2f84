//! The live scope on a real terminal.

use super::support::arg;
use super::terminal::Session;
use rustix::process::{Signal, kill_process};
use servoid::data::recording::{Completeness, Recording};
use std::path::Path;
use std::time::Duration;

const ENTER: &str = "\x1b[?1049h";
const LEAVE: &str = "\x1b[?1049l";

fn begin(file: &Path, more: &[&str]) -> Session {
    let capture = ["capture", "--port", "sim:bench?realtime", "-o", arg(file)];
    Session::begin(&[&capture, more].concat())
}

fn wait_for_rows(session: &Session, file: &Path) {
    session.wait_for("no rows came", |_| {
        std::fs::metadata(file).is_ok_and(|m| m.len() > 4000)
    });
}

/// The program has ended well, the terminal is as it was, and the data is kept.
fn require_stopped_safely(mut session: Session, file: &Path) {
    let status = session.end();
    session.wait_for("the screen is not given back", |seen| seen.contains(LEAVE));
    let seen = session.seen();
    assert_eq!(status.code(), Some(3), "{status}: {seen}");
    assert!(!seen.contains("panicked"), "{seen}");
    assert_eq!(seen.matches(ENTER).count(), 1);
    assert!(session.is_as_before());
    let recording = Recording::read(file).unwrap();
    let Completeness::Partial(reason) = &recording.completeness else {
        panic!("it is partial")
    };
    // The recording says so only where the rig itself has confirmed that it stopped.
    assert_eq!(reason, "stopped by the user");
}

/// On the way the terminal becomes tiny and large; q held down is one wish to stop, not two.
#[test]
fn q_stops_the_run_and_gives_the_terminal_back() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let mut session = begin(&file, &[]);
    session.wait_for("no scope", |seen| {
        seen.contains(ENTER) && seen.contains("servoid capture")
    });
    assert!(!session.is_as_before());
    wait_for_rows(&session, &file);
    for (columns, rows) in [(1, 1), (40, 12), (200, 60), (80, 24)] {
        session.resize(columns, rows);
        // Some pictures of that size.
        std::thread::sleep(Duration::from_millis(200));
    }
    session.press("q");
    session.press("q");
    require_stopped_safely(session, &file);
}

#[test]
fn a_signal_stops_the_run_and_gives_the_terminal_back() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let session = begin(&file, &[]);
    session.wait_for("no scope", |seen| seen.contains(ENTER));
    wait_for_rows(&session, &file);
    kill_process(session.pid(), Signal::TERM).unwrap();
    require_stopped_safely(session, &file);
}

/// The run goes on and ends on a signal, and so does the program within a second.
#[test]
fn a_terminal_that_takes_nothing_any_more_holds_nothing_up() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let mut session = begin(&file, &[]);
    session.wait_for("no scope", |seen| seen.contains(ENTER));
    session.hold();
    // Pictures fill the terminal's buffer, of some kilobytes, meanwhile.
    let long = 40_000;
    session.wait_for("no rows came", |_| {
        std::fs::metadata(&file).is_ok_and(|m| m.len() > long)
    });
    kill_process(session.pid(), Signal::TERM).unwrap();
    session.wait_for("the recording is not closed", |_| {
        std::fs::read_to_string(&file).is_ok_and(|text| text.contains("\n# end = "))
    });
    let recording = Recording::read(&file).unwrap();
    assert!(matches!(recording.completeness, Completeness::Partial(_)));
    kill_process(session.pid(), Signal::TERM).unwrap();
    // A busy machine may have drawn too little to fill the buffer: then it has ended by itself by now.
    let code = session.end().code();
    assert!(matches!(code, Some(130 | 3)), "{code:?}");
}

#[test]
fn scripts_get_no_scope_even_on_a_terminal() {
    for word in ["--quiet", "--plain"] {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("x.csv");
        let mut session = begin(&file, &[word]);
        wait_for_rows(&session, &file);
        kill_process(session.pid(), Signal::TERM).unwrap();
        assert_eq!(session.end().code(), Some(3));
        assert!(!session.seen().contains(ENTER), "{word}");
    }
}
