//! Recordings of other programs: what is certain is read, and said; what is not is asked.

use crate::support::{arg, refusal, run, servoid};
use std::path::Path;

/// Command and answer of a servo of first order, sampled every 2 ms.
fn samples() -> Vec<(u32, f64, f64)> {
    let mut y = -5.0;
    (0..1500)
        .map(|k| {
            let u = if k * k / 9000 % 2 == 0 { 5.0 } else { -5.0 };
            y += 0.15 * (u - y);
            let noise = f64::from(k * 7919 % 101) / 50.0 - 1.0;
            (k, u, y + 0.01 * noise)
        })
        .collect()
}

/// A file with this above its rows, each row as `row` writes it.
fn file(dir: &Path, name: &str, above: &str, row: impl Fn(u32, f64, f64) -> String) -> String {
    let rows: String = samples()
        .into_iter()
        .map(|(k, u, y)| row(k, u, y))
        .collect();
    let path = dir.join(name);
    std::fs::write(&path, format!("{above}{rows}")).unwrap();
    arg(&path).to_owned()
}

/// Identifies, and returns the gain, the sampling period and what was said.
fn identified(file: &str, more: &[&str]) -> (f64, f64, String) {
    let args = [&["identify", file, "--settling", "81", "--json"], more].concat();
    let output = servoid(&args).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{args:?}: {said}");
    let model: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let gain = number(&model["metrics"]["dc_gain"]["value"]);
    (gain, number(&model["sample_period_s"]), said)
}

const NAMED: [&str; 4] = ["--input", "u", "--output", "y"];

/// What is changed of a user's data stays in what is printed with -q, and in the JSON.
#[test]
fn data_that_are_used_otherwise_than_written_are_named_in_quiet_results() {
    let dir = tempfile::tempdir().unwrap();
    let wrapped = file(dir.path(), "wrapped.csv", "u,y\n", |_, u, y| {
        format!("{u},{:.6}\n", y.rem_euclid(360.0))
    });
    let args = [
        &["identify", "-q", &wrapped, "--period", "0.002"][..],
        &NAMED,
    ]
    .concat();
    let said = run(&args);
    assert!(said.contains("it is put together"), "{said}");
    let model = run(&[&args[..], &["--json"]].concat());
    assert!(model.contains("\"changed_data\""), "{model}");
}

/// Findings on the record, whose numbers are of the position, and a gain between two units.
#[test]
fn numbers_of_findings_have_the_units_of_the_file() {
    let dir = tempfile::tempdir().unwrap();
    let said = |name: &str, unit: &str, of: fn(f64) -> f64| {
        let above = format!("u_deg,y_{unit}\n");
        let file = file(dir.path(), name, &above, |_, u, y| {
            format!("{u},{:.6}\n", of(y))
        });
        let output = ["--input", "u_deg", "--output", &format!("y_{unit}")];
        let period = ["--period", "0.002"];
        run(&[&["identify", "-q", &file][..], &output, &period].concat())
    };
    let coarse = said("coarse.csv", "deg", |y| (2.0 * y).round() / 2.0);
    assert!(
        coarse.contains("The sensor's steps of 0.50 deg are larger"),
        "{coarse}"
    );
    let radians = said("radians.csv", "rad", f64::to_radians);
    // A gain of 1 deg/deg, which three decimals would hide.
    assert!(radians.contains(" ends at 0.0174"), "{radians}");
}

