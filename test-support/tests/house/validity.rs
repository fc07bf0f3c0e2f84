//! Bounds become valid in one place.

use crate::imports::Sources;
use crate::{source, workspace};

/// The place that decides, and the type itself, which hands on what is valid and reads documents.
const ALLOWED: [&str; 2] = [
    "identification/src/diagnostics/validity",
    "identification/src/results/validity",
];

/// Whether `rest`, from behind the name of the variant, makes a value. Patterns are followed by `=>`, `=` or a guard.
fn makes_a_value(rest: &[String]) -> bool {
    let mut depth = 0;
    let end = rest.iter().position(|word| {
        depth += match word.as_str() {
            "(" => 1,
            ")" => -1,
            _ => 0,
        };
        depth == 0
    });
    let Some(end) = end.filter(|_| rest[0] == "(") else {
        return true;
    };
    let behind: Vec<&str> = rest[end + 1..].iter().take(3).map(String::as_str).collect();
    !matches!(
        behind[..],
        ["=" | "if" | "|", ..] | [")", "=", ..] | [")", ")", "="]
    )
}

#[test]
fn nothing_but_the_evidence_makes_bounds_valid() {
    let mut forged = Vec::new();
    for folder in ["identification/src", "host/src", "client/src", "python/src"] {
        let sources = Sources::read(&workspace().join(folder));
        for (module, words) in sources.words() {
            let name = format!("{folder}/{}", module.join("/"));
            let mut variants = (3..=words.len())
                .filter(|&behind| words[behind - 3..behind] == ["Bounds", "::", "Valid"]);
            if !ALLOWED.contains(&name.as_str())
                && variants.any(|behind| makes_a_value(&words[behind..]))
            {
                forged.push(name);
            }
        }
    }
    assert!(forged.is_empty(), "bounds are made valid in {forged:?}");
}

#[test]
fn patterns_are_no_values() {
    let makes_a_value = |rest| makes_a_value(&source::words(rest));
    assert!(makes_a_value("(level)"));
    assert!(makes_a_value("(of(level)),"));
    assert!(makes_a_value(");"));
    assert!(!makes_a_value("(bounds) => bounds"));
    assert!(!makes_a_value("((a, b)) = both {"));
    assert!(!makes_a_value("(bounds)) => bounds"));
    assert!(!makes_a_value("(_) if linear"));
}
