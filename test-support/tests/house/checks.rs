//! Nothing but the code of advice asks what was checked: what follows from a finding is data beside it, or a fact of its own.

use crate::imports::Sources;
use crate::words::texts;
use crate::{source, workspace};
use std::path::Path;

/// The type, and what follows from a finding.
const ALLOWED: &str = "identification/src/results/advice";

/// Whether words look at what was checked: compare it, or branch on it.
fn look_at_checks(words: &[String]) -> bool {
    (0..words.len()).any(|at| {
        let text = |k: usize| words.get(k).map_or("", String::as_str);
        let [last, before] = [1, 2].map(|back| at.checked_sub(back).map_or("", text));
        let is_field = last == "." && text(at) == "check" && text(at + 1) != "(";
        let is_variant = text(at) == "Check" && text(at + 1) == "::";
        let compared_with = |behind: usize| {
            matches!(
                (text(behind), text(behind + 1)),
                ("=" | "!", "=") | ("=", ">") | ("|" | "if", _)
            )
        };
        let compares = last == "=" && matches!(before, "=" | "!");
        // `use` lists variants with `{`.
        is_field && (compared_with(at + 1) || is_matched(&words[..at]))
            || is_variant && (compared_with(at + 3) || compares || text(at + 2) == "{")
    })
}

/// Whether what begins somewhere in front of a field is what `match` or `matches!` looks at.
fn is_matched(words: &[String]) -> bool {
    let of_path = |word: &&String| {
        let is_mark = matches!(word.as_str(), "." | "&" | "(" | "!" | "*");
        is_mark || word.chars().all(|c| c.is_alphanumeric() || c == '_')
    };
    let path = words.iter().rev().take(8).take_while(of_path);
    path.into_iter()
        .any(|word| matches!(word.as_str(), "match" | "matches"))
}

#[test]
fn only_the_code_of_advice_asks_what_was_checked() {
    let mut found = Vec::new();
    for folder in [
        "identification/src",
        "host/src",
        "client/src",
        "simulator/src",
        "python/src",
    ] {
        for (module, words) in Sources::read(&workspace().join(folder)).words() {
            let name = format!("{folder}/{}", module.join("/"));
            if name != ALLOWED && look_at_checks(words) {
                found.push(name);
            }
        }
    }
    let mut files = Vec::new();
    texts(Path::new("python/servoid"), &mut files);
    for file in files {
        let text = std::fs::read_to_string(workspace().join(&file)).unwrap();
        let looks = [
            ".check =",
            ".check !",
            ".check in ",
            "[\"check\"] =",
            "[\"check\"] !",
            "[\"check\"] in ",
        ];
        if looks.iter().any(|look| text.contains(look)) {
            found.push(file.display().to_string());
        }
    }
    assert!(
        found.is_empty(),
        "a finding is asked what it is in {found:?}: say what follows from it in {ALLOWED}.rs"
    );
}

#[test]
fn comparisons_and_branches_are_found_and_new_findings_are_not() {
    let looks = |text: &str| look_at_checks(&source::words(text));
    assert!(looks("item.check == other"));
    assert!(looks("item.check != Check::Hum"));
    assert!(looks("wanted == Check::Hum"));
    assert!(looks("match &item.check { _ => 1 }"));
    assert!(looks("matches!(item.check, x)"));
    assert!(looks("Check::Hum => 1"));
    assert!(looks("x(Check::Hum | Check::Drift)"));
    assert!(!looks("Advice::new(Check::Hum, finding)"));
    assert!(!looks("let check = Check::Hum; f(check)"));
    assert!(!looks("options.check()? == x"));
    assert!(!looks("match options.check() { _ => 1 }"));
}