/// A servo that rests 3 degrees off: a finding on a file is among the results, and not before them as well.
#[test]
fn a_finding_on_a_file_is_printed_once() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("off.csv");
    let mut lagged = -10.0;
    let row = |k: u32| {
        let command = if (k / 100).is_multiple_of(2) {
            -10.0
        } else {
            10.0
        };
        lagged += 0.2 * (command - lagged);
        let noise = f64::from(k * 7919 % 101) / 1000.0 - 0.05;
        format!("{command},{:.4}\n", lagged + 3.0 + noise)
    };
    let rows: String = (0..3000).map(row).collect();
    let text = format!("u_deg,y_deg\n{rows}");
    std::fs::write(&file, text).unwrap();
    let identify = [
        "identify",
        arg(&file),
        "--input",
        "u_deg",
        "--output",
        "y_deg",
    ];
    let output = servoid(&[&identify[..], &["--period", "0.005"]].concat())
        .output()
        .unwrap();
    let printed = [output.stderr, output.stdout].map(|bytes| String::from_utf8(bytes).unwrap());
    let printed = printed.concat();
    assert_eq!(
        printed.matches("The servo rests +3.0").count(),
        1,
        "{printed}"
    );
}

/// Rows of a servo of first order under steps of random levels, as a logger writes them in whole milliseconds: `rest` is where it comes to rest
/// under a command, and the noise is that of `seed`.
fn logged(seed: u32, rest: fn(f64) -> f64) -> String {
    let mut y = 0.0;
    let row = |k: u32| {
        let mixed = (k / 60).wrapping_mul(2_654_435_761).wrapping_add(seed) >> 7;
        let command = [-25.0, -12.0, 0.0, 10.0, 20.0, 30.0][mixed as usize % 6];
        y += 0.15 * (rest(command) - y);
        let noise = f64::from((k + seed) * 7919 % 101) / 500.0 - 0.1;
        let stamp = 10 * k + (k * 7919 + seed) % 3;
        format!("{stamp},{command},{:.3}\n", y + noise)
    };
    let rows: String = (0..1500 + seed).map(row).collect();
    format!("time_ms,u_deg,y_deg\n{rows}")
}

const IN_DEGREES: [&str; 4] = ["--input", "u_deg", "--output", "y_deg"];

#[test]
fn two_files_of_one_logger_have_one_period() {
    let dir = tempfile::tempdir().unwrap();
    let [a, b] = [17, 940].map(|seed| {
        let path = dir.path().join(format!("{seed}.csv"));
        std::fs::write(&path, logged(seed, |command| command)).unwrap();
        arg(&path).to_owned()
    });
    let linear = [&["--no-servo-model"], &IN_DEGREES[..]].concat();
    let found = run(&[&["compare", "-q", &a, &b][..], &linear].concat());
    assert!(found.contains("  verdict  "), "{found}");
    let both = run(&[&["identify", "-q", &a, &b][..], &linear].concat());
    assert!(both.contains(", every 10 ms"), "{both}");
}

#[test]
fn a_servo_that_falls_short_of_its_commands_is_said_to() {
    let dir = tempfile::tempdir().unwrap();
    let said = |name: &str, rest: fn(f64) -> f64| {
        let path = dir.path().join(name);
        std::fs::write(&path, logged(5, rest)).unwrap();
        run(&[&["identify", "-q", arg(&path)][..], &IN_DEGREES].concat())
    };
    // A spring.
    let loaded = said("loaded.csv", |command| 0.76 * command);
    let sentence = "Commanded +30 deg the servo comes to rest at 22.8 deg, and commanded -25 deg at -19.0 deg.";
    let first = loaded.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(first.contains(sentence), "{loaded}");
    assert!(
        first.find(sentence) < first.find("DC gain"),
        "it is no first line: {loaded}"
    );
    let grows = "Between the two it falls short by 13.2 deg, which zeros that are off do not make. 13.2 deg of that grows with the command: look at the scale";
    assert!(first.contains(grows), "{loaded}");
    assert!(
        !first.contains("changes with the direction of the stroke: look"),
        "{loaded}"
    );
    for (name, rest) in [
        ("free.csv", (|command| command) as fn(f64) -> f64),
        ("off.csv", |command| command - 3.0),
    ] {
        let free = said(name, rest);
        assert!(!free.contains("Commanded +30"), "{name}: {free}");
    }
}

