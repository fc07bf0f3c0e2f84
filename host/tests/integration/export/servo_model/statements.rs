//! What the files say.

use super::subjects::{AIRCRAFT, SERVOS, TARGETS, changed, export, prose, pulses, unitless};
use crate::support::arg;
use crate::support::run;
use serde_json::json;
use servoid::data::Units;
use servoid::data::model_file::ModelFile;
use servoid::presentation::summary::of_servo_model;

#[test]
fn every_file_says_what_it_is_and_how_far_it_is_off() {
    for target in TARGETS {
        let exported = export(&AIRCRAFT.file, 0, target, &[]);
        let prose = prose(&exported.text);
        for said in [
            "the servo as a machine",
            "from a.json",
            "the command is in deg, the position is in deg",
            "torques per unit of inertia",
            "Identified, ",
            "Left out",
            "20.0 ms",
            "Start: ",
            "Frame: a servo gets a new command once in ",
            "root mean square ",
        ] {
            assert!(prose.contains(said), "{target}: {said}");
        }
        let (_, rest) = prose.split_once("under the command named below: ").unwrap();
        let stated: f64 = rest.split(' ').next().unwrap().parse().unwrap();
        // It is written with four digits.
        let apart = (stated - exported.stated).abs();
        assert!(apart <= 1e-3 * exported.stated, "{target}: {stated}");
        assert!(!exported.text.contains("{{") && !exported.text.contains("NaN"));
    }
}

#[test]
fn what_a_target_lacks_is_named_with_its_value() {
    let folder = tempfile::tempdir().unwrap();
    let find = |name: &str| SERVOS.into_iter().find(|servo| servo.name == name).unwrap();
    for (name, target, said) in [
        ("full", "mujoco", "dead band, 0.1500 deg to each side"),
        (
            "full",
            "mujoco",
            "0.7000 times as large where the drive is negative",
        ),
        (
            "full",
            "mujoco",
            "what friction at rest is beyond that in motion (it is 1.600 times that",
        ),
        (
            "full",
            "ardupilot",
            "friction, 300.0 deg/s^2, an error of 0.2000 deg",
        ),
        (
            "full",
            "ardupilot",
            "two speeds, 233.3 deg/s upwards and 158.3 downwards",
        ),
        ("constant", "ardupilot", "constant load, 600.0 deg/s^2"),
        (
            "hanging",
            "jsbsim",
            "the weight on the arm, which takes 1500 deg/s^2",
        ),
        ("airborne", "jsbsim", "stiffens below theta = 2.000 deg"),
        (
            "limited",
            "jsbsim",
            "full drive as an acceleration, 4500 deg/s^2",
        ),
    ] {
        let text = prose(&find(name).export(target, folder.path(), &[]).text);
        assert!(text.contains(said), "{name} {target}: {text}");
    }
    let linear = find("linear").export("mujoco", folder.path(), &[]);
    let nothing = prose(&linear.text);
    assert!(nothing.contains("Left out: nothing"), "{nothing}");
    assert!(!linear.text.contains("forcerange=") && !linear.text.contains("frictionloss="));
}

#[test]
fn intervals_and_offsets_of_runs_are_written_only_where_there_are_any() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = crate::support::json(&AIRCRAFT.file);
    let model = &mut document["servo_model"];
    let size = model["values"].as_array().unwrap().len();
    model["withdrawn"] = json!(null);
    model["bounds"] = json!({ "level": 0.99, "rows": vec![vec![0.0; size]; size] });
    model["fit"]["discrepancy"] = json!(0.01);
    for quantity in model["quantities"].as_array_mut().unwrap() {
        let value = quantity["value"].clone();
        quantity["withdrawn"] = json!(null);
        quantity["bounds"] = json!({ "value": value, "lower": value, "upper": value });
    }
    let delay = &mut model["quantities"][0];
    delay["value"] = json!(0.0216);
    delay["bounds"] = json!({ "value": 0.0216, "lower": 0.0211, "upper": 0.0222 });
    model["run_offsets"] = json!([-0.1, 0.04, 0.06]);
    let valid = folder.path().join("valid.json");
    std::fs::write(&valid, document.to_string()).unwrap();
    for target in TARGETS {
        let with = prose(&export(&valid, 0, target, &[]).text);
        assert!(with.contains("intervals of 99 %"), "{target}");
        assert!(with.contains("delay 21.60 ms (21.10 .. 22.20)"), "{target}");
        let mean = "The 3 runs rest at different positions: each has an offset of its own, -0.100 to +0.060 deg from their mean";
        assert!(with.contains(mean), "{target}: {with}");
        let without = prose(&export(&AIRCRAFT.file, 0, target, &[]).text);
        assert!(
            without.contains("WARNING: no intervals can be given"),
            "{target}"
        );
        assert!(
            !without.contains(" .. ")
                && !without.contains("intervals of 99 %")
                && !without.contains("The 3 runs"),
            "{target}: {without}"
        );
    }
}

