//! Servos that are not linear are distinguished from those that are; `examples/linearity.rs` is the long version.

use servoid_test_support::trials::linearity::{findings, motions};

#[test]
fn a_servo_that_is_not_linear_is_reported_and_a_linear_one_is_not() {
    let motions = motions();
    let of_size = |name: &str, degrees: f64| {
        let motion = motions.iter().find(|motion| motion.name == name);
        motion.expect("a motion of this name").of_size(degrees)
    };
    for (servo, name, degrees) in [
        ("aircraft", "stairs, 1.2 s", 10.0),
        ("aircraft", "random steps, 0.16 s", 5.0),
        ("bench", "staircase", 30.0),
        ("bench", "random steps, 0.02 s", 5.0),
    ] {
        let found = findings(servo, of_size(name, degrees), 1).expect("well excited");
        assert!(found.reported, "{servo}, {name}, {degrees}: {found:?}");
        let linear = findings("linear", of_size(name, degrees), 1).expect("well excited");
        assert!(
            linear.level && !linear.reported,
            "{name}, {degrees}: {linear:?}"
        );
    }
}

/// The noise at rest shows errors that functions of the motion do not.
#[test]
fn the_recorded_rest_is_a_witness() {
    let motions = motions();
    let stairs = motions[1].of_size(10.0);
    let found = findings("aircraft", stairs, 1).expect("well excited");
    assert!(found.found[1], "{found:?}");
}
