//! Recordings under adverse conditions: cut, changed, killed, and disks that are full.

use crate::support::{arg, data, refusal, run};
use servoid::data::DegreeScale;
use servoid::data::recording::{
    Completeness, Ending, FORMAT, Header, ReadError, ReadFault, Recording, RecordingWriter,
    is_recording, recover,
};
use servoid_protocol::{Counts, Frame, PulseWidth, framing};
use servoid_test_support::trials::kill;
use std::path::Path;
use std::time::Duration;

const FRAMES: u16 = 4;

/// Every frame another pulse, and every sample other counts.
fn frame(index: u16) -> Frame {
    let count = |k: u16| Counts(8_000 + 97 * index + 13 * k);
    Frame {
        run: 9,
        index,
        pulse: PulseWidth(1_500 + 25 * index),
        samples: std::array::from_fn(|k| count(k as u16)),
    }
}

const NOTES: &str = "a \"quoted\" remark, # and all";

/// A recording of four frames in which nothing depends on the clock, nor on what this program takes
/// a rig to be where nothing is given.
fn small(path: &Path, notes: &str, ending: Option<&Ending>) {
    small_under(path, &small_header(notes), ending);
}

fn small_header(notes: &str) -> Header {
    Header {
        servoid: "0.1.0".to_owned(),
        started: "2026-01-02T03:04:05Z".to_owned(),
        condition: "bench".to_owned(),
        notes: notes.to_owned(),
        neutral_us: 1_500,
        us_per_degree: 10.0,
        zero_counts: 8_190.0,
        degrees_per_count: 120.0 / (0.8 * 16_380.0),
        zero_sd_deg: 1.0,
        scale_sd_percent: 1.0,
        ..Header::default()
    }
}

fn small_under(path: &Path, header: &Header, ending: Option<&Ending>) {
    let mut writer = RecordingWriter::create(path, false, header).unwrap();
    (0..FRAMES).for_each(|index| writer.append(&frame(index)).unwrap());
    if let Some(ending) = ending {
        writer.finish(ending).unwrap();
    }
}

fn small_bytes(ending: Option<&Ending>) -> Vec<u8> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("small.csv");
    small(&path, NOTES, ending);
    std::fs::read(&path).unwrap()
}

fn parse(bytes: &[u8]) -> Result<Recording, ReadError> {
    Recording::parse(bytes, Path::new("x.csv"))
}

/// The rows that are there are rows of the original, each with its own numbers.
fn require_rows_of(found: &Recording, original: &Recording, what: &str) {
    for row in &found.rows {
        let there = original
            .rows
            .iter()
            .find(|other| other.sample == row.sample);
        let there = there.unwrap_or_else(|| panic!("{what}: sample {} is new", row.sample));
        assert_eq!(row, there, "{what}");
    }
}

#[test]
fn todays_format_is_what_it_was() {
    let golden = std::fs::read(data("recording-format-3-check.csv")).unwrap();
    assert_eq!(
        FORMAT, 4,
        "a new format needs a golden file of its own, and these stay"
    );
    let text = String::from_utf8(small_bytes(Some(&Ending::Complete))).unwrap();
    assert_eq!(text, String::from_utf8(golden).unwrap());
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("small.csv");
    let header = Header {
        format: FORMAT,
        pulse_period_us: 3_004,
        sample_period_s: 0.001_502,
        ..small_header(NOTES)
    };
    small_under(&path, &header, Some(&Ending::Complete));
    let text = std::fs::read_to_string(&path).unwrap();
    let golden = std::fs::read_to_string(data("recording-format-4.csv")).unwrap();
    assert_eq!(text, golden);
}

/// The digit that says how far the pulses are apart is damaged: the rows' own times contradict it, and are kept from being
/// read at another rate.
#[test]
fn a_damaged_period_of_pulses_is_not_believed() {
    let golden = std::fs::read_to_string(data("recording-format-4.csv")).unwrap();
    for damaged in ["3006", "20000", "0"] {
        let text = golden.replace(
            "pulse_period_us = 3004",
            &format!("pulse_period_us = {damaged}"),
        );
        assert!(parse(text.as_bytes()).is_err(), "{damaged}");
    }
}

