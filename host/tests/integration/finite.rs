//! Whatever a recording is like: no result has a number that is none, and a model that `identify` wrote is accepted by
//! everything that takes models.

use crate::support::{arg, data, json, refusal, run, servoid};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;

const SAMPLES: usize = 500;

/// Larger than the square of any value or gain of these recordings, up to some 1e16.
const ABSURD: f64 = 1e36;

const COLUMNS: [&str; 6] = ["--input", "u", "--output", "y", "--period", "0.02"];

/// A kind of recording: its name, and command and motion of it.
type Kind = (&'static str, Vec<f64>, Vec<f64>);

/// Steps, and the answer of a servo with one pole to them, with a little noise beside it.
fn kinds() -> Vec<Kind> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let levels = [-5.0, 0.0, 2.5, 5.0];
    let holds: Vec<f64> = (0..SAMPLES / 25)
        .map(|_| levels[rng.random_range(0..4)])
        .collect();
    let u: Vec<f64> = (0..SAMPLES).map(|k| holds[k / 25]).collect();
    let mut y = vec![0.0; SAMPLES];
    for k in 1..SAMPLES {
        y[k] = 0.7 * y[k - 1] + 0.3 * u[k - 1];
    }
    let noise: Vec<f64> = (0..SAMPLES)
        .map(|_| 0.1 * (rng.random::<f64>() - 0.5))
        .collect();
    let of = |motion: &dyn Fn(usize) -> f64| (0..SAMPLES).map(motion).collect::<Vec<f64>>();
    let noisy = of(&|k| y[k] + noise[k]);
    let sum = |k: usize| 0.01 * u[..k].iter().sum::<f64>();
    vec![
        ("plain", u.clone(), noisy.clone()),
        ("without noise", u.clone(), y.clone()),
        ("the command itself", u.clone(), u.clone()),
        ("rounded", u.clone(), of(&|k| y[k].round())),
        ("two values", u.clone(), of(&|k| noisy[k].signum())),
        ("noise alone", u.clone(), noise.clone()),
        ("frozen", u.clone(), of(&|k| noisy[k.min(300)])),
        ("integrated", u.clone(), of(&|k| sum(k) + noise[k])),
        ("turned around", u.clone(), of(&|k| -noisy[k])),
        ("far away", u.clone(), of(&|k| noisy[k] + 1e9)),
        ("farther away", u.clone(), of(&|k| noisy[k] + 1e15)),
        ("large", u.clone(), of(&|k| 1e15 * noisy[k])),
        ("small", u.clone(), of(&|k| 1e-15 * noisy[k])),
        ("small command", of(&|k| 1e-15 * u[k]), noisy.clone()),
        (
            "both small",
            of(&|k| 1e-15 * u[k]),
            of(&|k| 1e-15 * noisy[k]),
        ),
        (
            "late",
            u.clone(),
            of(&|k| y[k.saturating_sub(40)] + noise[k]),
        ),
        (
            "one step",
            of(&|k| f64::from(k > 300)),
            of(&|k| {
                let after = k.saturating_sub(300) as f64;
                1.0 - (-after / 3.0).exp() + noise[k]
            }),
        ),
        (
            "holes",
            u,
            of(&|k| if k % 97 == 5 { f64::NAN } else { noisy[k] }),
        ),
    ]
}

/// As a table for `identify`; what is missing is an empty cell.
fn table(input: &[f64], output: &[f64]) -> String {
    let mut text = "u,y\n".to_owned();
    for (u, y) in input.iter().zip(output) {
        let y = if y.is_nan() {
            String::new()
        } else {
            format!("{y:e}")
        };
        writeln!(text, "{u:e},{y}").unwrap();
    }
    text
}

/// Requires that numbers are numbers: JSON has `null` for others, and no list of numbers of a document has a gap.
fn require_numbers(value: &Value, place: &str) {
    match value {
        Value::Object(fields) => fields
            .iter()
            .for_each(|(name, value)| require_numbers(value, &format!("{place}/{name}"))),
        Value::Array(values) => {
            assert!(!values.contains(&Value::Null), "{place} has a null");
            values
                .iter()
                .for_each(|value| require_numbers(value, place));
        }
        Value::Number(number) => {
            let number = number.as_f64().unwrap();
            assert!(number.abs() < ABSURD, "{place}: {number}");
        }
        _ => {}
    }
}

/// Requires that a text, a program or a picture has no number that is none. Programs have words for these: `NaN(`, `isinf`.
fn require_none_unsaid(text: &str, place: &str) {
    let is_part = |letter: char| letter.is_alphanumeric() || "_./".contains(letter);
    for word in text.split(|letter| !is_part(letter)) {
        let is_none = matches!(word, "NaN" | "nan" | "inf");
        assert!(!is_none, "{place}: {word} in\n{text}");
    }
}

