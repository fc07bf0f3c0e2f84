//! Servos with all terms, and their exports.

use crate::support::{arg, run};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use servoid::data::model_file::ModelFile;
use servoid::presentation::export::servo_model::{Held, Trial};
use servoid_dynamics::{Grid, Start, simulate};
use servoid_identification::servo_model::ServoParameters;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// A model file with a servo model, identified once.
pub struct Identified {
    _folder: tempfile::TempDir,
    pub file: PathBuf,
}

pub static AIRCRAFT: LazyLock<Identified> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let (record, file) = (folder.path().join("a.csv"), folder.path().join("a.json"));
    let simulate = ["simulate", "--servo", "aircraft", "--seed", "1"];
    run(&[&simulate[..], &["-o", arg(&record)]].concat());
    run(&[
        "identify",
        arg(&record),
        "--servo-model",
        "-o",
        arg(&file),
        "-q",
    ]);
    Identified {
        _folder: folder,
        file,
    }
});

/// What a servo model is exported to.
pub const TARGETS: [&str; 7] = [
    "c",
    "python",
    "julia",
    "matlab",
    "jsbsim",
    "ardupilot",
    "mujoco",
];

/// A model of the aircraft's servo, changed by `change`, in a folder.
pub fn changed(folder: &Path, change: impl Fn(&mut Value)) -> PathBuf {
    let mut document = crate::support::json(&AIRCRAFT.file);
    change(&mut document["servo_model"]);
    let file = folder.join("changed.json");
    std::fs::write(&file, document.to_string()).unwrap();
    file
}

/// A servo that is made of chosen terms.
#[derive(Clone, Copy)]
pub struct Servo {
    /// A word, of which file and identifier are made.
    pub name: &'static str,
    pub terms: &'static [&'static str],
    pub load: &'static str,
    /// The name of the controller of the export.
    pub controller: Option<f64>,
}

const ALL_TERMS: &[&str] = &[
    "limit",
    "two_speeds",
    "dead_band",
    "play",
    "friction",
    "gears",
];

/// One with each term and each load, one without any, one that runs into its stops, and those whose speed is cut off.
pub const SERVOS: [Servo; 15] = [
    servo("linear", &[], "none"),
    servo("limited", &["limit"], "none"),
    servo(
        "full",
        &["limit", "two_speeds", "dead_band", "friction"],
        "none",
    ),
    servo("constant", ALL_TERMS, "constant"),
    servo("hanging", ALL_TERMS, "pendulum"),
    servo("tilted", ALL_TERMS, "tilted_pendulum"),
    servo("airborne", ALL_TERMS, "air"),
    Servo {
        controller: Some(800.0),
        ..servo("second", ALL_TERMS, "constant")
    },
    servo("weightless", &["limit"], "none"),
    // The load pushes it through the dead band.
    servo("pushed", &["limit", "two_speeds", "dead_band"], "constant"),
    servo("stopped", &["limit", "play", "friction"], "constant"),
    servo("clipped", &["speed_limit"], "none"),
    servo(
        "profiled",
        &["limit", "speed_limit", "two_speeds", "friction"],
        "constant",
    ),
    servo("sprung", ALL_TERMS, "spring"),
    // As a draw may be: the directions differ in the limit alone.
    servo(
        "uneven",
        &[
            "limit",
            "two_speeds",
            "one_stiffness",
            "dead_band",
            "friction",
        ],
        "none",
    ),
];

