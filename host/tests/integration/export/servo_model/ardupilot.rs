//! The parameters for ArduPilot, in a servo that is computed as `libraries/SITL/ServoModel.cpp`, `AP_HAL/utility/RingBuffer.h`
//! and `Filter/LowPassFilter2p.cpp` of ArduPilot do, in single precision: a ring of commands of which the oldest is taken after the
//! newest is put in, a limit of the change in a step, and a biquad filter.

use super::smooth::Smooth;
use super::subjects::{Exported, SERVOS, export, number_behind, prose, pulses, unitless};
use std::collections::VecDeque;

/// A servo of SITL. Commands and positions are parts of the full deflection.
struct Sitl {
    ring: VecDeque<f32>,
    largest_change: Option<f32>,
    last: f32,
    a: [f32; 2],
    b: [f32; 3],
    elements: [f32; 2],
}

impl Sitl {
    fn new(text: &str, first: f32) -> Self {
        let value = |name: &str| -> f32 {
            let rows = text.lines().filter_map(|line| line.split_once(' '));
            let (_, value) = rows.into_iter().find(|(key, _)| *key == name).unwrap();
            value.parse().unwrap()
        };
        let rate = value("SIM_RATE_HZ");
        let capacity = (value("SIM_SERVO_DELAY") * rate).max(1.0) as usize;
        let speed = value("SIM_SERVO_SPEED");
        // The full deflection is 45 degrees there.
        let change = |speed: f32| 1.0 / (45.0 * (speed / 60.0)) / rate;
        let bent = (std::f32::consts::PI / (rate / value("SIM_SERVO_FILTER"))).tan();
        let quarter = 2.0 * std::f32::consts::FRAC_PI_4.cos() * bent;
        let c = 1.0 + quarter + bent * bent;
        let b0 = bent * bent / c;
        let a = [
            2.0 * (bent * bent - 1.0) / c,
            (1.0 - quarter + bent * bent) / c,
        ];
        Self {
            ring: std::iter::repeat_n(first, capacity - 1).collect(),
            largest_change: (speed > 0.0).then(|| change(speed)),
            last: first,
            a,
            b: [b0, 2.0 * b0, b0],
            // At rest: the element that gives `first` with a gain of one.
            elements: [first / (1.0 + a[0] + a[1]); 2],
        }
    }

    fn step(&mut self, command: f32) -> f32 {
        self.ring.push_back(command);
        let mut value = self.ring.pop_front().unwrap();
        if let Some(change) = self.largest_change {
            value = value.clamp(self.last - change, self.last + change);
            value = value.clamp(-1.0, 1.0);
            self.last = value;
        }
        let ([a1, a2], [b0, b1, b2], [e1, e2]) = (self.a, self.b, self.elements);
        let newest = value - e1 * a1 - e2 * a2;
        self.elements = [newest, e1];
        newest * b0 + e1 * b1 + e2 * b2
    }
}

/// The wait for a pulse is in the delay, and the trial has none.
const WITHOUT_WAIT: &[&str] = &["--frame-ms", "0"];

fn positions(exported: &Exported) -> Vec<f64> {
    positions_of(exported, &exported.text)
}

/// The same with other parameters, of `text`.
fn positions_of(exported: &Exported, text: &str) -> Vec<f64> {
    under(exported, text, &exported.trial.command())
}

/// The same under other commands, at the beginning of each step.
fn under(exported: &Exported, text: &str, commands: &[f64]) -> Vec<f64> {
    // As the header says.
    let said = prose(&exported.text);
    let full = number_behind(&said, "An output of 1 stands for ");
    let zero = number_behind(&said, "and 0 under the command ");
    let [at_zero, each] = exported.line("position");
    let part = |command: f64| ((command - zero) / full) as f32;
    let mut sitl = Sitl::new(text, part(commands[0]));
    let position = |command: &f64| at_zero + each * f64::from(sitl.step(part(*command)));
    commands.iter().map(position).collect()
}

#[test]
fn parameters_are_as_far_from_the_servo_model_as_they_state() {
    let folder = tempfile::tempdir().unwrap();
    for servo in SERVOS {
        let exported = servo.export("ardupilot", folder.path(), WITHOUT_WAIT);
        // Single precision in a filter whose poles are close to one: 24 bits less some 10 of them.
        exported.check(servo.name, &positions(&exported), 1e-3);
    }
}

#[test]
fn reversals_are_no_farther_than_they_state() {
    let folder = tempfile::tempdir().unwrap();
    for servo in SERVOS {
        let exported = servo.export("ardupilot", folder.path(), WITHOUT_WAIT);
        exported.check_reversals(servo.name, |commands| {
            under(&exported, &exported.text, commands)
        });
    }
}

/// To the servo with its load, which the file leaves out.
#[test]
fn no_slower_and_no_quicker_servo_is_closer() {
    let folder = tempfile::tempdir().unwrap();
    for servo in SERVOS.iter().filter(|servo| servo.name != "linear") {
        let exported = servo.export("ardupilot", folder.path(), WITHOUT_WAIT);
        require_closest(servo.name, &exported);
    }
    // The same full drive, and a top speed that strokes of the recording are far from.
    let file = SERVOS[1].file(folder.path());
    let mut document = crate::support::json(&file);
    let values = document["servo_model"]["values"].as_array_mut().unwrap();
    for (value, far) in values.iter_mut().rev().zip([0.3 / 200.0, 5e4f64.ln()]) {
        *value = far.into();
    }
    std::fs::write(&file, document.to_string()).unwrap();
    let far = export(&file, 0, "ardupilot", WITHOUT_WAIT);
    let lines = far.text.lines().map(|line| line.trim_start_matches('#'));
    let words: Vec<&str> = lines.flat_map(str::split_whitespace).collect();
    let said = words.join(" ");
    assert!(
        said.contains("of the model's top speed of 50000 deg/s"),
        "{said}"
    );
    require_closest("far", &far);
}

