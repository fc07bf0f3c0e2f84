//! What is on the disk stays until something better takes its place; a rig in use is left alone.

use crate::support::{arg, data, json, refusal, run};
use servoid::data::FileError;
use servoid::data::model_file::ModelFile;
use servoid::data::recording::{
    Completeness, Ending, Header, Recording, RecordingWriter, ReservedFile, WriteFault, write_file,
};
use servoid::data::rig_file::RigFile;
use servoid::instrument::port;
use servoid::instrument::rig::CaptureError;
use servoid::instrument::rig::ClientError;
use servoid::instrument::rig::{Capture, RigClient, TalkError};
use servoid_protocol::message::Refusal;
use servoid_protocol::reference::Staircase;
use servoid_protocol::{Counts, Frame, PulseWidth, Reference, RigMessage, framing};
use std::path::Path;

fn frame(index: u16) -> Frame {
    Frame {
        run: 9,
        index,
        pulse: PulseWidth(1_500),
        samples: [Counts(8_000 + index); 10],
    }
}

/// A recording to `file` on a rig that was never armed.
fn record_unarmed(file: &Path, force: bool, stop: bool) -> CaptureError {
    let reserved = ReservedFile::new(file, force).unwrap();
    let mut client = RigClient::connect_as(port::open("sim:bench").unwrap(), "sim", 1).unwrap();
    let capture = Capture::new(RigFile::default(), Reference::Staircase(Staircase::PAPER));
    let header = Header::of_run(client.hello(), &capture.rig, &capture.start);
    let writer = RecordingWriter::begin(reserved, &header);
    capture
        .record(
            &mut client,
            writer,
            &|| stop.then_some(servoid::instrument::rig::StopReason::User),
            &mut |_| (),
        )
        .unwrap_err()
}

#[test]
fn a_run_that_does_not_begin_costs_no_file_and_leaves_none() {
    let dir = tempfile::tempdir().unwrap();
    let (old, new) = (dir.path().join("old.csv"), dir.path().join("new.csv"));
    std::fs::write(&old, "precious").unwrap();
    for stop in [false, true] {
        for (file, force) in [(&old, true), (&new, false)] {
            let error = record_unarmed(file, force, stop);
            let expected = match error {
                CaptureError::StoppedBefore => stop,
                CaptureError::Talk(TalkError::Rig(ClientError::Refused { refusal, .. })) => {
                    refusal == Refusal::NotArmed && !stop
                }
                _ => false,
            };
            assert!(expected, "stop {stop}: {error}");
        }
        assert_eq!(std::fs::read_to_string(&old).unwrap(), "precious");
        assert!(!new.exists());
    }
}

#[test]
fn an_empty_file_is_not_in_the_way() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    std::fs::write(&file, "").unwrap();
    run(&["capture", "--port", "sim:linear", "-o", arg(&file)]);
    let recording = Recording::read(&file).unwrap();
    assert_eq!(recording.completeness, Completeness::Complete);
}

/// A recording to a file that nobody else writes to.
fn recording_under_way(file: &Path) -> RecordingWriter {
    let reserved = ReservedFile::new(file, false).unwrap();
    RecordingWriter::begin(reserved, &Header::default())
}

#[test]
fn a_file_is_written_by_one_capture_at_a_time() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let mut first = recording_under_way(&file);
    for _ in 0..2 {
        let second = ReservedFile::new(&file, true);
        assert!(
            matches!(
                second,
                Err(FileError {
                    fault: WriteFault::InUse,
                    ..
                })
            ),
            "{second:?}"
        );
        // Before its first frame and after it.
        first.append(&frame(0)).unwrap();
    }
    drop(first);
    ReservedFile::new(&file, true).unwrap();
}

#[cfg(unix)]
#[test]
fn a_file_that_is_removed_under_way_is_put_back_or_beside_the_one_in_its_place() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    for (replaced, name) in [(false, "x.csv"), (true, "x-rescued-1.csv")] {
        let reserved = ReservedFile::new(&file, true).unwrap();
        let mut writer = RecordingWriter::begin(reserved, &Header::default());
        writer.append(&frame(0)).unwrap();
        std::fs::remove_file(&file).unwrap();
        if replaced {
            std::fs::write(&file, "another's").unwrap();
        }
        let error = writer.finish(&Ending::Complete).unwrap_err();
        let WriteFault::Rescued { rows: 10, kept } = error.fault else {
            panic!("{error}");
        };
        assert_eq!(kept, dir.path().join(name));
        let rescued = Recording::read(&kept).unwrap();
        assert_eq!(rescued.completeness, Completeness::Complete);
        assert_eq!(rescued.rows.len(), 10);
    }
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "another's");
}

