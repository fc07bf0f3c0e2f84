//! Servos with other pulses than the usual ones, from the rig file to the model.

use crate::support::{arg, refusal, run};
use servoid::data::model_file::ModelFile;
use servoid::data::recording::{Completeness, Recording};
use servoid::data::rig_file::RigFile;
use std::path::Path;

/// Of the simulated linear servo, with these options of `init`: the recording and the model.
fn measured(dir: &Path, name: &str, servo: &str, init: &[&str]) -> (Recording, ModelFile) {
    let file = |ending: &str| dir.join(format!("{name}.{ending}"));
    let (rig, recording, model) = (file("toml"), file("csv"), file("json"));
    let mut args = vec!["init", "--yes", "--port", servo, "-o", arg(&rig)];
    args.extend(init);
    run(&args);
    run(&["capture", "--rig", arg(&rig), "-o", arg(&recording)]);
    run(&["identify", arg(&recording), "-o", arg(&model)]);
    let recording = Recording::read(&recording).unwrap();
    assert_eq!(recording.completeness, Completeness::Complete);
    (recording, ModelFile::read(&model).unwrap())
}

/// The servo is the same, whatever pulses bring it its command: delay, rise and gain agree, and count from the same edge.
#[test]
fn the_same_servo_is_found_by_every_train_of_pulses() {
    let dir = tempfile::tempdir().unwrap();
    let of = |name: &str, servo, init: &[&str]| measured(dir.path(), name, servo, init);
    let wide = "sim:linear?seed=2";
    let (_, usual) = of("usual", wide, &[]);
    let narrow = ["--pulse-type", "narrow", "--pulse-rate", "560"];
    let others = [
        (of("100", wide, &["--pulse-rate", "100"]), 10_000, 0.002),
        (of("333", wide, &["--pulse-rate", "333"]), 3_004, 0.001_502),
        (
            of("560", "sim:linear?seed=2&pulses=narrow", &narrow),
            1_786,
            0.001_786,
        ),
    ];
    for ((recording, found), pulse_us, period_s) in others {
        let header = &recording.header;
        assert_eq!(
            (header.pulse_period_us, header.sample_period_s),
            (pulse_us, period_s)
        );
        assert_eq!(
            found.metadata.pulse_frame_s,
            Some(f64::from(pulse_us) / 1e6)
        );
        let metrics = |file: &ModelFile| {
            let metrics = &file.model.metrics;
            [
                metrics.delay_s.value.unwrap(),
                metrics.t50_s.value.unwrap(),
                metrics.dc_gain.value.unwrap(),
            ]
        };
        let pairs = metrics(&found).into_iter().zip(metrics(&usual));
        for ((found, usual), tolerance) in pairs.zip([5e-4, 5e-4, 0.005]) {
            assert!(
                (found - usual).abs() < tolerance,
                "{pulse_us}: {found}, {usual}"
            );
        }
    }
}

#[test]
fn what_no_servo_takes_is_refused_with_what_to_do() {
    let dir = tempfile::tempdir().unwrap();
    let rig = dir.path().join("rig.toml");
    let init = |options: &[&str]| {
        let mut args = vec!["init", "--yes", "-o", arg(&rig)];
        args.extend(options);
        refusal(&args)
    };
    let said = init(&["--pulse-rate", "560"]);
    assert!(said.contains("wide pulses come at 50 to 333 Hz"), "{said}");
    let said = init(&["--pulses", "500:1000"]);
    assert!(said.contains("--pulse-type narrow"), "{said}");
    for value in ["333Hz", "fast"] {
        let said = init(&["--pulse-rate", value]);
        assert!(said.contains("a number without a unit"), "{said}");
        assert!(!said.contains("float"), "{said}");
    }
    let said = init(&["--neutral", "760"]);
    assert!(said.ends_with("needs --pulse-type narrow\n"), "{said}");
    // No file says that the servo of this port takes narrow pulses, so it would get wide ones.
    let out = dir.path().join("x.csv");
    let narrow = "sim:bench?pulses=narrow";
    let said = refusal(&["capture", "--port", narrow, "--no-rig", "-o", arg(&out)]);
    assert!(
        said.contains("--pulse-type narrow") && !out.exists(),
        "{said}"
    );
    // Written by hand: type and neutral contradict each other.
    std::fs::write(&rig, "[servo]\npulse_type = \"narrow\"\n").unwrap();
    let capture = [
        "capture",
        "--port",
        "sim:bench",
        "--rig",
        arg(&rig),
        "-o",
        "x.csv",
    ];
    let said = refusal(&capture);
    assert!(said.contains("400 to 1100 µs"), "{said}");
}

/// A frequency on the wire counts in frames: the sweep ends at the frequency that was asked for.
#[test]
fn a_sweep_has_its_frequencies_at_every_rate() {
    let dir = tempfile::tempdir().unwrap();
    let (rig, file) = (dir.path().join("rig.toml"), dir.path().join("x.csv"));
    let args = [
        "init",
        "--yes",
        "--port",
        "sim:linear",
        "--pulse-rate",
        "333",
        "-o",
        arg(&rig),
    ];
    run(&args);
    let options = [
        "--reference",
        "sweep",
        "--frequencies",
        "1:1",
        "--length",
        "3",
    ];
    let mut args = vec!["capture", "--rig", arg(&rig), "-o", arg(&file)];
    args.extend(options);
    run(&args);
    let recording = Recording::read(&file).unwrap();
    let neutral = RigFile::default().servo.neutral_us;
    let above: Vec<bool> = recording
        .rows
        .iter()
        .map(|row| row.pulse.0 > neutral)
        .collect();
    let rises = above.windows(2).filter(|pair| !pair[0] && pair[1]).count();
    assert_eq!(rises, 3, "three turns in three seconds");
}
