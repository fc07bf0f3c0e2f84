use super::*;
use crate::data::rig_file::FULL_SCALE_VOLTS;
use crate::instrument::reference::ReferenceSpec;

impl RigAnswers {
    /// Checks all answers, in the order of the questions.
    fn check(&self) -> Checked {
        check_name(&self.name)?;
        check_condition(&self.condition)?;
        check_name(&self.servo)?;
        check_pulse_rate(self.pulse_rate_hz, self.pulse_type)?;
        check_pulses(&self.pulses_us, self.pulse_type)?;
        check_neutral(self.neutral_us, &self.pulses_us)?;
        check_us_per_degree(&self.us_per_degree)?;
        check_travel(&self.travel_deg)?;
        check_name(&self.sensor)?;
        check_volts(&self.sensor_volts, &self.sensor_kind.preset())?;
        check_sensor_degrees(&self.sensor_degrees)?;
        self.sensor_delay_ms.iter().try_for_each(check_delay)
    }
}

#[test]
fn default_answers_are_the_default_rig() {
    let (text, rig) = RigAnswers::default()
        .to_rig_file("rig.toml".as_ref())
        .unwrap();
    let default = RigFile::default();
    assert!(text.contains("# reading at 0 degrees"), "{text}");
    // Within what the board takes by itself, and with room for what a reference does by itself.
    let [shortest, longest] = [rig.limits.shortest_us, rig.limits.longest_us];
    assert_eq!([shortest, longest], [1400, 1600]);
    let resolved = ReferenceSpec::default()
        .resolve(default.servo.us_per_degree)
        .unwrap();
    let (_, farthest) = resolved.reference.extremes_us();
    let room = i32::from(longest) - i32::from(default.servo.neutral_us);
    assert_eq!(room, 2 * i32::from(farthest));
    assert_eq!(rig.servo, default.servo);
    let sensor = SensorSection {
        name: rig.sensor.name.clone(),
        // Of its data sheet; without a rig file no delay is known.
        delay_ms: 4.0,
        delay_uncertainty_ms: 2.0,
        ..default.sensor
    };
    assert_eq!(rig.sensor, sensor);
    assert!(!text.contains("{{"), "{text}");
}

#[test]
fn a_narrow_pulse_servo_gets_half_of_everything() {
    let mut answers = RigAnswers::default();
    answers.take_pulse_type(PulseTypeName::Narrow);
    answers.pulse_rate_hz = 560.0;
    answers.check().unwrap();
    let (_, rig) = answers.to_rig_file("rig.toml".as_ref()).unwrap();
    assert_eq!((rig.servo.neutral_us, rig.servo.us_per_degree), (760, 5.0));
    assert_eq!((rig.limits.shortest_us, rig.limits.longest_us), (710, 810));
    assert_eq!(rig.train().period_us, 1_786);
}

#[test]
fn each_answer_arrives_whatever_is_in_it() {
    let answers = RigAnswers {
        name: "a \"quoted\" name \\ {{port}} # ü".into(),
        port: Some("tcp:localhost:7000".into()),
        condition: "aircraft, rotor off".into(),
        servo: "S1".into(),
        pulse_type: PulseTypeName::Wide,
        pulse_rate_hz: 333.0,
        neutral_us: 1520,
        us_per_degree: -9.5,
        pulses_us: "900:2100".parse().unwrap(),
        travel_deg: "-20:30".parse().unwrap(),
        sensor_kind: SensorKind::Linear,
        sensor_delay_ms: [1.5, 0.25],
        sensor: "H".into(),
        sensor_volts: "0.25:4.75".parse().unwrap(),
        sensor_degrees: -90.0,
    };
    answers.check().unwrap();
    let (text, rig) = answers.to_rig_file("rig.toml".as_ref()).unwrap();
    assert_eq!(rig.name, answers.name);
    assert_eq!(rig.port, answers.port);
    assert_eq!(rig.condition.as_deref(), Some("aircraft, rotor off"));
    assert_eq!(
        (rig.servo.neutral_us, rig.servo.us_per_degree),
        (1520, -9.5)
    );
    // The longer pulse is the lower angle: 1520 - 30 · 9.5 and 1520 + 20 · 9.5, rounded inwards.
    assert_eq!(
        (rig.limits.shortest_us, rig.limits.longest_us),
        (1235, 1710)
    );
    assert!(text.contains("From -20.0 to 30.0 degrees"), "{text}");
    assert_eq!(
        [rig.sensor.delay_ms, rig.sensor.delay_uncertainty_ms],
        [1.5, 0.25]
    );
    let scale = rig.sensor_scale();
    let counts = |volts: f64| volts / FULL_SCALE_VOLTS * 4.0 * 4096.0;
    let at = |volts: f64| (counts(volts) - scale.zero_counts) * scale.degrees_per_count;
    // Rounding of numbers of 1e4 counts.
    assert!((at(0.25) - 45.0).abs() < 1e-9 && (at(4.75) + 45.0).abs() < 1e-9);
}

