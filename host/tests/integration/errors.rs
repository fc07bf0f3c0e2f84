//! Bad input: one plain sentence, exit code 1 or 2, and nothing breaks.

use crate::support::{arg, refusal, run};
use std::path::Path;

fn write(dir: &Path, name: &str, text: &str) -> String {
    let path = dir.join(name);
    std::fs::write(&path, text).unwrap();
    arg(&path).to_owned()
}

/// `rows` rows of an input that moves and an output that follows.
fn good_rows(rows: usize) -> String {
    let row = |k: usize| format!("{},{}\n", k / 7 % 2, k / 7 % 2 * (k % 7));
    (0..rows).map(row).collect()
}

/// What helps first is said so that it can be typed, and each of it works.
#[test]
fn a_recording_that_is_too_short_for_a_choice_says_what_to_type() {
    let dir = tempfile::tempdir().unwrap();
    let mut servo = 0.0;
    let row = |k: u32| {
        let command = [0.0, 15.0, -15.0, 0.0][(k / 30) as usize];
        servo += 0.3 * (command - servo);
        format!(
            "{command},{:.3}\n",
            servo + 0.05 * (0.7 * f64::from(k * k)).sin()
        )
    };
    let rows: String = (0..120).map(row).collect();
    let file = write(dir.path(), "short.csv", &format!("u,y\n{rows}"));
    let identify = [
        "identify", "-q", &file, "--input", "u", "--output", "y", "--period", "0.01",
    ];
    let said = refusal(&identify);
    assert!(
        said.contains("if the servo rests at the beginning, state the input there, which is 0")
            && said.trim_end().ends_with("(--at-rest 0, or --settling 24)"),
        "{said}"
    );
    for option in [["--at-rest", "0"], ["--settling", "24"]] {
        let text = run(&[&identify[..], &option].concat());
        assert!(text.contains("DC gain"), "{text}");
    }
}

#[test]
fn files_that_are_not_what_they_should_be() {
    let dir = tempfile::tempdir().unwrap();
    let rows = good_rows(400);
    let cases = [
        ("empty.csv", String::new(), "empty"),
        ("noise.csv", "\u{0}\u{1}\u{2}".repeat(99), "bytes of zero"),
        ("missing.csv", format!("a,y\n{rows}"), "no column \"u\""),
        ("inf.csv", format!("u,y\n{rows}1,inf\n"), "line 402"),
        ("text.csv", format!("u,y\nup,1\n{rows}"), "\"up\""),
        ("ragged.csv", format!("u,y\n{rows}1\n"), "cells where"),
        ("two.csv", "u,y\n0,0\n1,1\n".to_owned(), "record longer"),
        (
            "constant.csv",
            format!("u,y\n{}", "3,1\n3,2\n".repeat(200)),
            "input",
        ),
        (
            "flat.csv",
            format!("u,y\n{}", "1,5\n2,5\n".repeat(200)),
            "output",
        ),
        (
            "gone.csv",
            format!("u,y\n{}", ",1\n,2\n".repeat(200)),
            "input",
        ),
    ];
    for (name, text, word) in &cases {
        let file = write(dir.path(), name, text);
        let said = refusal(&[
            "identify", &file, "--input", "u", "--output", "y", "--period", "0.02",
        ]);
        assert!(said.contains(word), "{name}: {said}");
        assert!(said.contains(name), "{name} is not named: {said}");
    }
    let missing = dir.path().join("nowhere.csv");
    assert!(refusal(&["identify", arg(&missing)]).contains("cannot be read"));
    let unnamed = write(dir.path(), "u.csv", &format!("u,y\n{rows}"));
    assert!(
        refusal(&["identify", &unnamed]).contains("add: --input u --output y --period SECONDS")
    );
    let named = [
        "identify",
        unnamed.as_str(),
        "--input",
        "u",
        "--output",
        "y",
    ];
    assert!(refusal(&named).contains("--period"));
}

