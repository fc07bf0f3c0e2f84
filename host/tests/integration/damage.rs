//! Recordings that lie: damaged headers, timing of another rig, files of nothing but damage.

use crate::support::{arg, data, refusal, run, servoid};
use servoid::data::dataset::{DatasetOptions, load};
use servoid::data::recording::{Recording, recover};
use servoid::data::rig_file::RigFile;
use servoid::instrument::port::{self, Port};
use servoid::instrument::rig::ClientError;
use servoid::instrument::rig::TalkError;
use servoid::instrument::rig::{Capture, RigClient};
use servoid_protocol::reference::Staircase;
use servoid_protocol::{Decoder, Hello, Reference, RigMessage, framing};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::time::Duration;

type Change = fn(&mut Hello);

/// A simulated rig that says of itself what it is not.
struct OtherTiming {
    inner: Box<dyn Port>,
    decoder: Decoder,
    waiting: VecDeque<u8>,
    change: Change,
}

impl Port for OtherTiming {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> std::io::Result<usize> {
        let mut received = [0; 64];
        let count = self.inner.read(&mut received, timeout)?;
        for &byte in &received[..count] {
            if let Some(mut message) = self.decoder.push::<RigMessage>(byte) {
                if let RigMessage::Hello(hello) = &mut message {
                    (self.change)(hello);
                }
                let mut wire = [0; framing::MAX_WIRE];
                self.waiting
                    .extend(framing::encode(&message, &mut wire).unwrap());
            }
        }
        let count = self.waiting.len().min(buffer.len());
        for (slot, byte) in buffer.iter_mut().zip(self.waiting.drain(..count)) {
            *slot = byte;
        }
        Ok(count)
    }

    fn write_all(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.inner.write_all(bytes)
    }

    fn now(&self) -> Duration {
        self.inner.now()
    }
}

#[test]
fn a_rig_of_another_timing_is_not_armed_though_its_messages_are_ours() {
    let changes: [(&str, Change); 2] = [
        ("sample_us", |hello| hello.sample_us = 1000),
        ("frame_us", |hello| hello.frame_us = 10_000),
    ];
    for (changed, change) in changes {
        let port = OtherTiming {
            inner: port::open("sim:bench").unwrap(),
            decoder: Decoder::new(),
            waiting: VecDeque::new(),
            change,
        };
        let mut client = RigClient::connect_as(Box::new(port), "sim", 1).unwrap();
        let capture = Capture::new(RigFile::default(), Reference::Staircase(Staircase::PAPER));
        match capture.arm(&mut client) {
            Err(TalkError::Rig(ClientError::TimingDiffers { field, .. })) => {
                assert_eq!(field, changed)
            }
            other => panic!("{changed}: {other:?}"),
        }
    }
}

/// A whole recording of a simulated servo, made once for each test that wants one.
fn recorded(dir: &Path) -> (PathBuf, String) {
    let file = dir.join("x.csv");
    run(&["capture", "--port", "sim:bench", "-q", "-o", arg(&file)]);
    let text = std::fs::read_to_string(&file).unwrap();
    (file, text)
}

/// The text as early files of its format had it: no row has a check, and the last line none of its own.
fn without_checks(text: &str) -> String {
    let text = text.replacen("# row_checks = true\n", "", 1);
    let (head, rows) = text.split_once("sample,").unwrap();
    let (rows, end) = rows.split_once("# end").unwrap();
    let short = |line: &str| line.rsplit_once(',').unwrap().0.to_owned() + "\n";
    let rows: String = rows.lines().map(short).collect();
    let columns = rows.find('\n').unwrap() + 1;
    let crc32 = framing::CRC.checksum(&rows.as_bytes()[columns..]);
    let (count, _) = end.split_once(", crc32").unwrap();
    format!("{head}sample,{rows}# end{count}, crc32 = \"{crc32:08x}\"\n")
}

/// The text with another header, whose CRC is right again or left as it is.
fn with_header(text: &str, from: &str, to: &str, sealed: bool) -> String {
    assert!(text.contains(from), "{from}");
    let text = text.replacen(from, to, 1);
    let text = if sealed { without_checks(&text) } else { text };
    let seal = text.find("# header_crc32").unwrap();
    let end = seal + text[seal..].find('\n').unwrap();
    let crc32 = framing::CRC.checksum(&text.as_bytes()[..seal]);
    match sealed {
        true => format!(
            "{}# header_crc32 = \"{crc32:08x}\"{}",
            &text[..seal],
            &text[end..]
        ),
        false => text,
    }
}