#[test]
fn a_hostile_name_stays_a_name() {
    const HOSTILE: &str = "x\"; */ --> ' ] ) ??/\n%}\r\u{2028}\u{202e}=# \"\"\" $(y) \\";
    for target in TARGETS {
        let lines = |name: &str| -> Vec<String> {
            let text = export(&AIRCRAFT.file, 0, target, &["--name", name]).text;
            text.lines().map(str::to_owned).collect()
        };
        let harmless = lines("x y");
        let comment = match target {
            "matlab" => "% ",
            "c" => " * ",
            "jsbsim" | "mujoco" => "  ",
            // Within the text of the module, which three quotes end.
            "python" => "",
            _ => "# ",
        };
        for line in lines(HOSTILE)
            .iter()
            .filter(|line| !harmless.contains(line))
        {
            let named = line.contains("NAME") || line.contains("p.name = ");
            assert!(named || line.starts_with(comment), "{target}: {line}");
            let ended = match target {
                "c" => line.contains("*/"),
                "jsbsim" | "mujoco" => line.contains("-->"),
                "python" => line.contains("\"\"\""),
                _ => line.contains('\u{202e}'),
            };
            // Within a string it ends nothing.
            assert!(named || !ended, "{target}: {line}");
        }
    }
}

#[test]
fn what_the_recording_does_not_determine_is_said_without_a_value() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = crate::support::json(&AIRCRAFT.file);
    document["servo_model"]["quantities"][4]["determined"] = false.into();
    let file = folder.path().join("open.json");
    std::fs::write(&file, document.to_string()).unwrap();
    let said = prose(&export(&file, 0, "c", &[]).text);
    assert!(
        said.contains("Not determined by the recording")
            && said.contains("many: damping ratio, friction at rest to that in motion."),
        "{said}"
    );
    assert!(!said.contains("damping ratio 0."), "{said}");
}

/// The angle of a stop is that of the constant in the file.
#[test]
fn each_stop_is_named_with_its_own_angle() {
    let folder = tempfile::tempdir().unwrap();
    for (name, sides) in [
        ("upper", ["upper", "highest"]),
        ("lower", ["lower", "lowest"]),
    ] {
        let mut document = crate::support::json(&AIRCRAFT.file);
        let stop = if name == "upper" { 3.1 } else { -3.1 };
        document["servo_model"]["stops"] = serde_json::json!({ sides[0]: stop });
        let file = folder.path().join(format!("{name}.json"));
        std::fs::write(&file, document.to_string()).unwrap();
        let text = export(&file, 0, "c", &[]).text;
        let after = |what: &str| -> f64 {
            let (_, rest) = text.split_once(what).unwrap();
            let number: String = rest
                .chars()
                .take_while(|letter| "-.0123456789e".contains(*letter))
                .collect();
            number.parse().unwrap()
        };
        let constant = after(&format!("{}_angle = ", sides[1]));
        // It is said with four digits.
        let said = after("(theta = ");
        assert!(
            (said - constant).abs() < 1e-3 * constant.abs(),
            "{name}: {said} {constant}"
        );
    }
}

/// Of a servo that turns against its command, with an offset: who follows the header gets its position.
/// A simulation has no header, and says it before it begins.
#[test]
fn a_simulation_says_that_its_model_has_no_intervals() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("again.csv");
    let servo = arg(&AIRCRAFT.file);
    let args = [
        "simulate",
        "--servo",
        servo,
        "-o",
        arg(&out),
        "--length",
        "4",
    ];
    let said = remarks(&[&args[..], &["--reference", "prbs"]].concat());
    assert!(said.contains("has no intervals, because "), "{said}");
}

