//! Where no bounds can be given, none are shown: not as numbers, not as curves, not in a caption.

use crate::report::embedded;
use crate::support::{arg, json, run, servoid};
use serde_json::Value;
use servoid_identification::Record;
use servoid_test_support::closed_loop::{Course, Loop};
use servoid_test_support::drifting_servos::{Command, DriftingServo, Motion};
use servoid_test_support::loggers::Logger;
use servoid_test_support::plants::{self, Noise, Plant};
use std::path::{Path, PathBuf};

/// A recording for which no bounds can be given, one for each reason.
#[derive(Clone, Copy, Debug)]
enum Withdrawn {
    /// A smooth reference that leaves frequencies without power, and a servo whose speed is limited.
    InputUnexcited,
    /// Steps that are held, and fewer frequencies asked for than the response needs.
    FrequenciesLeftOut,
    /// A servo whose speed is limited, under random steps that do not let it rest.
    ErrorsNotNoise,
    /// A smooth reference, and steps of the sensor that are larger than the noise.
    QuantisationAboveNoise,
    /// Commands that were written late.
    EarlyMotion,
    /// A sensor that is read with every fifth sample.
    HeldOutput,
    /// Two columns with clocks of their own.
    LagDrift,
    /// A stop within the range of the commands.
    TravelEnd,
    /// A gain that falls along the recording.
    GainDrift,
    /// A controller that computes the command from the output.
    InputFollowsOutput,
    /// A square wave whose holds end before the servo has come to rest.
    EndUnseen,
    /// A tenth of the response takes much longer than the holds.
    ResponseNotOver,
    /// A lag of four seconds.
    SlowServo,
}

impl Withdrawn {
    /// But for [`Self::InputUnexcited`] and [`Self::TravelEnd`], which the quick test has.
    const OTHERS: [Self; 11] = [
        Self::FrequenciesLeftOut,
        Self::ErrorsNotNoise,
        Self::QuantisationAboveNoise,
        Self::EarlyMotion,
        Self::HeldOutput,
        Self::LagDrift,
        Self::GainDrift,
        Self::InputFollowsOutput,
        Self::EndUnseen,
        Self::ResponseNotOver,
        Self::SlowServo,
    ];

    fn reason(self) -> &'static str {
        match self {
            Self::InputUnexcited => "input_unexcited",
            Self::FrequenciesLeftOut => "frequencies_left_out",
            Self::ErrorsNotNoise => "errors_not_noise",
            Self::QuantisationAboveNoise => "quantisation_above_noise",
            Self::EarlyMotion => "early_motion",
            Self::HeldOutput => "held_output",
            Self::LagDrift => "lag_drift",
            Self::TravelEnd => "travel_end",
            Self::GainDrift => "gain_drift",
            Self::InputFollowsOutput => "input_follows_output",
            Self::EndUnseen => "end_unseen",
            Self::ResponseNotOver | Self::SlowServo => "response_not_over",
        }
    }

    /// Options of `identify` that the reason needs.
    fn asked(self) -> &'static [&'static str] {
        match self {
            Self::FrequenciesLeftOut => &["--settling", "177", "--frequencies", "19"],
            _ => &[],
        }
    }

    fn recording(self, dir: &Path, seed: u32) -> PathBuf {
        let file = dir.join(format!("{}-{seed}.csv", self.reason().replace('_', "-")));
        write(&self.record(seed), &file);
        file
    }

    fn record(self, seed: u32) -> Record<'static> {
        let logger = Logger::default();
        let logged = |logger: Logger| logger.record(seed.into());
        match self {
            Self::InputUnexcited => second_order(seed, 4, 100.0, (0.17, 0.0)),
            Self::FrequenciesLeftOut => second_order(seed, 0, f64::INFINITY, (0.17, 0.0)),
            Self::ErrorsNotNoise => second_order(seed, 0, 100.0, (0.07, 0.0)),
            Self::QuantisationAboveNoise => second_order(seed, 1, f64::INFINITY, (0.01, 0.04)),
            Self::EarlyMotion => logged(Logger { late: 12, ..logger }),
            Self::HeldOutput => logged(Logger {
                refresh: 5,
                ..logger
            }),
            Self::LagDrift => logged(Logger {
                drift: 0.001,
                ..logger
            }),
            Self::TravelEnd => logged(Logger {
                stop: 9.0,
                ..logger
            }),
            Self::GainDrift => DriftingServo {
                change: -0.05,
                ..DriftingServo::default()
            }
            .record(seed.into()),
            Self::InputFollowsOutput => in_closed_loop(seed),
            Self::EndUnseen => under_equal_holds(seed),
            Self::ResponseNotOver => with_slow_end(seed),
            Self::SlowServo => DriftingServo {
                motion: Motion::Lag(4.0),
                command: Command::Levels(5.0),
                ..DriftingServo::default()
            }
            .record(seed.into()),
        }
    }
}

