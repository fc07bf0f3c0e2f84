//! The report as a file: what it holds, and what must not get into it.

use crate::support::{arg, data, refusal, run, servoid};

/// The JSON in the element with this id.
pub fn embedded(page: &str, id: &str) -> serde_json::Value {
    let start = format!("<script type=\"application/json\" id=\"{id}\">");
    let (_, rest) = page.split_once(&start).expect("the element is there");
    let (text, _) = rest.split_once("</script>").expect("it ends");
    serde_json::from_str(text).expect("it is JSON")
}

/// A recording of a simulated rig with another servo, written by 'capture' itself.
fn recording(dir: &std::path::Path, name: &str, servo: &str, notes: &str) -> std::path::PathBuf {
    let file = dir.join(name);
    run(&[
        "capture",
        "--quiet",
        "--port",
        &format!("sim:{servo}"),
        "--notes",
        notes,
        "--condition",
        "on the desk",
        "-o",
        arg(&file),
    ]);
    file
}

#[test]
fn a_hostile_recording_stays_text_and_the_model_is_in_the_page() {
    let dir = tempfile::tempdir().unwrap();
    let hostile =
        "</script><script>document.title='owned'</script><img src=x onerror=alert(1)>{{library}}";
    let file = recording(dir.path(), "x.csv", "linear", hostile);
    let (out, model) = (dir.path().join("x.html"), dir.path().join("x.json"));
    run(&["identify", "--quiet", arg(&file), "-o", arg(&model)]);
    run(&[
        "report",
        "--quiet",
        arg(&file),
        "-o",
        arg(&out),
        "--title",
        hostile,
    ]);
    let page = std::fs::read_to_string(&out).unwrap();
    assert!(page.len() < 8_000_000, "{} bytes", page.len());
    assert!(!page.contains("<script>document.title") && !page.contains("<img src=x"));
    // Figures, models, the library and the page's own: nothing else opens or closes a script.
    assert_eq!(page.matches("</script>").count(), 4);
    assert!(page.contains("&lt;img src=x onerror=alert(1)&gt;{{library}}"));
    assert_eq!(embedded(&page, "models")[0], crate::support::json(&model));
    for fact in [
        "complete",
        "firmware",
        "sample period s",
        "staircase",
        "degrees per count",
    ] {
        assert!(page.contains(fact), "{fact}");
    }
}

#[test]
fn runs_on_both_sides_are_compared_and_every_figure_of_the_paper_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let runs = |servo: &str| -> Vec<std::path::PathBuf> {
        (0..2)
            .map(|k| {
                let name = format!("{servo}{k}.csv");
                recording(
                    dir.path(),
                    &name,
                    &format!("{servo}?scatter=all&seed={k}"),
                    "",
                )
            })
            .collect()
    };
    let (a, b, out) = (runs("bench"), runs("aircraft"), dir.path().join("x.html"));
    let sides = ["--a", arg(&a[0]), arg(&a[1]), "--b", arg(&b[0]), arg(&b[1])];
    run(&[
        &["report", "-q", "-o", arg(&out), "--margin", "4"],
        &sides[..],
    ]
    .concat());
    let page = std::fs::read_to_string(&out).unwrap();
    assert!(page.len() < 8_000_000, "{} bytes", page.len());
    for number in 4..=12 {
        assert!(
            page.contains(&format!("Fig. {number} of the paper: ")),
            "Fig. {number}"
        );
    }
    assert!(page.contains("<b>different</b>") && page.contains("margin 4 %"));
    let figures = embedded(&page, "figures");
    let names: Vec<&str> = figures
        .as_array()
        .unwrap()
        .iter()
        .map(|figure| figure["name"].as_str().unwrap())
        .collect();
    for name in [
        "difference",
        "structure-first",
        "residuals-second",
        "runs-first",
        "runs-second",
    ] {
        assert!(names.contains(&name), "{names:?}");
    }
}

#[test]
fn a_stranger_gets_to_the_report_by_what_the_program_says() {
    let dir = tempfile::tempdir().unwrap();
    let mine = dir.path().join("mine.csv");
    std::fs::copy(data("dcmotor_speed_prbs.csv"), &mine).unwrap();
    let reported = refusal(&["identify", arg(&mine)]);
    let (_, options) = reported.split_once("add: ").expect("it says what to add");
    assert!(options.starts_with("--input u --output y"), "{reported}");
    let options = options.trim().replace("SECONDS", "0.02");
    let words: Vec<&str> = options.split(' ').collect();
    let output = servoid(&[&["identify", arg(&mine)], &words[..]].concat())
        .output()
        .unwrap();
    assert!(output.status.success());
    let reported = String::from_utf8(output.stdout).unwrap();
    let (_, command) = reported
        .split_once("next: servoid report ")
        .expect("it says how to go on");
    let words: Vec<&str> = command.lines().next().unwrap().split(' ').collect();
    let output = servoid(&[&["report"], &words[..]].concat())
        .current_dir(dir.path())
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(dir.path().join("mine.html").is_file());
}

#[test]
fn three_runs_of_one_servo_are_said_to_be_one_side() {
    let said = refusal(&["report", "a.csv", "b.csv", "c.csv", "-o", "x.html"]);
    assert!(
        said.contains("servoid report --a a.csv b.csv c.csv -o"),
        "{said}"
    );
    let said = refusal(&["compare", "a.csv", "b.csv", "c.csv"]);
    assert!(
        said.contains("servoid identify a.csv b.csv c.csv"),
        "{said}"
    );
}
