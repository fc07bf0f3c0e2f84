//! The sensor's scale from readings at known angles.

use crate::support::{arg, refusal, run};
use servoid::rig::RigFile;

const PAIRS: &str = "--pairs=-20=6001,-10=7000,0=8001,10=9000,20=10001";

#[test]
fn a_calibration_goes_into_the_rig_file_and_leaves_the_rest() {
    let dir = tempfile::tempdir().unwrap();
    let (old, new) = (dir.path().join("old.toml"), dir.path().join("new.toml"));
    std::fs::write(&old, "# mine\n[servo]\nneutral_us = 1520\n").unwrap();
    let args = [
        "calibrate",
        PAIRS,
        "--rig",
        arg(&old),
        "-o",
        arg(&new),
        "--json",
    ];
    let found: serde_json::Value = serde_json::from_str(&run(&args)).unwrap();
    assert_eq!(found["readings"], 5);
    let rig = RigFile::read(&new).unwrap();
    assert_eq!(rig.servo.neutral_us, 1520);
    // The readings are within a count of 100 counts a degree and 8000 at 0.
    assert!((rig.sensor.degrees_per_count - 0.01).abs() < 1e-5);
    assert!((rig.sensor.zero_counts - 8000.6).abs() < 1e-6);
    assert!(rig.sensor.zero_sd_deg > 0.0 && rig.sensor.scale_sd_percent > 0.0);
    assert!(std::fs::read_to_string(&new).unwrap().contains("# mine"));
    assert!(refusal(&args).contains("--force"));
}

#[test]
fn readings_that_give_no_scale_are_refused_and_nothing_is_written() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("rig.toml");
    for (pairs, word) in [
        ("--pairs=-20=6000,20=10000", "three"),
        ("--pairs=-20=8000,0=8000,20=8000", "direction"),
        ("--pairs=-20=6000,0=8000,20=70000", "65535"),
        ("--pairs=20", "-20=6008"),
    ] {
        let said = refusal(&["calibrate", pairs, "-o", arg(&out)]);
        assert!(said.contains(word), "{pairs}: {said}");
        assert!(!out.exists());
    }
}