/// The first run of `record` as a CSV file.
fn write(record: &Record<'_>, file: &Path) {
    let run = &record.runs()[0];
    let mut rows = String::from("time_s,u [us],y [deg]\n");
    for (k, (command, output)) in (0..).zip(run.input().iter().zip(run.output())) {
        let time = f64::from(k) * record.sample_period_s();
        rows += &format!("{time:.3},{command},{output:.4}\n");
    }
    std::fs::write(file, rows).unwrap();
}

/// A servo of second order, 60 rad/s and damping 0.7: lags of 20 Hz between the steps and its command, limit of its speed \[deg/s\], noise
/// and step of its sensor \[deg\].
fn second_order(
    seed: u32,
    lags: usize,
    fastest: f64,
    (loudness, step): (f64, f64),
) -> Record<'static> {
    const PERIOD: f64 = plants::PERIOD;
    let (mut random, mut noise) = (seed, 7 * seed + 1);
    let next = |state: &mut u32| {
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(*state >> 8) / f64::from(1 << 24)
    };
    // Only the servo whose speed is limited must not come to rest.
    let frames = if fastest.is_finite() { 1 } else { 12 };
    let keep = (-std::f64::consts::TAU * 20.0 * PERIOD).exp();
    let mut level = 5.0;
    let mut lagged = vec![level; lags];
    let (mut position, mut speed) = (level, 0.0);
    let (mut commands, mut outputs) = (Vec::new(), Vec::new());
    for k in 0..1400 {
        if k % (10 * frames) == 0 {
            level = if next(&mut random) > 0.5 { 5.0 } else { -5.0 };
        }
        let mut command = level;
        for state in &mut lagged {
            *state = keep * *state + (1.0 - keep) * command;
            command = *state;
        }
        // Ten steps a sample.
        for _ in 0..10 {
            let acceleration = 3600.0 * (command - position) - 84.0 * speed;
            speed = (speed + acceleration * PERIOD / 10.0).clamp(-fastest, fastest);
            position += speed * PERIOD / 10.0;
        }
        let mut output = position + loudness * (next(&mut noise) - 0.5);
        if step > 0.0 {
            output = step * (output / step).round();
        }
        commands.push(command);
        outputs.push(output);
    }
    Record::of_run(PERIOD, commands, outputs).unwrap()
}

fn in_closed_loop(seed: u32) -> Record<'static> {
    let line = Loop {
        course: Course::Prbs,
        controller: Some(0.3),
        plant: Plant::A,
        noise: Noise::Ar1,
        scale: 10.0,
        delay: 0,
    };
    line.trial(&mut plants::random(seed.into())).record
}

fn under_equal_holds(seed: u32) -> Record<'static> {
    let level = |k: u32| {
        if (k / 150).is_multiple_of(2) {
            5.0
        } else {
            -5.0
        }
    };
    let input: Vec<f64> = (0..4200).map(level).collect();
    let mut random = plants::random(seed.into());
    let output = plants::simulate(Plant::A, Noise::White, &input, 1.0, &mut random);
    Record::of_run(plants::PERIOD, input, output).unwrap()
}