#[test]
fn what_is_to_be_applied_beside_a_file_is_said_with_its_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let reversed = changed(folder.path(), |model| {
        let places = model["coordinates"].as_array().unwrap().clone();
        for (name, value) in [("gain", -0.8), ("offset", 12.0)] {
            let place = places.iter().position(|at| *at == name).unwrap();
            model["values"][place] = json!(value);
        }
    });
    let of = |target| prose(&export(&reversed, 0, target, &[]).text);
    let exported = export(&reversed, 0, "ardupilot", &[]);
    let [at_zero, each] = exported.line("position");
    // Six digits are written.
    assert!((at_zero - exported.servo.resting_output(0.0)).abs() < 1e-4);
    assert_eq!(each, -36.0);
    let said = prose(&exported.text);
    for part in [
        "- 36 times the output of SITL's servo, in deg. The output is from -1 to 1, and 0 under the command 0 deg.",
        "where your flight model takes the output",
        "SERVOn_REVERSED, set opposite to that of the aircraft",
        "deg of the position, ",
        "deg of the command (the recording has",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let said = of("mujoco");
    let line = "ctrl = 0.20944 - 0.0139626 times the command in deg";
    assert!(said.contains(line), "{said}");
    assert!(!prose(&export(&AIRCRAFT.file, 0, "ardupilot", &[]).text).contains("SERVOn_REVERSED"));
    let args = ["export", arg(&reversed), "--to", "mujoco"];
    let remarks = remarks(&args);
    assert!(remarks.contains(line), "{remarks}");
    // Others have both in the file.
    for target in ["c", "python", "julia", "matlab", "jsbsim"] {
        assert!(!of(target).contains("Apply beside"), "{target}");
    }
}

/// Its gain rests on the scale of the sensor, which this recording has from a data sheet.
#[test]
fn what_is_known_of_the_sensor_is_a_warning_in_every_file() {
    for target in TARGETS {
        let said = prose(&export(&AIRCRAFT.file, 0, target, &[]).text);
        let warning = "WARNING: The scale of the sensor is known to";
        assert!(said.contains(warning), "{target}: {said}");
    }
}

/// The shaft holds against friction at rest, which is 1.6 times the error of 0.2 deg, on the weaker side by the ratio of both more; the dead band
/// is 0.15 deg to each side.
#[test]
fn the_hysteresis_is_the_distance_of_the_rests() {
    let folder = tempfile::tempdir().unwrap();
    let text = SERVOS[2].export("jsbsim", folder.path(), &[]).text;
    let (_, rest) = text.split_once("<hysteresis_width>").unwrap();
    let width: f64 = rest.split('<').next().unwrap().parse().unwrap();
    let distance = 0.32 + 0.32 / 0.7 + 0.3;
    assert!((width - distance).abs() < 1e-9, "{width} {distance}");
}

#[test]
fn pulses_are_said_as_the_degrees_that_they_stand_for() {
    let folder = tempfile::tempdir().unwrap();
    let ardupilot = prose(&export(&AIRCRAFT.file, 0, "ardupilot", &[]).text);
    let said = "An output of 1 stands for 45 deg of the command, which are 45 degrees";
    assert!(ardupilot.contains(said), "{ardupilot}");
    let pulses = pulses(folder.path());
    let ardupilot = prose(&export(&pulses, 0, "ardupilot", &[]).text);
    let said = "500 us of the command: it is (pulse - 1500) / 500, as SITL takes the pulse";
    assert!(ardupilot.contains(said), "{ardupilot}");
    // -150 deg and 0.1 deg/us.
    let mujoco = prose(&export(&pulses, 0, "mujoco", &[]).text);
    let said = "ctrl = -2.61799 + 0.00174533 times the command in us";
    assert!(mujoco.contains(said), "{mujoco}");
}

#[test]
fn what_a_model_does_not_know_of_speeds_is_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let open = changed(folder.path(), |model| {
        model["quantities"][5]["determined"] = json!(false);
    });
    let said = prose(&export(&open, 0, "ardupilot", &[]).text);
    let warning = "WARNING: the recording does not determine the top speed: strokes that are faster than the recorded motion (";
    assert!(said.contains(warning), "{said}");
    let linear = SERVOS[0].export("ardupilot", folder.path(), &[]).text;
    let said = prose(&linear);
    for part in [
        "WARNING: no limit of the speed was seen up to ",
        "this file has none, and a servo has one",
        "Rate: this file has no limit, as none was reached",
        "or 0 for no limit",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(linear.contains("\nSIM_SERVO_SPEED 0.0\n"), "{linear}");
}

