use super::*;
use crate::data::recording::as_toml;
use servoid_protocol::reference::{MAX_STEPS, Steps};
use servoid_protocol::reference::{Staircase, Sweep};
use servoid_protocol::{PulseTrain, Reference};

fn spec(kind: &str) -> ReferenceSpec {
    ReferenceSpec {
        kind: kind.parse().unwrap(),
        ..ReferenceSpec::default()
    }
}

fn resolved(spec: &ReferenceSpec) -> Reference {
    spec.resolve(10.0).unwrap().reference
}

#[test]
fn without_options_references_take_about_ten_seconds_and_stairs_more_at_five_degrees() {
    assert_eq!(
        resolved(&spec("staircase")),
        Reference::Staircase(Staircase::PAPER)
    );
    for kind in ["stairs", "prbs", "sweep", "multisine"] {
        let reference = resolved(&spec(kind));
        assert_eq!(reference.name(), kind);
        assert_eq!(reference.extremes_us(), (-50, 50));
        let length_s = seconds(reference.frames(), PulseTrain::USUAL);
        // Two cycles of 20 strokes of 1.2 s.
        let expected = if kind == "stairs" {
            48.0..=48.0
        } else {
            10.0..=12.0
        };
        assert!(expected.contains(&length_s), "{kind}: {length_s} s");
    }
    let Reference::Prbs(prbs) = resolved(&spec("prbs")) else {
        panic!("it is one")
    };
    assert_eq!((prbs.register, prbs.chips, prbs.seed), (6, 63, 63));
    assert_eq!(prbs.chip_frames, 8);
}

#[test]
fn lengths_and_holds_are_kept_as_nearly_as_whole_cycles_allow() {
    let stairs = ReferenceSpec {
        length_s: Some(20.0),
        hold_s: Some(0.4),
        ..spec("stairs")
    };
    // 20 strokes of 0.4 s are 8 s: two and a half cycles, of which three come as near as two.
    assert_eq!(seconds(resolved(&stairs).frames(), PulseTrain::USUAL), 24.0);
    let prbs = ReferenceSpec {
        length_s: Some(20.0),
        hold_s: Some(0.04),
        ..spec("prbs")
    };
    let Reference::Prbs(prbs) = resolved(&prbs) else {
        panic!("it is one")
    };
    assert_eq!((prbs.chips, prbs.chip_frames, prbs.register), (500, 2, 9));
    let sweep = ReferenceSpec {
        length_s: Some(30.0),
        frequencies_hz: Some("12:1".parse().unwrap()),
        ..spec("sweep")
    };
    assert_eq!(
        resolved(&sweep),
        Reference::Sweep(Sweep {
            amplitude_us: 50,
            first_millihertz: 12_000,
            last_millihertz: 1_000,
            frames: 1500
        })
    );
}

#[test]
fn a_long_multisine_has_its_tones_spread_over_its_frequencies() {
    for length_s in [2.0, 10.0, 60.0, 600.0] {
        let spec = ReferenceSpec {
            length_s: Some(length_s),
            frequencies_hz: Some("0.5:25".parse().unwrap()),
            ..spec("multisine")
        };
        let Reference::Multisine(multisine) = resolved(&spec) else {
            panic!("it is one")
        };
        let period_s = seconds(multisine.period_frames.into(), PulseTrain::USUAL);
        let tones: Vec<f64> = multisine
            .harmonics()
            .map(|harmonic| f64::from(harmonic) / period_s)
            .collect();
        assert!(tones[0] >= 0.5 && tones[0] < 0.5 + 1.0 / period_s);
        let last = tones[tones.len() - 1];
        assert!(
            (24.0..25.0).contains(&last),
            "{length_s} s: up to {last} Hz"
        );
    }
}