/// 90 % with 20 ms and 10 % with 0.8 s, of which every second sample is recorded: the fewer, the sooner a response of a second is found.
fn with_slow_end(seed: u32) -> Record<'static> {
    let input = plants::staircase();
    let noise = Noise::White.samples(&mut plants::random(seed.into()), input.len());
    let (mut fast, mut slow) = (0.0, 0.0);
    let output: Vec<f64> = (input.iter().zip(noise))
        .map(|(u, v)| {
            fast += (u - fast) * plants::PERIOD / 0.02;
            slow += (u - slow) * plants::PERIOD / 0.8;
            0.9 * fast + 0.1 * slow + v
        })
        .collect();
    let [input, output] = [input, output].map(|all| {
        let kept = all.into_iter().step_by(2);
        kept.collect::<Vec<f64>>()
    });
    Record::of_run(2.0 * plants::PERIOD, input, output).unwrap()
}

/// A servo whose speed is limited: its errors are not noise.
fn limited(dir: &Path, seed: u32) -> PathBuf {
    Withdrawn::ErrorsNotNoise.recording(dir, seed)
}

const NAMED: [&str; 4] = ["--input", "u", "--output", "y"];

/// Fields that are bounds, or of which bounds are made, by their names in JSON and in exports.
const BOUNDS: [&str; 31] = [
    "bounds",
    "level",
    "lower",
    "upper",
    "sd",
    "critical_value",
    "covariance",
    "truncation_bias",
    "rounding_bias",
    "bias",
    "allowance",
    "noise_half_width",
    "half_width",
    "degrees_of_freedom",
    "magnitude_db_lower",
    "magnitude_db_upper",
    "phase_deg_lower",
    "phase_deg_upper",
    "pointwise",
    "simultaneous",
    "difference_percent",
    "at_least",
    "at_most",
    "a_bounds",
    "b_bounds",
    "delay_shift_bounds_s",
    "theta_sd",
    "step_sd",
    "step_lower",
    "step_upper",
    "discrepancy",
];

/// No bound in a document is a number, nor has numbers in it.
pub fn require_no_bound(value: &Value, place: &str) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                let place = format!("{place}/{key}");
                // Limits have bounds of their own evidence, the scatter of strokes and rests; stops are angles, the upper and the lower one. How much runs differ
                // from each other is a result; how well each of them is known would be a bound.
                // Models of older versions have a test of fit: its degrees of freedom are no bound.
                let own_evidence = place.ends_with("/limits")
                    || place.ends_with("/stops")
                    || place.ends_with("/flight_model/tried")
                    || ["gain_percent", "delay_s", "offset"]
                        .iter()
                        .any(|quantity| {
                            place.ends_with(&format!("/explanation/runs/{quantity}/sd"))
                        });
                if own_evidence {
                    continue;
                }
                if BOUNDS.contains(&key.as_str()) {
                    assert!(value.is_null(), "{place} is {value}");
                }
                require_no_bound(value, &place);
            }
        }
        Value::Array(list) => list.iter().for_each(|value| require_no_bound(value, place)),
        _ => {}
    }
}

/// No sentence for people speaks of bounds as if there were some.
fn require_no_claim(text: &str, place: &str) {
    for claim in [
        "99 % interval",
        "99 % bounds",
        "99 % sure",
        "level 99 %",
        " ±",
        "noise ±",
        "half width",
        "degrees of freedom or more",
        "standard deviations. The bounds",
        "bounds of the gain",
        "bounds contain",
        "bands contain",
        "bounds hold",
        "bounds rest",
        "bounds are",
        "bounds describe",
        "bounds of the step response wide",
        "width of the b",
        "is itself uncertain",
        "allow for it",
        "contain it",
    ] {
        assert!(!text.contains(claim), "{place} has '{claim}':\n{text}");
    }
}

/// The advice of a document, one sentence a line.
fn sentences(document: &Value) -> String {
    let advice = document["advice"].as_array().unwrap().iter();
    let texts = advice.flat_map(|found| [&found["finding"], &found["do"]]);
    texts
        .map(|text| format!("{}\n", text.as_str().unwrap()))
        .collect()
}