#[test]
fn recordings_of_every_format_are_read() {
    for (name, format) in [
        ("recording-format-1.csv", 1),
        ("recording-format-2.csv", 2),
        ("recording-format-2-end-crc.csv", 2),
        ("recording-format-3.csv", 3),
        ("recording-format-3-check.csv", 3),
        ("recording-format-4.csv", 4),
    ] {
        let recording = Recording::read(&data(name)).unwrap();
        assert_eq!(recording.completeness, Completeness::Complete, "{name}");
        assert_eq!(recording.header.format, format);
        assert_eq!(recording.header.condition, "bench");
        let frames = (0..FRAMES).map(frame);
        let rows = frames.flat_map(|frame| frame.samples.map(|counts| (frame.pulse, counts)));
        for (row, (sample, (pulse, counts))) in recording.rows.iter().zip((0..).zip(rows)) {
            assert_eq!((row.sample, row.pulse, row.counts), (sample, pulse, counts));
        }
        let (reference, position) =
            DegreeScale::of_recording(&recording.header).columns(&recording.rows);
        assert_eq!((reference.len(), position.len()), (40, 40));
        assert_eq!(reference[39], 7.5);
        assert_eq!(position[0], -1.7399);
    }
}

/// Rows of another recording with the same scales, in a file that was never closed: each of them is right in itself.
#[test]
fn rows_of_another_recording_are_not_taken_for_its_own() {
    let dir = tempfile::tempdir().unwrap();
    let text = |notes: &str| {
        let path = dir.path().join(format!("{notes}.csv"));
        small(&path, notes, None);
        std::fs::read_to_string(&path).unwrap()
    };
    let (ours, theirs) = (text("ours"), text("theirs"));
    let ten = |text: &str| text.find("\n10,").unwrap() + 1;
    let spliced = format!("{}{}", &ours[..ten(&ours)], &theirs[ten(&theirs)..]);
    assert!(parse(ours.as_bytes()).is_ok());
    let refused = parse(spliced.as_bytes()).unwrap_err().to_string();
    assert!(refused.contains("check"), "{refused}");
}

#[test]
fn a_recording_of_a_later_format_says_so() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("x.csv");
    std::fs::write(
        &path,
        "# format = 5\n# new = \"thing\"\nsample,angle\n0,1\n",
    )
    .unwrap();
    let said = refusal(&["identify", arg(&path)]);
    assert!(said.contains("made by a newer servoid"), "{said}");
}

#[test]
fn every_prefix_is_read_as_what_it_is() {
    let bytes = small_bytes(Some(&Ending::Complete));
    let original = parse(&bytes).unwrap();
    assert_eq!(original.completeness, Completeness::Complete);
    let text = String::from_utf8(bytes.clone()).unwrap();
    let first_row = text.find("\n0,").unwrap() + 1;
    for cut in 0..bytes.len() {
        let found = parse(&bytes[..cut]).unwrap_or_else(|e| panic!("cut at {cut}: {e}"));
        assert!(
            matches!(found.completeness, Completeness::Partial(_)),
            "cut at {cut}"
        );
        // Whole frames whose last line end is there.
        let rows = text[..cut].get(first_row..).unwrap_or_default();
        let rows = rows.matches('\n').count();
        assert_eq!(found.rows.len(), (rows / 10 * 10).min(40), "cut at {cut}");
        require_rows_of(&found, &original, &format!("cut at {cut}"));
    }
}

/// What was read is the original's, or it is said that the end was damaged or is not there.
fn require_same_or_damaged(found: &Recording, original: &Recording, what: &str) {
    let state = |recording: &Recording| {
        (
            recording.completeness.clone(),
            recording.rows.clone(),
            recording.lost_samples.clone(),
        )
    };
    if state(found) != state(original) {
        let Completeness::Partial(why) = &found.completeness else {
            panic!("{what}: {:?}", found.completeness);
        };
        let causes = ["damaged", "cut off", "no last line", "no rows"];
        assert!(
            causes.iter().any(|words| why.contains(words)),
            "{what}: {why}"
        );
        assert!(found.lost_samples.is_empty(), "{what}");
    }
}

