//! The parameters for ArduPilot, in a servo that is computed as `libraries/SITL/ServoModel.cpp`, `AP_HAL/utility/RingBuffer.h`
//! and `Filter/LowPassFilter2p.cpp` of ArduPilot do, in single precision: a ring of commands of which the oldest is taken after the
//! newest is put in, a limit of the change in a step, and a biquad filter.

use super::subjects::{Exported, SERVOS, export, number_behind, prose};
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

fn positions(exported: &Exported) -> Vec<f64> {
    positions_of(exported, &exported.text)
}

/// The same with other parameters, of `text`.
fn positions_of(exported: &Exported, text: &str) -> Vec<f64> {
    // As the header says; the command is in deg.
    let said = prose(&exported.text);
    let full = number_behind(&said, "An output of 1 stands for ");
    let zero = number_behind(&said, "and 0 under the command ");
    let [at_zero, each] = exported.line();
    let part = |command: f64| ((command - zero) / full) as f32;
    let mut sitl = Sitl::new(text, part(exported.trial.levels[0]));
    let position = |command: &f64| at_zero + each * f64::from(sitl.step(part(*command)));
    exported.trial.command().iter().map(position).collect()
}

#[test]
fn parameters_are_as_far_from_the_servo_model_as_they_state() {
    let folder = tempfile::tempdir().unwrap();
    for servo in SERVOS {
        let exported = servo.export("ardupilot", folder.path(), &[]);
        // Single precision in a filter whose poles are close to one: 24 bits less some 10 of them.
        exported.check(servo.name, &positions(&exported), 1e-3);
    }
}

/// To the servo with its load, which the file leaves out.
#[test]
fn no_slower_and_no_quicker_servo_is_closer() {
    let folder = tempfile::tempdir().unwrap();
    for servo in SERVOS.iter().filter(|servo| servo.name != "linear") {
        let exported = servo.export("ardupilot", folder.path(), &[]);
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
    let far = export(&file, 0, "ardupilot", &[]);
    assert!(far.text.contains("of the top speed of 50000 deg/s"));
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
        exported.trial.root_mean_square(&found, &exported.exact)
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
    let exported = SERVOS[1].export("ardupilot", folder.path(), &["--step-ms", "2.5"]);
    assert!(exported.text.contains("SIM_RATE_HZ 400\n"));
    exported.check("400 Hz", &positions(&exported), 1e-3);
}
