//! Input from elsewhere: whatever the bytes are, nothing panics and nothing is believed that is not so.
//!
//! The same properties as the fuzz targets in `fuzz/`, on fewer inputs and without their tools.

use crate::support::data;
use proptest::prelude::*;
use servoid::data::rig_file::RigFile;
use servoid::data::table::Table;
use servoid_protocol::{Decoder, Degrees, PulseWidth, Request, RigMessage, framing};
use servoid_test_support::trials::any_bytes::read_as_a_recording;
use std::path::Path;

/// Bytes that are nearly a file: some of it replaced, cut out or doubled.
fn nearly(original: Vec<u8>) -> impl Strategy<Value = Vec<u8>> {
    let len = original.len();
    let change = (
        0..len,
        0..200_usize,
        prop::collection::vec(any::<u8>(), 0..40),
    );
    prop::collection::vec(change, 1..6).prop_map(move |changes| {
        let mut bytes = original.clone();
        for (at, length, new) in changes {
            let at = at.min(bytes.len());
            let end = (at + length).min(bytes.len());
            bytes.splice(at..end, new);
        }
        bytes
    })
}

fn golden(format: u32) -> Vec<u8> {
    std::fs::read(data(&format!("recording-format-{format}.csv"))).unwrap()
}

/// The seeds of the fuzz targets, each as what it is a seed of; those of models and data sets need files and options,
/// and are read as recordings and tables.
#[test]
fn the_seeds_of_the_fuzz_targets_have_their_properties() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus");
    let mut seeds = 0;
    for target in [
        "csv_table",
        "dataset",
        "frame_decoder",
        "model_file",
        "recording",
        "rig_file",
    ] {
        for entry in std::fs::read_dir(corpus.join(target)).unwrap() {
            let bytes = std::fs::read(entry.unwrap().path()).unwrap();
            seeds += 1;
            read_as_a_recording(&bytes);
            if let Ok(table) = Table::parse(bytes.clone()) {
                let names = table.columns().to_vec();
                let both = [names[0].as_str(), names[names.len() - 1].as_str()];
                if let Ok(columns) = table.numbers(&both) {
                    assert_eq!(columns[0].len(), columns[1].len(), "{target}");
                }
            }
            if let Ok(text) = std::str::from_utf8(&bytes)
                && let Ok(rig) = RigFile::parse(text, Path::new("rig.toml"))
            {
                assert!(rig.sensor.healthy_counts.is_sorted(), "{target}");
            }
            let (mut to_rig, mut to_host) = (Decoder::new(), Decoder::new());
            for byte in bytes {
                let request = to_rig.push::<Request>(byte);
                let message = to_host.push::<RigMessage>(byte);
                let mut wire = [0; framing::MAX_WIRE];
                assert!(request.is_none_or(|it| framing::encode(&it, &mut wire).is_ok()));
                assert!(message.is_none_or(|it| framing::encode(&it, &mut wire).is_ok()));
            }
        }
    }
    assert!(seeds >= 30, "{seeds}");
}

proptest! {
    #[test]
    fn any_bytes_as_a_recording(bytes in prop::collection::vec(any::<u8>(), 0..2_000)) {
        read_as_a_recording(&bytes);
    }

    #[test]
    fn nearly_a_recording(bytes in prop_oneof![nearly(golden(2)), nearly(golden(3))]) {
        read_as_a_recording(&bytes);
    }

    #[test]
    fn any_text_as_a_rig_file(text in "(\\[?[a-z_]{0,12}\\]? ?=? ?[-0-9.\"a-z\\[\\], ]{0,12}\n){0,12}") {
        let _ = RigFile::parse(&text, Path::new("rig.toml"));
    }

    #[test]
    fn a_rig_file_with_any_numbers_is_refused_or_works(
        neutral: u16, us_per_degree: f64, zero: f64, scale: f64, limits: [u16; 2],
    ) {
        let text = format!(
            "[servo]\nneutral_us = {neutral}\nus_per_degree = {us_per_degree:e}\n[sensor]\nzero_counts = {zero:e}\n\
             degrees_per_count = {scale:e}\n[limits]\nshortest_us = {}\nlongest_us = {}\n", limits[0], limits[1],
        );
        if let Ok(rig) = RigFile::parse(&text, Path::new("rig.toml")) {
            prop_assert!(limits[0] <= neutral && neutral <= limits[1]);
            let pulse = rig.servo_scale().pulse(Degrees(0.0));
            prop_assert_eq!(pulse, Some(PulseWidth(neutral)));
        }
    }

    #[test]
    fn any_bytes_as_a_table(bytes in prop::collection::vec(prop_oneof![Just(b','), Just(b'\n'), Just(b'"'), any::<u8>()], 0..500)) {
        if let Ok(table) = Table::parse(bytes)
            && let [first, .., last] = table.columns().to_vec().as_slice()
            && let Ok(columns) = table.numbers(&[first, last])
            && let [a, b] = columns.as_slice()
        {
            prop_assert_eq!(a.len(), b.len());
        }
    }
}