#[test]
fn a_period_that_is_not_that_of_the_rows_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let (file, text) = recorded(dir.path());
    let (from, to) = ("sample_period_s = 0.002", "sample_period_s = 0.001");
    std::fs::write(&file, with_header(&text, from, to, true)).unwrap();
    let said = refusal(&["identify", arg(&file)]);
    assert!(
        said.contains("sample_period_s") && said.contains("0.001"),
        "{said}"
    );
    let saved = dir.path().join("saved.csv");
    run(&["recover", arg(&file), "-o", arg(&saved)]);
    assert_eq!(
        Recording::read(&saved).unwrap().header.sample_period_s,
        0.002
    );
    // Format 1 had no rule that rows are held against: the times are, all the same.
    let old = std::fs::read_to_string(data("recording-format-1.csv")).unwrap();
    let shifted = old.replace("\n15,0.030,", "\n15,0.032,");
    assert_ne!(old, shifted);
    let said = Recording::parse(shifted.as_bytes(), &file).unwrap_err();
    assert!(said.to_string().contains("its time"), "{said}");
}

#[test]
fn what_a_damaged_header_says_is_marked_as_unproved_for_ever() {
    let dir = tempfile::tempdir().unwrap();
    let (file, text) = recorded(dir.path());
    let damaged = with_header(&text, "us_per_degree = 10.0", "us_per_degree = 20.0", false);
    // As format 2, which has no column of the pulse, and half the reference at twice the pulse per degree: no
    // row contradicts it.
    let damaged: String = damaged
        .replace("# format = 3", "# format = 2")
        .lines()
        .map(|line| match line.split(',').collect::<Vec<_>>()[..] {
            ["sample", t, u, y, _, c, _] => format!("sample,{t},{u},{y},{c}\n"),
            [n, t, u, y, _, c, _] if !n.starts_with('#') => {
                format!("{n},{t},{},{y},{c}\n", u.parse::<f64>().unwrap() / 2.0)
            }
            _ => format!("{line}\n"),
        })
        .collect();
    std::fs::write(&file, damaged).unwrap();
    assert!(refusal(&["identify", arg(&file)]).contains("recover"));
    let saved = dir.path().join("saved.csv");
    run(&["recover", arg(&file), "-o", arg(&saved)]);
    let header = Recording::read(&saved).unwrap().header;
    assert!(
        header.unproved.contains("us_per_degree = 20.0"),
        "{}",
        header.unproved
    );
    for proved in ["sample_period_s", "zero_counts", "degrees_per_count"] {
        assert!(!header.unproved.contains(proved), "{}", header.unproved);
    }
    let remarks = load(&[saved], &DatasetOptions::default())
        .unwrap()
        .about
        .remarks;
    assert!(
        remarks
            .iter()
            .any(|r| r.contains("nothing proves") && r.contains("us_per_degree")),
        "{remarks:?}"
    );
}

#[test]
fn rows_with_pulses_prove_the_scale_of_the_servo_too() {
    let dir = tempfile::tempdir().unwrap();
    let (file, text) = recorded(dir.path());
    let (from, to) = ("condition = \"bench\"", "condition = \"wrong\"");
    std::fs::write(&file, with_header(&text, from, to, false)).unwrap();
    let saved = dir.path().join("saved.csv");
    run(&["recover", arg(&file), "-o", arg(&saved)]);
    let header = Recording::read(&saved).unwrap().header;
    assert!(header.unproved.contains(to), "{}", header.unproved);
    for proved in ["neutral_us", "us_per_degree", "degrees_per_count"] {
        assert!(!header.unproved.contains(proved), "{}", header.unproved);
    }
}

#[test]
fn lost_samples_beyond_any_run_are_refused() {
    let text = std::fs::read_to_string(data("recording-format-2.csv")).unwrap();
    let text = text.replace(
        "end = \"complete\"",
        "lost_samples = [[44000, 9000000009]], end = \"partial\"",
    );
    let path = Path::new("x.csv");
    let said = Recording::parse(text.as_bytes(), path).unwrap_err();
    assert!(said.to_string().contains("names as lost"), "{said}");
    let saved = recover(text.as_bytes(), path).unwrap();
    assert_eq!(saved.lost_frames, []);
}

