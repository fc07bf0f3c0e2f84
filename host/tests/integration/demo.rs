//! The whole paper on simulated rigs.

use crate::support::{arg, json, refusal, run};

#[test]
fn the_demo_leaves_everything_and_finds_the_papers_facts() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("demo");
    let text = run(&["demo", "--out", arg(&out)]);
    for word in ["bench", "aircraft", "difference", "paper"] {
        assert!(text.contains(word), "{text}");
    }
    for file in [
        "bench.csv",
        "aircraft.csv",
        "bench.json",
        "aircraft.json",
        "summary.json",
    ] {
        assert!(out.join(file).is_file(), "{file}");
    }
    let plots = std::fs::read_dir(out.join("plots")).unwrap().count();
    assert_eq!(plots, 9, "Figs 4 to 12");
    let summary = json(&out.join("summary.json"));
    // The simulated servos were fitted to the paper with other noise and another structure than
    // this run has: the numbers must come back about as well as a reader takes them off its plots.
    for (fact, tolerance) in [
        ("settles", 8.0),
        ("overshoot", 0.1),
        ("undershoot", 0.1),
        ("over-predicts", 2.0),
    ] {
        let facts = summary["paper"].as_array().unwrap();
        let entry = facts
            .iter()
            .find(|f| f["fact"].as_str().unwrap().contains(fact))
            .unwrap();
        let (paper, here) = (
            entry["paper"].as_f64().unwrap(),
            entry["here"].as_f64().unwrap(),
        );
        assert!(
            (paper - here).abs() <= tolerance,
            "{fact}: paper {paper}, here {here}"
        );
    }
}

#[test]
fn the_demo_replaces_its_own_files_and_nobody_elses() {
    let dir = tempfile::tempdir().unwrap();
    let precious = dir.path().join("bench.csv");
    std::fs::write(&precious, "my recording").unwrap();
    let args = ["demo", "--out", arg(dir.path())];
    assert!(refusal(&args).contains("--force"));
    assert_eq!(std::fs::read_to_string(&precious).unwrap(), "my recording");
    run(&[&args[..], &["--force"]].concat());
    run(&args);
}