/// What is printed on standard error.
fn remarks(args: &[&str]) -> String {
    let output = crate::support::servoid(args).output().unwrap();
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn a_stated_frame_is_doubted_where_the_recording_is_not_of_servoid() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = crate::support::json(&AIRCRAFT.file);
    document.as_object_mut().unwrap().remove("pulse_frame_s");
    let foreign = folder.path().join("foreign.json");
    std::fs::write(&foreign, document.to_string()).unwrap();
    let exact = folder.path().join("exact.json");
    document["exact_command"] = true.into();
    std::fs::write(&exact, document.to_string()).unwrap();
    for more in [&[][..], &["--servo-model"]] {
        let of = |file: &std::path::Path, frame: &[&str]| {
            remarks(&[&["export", arg(file), "--to", "c"], more, frame].concat())
        };
        let unknown = of(&foreign, &[]);
        assert!(
            unknown.contains("no frame hold is assumed: state --frame-ms only where")
                && !unknown.contains("warning: no frame hold"),
            "{unknown}"
        );
        let stated = of(&foreign, &["--frame-ms", "20"]);
        assert!(
            stated.contains("commands with this hold are then 10.00 ms too late"),
            "{stated}"
        );
        for frame in [&[][..], &["--frame-ms", "10"]] {
            let own = of(&AIRCRAFT.file, frame);
            assert!(!own.contains("in the model already"), "{own}");
        }
        assert!(!of(&foreign, &["--frame-ms", "0"]).contains("in the model already"));
        assert!(!of(&exact, &["--frame-ms", "20"]).contains("in the model already"));
    }
}

#[test]
fn an_angle_that_is_guessed_and_a_function_in_a_file_of_another_name_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = crate::support::json(&AIRCRAFT.file);
    document.as_object_mut().unwrap().remove("units");
    let bare = folder.path().join("bare.json");
    std::fs::write(&bare, document.to_string()).unwrap();
    let said = remarks(&["export", arg(&bare), "--to", "ardupilot"]);
    assert!(
        said.contains("it is taken for degrees, by the size of the commands alone"),
        "{said}"
    );
    for (name, holds) in [("servo.xml", true), ("servo_a.xml", false)] {
        for more in [&[][..], &["--servo-model"]] {
            let out = folder.path().join(name);
            let args = ["export", arg(&AIRCRAFT.file), "--to", "jsbsim", "--force"];
            let said = remarks(&[&args[..], &["-o", arg(&out)], more].concat());
            assert_eq!(said.contains("call it servo_a.xml"), holds, "{said}");
        }
    }
    for (name, holds) in [("neg.m", true), ("servo_a.m", false)] {
        let out = folder.path().join(name);
        let said = remarks(&[
            "export",
            arg(&AIRCRAFT.file),
            "--to",
            "matlab",
            "--servo-model",
            "-o",
            arg(&out),
        ]);
        assert_eq!(said.contains("call it servo_a.m"), holds, "{said}");
    }
}

/// What was assumed, and what one number stands for, is said on the terminal, too.
#[test]
fn what_is_assumed_for_ardupilot_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let of = |file: &std::path::Path, more: &[&str]| {
        remarks(&[&["export", arg(file), "--to", "ardupilot"], more].concat())
    };
    let degrees = of(&AIRCRAFT.file, &[]);
    let said = "an output of 1 (a pulse of 2000 us) is taken for the command 45 deg: state another with --full-command";
    assert!(degrees.contains(said), "{degrees}");
    assert!(!of(&AIRCRAFT.file, &["--full-command", "30"]).contains("is taken for"));
    assert!(!of(&pulses(folder.path()), &[]).contains("is taken for"));
    let part = of(&unitless(folder.path()), &[]);
    assert!(part.contains("is taken for the command 1: state"), "{part}");
    // Speeds of 233 and 158 deg/s of the command, times the gain of 1.02.
    let unequal = of(&SERVOS[2].file(folder.path()), &[]);
    let said = "where the model has 238.0 deg/s upwards and 161.5 deg/s downwards";
    assert!(
        unequal.contains("one speed stands for two: ") && unequal.contains(said),
        "{unequal}"
    );
    assert!(!of(&SERVOS[1].file(folder.path()), &[]).contains("one speed stands for two"));
}