/// 34 s before frames were counted instead of searched, so a time far above what is needed and far
/// below what it was is no measure of speed, but of its growth.
#[test]
fn a_file_of_nothing_but_bad_rows_takes_no_square_of_its_length() {
    let header = std::fs::read_to_string(data("recording-format-2.csv")).unwrap();
    let header = &header[..header.find("\n0,").unwrap() + 1];
    let lines = 200_000;
    for bad in [" \n", "x\n", "1,2,3\n"] {
        let started = std::time::Instant::now();
        let text = format!("{header}{}", bad.repeat(lines));
        let path = Path::new("x.csv");
        assert!(Recording::parse(text.as_bytes(), path).is_err());
        assert!(recover(text.as_bytes(), path).is_err());
        assert!(
            started.elapsed() < Duration::from_secs(20),
            "{:?}",
            started.elapsed()
        );
    }
}

#[test]
fn a_recording_is_known_as_one_whatever_became_of_its_first_line() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let bytes = std::fs::read(data("recording-format-2.csv")).unwrap();
    let said = |bytes: &[u8]| {
        std::fs::write(&file, bytes).unwrap();
        let found = load(std::slice::from_ref(&file), &DatasetOptions::default());
        found.map_or_else(|e| e.to_string(), |data| data.about.remarks.concat())
    };
    let first_line = bytes.iter().position(|b| *b == b'\n').unwrap();
    for at in 0..=first_line {
        for bit in 0..8 {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << bit;
            let said = said(&changed);
            assert!(
                said.contains("damaged above its rows"),
                "byte {at}, bit {bit}: {said}"
            );
            // What is still of the form is seen by the CRC alone, a line end is of two lines.
            let by_form = at < first_line && !said.contains("CRC");
            assert!(
                said.contains("at line 1:") || !by_form,
                "byte {at}, bit {bit}: {said}"
            );
        }
    }
    for cut in 0..bytes.len() {
        let said = said(&bytes[..cut]);
        assert!(!said.contains("is no recording"), "cut at {cut}: {said}");
        let cut_short = Recording::parse(&bytes[..cut], &file).unwrap();
        let servoid::data::recording::Completeness::Partial(why) = cut_short.completeness else {
            panic!("cut at {cut}: complete")
        };
        if !cut_short.rows.is_empty() {
            continue; // four frames are too few for anything, which is another complaint
        }
        // 'recover' says the same of it.
        let expected = format!("partial ({why})");
        assert!(said.contains(&expected), "cut at {cut}: {said}, not {why}");
    }
}

#[test]
fn a_recording_that_ends_before_its_reference_says_so() {
    let dir = tempfile::tempdir().unwrap();
    let (file, text) = recorded(dir.path());
    let cut = text.find("\n300,").unwrap() + 1;
    std::fs::write(&file, &text[..cut]).unwrap();
    let said = refusal(&["identify", arg(&file)]);
    assert!(
        said.contains("partial") && said.contains("before the reference begins"),
        "{said}"
    );
    assert!(
        said.contains("300 rows") && said.contains("sample 400"),
        "{said}"
    );
}

#[test]
fn a_damaged_recording_with_its_columns_named_is_read_with_a_warning() {
    let dir = tempfile::tempdir().unwrap();
    let (file, text) = recorded(dir.path());
    std::fs::write(&file, text.replace("\n1500,3.000,", "\n1500,3.001,")).unwrap();
    let options = DatasetOptions {
        input: Some("reference_deg".to_owned()),
        output: Some("position_deg".to_owned()),
        period_s: Some(0.002),
        ..DatasetOptions::default()
    };
    let remarks = load(&[file], &options).unwrap().about.remarks;
    assert!(
        remarks.iter().any(|r| r.contains("damaged at row 1501")),
        "{remarks:?}"
    );
}