/// Compares two recordings or two models, in their folder.
fn require_comparison_without_bounds(a: &Path, b: &Path, withdrawn: Withdrawn) {
    let compared = a.with_file_name("compared.json");
    let args = [
        "compare",
        "-q",
        arg(a),
        arg(b),
        "--force",
        "-o",
        arg(&compared),
    ];
    let named: &[&str] = match a.extension() {
        Some(extension) if extension == "csv" => &NAMED,
        _ => &[],
    };
    let text = run(&[&args[..], named].concat());
    let document = json(&compared);
    assert_eq!(
        document["withdrawn"]["reason"],
        withdrawn.reason(),
        "{text}"
    );
    require_no_bound(&document, "comparison");
    require_no_claim(&sentences(&document), "the advice of a comparison");
    require_no_claim(&text, "a comparison");
    assert!(!text.contains(" .. "), "{text}");
}

/// Of a linear servo the frequency response is known where a smooth reference has power, and nothing else.
#[test]
fn a_smooth_reference_has_bounds_in_its_band_alone() {
    let dir = tempfile::tempdir().unwrap();
    let [file, model] = ["smooth.csv", "model.json"].map(|name| dir.path().join(name));
    write(&second_order(1, 4, f64::INFINITY, (0.17, 0.0)), &file);
    let kept = ["identify", "-q", arg(&file), "-o", arg(&model)];
    let text = run(&[&kept[..], &NAMED].concat());
    let document = json(&model);
    assert_eq!(document["linear"], true, "{text}");
    for without in [&document, &document["step"]] {
        assert_eq!(without["withdrawn"]["reason"], "input_unexcited");
        assert!(without["bounds"].is_null());
    }
    assert_eq!(document["frequency"]["bounds"]["level"], 0.99);
    for said in [
        "Hz the frequency response is known to ±",
        "How the servo answers a step is not determined, because",
        "! NO BOUNDS OF THE STEP RESPONSE CAN BE GIVEN",
        "No bounds of the step response can be given, because the reference determines the response from",
    ] {
        let words = text.split_whitespace().collect::<Vec<&str>>().join(" ");
        assert!(words.contains(said), "no '{said}' in:\n{text}");
    }
    assert!(!text.contains("errors noise"), "{text}");
}

#[test]
fn no_bound_is_left() {
    require_no_bounds(&[Withdrawn::InputUnexcited, Withdrawn::TravelEnd]);
}

#[test]
#[ignore = "half a minute: cargo test -p servoid --test integration -- --ignored no_reason_leaves_a_bound"]
fn no_reason_leaves_a_bound() {
    require_no_bounds(&Withdrawn::OTHERS);
}

/// Not in an identification, and not in what is made of its model.
fn require_no_bounds(reasons: &[Withdrawn]) {
    for &withdrawn in reasons {
        let dir = tempfile::tempdir().unwrap();
        let model = dir.path().join("model.json");
        require_identification_without_bounds(withdrawn, &model);
        require_exports_without_bounds(withdrawn, &model);
        require_uses_without_bounds(withdrawn, &model);
        require_comparison_without_bounds(&model, &model, withdrawn);
    }
}

/// Writes the `model`.
fn require_identification_without_bounds(withdrawn: Withdrawn, model: &Path) {
    let dir = model.parent().unwrap();
    let files = [1, 2].map(|seed| withdrawn.recording(dir, seed));
    let common = ["identify", "-q", arg(&files[0]), arg(&files[1])];
    let further = ["--explain", "--limits", "--flight-model"];
    let asked = withdrawn.asked();
    let kept = ["-o", arg(model)];
    let text = run(&[&common[..], &further, &NAMED, asked, &kept].concat());
    let document = json(model);
    assert_eq!(
        document["withdrawn"]["reason"],
        withdrawn.reason(),
        "{text}"
    );
    require_no_bound(&document, withdrawn.reason());
    let found = |path: &str| document.pointer(path).is_some_and(|value| !value.is_null());
    for part in [
        "/explanation/runs/runs/0",
        "/explanation/settling",
        "/limits",
        "/directions",
    ] {
        // A settling time that was asked for was not looked for.
        let is_given = part == "/explanation/settling" && !asked.is_empty();
        assert!(found(part) || is_given, "{withdrawn:?} has no {part}");
    }
    require_no_claim(&sentences(&document), "the advice");
    // Up to the limits, which have bounds of their own evidence.
    let (linear, _) = text.split_once("\nlimits of a linear model").unwrap();
    assert!(linear.contains("how the structure came about"), "{linear}");
    require_no_claim(linear, "the summary");
    assert!(!linear.contains(" .. "), "{linear}");
}

