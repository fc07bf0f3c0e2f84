//! A recording that is held against itself is noticed, whatever it is called and however it is written.

use crate::support::{arg, run};

#[test]
fn the_same_samples_are_known_again_under_another_name() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| arg(&dir.path().join(name)).to_owned();
    let (one, copy, other) = (at("one.csv"), at("copy.csv"), at("other.csv"));
    run(&["simulate", "--servo", "linear", "-o", &one]);
    run(&["simulate", "--servo", "linear", "--seed", "2", "-o", &other]);
    std::fs::copy(&one, &copy).unwrap();
    let (model, twin) = (at("one.json"), at("twin.json"));
    run(&["identify", "-q", &one, "-o", &model]);
    run(&["identify", "-q", &copy, "-o", &twin]);

    // The columns of a recording as another program would write them.
    let text = std::fs::read_to_string(&one).unwrap();
    let bare: String = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.replace(',', ";") + "\r\n")
        .collect();
    let (foreign, twice) = (at("foreign.csv"), at("twice.csv"));
    std::fs::write(&foreign, &bare).unwrap();
    std::fs::write(&twice, bare.replace("\r\n", "\n")).unwrap();

    let noticed = "Both sides have the same samples";
    for (args, expected) in [
        (vec!["compare", &one, &one], true),
        (vec!["compare", &one, &copy], true),
        (vec!["compare", &model, &twin], true),
        (vec!["compare", &one, &other], false),
    ] {
        let printed = run(&[&args[..], &["-q"]].concat()).replace("\n    ", " ");
        // It is said before the verdict, which means nothing then.
        let beginning = printed.split("\n\n").nth(1).unwrap_or_default();
        assert_eq!(
            beginning.starts_with(noticed),
            expected,
            "{args:?}: {printed}"
        );
        let of = match args[1].ends_with(".json") {
            true => "of these models",
            false => "of these recordings",
        };
        assert!(printed.contains(of), "{args:?}: {printed}");
    }
    let columns = ["--input", "reference_deg", "--output", "position_deg", "-q"];
    let printed = run(&[&["compare", &foreign, &twice], &columns[..]].concat());
    assert!(
        printed.replace("\n    ", " ").contains(noticed),
        "{printed}"
    );

    let seen = "identified from these very samples";
    for (file, expected) in [(&one, true), (&copy, true), (&other, false)] {
        let printed = run(&["validate", &model, file, "-q"]);
        assert_eq!(printed.contains(seen), expected, "{file}: {printed}");
    }
    let printed = run(&["identify", &one, &copy, "-q"]);
    assert!(
        printed.contains("repeat the samples of another one"),
        "{printed}"
    );
}