#[test]
fn each_mistake_has_its_sentence() {
    type Change = fn(&mut RigAnswers);
    let cases: [(Change, &str); 11] = [
        (|a| a.name = "a\nb".into(), "one line"),
        (|a| a.condition = " ".into(), "needs a name"),
        (|a| a.pulses_us = "700:2000".parse().unwrap(), "800 to 2200"),
        (|a| a.pulses_us = "1000.5:2000".parse().unwrap(), "whole"),
        (|a| a.neutral_us = 900, "1000:2000"),
        (|a| a.us_per_degree = 0.0, "10 µs"),
        (|a| a.us_per_degree = f64::NAN, "10 µs"),
        (|a| a.travel_deg = "5:20".parse().unwrap(), "below 0"),
        (|a| a.sensor_volts = "0.5:5.5".parse().unwrap(), "0 to 5 V"),
        (|a| a.sensor_delay_ms = [1.0, -1.0], "milliseconds"),
        (|a| a.sensor_degrees = 0.0, "3600"),
    ];
    for (change, word) in cases {
        let mut answers = RigAnswers::default();
        change(&mut answers);
        let said = answers.check().unwrap_err();
        assert!(said.contains(word), "{said}");
    }
}

/// A simulated rig reads the angle at once; on a board the sensor lags by its data sheet.
#[test]
fn each_kind_of_sensor_has_its_scale_and_its_delay() {
    for kind in SensorKind::ALL {
        for (port, lags) in [(None, true), (Some("sim:bench".to_owned()), false)] {
            let mut answers = RigAnswers {
                port,
                ..RigAnswers::default()
            };
            answers.take_sensor(kind);
            answers.check().unwrap();
            let (text, rig) = answers.to_rig_file("rig.toml".as_ref()).unwrap();
            let preset = kind.preset();
            // The port may become that of a board, whose delay the file then has to state.
            let noted = !lags && preset.delay_ms[0] > 0.0;
            assert_eq!(text.contains("with a board, write"), noted, "{text}");
            let expected = if lags { preset.delay_ms } else { [0.0, 0.0] };
            let sensor = &rig.sensor;
            assert_eq!([sensor.delay_ms, sensor.delay_uncertainty_ms], expected);
            let [low, high] = preset.volts;
            let counts = (high - low) / preset.full_scale_volts * 4.0 * 4096.0;
            assert!((sensor.degrees_per_count * counts - preset.degrees).abs() < 1e-9);
        }
    }
}

#[test]
fn what_is_known_of_a_simulated_rig_is_taken() {
    let of = |port: &str| {
        let mut answers = RigAnswers::default();
        answers.take_port(port);
        (answers.condition, answers.pulse_type)
    };
    let bench = "bench".to_owned();
    assert_eq!(
        of("sim:aircraft?seed=2"),
        ("aircraft".to_owned(), PulseTypeName::Wide)
    );
    assert_eq!(
        of("sim:bench?pulses=narrow"),
        (bench.clone(), PulseTypeName::Narrow)
    );
    assert_eq!(of("/dev/ttyUSB0"), (bench, PulseTypeName::Wide));
}

#[test]
fn a_travel_that_is_cut_says_so() {
    let of = |travel: &str| {
        let answers = RigAnswers {
            travel_deg: travel.parse().unwrap(),
            ..RigAnswers::default()
        };
        answers.travel_in_words()
    };
    assert_eq!(
        of("-20:20"),
        "From -20.0 to 20.0 degrees: the travel of the linkage."
    );
    assert_eq!(
        of("-80:80"),
        "From -50.0 to 50.0 degrees: the travel of the linkage, -80 to 80, cut to the pulses that the servo takes, 1000:2000 µs (--pulses)."
    );
}