#[test]
fn what_an_editor_does_to_a_text_is_undone() {
    let bytes = small_bytes(Some(&Ending::Complete));
    let original = parse(&bytes).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let returns = text.replace('\n', "\r\n");
    for changed in [
        returns.clone(),
        format!("\u{feff}{text}"),
        format!("\u{feff}{returns}\r\n\r\n"),
        format!("{text}\n\n"),
    ] {
        assert!(is_recording(changed.as_bytes()));
        let found = parse(changed.as_bytes()).unwrap();
        assert_eq!(found.completeness, Completeness::Complete);
        assert_eq!(found.header, original.header);
        assert_eq!(found.rows, original.rows);
    }
    // One carriage return is no editor's.
    let one = text.replacen("\n10,", "\r\n10,", 1);
    assert!(parse(one.as_bytes()).is_err());
}

#[test]
fn complete_is_what_has_the_whole_run() {
    let partial = Ending::Partial {
        reason: "the cable is out".to_owned(),
        lost_frames: vec![4..6, 8..9],
    };
    let text = String::from_utf8(small_bytes(Some(&partial))).unwrap();
    let (rows, last) = text.split_at(text.find("# end").unwrap());
    let crc = &last[last.find("crc32").unwrap()..last.find(", reason").unwrap()];
    let sealed = |line: &str| {
        let crc32 = framing::CRC.checksum(line.as_bytes());
        format!("{rows}{line}, end_crc32 = \"{crc32:08x}\"\n")
    };
    let ended = |end: &str, more: &str| {
        let text = sealed(&format!("# end = \"{end}\", rows = 40, {crc}{more}"));
        parse(text.as_bytes()).map(|found| found.completeness)
    };
    assert_eq!(ended("complete", "").unwrap(), Completeness::Complete);
    for (end, more) in [
        ("complete", ", lost_samples = [[40, 59]]"),
        ("early", ", reason = \"x\", lost_samples = [[40, 59]]"),
        ("partial", ", reason = \"x\", lost_samples = [[30, 49]]"),
    ] {
        let error = ended(end, more).unwrap_err();
        assert!(matches!(error.fault, ReadFault::Changed(_)), "{error}");
    }
    // A run of which the header says that it has more.
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("short.csv");
    let header = Header {
        reference_frames: u32::from(FRAMES) + 1,
        ..Header::default()
    };
    let mut writer = RecordingWriter::create(&path, false, &header).unwrap();
    (0..FRAMES).for_each(|index| writer.append(&frame(index)).unwrap());
    writer.finish(&Ending::Complete).unwrap();
    let error = Recording::read(&path).unwrap_err();
    assert!(error.to_string().contains("shorter or longer"), "{error}");
}

/// Every bit, and some bytes that mean something in such a file.
fn changes(byte: u8) -> impl Iterator<Item = u8> {
    let flips = (0..8).map(move |bit| byte ^ (1 << bit));
    let others = [b'\n', b',', b'#', b'"', b'0', b'9', b'-', b' ', 0, 0xff];
    flips.chain(others).filter(move |changed| *changed != byte)
}

/// More than the last line of any ending [bytes].
const LAST_LINES: usize = 300;

#[test]
fn changed_bytes_are_seen_where_they_are_and_what_is_sound_is_saved() {
    // A prime, so that all places of a row come about.
    require_changes_seen(17);
}

#[test]
#[ignore = "five seconds: cargo test -p servoid --test integration -- --ignored every_changed_byte"]
fn every_changed_byte_is_seen_where_it_is_and_what_is_sound_is_saved() {
    require_changes_seen(1);
}

