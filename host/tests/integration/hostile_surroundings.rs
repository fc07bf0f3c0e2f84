//! What a terminal, a file system and other programs do to a capture under way.

use super::support::{arg, refusal, run, servoid};
use super::terminal::Session;
use rustix::process::{Signal, kill_process};
use servoid::data::recording::{Completeness, Recording};
use servoid::instrument::port::Port;
use servoid_simulator::InProcessRig;
use std::io::{Read, Seek, SeekFrom, Write};
use std::net::TcpListener;
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

/// The terminal blocks, and the signal comes in mid-run: the recording is partial, and so says the exit code, though the
/// program could not say its last word.
#[test]
fn a_partial_recording_has_its_exit_code_behind_a_blocked_terminal_too() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let port = ["capture", "--port", "sim:bench?realtime", "-o", arg(&file)];
    let mut session = Session::begin_on("dumb", &port);
    session.wait_for("no rows came", |_| length(&file) > 4_000);
    session.hold();
    session.fill();
    kill_process(session.pid(), Signal::TERM).unwrap();
    assert_eq!(session.end().code(), Some(3));
    let recording = Recording::read(&file).unwrap();
    assert!(matches!(recording.completeness, Completeness::Partial(_)));
}

/// Ctrl-C comes early in the rest before the reference, or a little later on a loaded machine: the next command is one that works.
#[test]
fn a_run_that_ends_before_its_reference_has_no_next_command() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let port = ["capture", "--port", "sim:bench?realtime", "-o", arg(&file)];
    let mut session = Session::begin_on("dumb", &port);
    session.wait_for("no rows came", |_| length(&file) > 500);
    session.press("\x03");
    assert_eq!(session.end().code(), Some(3));
    let asked = servoid(&["identify", arg(&file)]).output().unwrap();
    let said = String::from_utf8(asked.stderr).unwrap();
    let seen = session.seen();
    match said.contains("end before the reference begins") {
        true => assert!(
            seen.contains("nothing to identify") && !seen.contains("next:"),
            "{seen}"
        ),
        false => assert!(seen.contains("next: servoid identify"), "{seen}"),
    }
}

/// The line breaks before the run, in it, and in the second of two runs.
#[test]
fn what_a_broken_line_leaves_decides_the_exit_code() {
    // After so many bytes of the rig: a run of 110 frames is less than 5000.
    for (bytes, runs, code, says) in [
        (120, "1", 1, "the connection broke"),
        (2_500, "1", 3, "keeps all rows up to the failure"),
        (5_400, "2", 3, "(1 complete before it)"),
    ] {
        let dir = tempfile::tempdir().unwrap();
        let (steps, file) = (dir.path().join("steps.csv"), dir.path().join("x.csv"));
        std::fs::write(&steps, "angle_deg,hold_s\n5,0.3\n-5,0.3\n").unwrap();
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = format!("tcp:{}", listener.local_addr().unwrap());
        let bridge = std::thread::spawn(move || pass_on(&listener, bytes));
        let capture = ["capture", "--port", &port, "--repeat", runs, "--reference"];
        let output = servoid(&[&capture[..], &[arg(&steps), "-o", arg(&file)]].concat())
            .output()
            .unwrap();
        bridge.join().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{bytes}: {said}");
        assert!(said.contains(says), "{bytes}: {said}");
        assert_eq!(length(&file) > 0, code == 3 && runs == "1", "{said}");
    }
}

/// A bridge to a simulated rig that closes after so many bytes of it.
fn pass_on(listener: &TcpListener, mut bytes: usize) {
    let mut rig = InProcessRig::new(&"linear".parse().unwrap()).unwrap();
    let (mut stream, _) = listener.accept().unwrap();
    stream.set_nonblocking(true).unwrap();
    let mut buffer = [0; 512];
    while bytes > 0 {
        match stream.read(&mut buffer) {
            Ok(0) => return,
            Ok(count) => rig.write_all(&buffer[..count]).unwrap(),
            Err(_nothing_came) => {}
        }
        let most = bytes.min(buffer.len());
        let waits = Duration::from_millis(2);
        let count = Port::read(&mut rig, &mut buffer[..most], waits).unwrap();
        std::thread::sleep(Duration::from_millis(1));
        stream.write_all(&buffer[..count]).unwrap();
        bytes -= count;
    }
}

/// `ulimit -f`: the system ends a program that writes beyond it by a signal, unless it is caught.
#[test]
fn a_file_beyond_the_largest_that_is_allowed_is_an_error_and_leaves_no_half() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    let (recording, model, out) = (path("x.csv"), path("x.json"), path("out"));
    run(&["simulate", "--servo", "linear", "-o", arg(&recording)]);
    run(&["identify", arg(&recording), "-o", arg(&model)]);
    let (recording, model, out) = (arg(&recording), arg(&model), arg(&out));
    for (blocks, command) in [
        (8, &["identify", recording, "-o", out][..]),
        (8, &["identify", recording, "--plots", out]),
        (8, &["compare", recording, recording, "-o", out]),
        (8, &["report", model, "-o", out]),
        (2, &["export", model, "--to", "c", "-o", out]),
        (1, &["init", "--yes", "--port", "sim:bench", "-o", out]),
        (8, &["demo", "-o", out]),
        (8, &["simulate", "--servo", "linear", "-o", out]),
    ] {
        let quoted = command.join("' '");
        let program = env!("CARGO_BIN_EXE_servoid");
        let script = format!("ulimit -f {blocks} && exec '{program}' '{quoted}'");
        let shell = ["-c", &script];
        let output = std::process::Command::new("sh").args(shell).output();
        let output = output.unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        let sentence = said.lines().last().unwrap_or_default();
        assert!(sentence.starts_with("servoid: "), "{command:?}: {said}");
        assert!(sentence.contains("File too large"), "{command:?}: {said}");
        // Of a recording the rows so far are kept.
        let recorded = matches!(command[0], "simulate" | "demo");
        let code = if recorded { 3 } else { 1 };
        assert_eq!(output.status.code(), Some(code), "{command:?}: {said}");
        let left: Vec<_> = std::fs::read_dir(dir.path()).unwrap().collect();
        let made = recorded || command.contains(&"--plots");
        assert_eq!(left.len(), 2 + usize::from(made), "{command:?}: {left:?}");
        if command.contains(&"--plots") {
            let plots = std::fs::read_dir(out).unwrap().flatten();
            for plot in plots {
                let drawing = std::fs::read_to_string(plot.path()).unwrap();
                assert!(drawing.trim_end().ends_with("</svg>"), "{plot:?}");
            }
        }
        match Path::new(out) {
            folder if folder.is_dir() => std::fs::remove_dir_all(folder).unwrap(),
            file if made => std::fs::remove_file(file).unwrap(),
            _ => {}
        }
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
    // Each run takes its seven seconds, whatever the processor does.
    std::thread::scope(|scope| {
        for damage in ["cut", "emptied", "overwritten"] {
            scope.spawn(move || require_damage_found(damage));
        }
    });
}

fn require_damage_found(damage: &str) {
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