/// The way out of a damaged header that its error advises gives what the recording gives.
#[test]
fn a_recording_without_a_sound_header_has_the_same_times_by_its_columns() {
    let dir = tempfile::tempdir().unwrap();
    let (file, text) = recorded(dir.path());
    let whole = load(std::slice::from_ref(&file), &DatasetOptions::default()).unwrap();
    let columns = |file: &Path, [input, output]: [&str; 2]| {
        let options = DatasetOptions {
            input: Some(input.to_owned()),
            output: Some(output.to_owned()),
            ..DatasetOptions::default()
        };
        load(&[file.to_owned()], &options).unwrap().record
    };
    let damaged = dir.path().join("damaged.csv");
    let header = with_header(&text, "zero_sd_deg = 4.0", "zero_sd_deg = 5.0", false);
    std::fs::write(&damaged, header).unwrap();
    let degrees = ["reference_deg", "position_deg"];
    let records = [
        columns(&damaged, degrees),
        columns(&file, ["pulse_us", "counts"]),
    ];
    for record in &records {
        assert_eq!(record.sample_phase_s(), whole.record.sample_phase_s());
        assert_eq!(record.samples(), whole.record.samples());
    }
    assert_eq!(records[0].runs()[0].input(), whole.record.runs()[0].input());
    // Only what works is advised: with another scale no row is sound.
    let scale = "degrees_per_count = 0.0091552734375";
    let header = with_header(&text, scale, "degrees_per_count = 0.02", false);
    let broken = dir.path().join("broken.csv");
    std::fs::write(&broken, header).unwrap();
    let refused = |file: &Path| load(&[file.to_owned()], &DatasetOptions::default()).unwrap_err();
    let (savable, lost) = (refused(&damaged).to_string(), refused(&broken).to_string());
    assert!(savable.contains("servoid recover"), "{savable}");
    assert!(
        !lost.contains("servoid recover") && lost.contains("--input reference_deg"),
        "{lost}"
    );
    // A header that is gone leaves the phase of every board.
    let (_, rows) = text.split_once("# header_crc32").unwrap();
    let (_, rows) = rows.split_once('\n').unwrap();
    std::fs::write(&damaged, rows).unwrap();
    assert_eq!(columns(&damaged, degrees).sample_phase_s(), 0.0005);
}

/// The reader of a pipe goes away: the run goes on, and the file is complete.
#[cfg(unix)]
#[test]
fn a_capture_outlives_whoever_reads_its_messages() {
    use std::process::{Command, Stdio};
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let mut child = Command::new(env!("CARGO_BIN_EXE_servoid"))
        .args(["capture", "--port", "sim:bench", "-o", arg(&file)])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    let status = child.wait().unwrap();
    assert!(status.success(), "{status}");
    let recording = Recording::read(&file).unwrap();
    assert_eq!(
        recording.completeness,
        servoid::data::recording::Completeness::Complete
    );
}

#[test]
fn a_level_that_is_none_is_refused_for_models_too() {
    let dir = tempfile::tempdir().unwrap();
    let (file, _) = recorded(dir.path());
    let model = dir.path().join("m.json");
    run(&["identify", arg(&file), "-o", arg(&model)]);
    for level in ["0", "1", "2", "nan", "-1"] {
        let level = format!("--level={level}");
        let output = servoid(&["compare", arg(&model), arg(&model), &level]).output();
        let output = output.unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{level}: {said}");
        assert!(said.contains("level"), "{level}: {said}");
    }
    let text = std::fs::read_to_string(&model).unwrap();
    std::fs::write(&model, text.replace("\"level\": 0.99", "\"level\": 2.0")).unwrap();
    assert!(refusal(&["compare", arg(&model), arg(&model)]).contains("contradicts itself"));
}

#[test]
fn a_scale_that_is_none_costs_no_row() {
    let dir = tempfile::tempdir().unwrap();
    let (file, _) = recorded(dir.path());
    let rows = Recording::read(&file).unwrap().rows.len();
    let text = std::fs::read_to_string(&file).unwrap();
    let broken = text.replace("# us_per_degree = 10.0", "# us_per_degree = 0.0");
    assert_ne!(broken, text);
    std::fs::write(&file, broken).unwrap();
    assert!(refusal(&["identify", arg(&file)]).contains("servoid recover"));
    let saved = dir.path().join("saved.csv");
    run(&["recover", arg(&file), "-o", arg(&saved)]);
    assert_eq!(Recording::read(&saved).unwrap().rows.len(), rows);
}