/// Changes each byte that is so many after the one before.
fn require_changes_seen(apart: usize) {
    let early = Ending::Early {
        reason: "the band is narrow enough".to_owned(),
    };
    let partial = Ending::Partial {
        reason: "the cable is out".to_owned(),
        lost_frames: vec![4..6, 8..9],
    };
    for ending in [Some(&Ending::Complete), Some(&early), Some(&partial), None] {
        let bytes = small_bytes(ending);
        let original = parse(&bytes).unwrap();
        let text = String::from_utf8(bytes.clone()).unwrap();
        let first_row = text.find("\n0,").unwrap() + 1;
        // Up to their last lines the files are the same.
        let from = match ending {
            Some(Ending::Complete) => 0,
            _ => bytes.len() - LAST_LINES,
        };
        for at in (from..bytes.len()).step_by(apart) {
            let row_hit = text[..at]
                .get(first_row..)
                .map(|rows| rows.matches('\n').count() + 1);
            // All kinds of changes come about equally often.
            let changes: Vec<u8> = changes(bytes[at]).collect();
            let byte = changes[at % changes.len()];
            let mut changed = bytes.clone();
            changed[at] = byte;
            let what = format!("byte {at} {:?} to {:?}", bytes[at] as char, byte as char);
            let found = match parse(&changed).map_err(|error| error.fault) {
                Ok(found) => {
                    assert_eq!(found.header, original.header, "{what}");
                    require_same_or_damaged(&found, &original, &what);
                    Some(found)
                }
                Err(ReadFault::DamagedRow { row, .. }) => {
                    let hit = row_hit.unwrap_or_else(|| panic!("{what}: no row was hit"));
                    assert!(row.abs_diff(hit) <= 1, "{what}: row {hit}, said {row}");
                    None
                }
                Err(ReadFault::DamagedHeader { .. }) => {
                    assert!(row_hit.is_none(), "{what}: a row was hit");
                    None
                }
                Err(ReadFault::Changed(_)) => {
                    assert!(row_hit > Some(40), "{what}: not the last line");
                    None
                }
                Err(other) => panic!("{what}: {other}"),
            };
            if let Some(found) = found {
                require_rows_of(&found, &original, &what);
            } else {
                require_saved(&changed, &original, row_hit, &what);
            }
        }
    }
}

/// All but the frame that was hit is saved, and nothing else. The end of a row is hit for two rows,
/// and between two frames for both.
fn require_saved(changed: &[u8], original: &Recording, row_hit: Option<usize>, what: &str) {
    // Where the scale above the rows was hit, no row fits to it any more.
    let Ok(saved) = recover(changed, Path::new("x.csv")) else {
        assert!(row_hit.is_none(), "{what}: nothing was saved");
        return;
    };
    assert!(!saved.findings.is_empty(), "{what}");
    let dir = tempfile_in_memory();
    let path = dir.path().join("saved.csv");
    let writer = RecordingWriter::create(&path, false, &saved.header).unwrap();
    saved.write(writer).unwrap();
    let found = Recording::read(&path).unwrap_or_else(|e| panic!("{what}: {e}"));
    assert!(
        matches!(found.completeness, Completeness::Partial(_)),
        "{what}"
    );
    if let Some(row) = row_hit {
        let least = if row % 10 == 0 { 20 } else { 30 };
        let rows = found.rows.len();
        assert!(rows >= least, "{what}: {rows} rows");
        require_rows_of(&found, original, what);
    }
}

/// A folder that is not on a disk where there is one: thousands of files are written and synced.
fn tempfile_in_memory() -> tempfile::TempDir {
    tempfile::tempdir_in("/dev/shm")
        .or_else(|_| tempfile::tempdir())
        .unwrap()
}

