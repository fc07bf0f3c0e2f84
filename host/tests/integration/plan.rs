//! Plans from the command line.

use crate::support::{arg, json, refusal, run};

/// The port of a rig is the first thing that somebody tries.
#[test]
fn a_port_is_answered_with_the_option_that_is_meant() {
    let said = refusal(&["plan", "--port", "sim:aircraft?seed=2"]);
    assert!(said.contains("take --servo 'aircraft?seed=2'"), "{said}");
    let said = refusal(&["plan", "--port", "/dev/ttyUSB0"]);
    assert!(said.contains("--model MODEL.json"), "{said}");
}

#[test]
fn a_plan_says_what_a_capture_then_finds() {
    let dir = tempfile::tempdir().unwrap();
    let plots = dir.path().join("plots");
    let out = dir.path().join("plan.json");
    let reference = ["--reference", "prbs", "--length", "8"];
    let planned = run(&[
        &[
            "plan",
            "--servo",
            "linear",
            "--band",
            "0.3",
            "--plots",
            arg(&plots),
            "-o",
            arg(&out),
        ],
        &reference[..],
    ]
    .concat());
    assert!(
        planned.contains("prbs") && planned.contains("hysteresis"),
        "{planned}"
    );
    assert!(
        std::fs::read_to_string(plots.join("plan-prbs.svg"))
            .unwrap()
            .contains("</svg>")
    );
    let plan = json(&out);
    assert_eq!(plan["reference"]["kind"], "prbs");
    assert_eq!(plan["alternatives"].as_array().unwrap().len(), 5);
    assert!(plan["needed"]["runs"].as_u64().unwrap() >= 1);

    let file = dir.path().join("run.csv");
    run(&[
        &[
            "capture",
            "--port",
            "sim:linear?seed=9",
            "-o",
            arg(&file),
            "--quiet",
        ],
        &reference[..],
    ]
    .concat());
    let found = run(&["identify", arg(&file), "--json", "--quiet"]);
    let found: serde_json::Value = serde_json::from_str(&found).unwrap();
    let widths = |side: &str| -> Vec<f64> {
        let list = found["step"]["bounds"]["simultaneous"][side]
            .as_array()
            .unwrap();
        list.iter().map(|number| number.as_f64().unwrap()).collect()
    };
    let (lower, upper) = (widths("lower"), widths("upper"));
    let mean = upper.iter().zip(&lower).map(|(u, l)| u - l).sum::<f64>() / 2.0 / upper.len() as f64;
    let ratio = plan["band"]["mean_percent"].as_f64().unwrap() / (100.0 * mean);
    // The plan's noise was itself found from one run, and so is the width: each to some 10 % in coloured
    // noise.
    assert!((0.7..1.4).contains(&ratio), "{ratio}");
}

#[test]
fn a_model_is_what_is_assumed() {
    let dir = tempfile::tempdir().unwrap();
    let (file, model) = (dir.path().join("x.csv"), dir.path().join("x.json"));
    run(&["simulate", "--servo", "aircraft", "-o", arg(&file)]);
    run(&["identify", arg(&file), "-o", arg(&model), "--quiet"]);
    let plan = |noise: &str| -> serde_json::Value {
        let args = ["plan", "--model", arg(&model), "--noise", noise, "--json"];
        serde_json::from_str(&run(&args)).unwrap()
    };
    let (quiet, loud) = (plan("0.01"), plan("0.05"));
    assert_eq!(quiet["noise_deg"], 0.01);
    let width = |plan: &serde_json::Value| plan["band"]["widest_percent"].as_f64().unwrap();
    // Five times the noise, and a settling time that is then seen for a little shorter.
    let ratio = width(&loud) / width(&quiet);
    assert!((4.0..5.5).contains(&ratio), "{ratio}");
}

#[test]
#[ignore = "ten seconds: cargo test -p servoid --test integration -- --ignored the_table_of_references"]
fn the_table_of_references_shows_what_they_give_on_a_servo_that_is_not_linear() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("plan.json");
    let reference = ["--reference", "prbs", "--hold", "0.04"];
    let text = run(&[&["plan", "-o", arg(&out), "-q"], &reference[..]].concat());
    assert!(text.contains("step band   none"), "{text}");
    assert!(!text.contains("expected interval"), "{text}");
    assert!(!text.contains("this recording"), "{text}");
    let plan = json(&out);
    assert!(plan["band"].is_null() && plan["metrics"].is_null());
    let all = plan["alternatives"].as_array().unwrap();
    let widths: Vec<f64> = all
        .iter()
        .map(|line| {
            line["widest_percent_in_a_minute"]
                .as_f64()
                .unwrap_or(f64::INFINITY)
        })
        .collect();
    assert!(widths.is_sorted(), "{widths:?}");
    let names: Vec<_> = all
        .iter()
        .map(|line| line["reference"].as_str().unwrap())
        .collect();
    // On the bench servo sines give a twentieth of what they give on a linear one, or no bounds at all.
    for sines in ["sweep", "multisine"] {
        let line = &all[names.iter().position(|name| *name == sines).unwrap()];
        let width = line["widest_percent"].as_f64();
        assert!(width.is_none_or(|percent| percent > 15.0), "{line}");
    }
    assert!(["prbs", "staircase"].contains(&names[0]), "{names:?}");
}