/// Rows of 10 ms of random levels behind a filter, each new after so many rows, and of a servo of first order: shares of what is left that both go in a row.
fn filtered_levels((filter, servo): (f64, f64), held: u32) -> String {
    let mut states = [0.0; 3];
    let row = |k: u32| {
        let noise = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 8) / 8_388_608.0 - 1.0;
        states[0] += filter * (60.0 * noise(k / held) - states[0]);
        states[1] += filter * (states[0] - states[1]);
        let command = (1e3 * states[1]).round() / 1e3;
        states[2] += servo * (command - states[2]);
        let off = 0.05 * noise(k + 77_777);
        format!("{},{command:.3},{:.3}\n", 10 * k, states[2] + off)
    };
    (0..3000).map(row).collect()
}

/// Of a response without bounds nothing is said, as of the second: errors of it may move faster than the servo.
#[test]
fn a_recording_without_steps_says_for_which_steps_it_stands() {
    let dir = tempfile::tempdir().unwrap();
    let said = |name: &str, rows: &str| {
        let path = dir.path().join(name);
        std::fs::write(&path, format!("time_ms,u_deg,y_deg\n{rows}")).unwrap();
        run(&[
            &["identify", "-q", "--no-servo-model", arg(&path)][..],
            &IN_DEGREES,
        ]
        .concat())
    };
    let words = "This recording is not one of steps: in 99 % of it the servo moves no faster, ";
    let smooth = said("smooth.csv", &filtered_levels((0.3, 0.05), 20));
    assert!(smooth.contains(words), "{smooth}");
    let stick = said("stick.csv", &filtered_levels((0.3, 0.1), 5));
    assert!(
        stick.contains("NO BOUNDS") && !stick.contains(words),
        "{stick}"
    );
    let steps = dir.path().join("steps.csv");
    std::fs::write(&steps, logged(5, |command| command)).unwrap();
    let said = run(&[
        &["identify", "-q", "--no-servo-model", arg(&steps)][..],
        &IN_DEGREES,
    ]
    .concat());
    assert!(!said.contains("is not one of steps"), "{said}");
}

#[test]
fn what_other_programs_write_is_read_and_said() {
    let dir = tempfile::tempdir().unwrap();
    let new = |name: &str, above: &str, row: &dyn Fn(u32, f64, f64) -> String| {
        file(dir.path(), name, above, row)
    };
    let milliseconds = |k: u32| 2 * k;
    let comma = |x: f64| format!("{x:.4}").replace('.', ",");
    let said_ms = "time (column \"time_ms\") read as milliseconds: rows are 2.000 ms apart";
    let cases: Vec<(String, Vec<&str>, &str)> = vec![
        (
            new("ms.csv", "time_ms,u,y\n", &|k, u, y| {
                format!("{},{u},{y:.4}\n", milliseconds(k))
            }),
            vec![],
            said_ms,
        ),
        (
            new("us.csv", "t,u,y\n", &|k, u, y| {
                format!("{},{u},{y:.4}\n", 2000 * k)
            }),
            vec!["--time-unit", "us"],
            "read as microseconds: rows are 2.000 ms apart",
        ),
        (
            new("bom.csv", "\u{feff}Time [ms];u;y\r\n", &|k, u, y| {
                format!("{};{};{}\r\n", milliseconds(k), comma(u), comma(y))
            }),
            vec![],
            "column \"Time [ms]\"",
        ),
        (
            new(
                "tabs.txt",
                "Logger 3000\nRate\t500\n\nt\tu\ty\ns\tdeg\tdeg\n",
                &|k, u, y| {
                    format!(
                        "{}\t{}\t{}\n",
                        comma(0.002 * f64::from(k)),
                        comma(u),
                        comma(y)
                    )
                },
            ),
            vec![],
            "2 lines above its header row are passed over",
        ),
        (
            new("dropped.csv", "t,u,y\n", &|k, u, y| match k % 300 {
                4 => String::new(),
                7 => format!("{:.3},{u},NaN\n", 0.002 * f64::from(k)),
                _ => format!("{:.3},{u},{y:.4}\n", 0.002 * f64::from(k)),
            }),
            vec![],
            "has gaps; 5 samples count as missing",
        ),
        (
            new("jitter.csv", "time_s,u,y\n", &|k, u, y| {
                let late = f64::from(k * 7919 % 101) / 101.0 * 0.0008;
                format!("{:.6},{u},{y:.4}\n", 0.002 * f64::from(k) + late)
            }),
            vec![],
            "taken as evenly spaced",
        ),
        (
            new("bare.csv", "", &|k, u, y| {
                format!("{:.3},{u},{y:.4}\n", 0.002 * f64::from(k))
            }),
            vec!["--input", "2", "--output", "3", "--period", "0.002"],
            "its columns are called 1 to 3",
        ),
        (
            new(
                "units.csv",
                "time (us),Command [deg],Angle [deg]\n",
                &|k, u, y| format!("{},{u},{y:.4}\n", 2000 * k),
            ),
            vec!["--input", "command", "--output", "angle"],
            "read as microseconds",
        ),
    ];
    for (file, more, expected) in &cases {
        let named = if more.contains(&"--input") {
            &[][..]
        } else {
            &NAMED
        };
        let (gain, period, said) = identified(file, &[named, more].concat());
        assert!(
            (gain - 1.0).abs() < 0.01 && (period / 0.002 - 1.0).abs() < 1e-3,
            "{file}: {gain}, {period}"
        );
        assert!(said.contains(expected), "{file}: {said}");
    }
}