/// Whatever else writes files has to wait too.
#[test]
fn a_recording_under_way_is_replaced_by_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let mut first = recording_under_way(&file);
    first.append(&frame(0)).unwrap();
    let said = write_file(&file, true, "a model").unwrap_err();
    assert!(said.to_string().contains("being written"), "{said}");
    first.finish(&Ending::Complete).unwrap();
    write_file(&file, true, "a model").unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn a_pipe_that_nobody_reads_is_refused_rather_than_waited_for() {
    let dir = tempfile::tempdir().unwrap();
    let pipe = dir.path().join("pipe");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    for error in [
        ReservedFile::new(&pipe, true).unwrap_err().to_string(),
        write_file(&pipe, true, "").unwrap_err().to_string(),
    ] {
        assert!(error.contains("nobody reads"), "{error}");
    }
}

#[test]
fn a_folder_is_no_file_to_replace() {
    let dir = tempfile::tempdir().unwrap();
    for force in [false, true] {
        for error in [
            ReservedFile::new(dir.path(), force)
                .unwrap_err()
                .to_string(),
            write_file(dir.path(), force, "").unwrap_err().to_string(),
        ] {
            assert!(error.contains("is a folder"), "{force}: {error}");
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn what_is_no_plain_file_is_written_to_as_it_is() {
    let args = [
        "capture",
        "--port",
        "sim:linear",
        "--force",
        "-o",
        "/dev/null",
    ];
    assert!(run(&args).contains("complete"));
    write_file(Path::new("/dev/null"), true, "nothing").unwrap();
}

#[cfg(unix)]
#[test]
fn a_file_is_replaced_whole_and_stays_what_it_was_otherwise() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let dir = tempfile::tempdir().unwrap();
    let (file, link) = (dir.path().join("x.json"), dir.path().join("link"));
    write_file(&file, false, "first").unwrap();
    assert!(write_file(&file, false, "second").is_err());
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "first");
    std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o640)).unwrap();
    symlink(&file, &link).unwrap();
    let opened = std::fs::File::open(&file).unwrap();
    write_file(&link, true, "third").unwrap();
    assert!(link.is_symlink());
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "third");
    let mode = file.metadata().unwrap().permissions().mode() & 0o777;
    assert_eq!(mode, 0o640);
    // Whoever had the old one open has all of it still.
    assert_eq!(std::io::read_to_string(opened).unwrap(), "first");
    // And nothing is left beside it.
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 2);
}

#[test]
fn a_recording_is_recovered_onto_itself() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let text = std::fs::read_to_string(data("recording-format-2.csv")).unwrap();
    std::fs::write(&file, text.replace("\n15,0.030,", "\n15,0.031,")).unwrap();
    run(&["recover", arg(&file), "-o", arg(&file), "--force"]);
    assert_eq!(Recording::read(&file).unwrap().rows.len(), 30);
}

#[test]
fn a_result_from_a_partial_recording_says_so_for_ever() {
    let dir = tempfile::tempdir().unwrap();
    let (file, model) = (dir.path().join("x.csv"), dir.path().join("m.json"));
    run(&["capture", "--port", "sim:bench", "-o", arg(&file)]);
    let text = std::fs::read_to_string(&file).unwrap();
    let cut = text.find("\n3500,").unwrap() + 1;
    std::fs::write(&file, &text[..cut]).unwrap();
    let printed = run(&["identify", arg(&file), "--json", "-o", arg(&model)]);
    let printed: serde_json::Value = serde_json::from_str(&printed).unwrap();
    let page = dir.path().join("x.html");
    run(&["report", arg(&model), "-o", arg(&page)]);
    let of_model = std::fs::read_to_string(&page).unwrap();
    run(&["report", arg(&file), "-o", arg(&page), "--force"]);
    let of_recording = std::fs::read_to_string(&page).unwrap();
    let validated = run(&["validate", arg(&model), arg(&file), "--json"]);
    let compared = run(&["compare", arg(&file), arg(&file), "--json"]);
    for text in [
        printed["advice"].to_string(),
        json(&model)["advice"].to_string(),
        of_model,
        of_recording,
        validated,
        compared,
    ] {
        assert!(text.contains("x.csv is partial (it has no last line): it has 3500 rows"));
    }
}