#[test]
fn what_does_not_apply_or_cannot_be_is_refused_with_advice() {
    let seed = ReferenceSpec {
        seed: Some(3),
        ..spec("sweep")
    };
    let refusals = [
        (seed, "prbs"),
        (
            ReferenceSpec {
                seed: Some(64),
                ..spec("prbs")
            },
            "1 to 63",
        ),
        (
            ReferenceSpec {
                levels: Some(17),
                ..spec("stairs")
            },
            "2 to 16",
        ),
        (
            ReferenceSpec {
                length_s: Some(5.0),
                ..spec("staircase")
            },
            "7.2 s",
        ),
        (
            ReferenceSpec {
                length_s: Some(1e9),
                ..spec("prbs")
            },
            "1200 s",
        ),
        (
            ReferenceSpec {
                hold_s: Some(0.0),
                ..spec("stairs")
            },
            "0.02",
        ),
        (
            ReferenceSpec {
                amplitude_deg: Some(500.0),
                ..spec("prbs")
            },
            "1000 µs",
        ),
        (
            ReferenceSpec {
                frequencies_hz: Some("0.01:0.02".parse().unwrap()),
                ..spec("multisine")
            },
            "--length",
        ),
        (
            ReferenceSpec {
                frequencies_hz: Some("0:0".parse().unwrap()),
                ..spec("sweep")
            },
            "has to move",
        ),
        (
            ReferenceSpec {
                levels: Some(16),
                amplitude_deg: Some(0.5),
                ..spec("stairs")
            },
            "has to move",
        ),
    ];
    for (spec, advice) in refusals {
        let error = spec.resolve(10.0).unwrap_err().to_string();
        assert!(error.contains(advice), "{spec:?}: {error}");
    }
    assert!("sine".parse::<Kind>().is_err());
    for bad in ["", "5", "1:x", "-1:5", "1:26", "nan:1"] {
        assert!(bad.parse::<FrequencyBand>().is_err(), "{bad}");
    }
}

#[test]
fn a_table_of_steps_is_read_with_its_signs() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("steps.csv");
    let read = |text: &str, length_s| {
        std::fs::write(&path, text).unwrap();
        ReferenceSpec {
            kind: path.display().to_string().parse().unwrap(),
            length_s,
            ..ReferenceSpec::default()
        }
        .resolve(-10.0)
    };
    let resolved = read("angle_deg,hold_s\n5,0.4\n-2.5,0.31\n", Some(5.0)).unwrap();
    let Reference::Steps(steps) = resolved.reference else {
        panic!("it is one")
    };
    let held: Vec<_> = steps.held().map(|s| (s.offset_us, s.hold_frames)).collect();
    assert_eq!((held, steps.repeats), (vec![(-50, 20), (25, 16)], 7));
    assert!(
        resolved.remarks[0].contains("row 2"),
        "{:?}",
        resolved.remarks
    );
    for (text, advice) in [
        ("angle_deg,hold_s\n5,0\n", "row 1"),
        ("angle_deg,hold_s\n5,\n", "seconds"),
        ("angle_deg,hold_s\n500,1\n", "1000 µs"),
        ("angle_deg,hold_s\n0,1\n", "moves nothing"),
        ("angle,hold_s\n5,1\n", "angle_deg"),
    ] {
        let error = read(text, None).unwrap_err().to_string();
        assert!(error.contains(advice), "{text}: {error}");
    }
    let long = "1,1\n".repeat(MAX_STEPS + 1);
    let error = read(&format!("angle_deg,hold_s\n{long}"), None).unwrap_err();
    assert!(error.to_string().contains("19 steps"), "{error}");
}

#[test]
fn a_header_names_the_reference_with_every_number() {
    let text = |reference| toml::to_string(&as_toml(&reference)).unwrap();
    assert_eq!(
        text(resolved(&spec("stairs"))),
        "amplitude_us = 50\ncycles = 2\nhold_frames = 60\nkind = \"stairs\"\nlevels = 5\n"
    );
    let steps =
        [(50, 20), (-50, 10)].map(
            |(offset_us, hold_frames)| servoid_protocol::reference::Step {
                offset_us,
                hold_frames,
            },
        );
    assert_eq!(
        text(Reference::Steps(Steps::new(2, &steps).unwrap())),
        "kind = \"steps\"\nrepeats = 2\nsteps = [[50, 20], [-50, 10]]\n"
    );
}
