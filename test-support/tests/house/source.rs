//! Rust source as words, which are names and marks: without comments, texts and tests.

/// The words of `source`; items behind `#[cfg(test)]` are left out.
pub fn words(source: &str) -> Vec<String> {
    without_tests(split(source))
}

fn split(source: &str) -> Vec<String> {
    let chars: Vec<char> = source.chars().collect();
    let mut words = Vec::new();
    let mut at = 0;
    while let Some(&c) = chars.get(at) {
        let end = match c {
            _ if c.is_whitespace() => at + 1,
            '/' if chars.get(at + 1) == Some(&'/') => line_end(&chars, at),
            '/' if chars.get(at + 1) == Some(&'*') => comment_end(&chars, at),
            '"' => text_end(&chars, at + 1),
            '\'' => quoted_end(&chars, at),
            'r' | 'b' if raw_hashes(&chars, at).is_some() => raw_end(&chars, at),
            _ => {
                let end = word_end(&chars, at);
                words.push(chars[at..end].iter().collect());
                end
            }
        };
        at = end;
    }
    words
}

/// A name, `::` as one mark, or any other sign.
fn word_end(chars: &[char], at: usize) -> usize {
    let of_name = |c: &char| c.is_alphanumeric() || *c == '_';
    let name = chars[at..].iter().take_while(|c| of_name(c)).count();
    match name {
        0 if chars[at..].starts_with(&[':', ':']) => at + 2,
        0 => at + 1,
        length => at + length,
    }
}

fn line_end(chars: &[char], at: usize) -> usize {
    let rest = chars[at..].iter().position(|c| *c == '\n');
    rest.map_or(chars.len(), |rest| at + rest)
}

fn comment_end(chars: &[char], at: usize) -> usize {
    let (mut depth, mut at) = (0, at);
    while at < chars.len() {
        if chars[at..].starts_with(&['/', '*']) {
            (depth, at) = (depth + 1, at + 2);
        } else if chars[at..].starts_with(&['*', '/']) {
            (depth, at) = (depth - 1, at + 2);
            if depth == 0 {
                return at;
            }
        } else {
            at += 1;
        }
    }
    chars.len()
}

/// Behind the closing quote of a text that `at` is in.
fn text_end(chars: &[char], mut at: usize) -> usize {
    while at < chars.len() {
        match chars[at] {
            '\\' => at += 2,
            '"' => return at + 1,
            _ => at += 1,
        }
    }
    chars.len()
}

/// Behind a character in quotes, or behind the mark of a lifetime.
fn quoted_end(chars: &[char], at: usize) -> usize {
    match chars.get(at + 1) {
        Some('\\') => {
            let close = chars[at + 3..].iter().position(|c| *c == '\'');
            close.map_or(chars.len(), |close| at + 3 + close + 1)
        }
        Some(_) if chars.get(at + 2) == Some(&'\'') => at + 3,
        _ => at + 1,
    }
}

/// The number of `#` of a raw text that begins here.
fn raw_hashes(chars: &[char], at: usize) -> Option<usize> {
    // A name that ends in r or b is no beginning.
    let before = at.checked_sub(1).map(|before| chars[before]);
    if before.is_some_and(|c| c.is_alphanumeric() || c == '_') {
        return None;
    }
    let letters = chars[at..]
        .iter()
        .take_while(|c| matches!(c, 'r' | 'b'))
        .count();
    let hashes = chars[at + letters..]
        .iter()
        .take_while(|c| **c == '#')
        .count();
    let raw = chars[at..at + letters].contains(&'r');
    let opens = chars.get(at + letters + hashes) == Some(&'"');
    (raw && opens && letters <= 2).then_some(hashes)
}

fn raw_end(chars: &[char], at: usize) -> usize {
    let hashes = raw_hashes(chars, at).unwrap_or(0);
    let mut close = vec!['"'];
    close.extend(std::iter::repeat_n('#', hashes));
    let begin = at + chars[at..].iter().take_while(|c| **c != '"').count() + 1;
    (begin..chars.len())
        .find(|&k| chars[k..].starts_with(&close))
        .map_or(chars.len(), |k| k + close.len())
}

fn without_tests(words: Vec<String>) -> Vec<String> {
    const MARK: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let mut kept = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let marked = words[at..].iter().map(String::as_str).take(MARK.len());
        if marked.eq(MARK) {
            at = item_end(&words, at + MARK.len());
        } else {
            kept.push(words[at].clone());
            at += 1;
        }
    }
    kept
}

/// Behind the item that begins at `at`: behind its semicolon, or behind its last brace.
fn item_end(words: &[String], at: usize) -> usize {
    let mut depth = 0;
    for (k, word) in words.iter().enumerate().skip(at) {
        match word.as_str() {
            "{" | "(" | "[" => depth += 1,
            ")" | "]" => depth -= 1,
            "}" if depth == 1 => return k + 1,
            "}" => depth -= 1,
            ";" if depth == 0 => return k + 1,
            _ => {}
        }
    }
    words.len()
}

#[test]
fn texts_comments_and_tests_are_left_out() {
    let source = r##"
        // use crate::a;
        /* use /* crate::b; */ */
        use crate::c; /// "x
        const T: &str = r#"use crate::d;"#; const Q: char = '"'; fn f<'a>(x: &'a str) { "crate::e" }
        #[cfg(test)]
        mod tests { use crate::f; fn g() { [0; 2]; } }
        #[cfg(test)]
        use crate::h;
        fn last() {}
    "##;
    let words = words(source);
    let used = words.windows(3).filter(|w| w[0] == "crate");
    let used: Vec<&str> = used.map(|w| w[2].as_str()).collect();
    assert_eq!(used, ["c"]);
    assert!(words.iter().any(|word| word == "last"));
}