#[test]
fn recover_keeps_what_is_sound_and_names_what_is_not() {
    let dir = tempfile::tempdir().unwrap();
    let (damaged, saved) = (dir.path().join("x.csv"), dir.path().join("y.csv"));
    let text = String::from_utf8(small_bytes(Some(&Ending::Complete))).unwrap();
    std::fs::write(&damaged, &text).unwrap();
    let recovered = || refusal(&["recover", arg(&damaged), "-o", arg(&saved)]);
    assert!(recovered().contains("is complete and undamaged"));
    // Cut within its last frame.
    let cut = text.split_once("\n35,").unwrap().0;
    std::fs::write(&damaged, format!("{cut}\n")).unwrap();
    let said = recovered();
    assert!(
        said.contains("is partial, as its last frame was cut off. What is missing is not in the file; its 30 rows are sound"),
        "{said}"
    );
    assert!(!said.contains("undamaged"), "{said}");
    std::fs::write(&damaged, text.replace("\n15,0.030,", "\n15,0.031,")).unwrap();
    let said = refusal(&["validate", "m.json", arg(&damaged)]);
    assert!(!said.is_empty());
    let printed = run(&["recover", arg(&damaged), "-o", arg(&saved), "--json"]);
    let printed: serde_json::Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(printed["rows"], 30);
    assert_eq!(printed["lost_frames"], serde_json::json!([[1, 2]]));
    let recording = Recording::read(&saved).unwrap();
    assert_eq!(recording.lost_samples, vec![10..20]);
    assert!(
        recording.header.recovered.contains("its time"),
        "{:?}",
        recording.header
    );
    std::fs::remove_file(&saved).unwrap();
    std::fs::write(&damaged, [0; 5_000]).unwrap();
    assert!(refusal(&["recover", arg(&damaged), "-o", arg(&saved)]).contains("no recording"));
    std::fs::write(&damaged, "").unwrap();
    assert!(refusal(&["recover", arg(&damaged), "-o", arg(&saved)]).contains("no rows"));
    std::fs::write(&damaged, "# format = 2\nnothing of use\n").unwrap();
    assert!(refusal(&["recover", arg(&damaged), "-o", arg(&saved)]).contains("no sound frame"));
    assert!(!saved.exists());
}

#[test]
fn a_target_that_cannot_be_written_is_found_before_the_servo_moves() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("a-file");
    std::fs::write(&file, "").unwrap();
    for target in [file.join("x.csv"), dir.path().join("no/folder/x.csv")] {
        // The port does not exist: had it been opened first, that would be the complaint.
        let args = ["capture", "--port", "/dev/nowhere", "-o", arg(&target)];
        assert!(refusal(&args).contains("cannot be written"));
    }
}

#[test]
fn a_capture_that_does_not_take_place_leaves_no_file_and_replaces_none() {
    let dir = tempfile::tempdir().unwrap();
    let (new, old) = (dir.path().join("new.csv"), dir.path().join("old.csv"));
    std::fs::write(&old, "precious").unwrap();
    refusal(&["capture", "--port", "/dev/nowhere", "-o", arg(&new)]);
    refusal(&[
        "capture",
        "--port",
        "/dev/nowhere",
        "--force",
        "-o",
        arg(&old),
    ]);
    assert!(!new.exists());
    assert_eq!(std::fs::read_to_string(&old).unwrap(), "precious");
}

/// A capture that is killed leaves a file with all but its last 40 ms. A machine under load may not
/// run a program for longer than that: by how much this test itself was late is not held against it.
#[test]
fn a_capture_that_is_killed_keeps_all_but_the_last_moment() {
    let dir = tempfile::tempdir().unwrap();
    let servoid = Path::new(env!("CARGO_BIN_EXE_servoid"));
    for at in [350, 777, 1_234] {
        let cost = kill::trial(servoid, dir.path(), Duration::from_millis(at)).unwrap();
        let allowed = Duration::from_millis(40) + cost.lateness;
        assert!(cost.missing <= allowed, "{cost:?}");
    }
}

/// A disk of 64 kB, where the system lets a user have one.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_ends_with_a_sentence_and_keeps_the_rows() {
    let dir = tempfile::tempdir().unwrap();
    let script = format!(
        "mount -t tmpfs -o size=64k tmpfs {0} && {1} capture --port sim:bench -o {0}/x.csv; \
         status=$?; cp {0}/x.csv {0}.kept; exit $status",
        arg(dir.path()),
        env!("CARGO_BIN_EXE_servoid")
    );
    let output = std::process::Command::new("unshare")
        .args(["--user", "--map-root-user", "--mount", "sh", "-c", &script])
        .output();
    let kept = dir.path().with_extension("kept");
    let output = match output {
        Ok(output) if kept.exists() => output,
        other => {
            eprintln!("no disk of one's own here, so nothing was tested: {other:?}");
            return;
        }
    };
    let recording = Recording::read(&kept);
    std::fs::remove_file(&kept).unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("rows so far are kept"), "{said}");
    let recording = recording.unwrap();
    assert!(matches!(recording.completeness, Completeness::Partial(_)));
    assert!(recording.rows.len() > 1_000, "{}", recording.rows.len());
}