/// A capture names the runs that its noise alone takes, which are no more than those that the plan tries, and both agree on when more runs are no advice.
#[test]
#[ignore = "three seconds: cargo test -p servoid --test integration -- --ignored nobody_is_asked"]
fn nobody_is_asked_to_record_thousands_of_runs() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let captured = |band: &str| {
        let args = ["capture", "--port", "sim:linear", "--until-band", band];
        run(&[&args[..], &["-q", "--force", "-o", arg(&file)]].concat())
    };
    let planned = |band: &str| run(&["plan", "--servo", "linear", "--band", band]);
    for reported in [captured("0.01"), planned("0.01")] {
        assert!(reported.contains("more than 100 such runs"), "{reported}");
        assert!(reported.contains("--amplitude"), "{reported}");
    }
    let runs = |reported: &str, before: &str, after: &str| -> f64 {
        let (_, rest) = reported.split_once(before).expect(before);
        rest.split_once(after)
            .expect(after)
            .0
            .trim()
            .parse()
            .unwrap()
    };
    let of_noise = runs(&captured("0.2"), "by its noise alone", "such runs");
    let ratio = of_noise / runs(&planned("0.2"), "for ±0.2 %", "runs");
    // The scatter of runs and slow ends that some of them show widen a band by up to a half, and runs go with its square.
    assert!((0.4..=1.0).contains(&ratio), "{ratio}");
}

#[test]
fn what_cannot_be_planned_is_said_in_a_sentence() {
    let dir = tempfile::tempdir().unwrap();
    let (file, other) = (dir.path().join("x.csv"), dir.path().join("x.json"));
    // Sampled every 20 ms, which no rig does.
    let rows: String = (0..400)
        .map(|k: i32| {
            let step = |k: i32| k.rem_euclid(80) / 40;
            format!("{},{}.{}\n", step(k), step(k - 2), k * 7 % 10)
        })
        .collect();
    std::fs::write(&file, format!("u,y\n{rows}")).unwrap();
    let columns = ["--input", "u", "--output", "y", "--period", "0.02", "-q"];
    run(&[&["identify", arg(&file), "-o", arg(&other)], &columns[..]].concat());
    for (options, advice) in [
        (&["--noise", "0"][..], "--noise"),
        (&["--level", "2"], "--level"),
        (
            &["--reference", "prbs", "--length", "0.1"],
            "could not be identified",
        ),
        (&["--model", "missing.json"], "missing.json"),
        (&["--model", arg(&other)], "servoid capture"),
        (&["--servo", "boat"], "boat"),
    ] {
        let said = refusal(&[&["plan"], options].concat());
        assert!(said.contains(advice), "{options:?}: {said}");
    }
}

/// Recordings of such a servo have noise alone, and the sensor is not to blame.
#[test]
fn a_servo_that_the_strokes_do_not_move_is_named() {
    let said = refusal(&["plan", "--servo", "bench?stops-deg=-0.01:0.01"]);
    assert!(
        said.contains("friction, a dead band or a stop") && said.contains("--amplitude"),
        "{said}"
    );
    assert!(!said.contains("sensor"), "{said}");
    let said = refusal(&["plan", "--servo", "bench", "--controller", "3"]);
    assert!(said.contains("has no controllers"), "{said}");
}

#[test]
fn strokes_into_a_stop_of_the_servo_are_named_with_the_amplitude_that_avoids_it() {
    let servo = "bench?stops-deg=-30:4";
    let said = run(&[
        "plan",
        "-q",
        "--servo",
        servo,
        "--reference",
        "stairs",
        "--amplitude",
        "20",
        "--hold",
        "0.5",
        "--servo-model",
    ]);
    let said: String = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("runs into the stop at 4.000 deg"), "{said}");
    assert!(said.contains("take --amplitude 4 or less"), "{said}");
    assert!(said.contains("- take strokes between the stops"), "{said}");
    assert!(!said.contains("longer holds, so that noise"), "{said}");
    let said = run(&[
        "plan",
        "-q",
        "--servo",
        servo,
        "--reference",
        "staircase",
        "--amplitude",
        "3.9",
    ]);
    assert!(!said.contains("stop at"), "{said}");
}