#[test]
fn other_languages_and_letters_are_read_and_units_reach_the_results() {
    let dir = tempfile::tempdir().unwrap();
    let rows = |row: &dyn Fn(u32, f64, f64) -> String| -> String {
        samples()
            .into_iter()
            .map(|(k, u, y)| row(k, u, y))
            .collect()
    };
    let text = rows(&|k, u, y| format!("{};{u};{y:.4}\n", 2 * k));
    let write = |name: &str, above: &[u8]| {
        let path = dir.path().join(name);
        std::fs::write(&path, [above, text.as_bytes()].concat()).unwrap();
        arg(&path).to_owned()
    };
    // Latin-1: 0xE4 is a umlaut, 0xB0 the degree sign, 0xB5 micro.
    let german = write("german.csv", b"Zeit [ms];Soll;Winkel\n");
    let latin = write("latin.csv", b"Zeit;Soll;Winkel\nms;\xB5s;\xB0\n");
    let named = write("named.csv", b"Z\xE4hler_ms;Soll [counts];Winkel [V]\n");
    let columns = ["--input", "Soll", "--output", "Winkel"];
    let clock = ["--time", "Zähler_ms"];
    for (file, more, unit) in [
        (&german, &[][..], ""),
        (&latin, &[], "°/µs"),
        (&named, &clock, "V/counts"),
    ] {
        let (gain, period, said) = identified(file, &[&columns[..], more].concat());
        assert!((gain - 1.0).abs() < 0.01 && (period / 0.002 - 1.0).abs() < 1e-3);
        assert!(said.contains("rows are 2.000 ms apart"), "{said}");
        let plots = dir.path().join("plots");
        let args = [
            &[
                "identify",
                "-q",
                file,
                "--settling",
                "81",
                "--force",
                "--plots",
                arg(&plots),
            ],
            &columns[..],
            more,
        ];
        let output = servoid(&args.concat()).output().unwrap();
        let printed = String::from_utf8(output.stdout).unwrap();
        let line = printed
            .lines()
            .find(|line| line.contains("DC gain"))
            .unwrap();
        assert!(line.contains(unit), "{file}: {line}");
        let stem = Path::new(file).file_stem().unwrap().to_str().unwrap();
        let plot =
            |what: &str| std::fs::read_to_string(plots.join(format!("{stem}-{what}.svg"))).unwrap();
        if let Some((output, input)) = unit.split_once('/') {
            for axis in [
                format!("position ({output})"),
                format!("reference ({input})"),
            ] {
                assert!(plot("input-output").contains(&axis), "{file}");
            }
            assert!(
                plot("step").contains(&format!("unit step ({unit})")),
                "{file}"
            );
            assert!(printed.contains(&format!(" {output} rms")), "{printed}");
        } else {
            // What is not known is not made up.
            assert!(!printed.contains(" deg rms") && !plot("input-output").contains("(deg)"));
        }
    }
    let args = [&["identify", &named], &columns[..]].concat();
    assert!(refusal(&args).contains("--time COLUMN"));
    let args = [&args[..], &["--time", "when"]].concat();
    assert!(refusal(&args).contains("has no column \"when\""));
}