/// Random steps, and a reading that knows nothing of them: the sensor is not connected.
#[test]
fn a_sensor_that_sees_nothing_is_not_blamed_on_the_reference() {
    let dir = tempfile::tempdir().unwrap();
    let (mut state, mut level) = (7u32, 10);
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24) - 0.5
    };
    let mut rows = String::from("u,y\n");
    for k in 0..2_000 {
        if k % 40 == 0 && next() > 0.0 {
            level = -level;
        }
        rows += &format!("{level},{:.4}\n", next());
    }
    let file = write(dir.path(), "dead.csv", &rows);
    let named = ["--input", "u", "--output", "y", "--period", "0.01"];
    let output = crate::support::servoid(&[&["identify", file.as_str()], &named[..]].concat())
        .output()
        .unwrap();
    let said = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
    assert!(said.contains("no response to the input"), "{said}");
    assert!(!said.contains("too smoothly"), "{said}");
}

#[test]
fn names_of_columns_do_not_reach_the_terminal_raw_nor_without_end() {
    let dir = tempfile::tempdir().unwrap();
    let names: Vec<String> = (0..1_000).map(|k| format!("c{k}")).collect();
    let cells = vec!["1"; 1_000].join(",");
    let header = names.join(",").replace("c7,", "\u{1b}[31mred\u{7},");
    let file = write(
        dir.path(),
        "wide.csv",
        &format!("{header}\n{cells}\n{cells}\n"),
    );
    let said = refusal(&["identify", &file, "--input", "u", "--output", "y"]);
    assert!(
        !said.contains('\u{1b}') && !said.contains('\u{7}'),
        "{said}"
    );
    assert!(said.contains("and 970 more"), "{said}");
}

#[test]
fn one_column_for_input_and_output_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let file = write(dir.path(), "x.csv", &format!("u,y\n{}", good_rows(400)));
    let args = [
        "identify", &file, "--input", "y", "--output", "y", "--period", "0.02",
    ];
    assert!(refusal(&args).contains("cannot be both"));
}

#[test]
fn an_amplitude_below_zero_and_a_folder_that_is_not_there_are_said() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let args = [
        "capture",
        "--port",
        "sim:bench",
        "--amplitude=-5",
        "-o",
        arg(&file),
    ];
    assert!(refusal(&args).contains("state 5"));
    let nowhere = dir.path().join("no/x.csv");
    let args = ["capture", "--port", "sim:bench", "-o", arg(&nowhere)];
    let said = refusal(&args);
    assert!(said.contains("its folder is not there"), "{said}");
}

#[test]
fn models_that_are_none() {
    let dir = tempfile::tempdir().unwrap();
    let record = write(dir.path(), "x.csv", "u,y\n1,2\n2,3\n");
    let columns = ["--input", "u", "--output", "y", "--period", "1"];
    for (text, word) in [
        ("", "no model"),
        ("{}", "no model"),
        ("{\"schema\": 99}", "newer servoid"),
        ("[1, 2", "no model"),
    ] {
        let model = write(dir.path(), "m.json", text);
        let said = refusal(&[&["validate", &model, &record][..], &columns].concat());
        assert!(said.contains(word), "{text}: {said}");
    }
}

#[test]
fn options_that_make_no_sense_are_wrong_usage() {
    for args in [
        &["identify"][..],
        &["identify", "x.csv", "--settling", "soon"],
        &["identify", "x.csv", "--period", "0"],
        &["identify", "x.csv", "--period", "nan"],
        &["capture", "--port", "sim:bench"],
        &["simulate", "--servo", "boat", "-o", "x.csv"],
        &["fly"],
    ] {
        let said = refusal(args);
        assert!(
            said.contains("--help") || said.contains("Usage") || said.contains("choose bench"),
            "{args:?}: {said}"
        );
    }
}

#[test]
fn ports_that_are_not_there_or_make_no_sense() {
    for (port, word) in [
        ("/dev/nowhere", "servoid ports"),
        ("sim:boat", "bench, aircraft or linear"),
        ("tcp:nonsense", "tcp:HOST:PORT"),
    ] {
        let said = refusal(&["info", "--port", port]);
        assert!(said.contains(word), "{port}: {said}");
    }
    let said = refusal(&["capture", "-o", "x.csv"]);
    assert!(said.contains("--port"), "{said}");
}