/// Formats of `export`.
const FORMATS: [&str; 6] = ["matlab", "python", "julia", "c", "csv", "jsbsim"];

fn require_exports_without_bounds(withdrawn: Withdrawn, model: &Path) {
    for format in FORMATS {
        let exported = servoid(&["export", arg(model), "--to", format, "-q"])
            .output()
            .unwrap();
        // A model without a gain cannot be exported to every format.
        let text = String::from_utf8(exported.stdout).unwrap();
        let place = format!("{withdrawn:?} as {format}");
        if !exported.status.success() {
            assert!(text.is_empty(), "{place}: {text}");
            continue;
        }
        assert!(
            text.contains("Bounds: none can be given"),
            "{place}: {text}"
        );
        require_no_claim(&text, &place);
        for line in text.lines() {
            let name = line
                .split(['=', ':', '[', '(', ','])
                .next()
                .unwrap_or_default();
            let name = name
                .trim()
                .rsplit([' ', '.', '_'])
                .next()
                .unwrap_or_default()
                .to_lowercase();
            let is_bound = [
                "lower",
                "upper",
                "sd",
                "covariance",
                "level",
                "simultaneous",
            ]
            .contains(&name.as_str());
            assert!(!is_bound, "{place}: {line}");
        }
        if format == "csv" {
            let names = text
                .lines()
                .find(|line| line.starts_with("time_s"))
                .unwrap();
            for name in names.split(',') {
                assert!(
                    !BOUNDS.contains(&name) && !name.contains("covariance"),
                    "{place}: {name}"
                );
            }
        }
    }
}

/// In a plan and in a validation.
fn require_uses_without_bounds(withdrawn: Withdrawn, model: &Path) {
    let dir = model.parent().unwrap();
    let planned = dir.join("plan.json");
    let plan = servoid(&["plan", "--model", arg(model), "-q", "-o", arg(&planned)])
        .output()
        .unwrap();
    if plan.status.success() {
        let document = json(&planned);
        assert!(
            document["band"].is_null() && document["metrics"].is_null(),
            "{withdrawn:?}: {document}"
        );
        assert_eq!(
            document["withdrawn"]["reason"],
            withdrawn.reason(),
            "{document}"
        );
    }
    let validated = dir.join("validated.json");
    let unseen = withdrawn.recording(dir, 3);
    let args = [
        "validate",
        "-q",
        arg(model),
        arg(&unseen),
        "-o",
        arg(&validated),
    ];
    run(&[&args[..], &NAMED].concat());
    let document = json(&validated);
    let fields: Vec<&String> = document.as_object().unwrap().keys().collect();
    // `bias` is the mean error of the prediction here.
    assert!(
        fields
            .iter()
            .all(|key| *key == "bias" || !BOUNDS.contains(&key.as_str())),
        "{fields:?}"
    );
}

#[test]
fn a_comparison_has_no_bounds_where_either_side_has_none() {
    let dir = tempfile::tempdir().unwrap();
    let without = limited(dir.path(), 1);
    let sound = dir.path().join("sound.csv");
    let mut rows = String::from("time_s,u [us],y [deg]\n");
    let (mut y, mut noise) = (5.0, 9u32);
    for k in 0..3600 {
        let level = if k * k / 40_000 % 2 == 0 { 5.0 } else { -5.0 };
        y += 0.1 * (level - y);
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let error = 0.05 * (f64::from(noise >> 8) / f64::from(1 << 24) - 0.5);
        rows += &format!("{:.3},{level},{:.4}\n", f64::from(k) * 0.002, y + error);
    }
    std::fs::write(&sound, rows).unwrap();
    let [without, sound] = [without, sound].map(|file| {
        let model = file.with_extension("json");
        run(&[
            &["identify", "-q", arg(&file), "-o", arg(&model)],
            &NAMED[..],
        ]
        .concat());
        model
    });
    for (a, b) in [(&without, &sound), (&sound, &without)] {
        require_comparison_without_bounds(a, b, Withdrawn::ErrorsNotNoise);
    }
}

