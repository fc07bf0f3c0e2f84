//! One servo recorded twice is never called different; `examples/verdict_pairs.rs` is the long version.

use servoid_identification::comparison::Verdict;
use servoid_test_support::trials::verdicts::{compare_pairs, count};

#[test]
fn one_servo_twice_is_the_same_whatever_scatters_and_a_loaded_one_is_not() {
    // In 100 pairs each, none was called different, and one undecided with scatter of the clock.
    for servo in ["bench", "bench?scatter=all"] {
        let found = compare_pairs([servo; 2], 0..4);
        assert_eq!(count(&found, Verdict::Different), 0, "{servo}");
        assert!(count(&found, Verdict::Same) >= 3, "{servo}");
    }
    let found = compare_pairs(["bench?scatter=all", "aircraft?scatter=all"], 0..2);
    assert_eq!(count(&found, Verdict::Different), 2);
    // The simulated load takes about 30 % of the step away at its worst moment.
    let mut bounds = found.iter().map(|c| c.bounds.valid().unwrap());
    assert!(bounds.all(|bounds| bounds.difference_percent.at_least > 25.0));
}