#[test]
fn a_model_of_another_schema_is_named_as_what_it_is() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("m.json");
    for (schema, words) in [
        ("3", "made by a newer servoid"),
        ("3.0", "made by a newer servoid"),
        ("\"3\"", "made by a newer servoid"),
        ("99999999999", "made by a newer servoid"),
        ("0", "no servoid writes"),
        ("\"1\"", "no servoid writes"),
        ("null", "no servoid writes"),
        ("1", "is not laid out like that"),
        ("2", "is no model"),
    ] {
        std::fs::write(&file, format!("{{\"schema\":{schema}}}")).unwrap();
        let said = ModelFile::read(&file).unwrap_err().to_string();
        assert!(said.contains(words), "{schema}: {said}");
    }
}

/// A network bridge that brings a run's frames to whoever connects, and counts the bytes that come.
#[test]
fn a_rig_with_a_run_under_way_is_left_alone() {
    use std::io::{Read, Write};
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp:{}", listener.local_addr().unwrap());
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let bridge = std::thread::spawn(move || {
        let mut received = 0;
        for _ in 0..2 {
            let (mut stream, _) = listener.accept().unwrap();
            let pause = std::time::Duration::from_millis(20);
            stream.set_read_timeout(Some(pause)).unwrap();
            for index in 0..1_000 {
                let mut wire = [0; framing::MAX_WIRE];
                let message = RigMessage::Frame(frame(index));
                let wire = framing::encode(&message, &mut wire).unwrap();
                if stream.write_all(wire).is_err() {
                    break;
                }
                // A frame's time passes, or somebody sends something.
                received += stream.read(&mut [0; 100]).unwrap_or(0);
            }
        }
        received
    });
    let said = run(&["info", "--port", &port]);
    assert!(said.contains("run of another program"), "{said}");
    let args = ["capture", "--port", &port, "-o", arg(&file)];
    assert!(refusal(&args).contains("run of another program"));
    assert!(!file.exists());
    assert_eq!(bridge.join().unwrap(), 0, "not a byte was said to the rig");
}

/// Not even --force: it may be the only copy.
#[test]
fn a_result_never_replaces_what_the_command_reads() {
    let dir = tempfile::tempdir().unwrap();
    let [recording, model, rig] = ["r.csv", "m.json", "rig.toml"].map(|name| dir.path().join(name));
    run(&["simulate", "-q", "--servo", "linear", "-o", arg(&recording)]);
    run(&["identify", "-q", arg(&recording), "-o", arg(&model)]);
    run(&[
        "init",
        "-q",
        "--yes",
        "--port",
        "sim:bench",
        "-o",
        arg(&rig),
    ]);
    let link = dir.path().join("link.csv");
    std::os::unix::fs::symlink(&recording, &link).unwrap();
    let before = [&recording, &model, &rig].map(|file| std::fs::read(file).unwrap());
    let [r, m, t] = [&recording, &model, &rig].map(|file| arg(file));
    let commands: [&[&str]; 7] = [
        &["identify", r, "-o", r],
        &["identify", r, "-o", arg(&link)],
        &["report", r, "-o", r],
        &["validate", m, r, "-o", m],
        &["export", "--to", "c", m, "-o", m],
        &["plan", "--model", m, "--rig", t, "-o", t],
        &["capture", "--rig", t, "-o", t],
    ];
    for command in commands {
        let said = refusal(&[command, &["--force"]].concat());
        assert!(
            said.contains("is what the command reads"),
            "{command:?}: {said}"
        );
    }
    let after = [&recording, &model, &rig].map(|file| std::fs::read(file).unwrap());
    assert_eq!(before, after);
    // A rig file that is made anew is kept.
    run(&[
        "init",
        "-q",
        "--yes",
        "--port",
        "sim:linear",
        "-o",
        t,
        "--force",
    ]);
    assert_eq!(
        std::fs::read(dir.path().join("rig-1.toml")).unwrap(),
        before[2]
    );
}