/// One convention for a command from -1 to 1: 1 is a pulse 500 us from the middle, which is 50 degrees of a rig and an output of 1 of ArduPilot.
#[test]
fn a_command_without_a_unit_is_simulated_as_a_part_of_a_full_one() {
    let folder = tempfile::tempdir().unwrap();
    let (model, out) = (unitless(folder.path()), folder.path().join("out.csv"));
    let simulate = ["simulate", "--servo", arg(&model), "-o", arg(&out)];
    let said = remarks(&simulate);
    let taken = "has no unit: 1 is taken for a full command, a pulse 500 us from the neutral one, which is 50 degrees of a rig";
    assert!(said.contains(taken), "{said}");
    let plan = remarks(&["plan", "--servo", arg(&model), "--length", "4"]);
    assert!(plan.contains(taken), "{plan}");
    // The rig commands 5 degrees, a tenth; 50 for each unit, and an offset of 0.2.
    let written = std::fs::read_to_string(&out).unwrap();
    let rows = written
        .lines()
        .filter_map(|line| line.split(',').nth(3)?.parse::<f64>().ok());
    let highest = rows.fold(f64::MIN, f64::max);
    // Noise and the resolution of the sensor are some tenths.
    assert!((5.0..5.8).contains(&highest), "{highest}");
    let bare = remarks(&[
        "simulate",
        "--force",
        "--servo",
        arg(&AIRCRAFT.file),
        "-o",
        arg(&out),
    ]);
    assert!(!bare.contains("is taken for"), "{bare}");
}

/// A load of the air that stiffens nowhere within the strokes.
#[test]
fn a_load_without_effect_is_not_counted_twice() {
    let folder = tempfile::tempdir().unwrap();
    let airborne = SERVOS
        .iter()
        .find(|servo| servo.name == "airborne")
        .unwrap();
    let file = airborne.file(folder.path());
    let mut document = crate::support::json(&file);
    let of = |document: &serde_json::Value| {
        std::fs::write(&file, document.to_string()).unwrap();
        prose(&export(&file, 0, "jsbsim", &[]).text)
    };
    let words = "From the same servo without the load that is left out it is";
    assert!(of(&document).contains(words));
    let model = &mut document["servo_model"];
    let place = model["coordinates"]
        .as_array()
        .unwrap()
        .iter()
        .position(|at| *at == "air_from");
    model["values"][place.unwrap()] = json!(-200.0);
    assert!(!of(&document).contains(words));
}

#[test]
fn the_controller_that_the_bandwidth_is_of_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let text = |file: &std::path::Path| {
        let model = ModelFile::read(file).unwrap().servo_model().unwrap();
        let text = of_servo_model(&model.unwrap(), Units::default(), false);
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let second = SERVOS.into_iter().find(|servo| servo.name == "second");
    let said = text(&second.unwrap().file(folder.path()));
    let sentence = "Bandwidth, damping ratio, error of full drive and what is left at rest are those with the controller 400; 800 is ";
    assert!(said.contains(sentence), "{said}");
    assert!(!text(&AIRCRAFT.file).contains("controller"));
}

#[test]
fn a_linear_model_of_a_servo_that_is_not_linear_says_what_its_offset_is() {
    let text = prose(&run(&["export", arg(&AIRCRAFT.file), "--to", "c", "-q"]));
    assert!(
        text.contains(
            "no position of rest. The servo model, which --servo-model exports, has where it rests."
        ),
        "{text}"
    );
}

/// A file from before has the directions exchanged where its gain is negative, and an offset without dead band.
#[test]
fn quantities_of_older_files_are_what_they_are_called() {
    let folder = tempfile::tempdir().unwrap();
    let older = changed(folder.path(), |model| {
        model.as_object_mut().unwrap().remove("commands");
        let gain = model["coordinates"]
            .as_array()
            .unwrap()
            .iter()
            .position(|at| *at == "gain")
            .unwrap();
        model["values"][gain] = json!(-1.0);
        model["quantities"][2]["value"] = json!(12.5);
    });
    let before = crate::support::json(&older)["servo_model"]["quantities"].clone();
    let read = ModelFile::read(&older)
        .unwrap()
        .servo_model()
        .unwrap()
        .unwrap();
    let found = &read.model.quantities;
    assert_eq!(before[5]["name"], "top speed upwards");
    assert_eq!(found[5].name, "top speed upwards");
    assert_eq!(json!(found[5].value), before[6]["value"]);
    assert_eq!(json!(found[6].value), before[5]["value"]);
    let offset = &found[2];
    let rest = read.model.parameters(0).resting_output(0.0);
    assert!(
        offset.name == "offset" && !offset.determined && offset.value == rest,
        "{offset:?}"
    );
}

/// Two of the formats take nothing else, so the option is not needed.
#[test]
fn ardupilot_and_mujoco_mean_the_servo_model() {
    for target in ["ardupilot", "mujoco"] {
        let args = ["export", arg(&AIRCRAFT.file), "--to", target, "-q"];
        assert_eq!(run(&args), export(&AIRCRAFT.file, 0, target, &[]).text);
    }
}
