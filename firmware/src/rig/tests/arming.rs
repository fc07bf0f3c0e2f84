//! Arming and disarming.

use super::*;

#[test]
fn no_pulse_before_arming() {
    let mut bench = Bench::connected();
    for command in [
        Command::Start(short_run(1)),
        Command::Stop { run: 1 },
        Command::Disarm,
        Command::KeepAlive,
        Command::Status,
    ] {
        bench.request(command);
        bench.frame();
        assert_eq!(bench.on_line, None, "{command:?}");
    }
    assert_eq!(
        bench.refused(Command::Start(short_run(1))),
        Refusal::NotArmed
    );
    assert_eq!(bench.status().activity, Activity::Idle);
}

#[test]
fn arming_puts_the_pulse_to_neutral_and_disarming_ends_it() {
    let mut bench = Bench::connected();
    bench.request(Command::Arm(Arm {
        neutral: PulseWidth(1_520),
        ..arm()
    }));
    bench.frame();
    assert_eq!(bench.on_line, Some(PulseWidth(1_520)));
    assert_eq!(bench.status().activity, Activity::Armed);
    bench.request(Command::Disarm);
    bench.frame();
    assert_eq!(bench.on_line, None);
}

#[test]
fn arming_is_refused_for_each_reason() {
    let mut bench = Bench::connected();
    let other_schema = Arm {
        schema_hash: SCHEMA_HASH ^ 1,
        ..arm()
    };
    assert_eq!(
        bench.refused(Command::Arm(other_schema)),
        Refusal::SchemaDiffers
    );
    let too_far = Arm {
        longest: PulseWidth(2_201),
        ..arm()
    };
    assert_eq!(bench.refused(Command::Arm(too_far)), Refusal::BadLimits);
    let mut samples = HEALTHY;
    samples[3] = SICK;
    bench.frame_with(None, samples);
    assert_eq!(
        bench.refused(Command::Arm(arm())),
        Refusal::SensorOutOfRange
    );
    bench.frame();
    assert_eq!(bench.request(Command::Arm(arm())), Some(Outcome::Done));
    bench.request(Command::Start(short_run(1)));
    assert_eq!(bench.refused(Command::Arm(arm())), Refusal::Running);
}

#[test]
fn a_sensor_that_was_never_read_does_not_arm() {
    let mut bench = Bench::new();
    bench.request(Command::Hello);
    assert_eq!(
        bench.refused(Command::Arm(arm())),
        Refusal::SensorOutOfRange
    );
}