#[test]
fn identify_compare_and_export_show_no_bounds() {
    let dir = tempfile::tempdir().unwrap();
    let [a, b] = [1, 2].map(|seed| limited(dir.path(), seed));
    let model = dir.path().join("a.json");
    let reported = run(&[
        &[
            "identify",
            "-q",
            arg(&a),
            "-o",
            arg(&model),
            "--flight-model",
        ],
        &NAMED[..],
    ]
    .concat());
    assert!(reported.contains("NO BOUNDS CAN BE GIVEN"), "{reported}");
    let (table, _) = reported.split_once("\n\n  ! ").unwrap();
    assert!(
        !table.contains(" .. ") && !table.contains("99 %"),
        "{reported}"
    );
    for gone in ["bounds of the gain", "bands contain", "bounds hold"] {
        assert!(!reported.contains(gone), "{reported}");
    }
    // A gain that may be zero is no gain, either.
    assert!(table.contains("all are withheld"), "{table}");
    assert!(!table.contains("DC gain"), "{table}");

    let file = dir.path().join("compared.json");
    let args = ["compare", "-q", arg(&a), arg(&b), "-o", arg(&file)];
    let reported = run(&[&args[..], &NAMED[..]].concat());
    let (facts, _) = reported.split_once("\n\n  ! ").unwrap();
    assert!(facts.contains("Not decided"), "{reported}");
    assert!(
        !facts.contains(" .. ") && !facts.contains("interval"),
        "{reported}"
    );

    let compared = json(&file);
    assert!(compared["bounds"].is_null());
    assert_eq!(compared["withdrawn"]["reason"], "errors_not_noise");
    require_no_bound(&compared, "comparison");
    let curves = compared["curves"].as_array().unwrap();
    assert!(!curves.is_empty());
    for curve in curves {
        let percent = curve["percent"].as_array().unwrap();
        assert!(percent.iter().all(Value::is_number));
    }

    assert!(!json(&model)["advice"].as_array().unwrap().is_empty());
    let exported = run(&["export", arg(&model), "--to", "python", "-q"]);
    assert!(exported.contains("BOUNDS_HOLD = False"), "{exported}");
    assert!(exported.contains("Bounds: none can be given"), "{exported}");
    assert!(!exported.contains("intervals of"), "{exported}");
}

#[test]
#[ignore = "five seconds: cargo test -p servoid --test integration -- --ignored a_report_draws_no_bounds"]
fn a_report_draws_no_bounds_and_its_captions_promise_none() {
    let dir = tempfile::tempdir().unwrap();
    let [a, b] = [1, 2].map(|seed| limited(dir.path(), seed));
    let page = dir.path().join("x.html");
    run(&[
        &["report", "-q", arg(&a), arg(&b), "-o", arg(&page)],
        &NAMED[..],
    ]
    .concat());
    let text = std::fs::read_to_string(&page).unwrap();
    let (body, _) = text.split_once("id=\"figures\"").unwrap();
    for gone in [
        "holds the whole curve",
        "are bounds for each",
        "difference<br>",
    ] {
        assert!(!body.contains(gone), "{gone}");
    }
    assert!(body.contains("No bounds can be given for errors-not-noise-1 and errors-not-noise-2"));
    let figures = embedded(&text, "figures");
    for figure in figures.as_array().unwrap() {
        let name = figure["name"].as_str().unwrap();
        assert_ne!(name, "difference");
        if !(name.contains("step") || name.contains("frequency")) {
            continue;
        }
        for trace in figure["data"].as_array().unwrap() {
            let label = trace["name"].as_str().unwrap();
            assert!(label.ends_with("no bounds can be given"), "{name}: {label}");
            assert!(trace.get("fill").is_none(), "{name}: {label} is an area");
        }
        if name.contains("step") {
            let axis = figure["layout"]["yaxis"]["title"]["text"].as_str().unwrap();
            assert!(axis.ends_with("(deg/us)"), "{axis}");
        }
    }
}