#[test]
fn what_is_not_certain_is_asked_in_one_sentence() {
    let dir = tempfile::tempdir().unwrap();
    let new = |name: &str, above: &str, row: &dyn Fn(u32, f64, f64) -> String| {
        file(dir.path(), name, above, row)
    };
    let model = dir.path().join("model.json");
    let clean = new("clean.csv", "time_s,u,y\n", &|k, u, y| {
        format!("{:.3},{u},{y:.4}\n", 0.002 * f64::from(k))
    });
    identified(&clean, &[&NAMED[..], &["-o", arg(&model)]].concat());
    let cases = [
        (
            new("unit.csv", "t,u,y\n", &|k, u, y| {
                format!("{},{u},{y:.4}\n", 2 * k)
            }),
            "--time-unit ms",
        ),
        (
            new("uneven.csv", "t,u,y\n", &|k, u, y| {
                format!("{:.4},{u},{y:.4}\n", 1e-5 * f64::from(k * k))
            }),
            "uneven steps",
        ),
        (
            new("suffix.csv", "time,u,y\n", &|k, u, y| {
                format!("{:.3} s,{u},{y:.4}\n", 0.002 * f64::from(k))
            }),
            "neither numbers nor those of a clock",
        ),
        (
            new("commas.csv", "t,u,y\n", &|k, u, y| {
                format!("0,{k:04},{u:.0},0,{y:.4}\n").replace('.', ",")
            }),
            "cells where the header row has 3",
        ),
        (
            new("words.csv", "t,u,y\n", &|k, u, y| match k {
                900 => "1.8,off,0\n".to_owned(),
                _ => format!("{:.3},{u},{y:.4}\n", 0.002 * f64::from(k)),
            }),
            "line 902, column \"u\"",
        ),
        (arg(&model).to_owned(), "is a model"),
    ];
    for (file, words) in &cases {
        let said = refusal(&[&["identify", file], &NAMED[..]].concat());
        assert!(
            said.contains(words) && said.trim().lines().count() == 1,
            "{file}: {said}"
        );
    }
    let said = refusal(&["validate", &clean, &clean]);
    assert!(said.contains("servoid identify"), "{said}");
}

/// A number that means that there is none counts as one, and hides all the others.
#[test]
fn a_number_that_stands_for_no_reading_is_pointed_out() {
    let dir = tempfile::tempdir().unwrap();
    let with = |name: &str, stand_in: &str| {
        file(dir.path(), name, "u,y\n", |k, u, y| match k % 97 {
            0 => format!("{u},{stand_in}\n"),
            _ => format!("{u},{y:.4}\n"),
        })
    };
    let options = ["--input", "u", "--output", "y", "--period", "0.002"];
    let nines = with("nines.csv", "-9999");
    let args = [&["identify", &nines], &options[..]].concat();
    let said = String::from_utf8(servoid(&args).output().unwrap().stderr).unwrap();
    assert!(
        said.contains("column \"y\" is -9999 in 16 rows of 1500, far from all its other values"),
        "{said}"
    );
    let (gain, _, said) = identified(&with("empty.csv", ""), &options);
    assert!(
        (gain - 1.0).abs() < 0.01 && !said.contains("far from"),
        "{gain} {said}"
    );
}

