//! The layout of text for a terminal: lines that it shows whole, and findings below them.

use servoid_identification::results::{Advice, Setting};

/// Letters of a line.
const LINE: usize = 110;

/// The option of the program that a remedy asks for; the library, which Python shares, knows none.
fn option(setting: Setting) -> &'static str {
    match setting {
        Setting::Limits => "--limits",
        Setting::InputAtRest => "--at-rest INPUT",
        Setting::Explanation => "--explain",
        Setting::KeptTrend => "--detrend none",
        Setting::SettlingTime => "--settling SAMPLES",
        Setting::ExactCommand => "--exact-command",
        Setting::ExchangedColumns => "--input and --output, the other way round",
    }
}

/// Each finding and its remedy, indented, and marked where something is wrong.
pub(crate) fn findings(advice: &[Advice]) -> String {
    findings_with(advice, "Option")
}

/// The same with what the `options` that remedies ask for are called.
pub(crate) fn findings_with(advice: &[Advice], options: &str) -> String {
    let finding = |item: &Advice| {
        let option = (item.setting()).map(|setting| format!(" {options}: {}.", option(setting)));
        let remedy = item.remedy.clone() + &option.unwrap_or_default();
        let [finding, remedy] = [&item.finding, &remedy].map(|text| wrapped(text, 4));
        let mark = if item.asks_nothing() { '-' } else { '!' };
        format!("\n  {mark} {finding}\n    {remedy}\n")
    };
    advice.iter().map(finding).collect()
}

/// The first of several sentences.
pub(crate) fn first_sentence(text: &str) -> String {
    text.split_once(". ")
        .map_or_else(|| text.to_owned(), |(first, _)| format!("{first}."))
}

/// "a, b and c".
pub(crate) fn listed_words(words: &[impl AsRef<str>]) -> String {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    match &words[..] {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The text in lines of [`LINE`] letters, all but the first indented.
pub(crate) fn wrapped(text: &str, indent: usize) -> String {
    let mut lines = String::new();
    let mut column = indent;
    for word in text.split(' ') {
        let length = word.chars().count();
        if column > indent && column + 1 + length > LINE {
            lines.push('\n');
            lines.extend(std::iter::repeat_n(' ', indent));
            column = indent;
        } else if column > indent {
            lines.push(' ');
            column += 1;
        }
        lines.push_str(word);
        column += length;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_end_with_and() {
        assert_eq!(listed_words(&["a"]), "a");
        assert_eq!(listed_words(&["a", "b", "c"]), "a, b and c");
    }

    #[test]
    fn long_lines_are_broken_between_words_and_lose_none() {
        let lines = wrapped(&("word ".repeat(60) + "end"), 4);
        assert!(lines.lines().count() > 2 && lines.lines().all(|line| line.len() <= LINE));
        assert!(lines.lines().skip(1).all(|line| line.starts_with("    ")));
        assert_eq!(lines.split_whitespace().count(), 61);
    }
}