fn require_closest(name: &str, exported: &Exported) {
    let time_s = number_behind(&exported.text, "\nSIM_SERVO_SPEED ");
    let line = |time_s: f64| format!("\nSIM_SERVO_SPEED {time_s}\n");
    let difference = |factor: f64| {
        let other = line(factor * time_s);
        let text = exported.text.replace(&line(time_s), &other);
        assert!(text.contains(&other), "{name}");
        let found = positions_of(exported, &text);
        let trial = &exported.trial;
        trial.root_mean_square(trial.staircase(&found), trial.staircase(&exported.exact))
    };
    let best = difference(1.0);
    let share = number_behind(&prose(&exported.text), "deg/s, which is ");
    // Rates that are tried are 3 % apart, and none is above the top speed.
    let is_highest = share > 94.0;
    assert!(best <= difference(1.06), "{name}");
    assert!(is_highest || best <= difference(1.0 / 1.06), "{name}");
}

#[test]
fn another_rate_is_written_and_used() {
    let folder = tempfile::tempdir().unwrap();
    let options = [WITHOUT_WAIT, &["--step-ms", "2.5"]].concat();
    let exported = SERVOS[1].export("ardupilot", folder.path(), &options);
    assert!(exported.text.contains("SIM_RATE_HZ 400\n"));
    exported.check("400 Hz", &positions(&exported), 1e-3);
}

/// Recorded from 1100 to 1596 us: SITL's output is 0 at 1500 us, and 1 at 2000 us, whatever the recording's middle is.
#[test]
fn a_pulse_is_taken_as_sitl_takes_it() {
    let folder = tempfile::tempdir().unwrap();
    let exported = export(&pulses(folder.path()), 0, "ardupilot", WITHOUT_WAIT);
    let said = prose(&exported.text);
    assert_eq!(number_behind(&said, "and 0 under the command "), 1500.0);
    assert_eq!(number_behind(&said, "An output of 1 stands for "), 500.0);
    let [at_zero, each] = exported.line("position");
    // Six digits are written.
    let position = |pulse: f64| at_zero + each * (pulse - 1500.0) / 500.0;
    for pulse in [1100.0, 1596.0] {
        let rest = exported.servo.resting_output(pulse);
        assert!((position(pulse) - rest).abs() < 1e-3, "{pulse}: {rest}");
    }
    exported.check("pulses", &positions(&exported), 1e-3);
}

/// The speed of a servo of which a full command is stated is written for that: nothing is left to be multiplied.
#[test]
fn a_stated_full_command_is_in_the_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let file = SERVOS[1].file(folder.path());
    let stated = |full: &'static str| {
        let options = [WITHOUT_WAIT, &["--full-command", full]].concat();
        export(&file, 0, "ardupilot", &options)
    };
    let (small, large) = (stated("25"), stated("50"));
    for (exported, full) in [(&small, 25.0), (&large, 50.0)] {
        exported.check("stated", &positions(exported), 1e-3);
        let said = number_behind(&prose(&exported.text), "An output of 1 stands for ");
        assert_eq!(said, full);
        assert!((exported.line("position")[1] - 1.02 * full).abs() < 1e-3);
    }
    let time_s = |exported: &Exported| number_behind(&exported.text, "\nSIM_SERVO_SPEED ");
    assert!((time_s(&large) / time_s(&small) - 2.0).abs() < 1e-9);
}

/// A command of -1 to 1 without a unit is SITL's output itself.
#[test]
fn a_small_command_without_a_unit_is_a_part_of_a_full_one() {
    let folder = tempfile::tempdir().unwrap();
    let file = unitless(folder.path());
    let exported = export(&file, 0, "ardupilot", WITHOUT_WAIT);
    let said = prose(&exported.text);
    assert_eq!(number_behind(&said, "An output of 1 stands for "), 1.0);
    assert_eq!(number_behind(&said, "and 0 under the command "), 0.0);
    exported.check("unitless", &positions(&exported), 1e-3);
}

#[test]
fn a_known_frame_is_in_the_delay() {
    let folder = tempfile::tempdir().unwrap();
    let of = |frame: &str| {
        let text = SERVOS[1].export("ardupilot", folder.path(), &["--frame-ms", frame]);
        number_behind(&text.text, "\nSIM_SERVO_DELAY ")
    };
    // Half of 20 ms are 12 steps of 1200 in a second.
    assert!((of("20") - of("0") - 0.01).abs() < 1e-9);
}

/// Of the held command the servo is as much later as the header says: the wait is in the delay.
#[test]
fn parameters_are_as_late_as_they_state() {
    let folder = tempfile::tempdir().unwrap();
    for frame in ["0", "20"] {
        let exported = SERVOS[1].export("ardupilot", folder.path(), &["--frame-ms", frame]);
        let smooth = Smooth::of(&exported, 1e-3 * frame.parse::<f64>().unwrap());
        let found = under(&exported, &exported.text, &smooth.command(0.0));
        smooth.check(&exported, &found);
    }
}