/// What `identify` makes of a recording, and all that takes its model.
fn require_usable(name: &str, recording: &Path, columns: &[&str], folder: &Path) -> bool {
    let (model, plots) = (folder.join("m.json"), folder.join("plots"));
    let (m, plots) = (arg(&model), arg(&plots));
    let mut identify = vec!["identify", arg(recording), "-o", m, "--plots", plots];
    identify.extend(["--explain", "--flight-model", "--limits", "--force"]);
    identify.extend(columns);
    let output = servoid(&identify).output().unwrap();
    if !output.status.success() {
        refusal(&identify);
        return false;
    }
    require_none_unsaid(&String::from_utf8(output.stdout).unwrap(), name);
    require_numbers(&json(&model), name);
    for plot in std::fs::read_dir(plots).unwrap().flatten() {
        require_none_unsaid(&std::fs::read_to_string(plot.path()).unwrap(), name);
    }
    for target in ["matlab", "julia", "python", "c", "csv", "jsbsim"] {
        let export = ["export", m, "--to", target];
        let output = servoid(&export).output().unwrap();
        if !output.status.success() {
            // The one reason that there is.
            assert_eq!(target, "jsbsim", "{name}");
            assert!(refusal(&export).contains("low-order model"), "{name}");
        }
        let text = String::from_utf8(output.stdout).unwrap();
        require_none_unsaid(&text, &format!("{name} {target}"));
    }
    let validated = run(&[&["validate", m, arg(recording)], columns].concat());
    require_none_unsaid(&validated, name);
    let compared = run(&["compare", m, m, "--json"]);
    require_numbers(&serde_json::from_str(&compared).unwrap(), name);
    require_none_unsaid(&run(&["compare", m, m]), name);
    run(&["report", m, "--force", "-o", arg(&folder.join("r.html"))]);
    true
}

/// Of the kinds whose names are `wanted`; returns how many of them have a model.
fn usable(wanted: impl Fn(&str) -> bool) -> usize {
    let mut kinds = kinds();
    kinds.retain(|(name, ..)| wanted(name));
    let next = std::sync::atomic::AtomicUsize::new(0);
    let work = || {
        let mut models = 0;
        while let Some((name, input, output)) =
            kinds.get(next.fetch_add(1, std::sync::atomic::Ordering::Relaxed))
        {
            let dir = tempfile::tempdir().unwrap();
            let file = dir.path().join("x.csv");
            std::fs::write(&file, table(input, output)).unwrap();
            models += usize::from(require_usable(name, &file, &COLUMNS, dir.path()));
        }
        models
    };
    std::thread::scope(|scope| {
        let workers = [scope.spawn(work), scope.spawn(work)];
        workers.map(|worker| worker.join().unwrap()).iter().sum()
    })
}

/// A usual one, the least that may be known of a motion, and one that has gaps.
const FEW: [&str; 4] = ["plain", "without noise", "frozen", "holes"];

#[test]
fn no_result_has_a_number_that_is_none_and_every_model_is_accepted() {
    assert!(usable(|name| FEW.contains(&name)) >= 3);
}

#[test]
#[ignore = "ten seconds: cargo test -p servoid --test integration -- --ignored no_result_of_any_kind"]
fn no_result_of_any_kind_of_recording_has_a_number_that_is_none() {
    let models = usable(|name| !FEW.contains(&name));
    assert!(models >= 7, "{models}");
}

#[test]
#[ignore = "five seconds: cargo test -p servoid --test integration -- --ignored every_model_of"]
fn every_model_of_a_recording_in_the_field_is_accepted() {
    for (name, columns) in [
        ("recording-format-1.csv", &[][..]),
        ("recording-format-3.csv", &[]),
        ("dcmotor_speed_prbs.csv", &["--input", "u", "--output", "y"]),
    ] {
        let dir = tempfile::tempdir().unwrap();
        require_usable(name, &data(name), columns, dir.path());
    }
}

/// Beyond these limits squares are not finite, or zero.
#[test]
fn numbers_that_cannot_be_computed_with_are_refused() {
    let (_, input, output) = kinds().swap_remove(0);
    for (of_input, of_output) in [(1.0, 1e30), (1.0, 1e-30), (1e-200, 1.0), (1e200, 1.0)] {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("x.csv");
        let scaled =
            |values: &[f64], scale: f64| values.iter().map(|v| v * scale).collect::<Vec<_>>();
        let text = table(&scaled(&input, of_input), &scaled(&output, of_output));
        std::fs::write(&file, text).unwrap();
        let said = refusal(&[&["identify", arg(&file)], &COLUMNS[..]].concat());
        let why = ["too large to compute with", "never moves from 0"];
        assert!(why.iter().any(|why| said.contains(why)), "{said}");
    }
}