const fn servo(name: &'static str, terms: &'static [&'static str], load: &'static str) -> Servo {
    Servo {
        name,
        terms,
        load,
        controller: None,
    }
}

/// The text of a file as one line, without the signs of comments.
pub fn prose(text: &str) -> String {
    let lines = text
        .lines()
        .map(|line| line.trim_start_matches(['#', '%', '*', ' ']));
    lines.collect::<Vec<_>>().join(" ")
}

/// The number behind these words.
pub fn number_behind(text: &str, words: &str) -> f64 {
    let (_, rest) = text.split_once(words).unwrap();
    let number = rest.split(char::is_whitespace).next().unwrap();
    number.parse().unwrap()
}

/// Motion that turns round before the servo rests.
#[derive(Clone, Copy, Debug)]
enum Reversals {
    Square,
    Sine,
    /// One stroke there and one back.
    Doublet,
}

/// An export, as `--json` describes it.
pub struct Exported {
    pub text: String,
    pub trial: Trial,
    pub stated: f64,
    /// In strokes that are held or broken off once.
    pub stated_in_strokes: f64,
    pub servo: ServoParameters,
    /// The position at the beginning of each step, by servoid's integrator.
    pub exact: Vec<f64>,
}

impl Exported {
    /// Requires that positions are as far from servoid's as the file states, within `tolerance` of the largest stroke.
    pub fn check(&self, name: &str, positions: &[f64], tolerance: f64) {
        let stroke = self.largest_stroke();
        let found = self.trial.largest_difference(positions, &self.exact);
        assert_eq!(positions.len(), self.exact.len(), "{name}");
        assert!(
            (found - self.stated).abs() <= tolerance * stroke,
            "{name}: {found} for {} of {stroke}",
            self.stated
        );
    }

    /// Requires that this program, under commands that no search had, is hardly farther from the servo than the file states: squares, sines
    /// and a doublet over the recorded range, as a loop has them, and random strokes.
    pub fn check_reversals(&self, name: &str, run: impl Fn(&[f64]) -> Vec<f64>) {
        let kinds = [Reversals::Square, Reversals::Sine, Reversals::Doublet];
        let half_periods_s = [0.06, 0.1, 0.14, 0.2, 0.3, 0.45];
        let reversals = kinds.into_iter().flat_map(|kind| {
            half_periods_s.map(|half_period_s| {
                let what = format!("{kind:?}, {half_period_s} s");
                (what, self.reversals(kind, half_period_s))
            })
        });
        let random = (0..4).map(|seed| (format!("seed {seed}"), self.random_strokes(seed)));
        let commands: Vec<(String, Vec<f64>)> = reversals.chain(random).collect();
        // One behind the other, each from rest: a program starts once.
        let rest = vec![self.trial.levels[0]; self.trial.steps_per_level];
        let parts = commands.iter().flat_map(|(_, command)| [&rest, command]);
        let all: Vec<f64> = parts.flatten().copied().collect();
        let (positions, exact) = (run(&all), self.exact_under(&all));
        let mut end = 0;
        for (what, command) in &commands {
            let begin = end + rest.len();
            end = begin + command.len();
            let pairs = positions[begin..end].iter().zip(&exact[begin..end]);
            let found = pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            // Seldom is a command that the search has not had a tenth farther.
            let stated = self.stated + 0.01 * self.largest_stroke();
            assert!(
                found <= 1.1 * stated,
                "{name}, {what}: {found} for {}",
                self.stated
            );
        }
    }

    /// Requires that this program is hardly farther from the servo than the file states in strokes that are broken off once, at times that no search
    /// had: between both ends, and between random levels.
    pub fn check_broken_off(&self, name: &str, run: impl Fn(&[f64]) -> Vec<f64>) {
        let Trial { levels, .. } = &self.trial;
        let (least, largest) = (
            levels.iter().copied().reduce(f64::min),
            levels.iter().copied().reduce(f64::max),
        );
        let (least, largest) = (least.unwrap(), largest.unwrap());
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let rest = self.trial.steps_per_level;
        let mut strokes: Vec<[(f64, usize); 3]> = Vec::new();
        for stroke in 0..24 {
            let [from, to, then] = match stroke % 4 {
                0 => [least, largest, least],
                1 => [largest, least, largest],
                2 => [levels[0], largest, least],
                _ => [(); 3].map(|()| random.random_range(least..=largest)),
            };
            let steps = (rest as f64).powf(random.random_range(0.2..1.0)) as usize;
            strokes.push([(from, rest), (to, steps), (then, rest)]);
        }
        let held = strokes.iter().flatten();
        let all: Vec<f64> = held
            .flat_map(|(level, steps)| std::iter::repeat_n(*level, *steps))
            .collect();
        let (positions, exact) = (run(&all), self.exact_under(&all));
        let mut begin = 0;
        for [from, to, then] in strokes {
            let end = begin + from.1 + to.1 + then.1;
            let compared = begin + from.1..end;
            let pairs = positions[compared.clone()].iter().zip(&exact[compared]);
            let found = pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            let stated = self.stated_in_strokes + 0.01 * self.largest_stroke();
            assert!(
                found <= 1.1 * stated,
                "{name}, {from:?}, {to:?}, {then:?}: {found} for {}",
                self.stated_in_strokes
            );
            begin = end;
        }
    }

    /// Random holds, between both ends or at random levels.
    fn random_strokes(&self, seed: u64) -> Vec<f64> {
        let Trial { levels, step_s, .. } = &self.trial;
        let ends = levels.iter().copied();
        let largest = ends.clone().fold(f64::NEG_INFINITY, f64::max);
        let least = ends.fold(f64::INFINITY, f64::min);
        let mut random = ChaCha8Rng::seed_from_u64(100 + seed);
        let mut commands = vec![levels[0]; self.trial.steps_per_level];
        for stroke in 0..30 {
            let level = match (seed % 4, stroke % 2) {
                (3, _) => random.random_range(least..largest),
                (_, 0) => largest,
                (_, _) => least,
            };
            let held_s = 0.03 * 15f64.powf(random.random_range(0.0..1.0));
            commands.extend(vec![level; (held_s / step_s).ceil() as usize]);
        }
        commands
    }

    /// From rest under the first level, between the largest and the least.
    fn reversals(&self, kind: Reversals, half_period_s: f64) -> Vec<f64> {
        let Trial { levels, step_s, .. } = &self.trial;
        let ends = levels.iter().copied();
        let largest = ends.clone().fold(f64::NEG_INFINITY, f64::max);
        let least = ends.fold(f64::INFINITY, f64::min);
        let command = |step: usize| {
            let halves = step as f64 * step_s / half_period_s - 2.0;
            let (middle, most) = ((largest + least) / 2.0, (largest - least) / 2.0);
            match kind {
                _ if halves < 0.0 => levels[0],
                Reversals::Doublet if halves >= 2.0 => levels[0],
                Reversals::Sine => middle + most * (std::f64::consts::PI * halves).sin(),
                _ if (halves as usize).is_multiple_of(2) => largest,
                _ => least,
            }
        };
        (0..(16.0 * half_period_s / step_s) as usize)
            .map(command)
            .collect()
    }

    /// The position of servoid's integrator.
    fn exact_under(&self, commands: &[f64]) -> Vec<f64> {
        let grid = Grid::for_stiffness(self.trial.step_s, 0.0, self.servo.stiffness);
        let rest = self.servo.resting_output(commands[0]);
        let start = Start::at_rest(rest, Some(commands[0]));
        let mut exact = Vec::new();
        simulate(&self.servo, &grid, &start, commands, |_, y| exact.push(y));
        exact
    }

    /// Requires that the servo stays where it is put at rest under the first command, from the first position `found` on.
    pub fn check_rest(&self, name: &str, found: f64, tolerance: f64) {
        let rest = self.servo.resting_output(self.trial.levels[0]);
        assert!(
            (found - rest).abs() <= tolerance * self.largest_stroke(),
            "{name}: {found}, at rest {rest}"
        );
    }

    /// The line that the header has for `what`: where that with which it is multiplied is 0, and for each unit of that.
    pub fn line(&self, what: &str) -> [f64; 2] {
        let said = prose(&self.text);
        // The equation has one, too.
        let (_, line) = said.rsplit_once(&format!("{what} = ")).unwrap();
        let words: Vec<&str> = line.split(' ').take(3).collect();
        let [at_zero, sign, each] = words[..] else {
            panic!("{line}");
        };
        [at_zero, &format!("{sign}{each}")].map(|number| number.parse().unwrap())
    }

    /// Of the position.
    pub fn largest_stroke(&self) -> f64 {
        let strokes = self.trial.levels.windows(2).map(|w| (w[1] - w[0]).abs());
        strokes.fold(0.0, f64::max) * self.servo.gain.abs()
    }
}

impl Servo {
    /// Its model file, in a folder.
    pub fn file(&self, folder: &Path) -> PathBuf {
        let mut document = crate::support::json(&AIRCRAFT.file);
        self.replace(&mut document["servo_model"]);
        let path = folder.join(format!("{}.json", self.name));
        std::fs::write(&path, document.to_string()).unwrap();
        path
    }

    fn replace(&self, model: &mut Value) {
        let has = |term: &str| self.terms.contains(&term);
        // One without a delay, and the others with one of a part of a step.
        let delay = if self.name == "linear" { 0.0 } else { 0.0213 };
        // One whose speed alone is limited: it follows with a lag of 12 ms.
        let (stiffness, damping): (f64, f64) = match self.name {
            "weightless" => (1.2e6, 1.44e4),
            _ => (1500.0, 60.0),
        };
        let mut pairs: Vec<(Value, f64)> = vec![
            (json!("delay"), delay),
            (json!("ln_stiffness"), stiffness.ln()),
            (json!("ln_damping"), damping.ln()),
            (json!("gain"), 1.02),
            (json!("offset"), 0.3),
        ];
        let mut with = |wanted: bool, names: &[(&str, f64)]| {
            let named = names.iter().map(|(name, value)| (json!(name), *value));
            pairs.extend(named.filter(|_| wanted));
        };
        with(has("speed_limit"), &[("ln_speed_limit", 80f64.ln())]);
        with(
            has("limit") && has("speed_limit"),
            &[("ln_acceleration", 5000f64.ln())],
        );
        with(
            has("limit") && !has("speed_limit"),
            &[("ln_top_speed", 250f64.ln()), ("motor_share", 0.3)],
        );
        with(has("two_speeds"), &[("ln_down_to_up", 0.7f64.ln())]);
        with(has("dead_band"), &[("dead_band", 0.15)]);
        with(has("play"), &[("play", 0.25)]);
        with(
            has("friction"),
            &[("friction", 0.2), ("friction_at_rest", 0.6)],
        );
        with(has("gears"), &[("friction_of_gears", 0.2)]);
        with(self.load == "constant", &[("constant_load", 0.4)]);
        with(self.load == "pendulum", &[("gravity", 1.0)]);
        with(
            self.load == "tilted_pendulum",
            &[("gravity", 1.0), ("gravity_from", 20.0)],
        );
        with(
            self.load == "spring",
            &[("constant_load", -0.3), ("spring", 0.08)],
        );
        with(
            self.load == "air",
            &[
                ("constant_load", 0.2),
                ("air_stiffening", -0.004),
                ("air_from", 2.0),
            ],
        );
        let controllers = 1 + usize::from(self.controller.is_some());
        if self.controller.is_some() {
            pairs.push((json!({ "ln_own_stiffness": 1 }), 1.5f64.ln()));
            model["controller_names"] = json!([400.0, 800.0]);
        }
        model["terms"] = json!({
            "limit": has("limit"),
            "two_speeds": has("two_speeds"),
            "one_stiffness": has("one_stiffness"),
            "speed_limit": has("speed_limit"),
            "dead_band": has("dead_band"),
            "play": has("play"),
            "friction": has("friction"),
            "friction_of_gears": has("gears"),
            "load": self.load,
        });
        model["controllers"] = controllers.into();
        let (names, values): (Vec<Value>, Vec<f64>) = pairs.into_iter().unzip();
        model["coordinates"] = names.into();
        model["values"] = values.into();
        model["alternatives"] = json!([]);
        if self.name == "stopped" {
            model["stops"] = json!({ "lower": -4.2, "upper": 3.1 });
        }
    }

    /// The file of one that turns against its command, by 0.8 of it.
    pub fn reversed(&self, folder: &Path) -> PathBuf {
        let mut document = crate::support::json(&self.file(folder));
        let values = document["servo_model"]["values"].as_array_mut().unwrap();
        values[3] = json!(-0.8);
        values[4] = json!(2.0);
        let file = folder.join(format!("{}_reversed.json", self.name));
        std::fs::write(&file, document.to_string()).unwrap();
        file
    }

    /// Exports it.
    pub fn export(&self, target: &str, folder: &Path, more: &[&str]) -> Exported {
        let controller = self.controller.map(|name| name.to_string());
        let mut options = vec!["--name", self.name];
        options.extend(controller.iter().flat_map(|name| ["--controller", name]));
        options.extend(more);
        let index = usize::from(self.controller.is_some());
        export(&self.file(folder), index, target, &options)
    }
}

/// Exports the servo model of a file with its controller number `controller`.
pub fn export(file: &Path, controller: usize, target: &str, more: &[&str]) -> Exported {
    let args = [
        "export",
        arg(file),
        "--servo-model",
        "--to",
        target,
        "--json",
        "-q",
    ];
    let result: Value = serde_json::from_str(&run(&[&args[..], more].concat())).unwrap();
    let trial = &result["trial"];
    let numbers = |value: &Value| -> Vec<f64> { serde_json::from_value(value.clone()).unwrap() };
    let steps = |name: &str| serde_json::from_value(trial[name].clone()).unwrap();
    let trial = Trial {
        step_s: trial["step_s"].as_f64().unwrap(),
        levels: numbers(&trial["levels"]),
        steps_per_level: steps("steps_per_level"),
        steps_of_broken_off: steps("steps_of_broken_off"),
        steps_of_reversals: serde_json::from_value(trial["steps_of_reversals"].clone()).unwrap(),
        worst: held(&trial["worst"]),
        worst_broken_off: held(&trial["worst_broken_off"]),
    };
    let model = ModelFile::read(file)
        .unwrap()
        .servo_model()
        .unwrap()
        .unwrap();
    let servo = model.model.parameters(controller);
    Exported {
        text: result["text"].as_str().unwrap().to_owned(),
        stated: result["largest_difference"].as_f64().unwrap(),
        stated_in_strokes: result["largest_difference_in_strokes"].as_f64().unwrap(),
        exact: trial.exact(&servo),
        trial,
        servo,
    }
}

/// The strokes of a search.
fn held(strokes: &Value) -> Vec<Held> {
    let strokes = strokes.as_array().unwrap().iter();
    let held = strokes.map(|held| Held {
        level: held["level"].as_f64().unwrap(),
        steps: serde_json::from_value(held["steps"].clone()).unwrap(),
    });
    held.collect()
}

/// The file of a servo whose command is a pulse, recorded on one side of 1500 us.
pub fn pulses(folder: &Path) -> PathBuf {
    rescaled(
        folder,
        "pulses",
        json!({ "input": "us", "output": "deg" }),
        [0.1, -150.0],
        [1100.0, 1596.0],
    )
}

/// That of one whose command has no unit, and goes from -0.74 to 0.73.
pub fn unitless(folder: &Path) -> PathBuf {
    rescaled(
        folder,
        "unitless",
        json!({ "output": "deg" }),
        [50.0, 0.2],
        [-0.74, 0.73],
    )
}

/// The limited servo with other units, gain and offset, and commands.
fn rescaled(
    folder: &Path,
    name: &str,
    units: Value,
    line: [f64; 2],
    commands: [f64; 2],
) -> PathBuf {
    let file = SERVOS[1].file(folder);
    let mut document = crate::support::json(&file);
    document["units"] = units;
    let model = &mut document["servo_model"];
    model["radians_per_command"] = json!(if commands[1] < 1.0 {
        1.0
    } else {
        1f64.to_radians()
    });
    model["commands"] = json!({ "least": commands[0], "largest": commands[1] });
    let [gain, offset] = line;
    // The same motion of the position.
    let top_speed = (250.0 * 1.02 / gain).ln();
    let values = model["values"].as_array_mut().unwrap();
    for (place, value) in [(3, gain), (4, offset), (5, top_speed)] {
        values[place] = json!(value);
    }
    let file = folder.join(format!("{name}.json"));
    std::fs::write(&file, document.to_string()).unwrap();
    file
}

/// Positions at the ends of steps as those at their beginnings: the first is that of the integrator.
pub fn from_ends(exported: &Exported, ends: &[f64]) -> Vec<f64> {
    let mut positions = vec![exported.exact[0]];
    positions.extend(&ends[..ends.len() - 1]);
    positions
}