#[test]
fn a_period_that_a_column_of_time_contradicts_is_said_and_a_slip_refused() {
    let dir = tempfile::tempdir().unwrap();
    let file = file(dir.path(), "x.csv", "time_ms,u,y\n", |k, u, y| {
        format!("{},{u},{y:.4}\n", 2 * k)
    });
    let twice = [&["identify", &file], &NAMED[..], &["--period", "0.004"]].concat();
    let said = refusal(&twice);
    assert!(said.contains("leave --period out"), "{said}");
    let (_, period, said) = identified(&file, &[&NAMED[..], &["--period", "0.00205"]].concat());
    assert_eq!(period, 0.00205);
    assert!(
        said.contains("by column \"time_ms\" rows are 2 ms apart, but 0.00205 s was stated"),
        "{said}"
    );
    let (_, _, said) = identified(&file, &[&NAMED[..], &["--period", "0.002"]].concat());
    assert!(!said.contains("was stated"), "{said}");
}

/// A model knows how its file was read; a time between rows that no servo is recorded with is named first.
#[test]
fn what_was_said_once_is_known_and_an_unlikely_period_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let rows = file(dir.path(), "mine.csv", "u,y\n", |_, u, y| {
        format!("{u},{y}\n")
    });
    let model = dir.path().join("mine.json");
    let options = ["--input", "u", "--output", "y", "--period", "0.002"];
    let (_, _, said) = identified(&rows, &[&options[..], &["-o", arg(&model)]].concat());
    assert!(!said.contains("--period"), "{said}");
    let output = servoid(&["validate", arg(&model), &rows]).output().unwrap();
    let [fit, said] = [output.stdout, output.stderr].map(|t| String::from_utf8(t).unwrap());
    assert!(fit.contains("fit 9"), "{fit}{said}");
    assert!(said.contains("as those of the model were"), "{said}");

    let wrong = ["--input", "u", "--output", "y", "--period", "2"];
    let args = [&["identify", &rows, "--settling", "81"], &wrong[..]].concat();
    let output = servoid(&args).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let first = text.split("  ! ").nth(1).unwrap_or_default();
    assert!(first.contains("--period 0.002 if it is 2 ms"), "{text}");
    let swapped = ["--input", "y", "--output", "u", "--period", "0.002"];
    let sentence = refusal(&[&["identify", &rows], &swapped[..]].concat());
    assert!(sentence.contains("seem to be swapped"), "{sentence}");
}

/// A last row that was cut in its last number, files in different units, and one file under two names.
#[test]
fn what_is_cut_mixed_or_named_twice_is_said() {
    let dir = tempfile::tempdir().unwrap();
    let row = |k: u32, u: f64, y: f64| format!("{k},{u},{y:.4}\n");
    let degrees = file(dir.path(), "degrees.csv", "time_ms,u,y\n", row);
    let radians = file(dir.path(), "radians.csv", "time_ms,u,y\n", |k, u, y| {
        row(k, u.to_radians(), y.to_radians())
    });
    let cut = dir.path().join("cut.csv");
    let whole = std::fs::read_to_string(&degrees).unwrap();
    std::fs::write(&cut, &whole[..whole.len() - 3]).unwrap();
    let (.., said) = identified(arg(&cut), &NAMED);
    assert!(said.contains("its last row has no end of line"), "{said}");
    let (.., said) = identified(&degrees, &[&NAMED[..], &[&radians]].concat());
    assert!(said.contains("moves 57 times as far in"), "{said}");
    let again = dir.path().join(".").join("degrees.csv");
    let said = refusal(&[&["identify", &degrees, arg(&again)], &NAMED[..]].concat());
    assert!(said.contains("is named twice"), "{said}");
}
