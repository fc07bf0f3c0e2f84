use super::*;
use servoid_identification::Run;

fn write(dir: &Path, name: &str, text: &str) -> PathBuf {
    let path = dir.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn fault_of(loaded: Result<Dataset<'static>, DatasetError>) -> DatasetFault {
    match loaded.unwrap_err() {
        DatasetError::File(file) => file.fault,
        other => panic!("{other}"),
    }
}

fn named() -> DatasetOptions {
    DatasetOptions {
        input: Some("u".into()),
        output: Some("y".into()),
        ..DatasetOptions::default()
    }
}

#[test]
fn runs_are_kept_apart_and_the_period_is_found() {
    let dir = tempfile::tempdir().unwrap();
    let path = write(
        dir.path(),
        "a.csv",
        "t,u,y,run\n0,1,2,1\n.02,2,3,1\n.04,1,,1\n0,5,6,2\n.02,7,8,2\n",
    );
    let options = DatasetOptions {
        run: Some("run".into()),
        at_rest: Some(0.0),
        ..named()
    };
    // One of four steps is the restart: not even enough for a column of time.
    let fault = fault_of(load(std::slice::from_ref(&path), &options));
    assert!(matches!(fault, DatasetFault::UnevenTime(..)));
    let options = DatasetOptions {
        period_s: Some(0.02),
        ..options
    };
    let again = dir.path().join("b.csv");
    std::fs::copy(&path, &again).unwrap();
    let fault = fault_of(load(&[path.clone(), path.clone()], &options));
    assert!(matches!(fault, DatasetFault::Twice));
    let set = load(&[path, again], &options).unwrap();
    let lengths: Vec<_> = set.record.runs().iter().map(Run::len).collect();
    assert_eq!(lengths, [3, 2, 3, 2]);
    assert_eq!(set.record.missing(), 2);
    assert_eq!(set.record.runs()[1].input_at_rest(), Some(0.0));
}

#[test]
fn an_even_column_of_time_gives_the_period() {
    let dir = tempfile::tempdir().unwrap();
    let rows: String = (0..100)
        .map(|k| format!("{:.2},{},{}\n", 0.02 * f64::from(k), k % 7, k % 5))
        .collect();
    let path = write(dir.path(), "a.csv", &format!("t,u,y\n{rows}"));
    let set = load(&[path], &named()).unwrap();
    assert_eq!(set.record.sample_period_s(), 0.02);
    assert_eq!(set.about.remarks.len(), 1);
}

#[test]
fn rows_that_are_missing_are_not_closed_up() {
    let dir = tempfile::tempdir().unwrap();
    let rows: String = (0..200)
        .filter(|k| !(50..70).contains(k))
        .map(|k| format!("{:.2},{},{}\n", 0.02 * f64::from(k), k % 7, k % 5))
        .collect();
    let path = write(dir.path(), "a.csv", &format!("t,u,y\n{rows}"));
    let set = load(&[path], &named()).unwrap();
    assert_eq!((set.record.samples(), set.record.missing()), (200, 20));
    assert!(
        set.about.remarks.iter().any(|r| r.contains("20 samples")),
        "{:?}",
        set.about.remarks
    );
}

#[test]
fn columns_that_are_not_named_are_asked_for() {
    let dir = tempfile::tempdir().unwrap();
    let path = write(dir.path(), "a.csv", "t,u,y\n0,1,2\n");
    let error = load(&[path], &DatasetOptions::default())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("--input") && error.contains("t, u, y"),
        "{error}"
    );
}

#[test]
fn a_period_in_milliseconds_is_refused_where_the_column_of_time_shows_it() {
    let dir = tempfile::tempdir().unwrap();
    let rows: String = (0..100)
        .map(|k| format!("{:.3},{},{}\n", 0.005 * f64::from(k), k % 7, k % 5))
        .collect();
    let with = |head: &str, period_s: f64| {
        let path = write(dir.path(), "a.csv", &format!("{head},u,y\n{rows}"));
        let options = DatasetOptions {
            period_s: Some(period_s),
            ..named()
        };
        load(&[path], &options)
    };
    for head in ["t", "time_s"] {
        let refused = with(head, 5.0).unwrap_err().to_string();
        assert!(
            refused.contains("rows 0.005 s apart") && refused.contains("--period 5 says 5 s"),
            "{refused}"
        );
    }
    // A little off is a remark, and the period that was stated is taken.
    let near = with("time_s", 0.0051).unwrap();
    assert_eq!(near.record.sample_period_s(), 0.0051);
    // A column without a unit may be one of milliseconds.
    assert!(with("t", 5e-6).is_ok());
}

#[test]
fn a_column_that_seems_to_name_controllers_is_pointed_at_until_it_is_used() {
    let dir = tempfile::tempdir().unwrap();
    let rows = "0,1,2,400\n.02,2,3,400\n.04,1,2,800\n.06,5,6,800\n.08,7,8,800\n";
    let path = write(dir.path(), "a.csv", &format!("t,u,y,kp\n{rows}"));
    let remarks = |options: &DatasetOptions| {
        let found = load(std::slice::from_ref(&path), options).unwrap();
        found.about.remarks.join("\n")
    };
    let said = remarks(&named());
    assert!(
        said.contains("\"kp\" has the values 400, 800") && said.contains("--controller kp"),
        "{said}"
    );
    let used = DatasetOptions {
        controller: Some("kp".into()),
        ..named()
    };
    assert!(!remarks(&used).contains("--controller"));
}

/// The pulses are in a recording of servoid; what other programs write may have been rounded.
#[test]
fn commands_of_recordings_of_servoid_alone_are_exact() {
    let dir = tempfile::tempdir().unwrap();
    let is_exact = |path: PathBuf, options: &DatasetOptions| {
        let set = load(&[path], options).unwrap();
        set.record.runs().iter().all(Run::has_exact_input)
    };
    let table = write(dir.path(), "a.csv", "u,y\n0,1\n1,2\n0,1\n1,3\n");
    let options = DatasetOptions {
        period_s: Some(0.02),
        ..named()
    };
    assert!(!is_exact(table, &options));
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    for format in ["recording-format-1.csv", "recording-format-4.csv"] {
        assert!(is_exact(data.join(format), &DatasetOptions::default()));
    }
}