/// A loopback listener whose other end does `serve` with the first connection.
fn listener(serve: impl FnOnce(std::net::TcpStream) + Send + 'static) -> String {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    std::thread::spawn(move || {
        if let Ok((stream, _)) = listener.accept() {
            serve(stream);
        }
    });
    address
}

#[test]
fn a_port_that_never_answers_and_one_that_talks_nonsense() {
    use std::io::{Read, Write};
    let silent = listener(|mut stream| {
        let mut nobody_reads = [0; 64];
        while stream.read(&mut nobody_reads).is_ok_and(|n| n > 0) {}
    });
    assert!(refusal(&["info", "--port", &silent]).contains("answers"));
    let noisy = listener(|mut stream| {
        while stream.write_all(b"U\x00junk\x03\x00").is_ok() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
    });
    assert!(refusal(&["info", "--port", &noisy]).contains("baud"));
    let gone = listener(drop);
    assert!(refusal(&["info", "--port", &gone]).contains("connection"));
}

/// A rig of another version, which can only say who it is.
fn foreign_rig(mut stream: std::net::TcpStream) {
    use servoid_protocol::hello::Text16;
    use servoid_protocol::schema::SCHEMA_HASH;
    use servoid_protocol::{Decoder, Hello, Request, RigMessage, framing};
    use servoid_test_support::hello::hello;
    use std::io::{Read, Write};
    let hello = Hello {
        protocol_version: 2,
        schema_hash: !SCHEMA_HASH,
        board: Text16::new("STM32F103C8"),
        build: Text16::new("9.9.9"),
        frame_us: 3_000,
        ..hello()
    };
    let (mut decoder, mut byte) = (Decoder::new(), [0]);
    while stream.read(&mut byte).is_ok_and(|n| n > 0) {
        if let Some(Request { .. }) = decoder.push::<Request>(byte[0]) {
            let mut wire = [0; framing::MAX_WIRE];
            let wire = framing::encode(&RigMessage::Hello(hello), &mut wire).unwrap();
            if stream.write_all(wire).is_err() {
                return;
            }
        }
    }
}

#[test]
fn a_rig_of_another_version_is_explained_field_by_field_and_not_armed() {
    let port = listener(foreign_rig);
    let text = crate::support::run(&["info", "--port", &port]);
    for words in [
        "protocol_version 2 (this servoid: 1): the rig is the newer one",
        "schema_hash",
        "frame_us         3000 (this servoid: 20000)",
    ] {
        assert!(text.contains(words), "{words:?} is not in\n{text}");
    }
    assert!(!text.contains("sample_us"), "{text}");
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let said = refusal(&[
        "capture",
        "--port",
        &listener(foreign_rig),
        "-o",
        arg(&file),
    ]);
    assert!(said.contains("another protocol"), "{said}");
    assert!(!file.exists());
}

#[cfg(unix)]
#[test]
fn a_port_that_another_servoid_has_is_busy() {
    let (_near, far) = serialport::TTYPort::pair().unwrap();
    let name = serialport::SerialPort::name(&far).unwrap();
    drop(far);
    let held = servoid::instrument::port::open(&name);
    assert!(held.is_ok(), "the first one gets it");
    assert!(refusal(&["info", "--port", &name]).contains("busy"));
}

#[test]
fn the_aircraft_is_not_moved_by_accident() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let capture = |condition: &[&str]| {
        let port = ["capture", "--port", "/dev/nowhere", "-o", arg(&file)];
        refusal(&[&port[..], condition].concat())
    };
    for condition in [
        "aircraft",
        " Aircraft",
        "heli",
        "",
        "Bench 2",
        "bench, on the aircraft with the rotor turning",
    ] {
        let said = capture(&["--condition", condition]);
        assert!(said.contains("--arm"), "{condition:?}: {said}");
    }
    for condition in [&[][..], &["--condition", "bench"]] {
        assert!(capture(condition).contains("there is no port"));
    }
}
