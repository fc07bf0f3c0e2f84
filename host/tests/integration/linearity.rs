//! Servos that are not linear are distinguished from those that are; `examples/linearity.rs` is the long version.

use servoid_test_support::trials::linearity::{findings, motions};

#[test]
fn a_servo_that_is_not_linear_is_reported_and_a_linear_one_is_not() {
    require_reported(&[("bench", "random steps, 0.02 s", 5.0)]);
}

#[test]
#[ignore = "five seconds: cargo test -p servoid --test integration -- --ignored servos_that_are_not_linear"]
fn servos_that_are_not_linear_are_reported_under_every_reference() {
    require_reported(&[
        ("aircraft", "stairs, 1.2 s", 10.0),
        ("aircraft", "random steps, 0.16 s", 5.0),
        ("bench", "staircase", 30.0),
    ]);
}

/// Servos under a reference of this name and size (degrees), and a linear one under the same.
fn require_reported(cases: &[(&str, &str, f64)]) {
    let motions = motions();
    let of_size = |name: &str, degrees: f64| {
        let motion = motions.iter().find(|motion| motion.name == name);
        motion.expect("a motion of this name").of_size(degrees)
    };
    for &(servo, name, degrees) in cases {
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
