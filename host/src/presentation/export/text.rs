//! Names, comments and numbers in the form that a language takes.
//!
//! Names of files and servos, and the sentences of a model, come from elsewhere: characters with a meaning in a
//! language must not reach it.

/// A name for programs, `servo_bench_1`: letters of ASCII, digits and underscores. The first word keeps it from
/// being a keyword of any language.
pub(crate) fn identifier(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric());
    let words = words.filter(|word| !word.is_empty());
    let mut words: Vec<String> = words.map(str::to_ascii_lowercase).collect();
    // A name that begins with that word has it already.
    if !words.first().is_some_and(|word| word.starts_with("servo")) {
        words.insert(0, "servo".to_owned());
    }
    let mut safe = words.join("_");
    // MATLAB distinguishes names by their first 63 characters, and fields and macros are added.
    safe.truncate(40);
    safe
}

/// Text in which nothing ends a line or hides: letters, digits and the signs of ASCII stay, all else
/// becomes a space.
pub(super) fn plain(text: &str) -> String {
    text.replace(
        |c: char| !(c.is_alphanumeric() || c.is_ascii_graphic()),
        " ",
    )
}

/// A name as text within a language, with what has a meaning there escaped: `signs` get a backslash before them, as the backslash
/// itself does.
pub(super) fn quoted(name: &str, signs: &[char]) -> String {
    let escaped = |letter: char| match letter == '\\' || signs.contains(&letter) {
        true => vec!['\\', letter],
        false => vec![letter],
    };
    plain(name).chars().flat_map(escaped).collect()
}

/// How a language writes comments, lists and matrices.
#[derive(Clone, Copy)]
pub(super) struct Style {
    /// Begins each line of a comment.
    pub comment: &'static str,
    /// Signs that must not stand in a comment, and what stands for them.
    pub forbidden: &'static [(&'static str, &'static str)],
    /// Between numbers.
    pub between: &'static str,
    /// Where a list goes on in the next line.
    pub broken: &'static str,
    /// Around each row of a matrix.
    pub row: (&'static str, &'static str),
}

/// The style of Python, whose statement is the text of the module.
pub(super) const PYTHON_STYLE: Style = Style {
    comment: "",
    forbidden: &[("\"\"\"", "\""), ("\\", "/")],
    ..SCRIPT_STYLE
};

/// The style of Julia, and of tables and lists of parameters.
pub(super) const SCRIPT_STYLE: Style = Style {
    comment: "# ",
    forbidden: &[],
    between: ", ",
    broken: "",
    row: ("", ""),
};

/// The style of C.
pub(super) const C_STYLE: Style = Style {
    comment: " * ",
    forbidden: &[("*/", "* /"), ("/*", "/ *")],
    row: ("{", "},"),
    ..SCRIPT_STYLE
};

/// The style of MATLAB.
pub(super) const MATLAB_STYLE: Style = Style {
    comment: "% ",
    broken: " ...",
    ..SCRIPT_STYLE
};

/// The style of XML, within the signs that begin and end them.
pub(super) const XML_STYLE: Style = Style {
    comment: "  ",
    // Two hyphens end a comment of XML, and one must not be its last sign. An option is still to be known as one.
    forbidden: &[(" --", " option "), ("(--", "(option "), ("--", "- -")],
    row: ("[", "]"),
    ..SCRIPT_STYLE
};

/// Columns of a line, where lines can be broken.
const WIDTH: usize = 96;

impl Style {
    /// Paragraphs as a comment.
    pub fn comment(&self, paragraphs: &[String]) -> String {
        let mut lines = Vec::new();
        for paragraph in paragraphs {
            let mut text = plain(paragraph);
            for (sign, instead) in self.forbidden {
                while text.contains(sign) {
                    text = text.replace(sign, instead);
                }
            }
            if !lines.is_empty() {
                lines.push(self.comment.trim_end().to_owned());
            }
            lines.extend(wrapped(text.split_whitespace(), " ", "", self.comment));
        }
        lines.join("\n")
    }

    /// Numbers as the inside of a list.
    pub fn list(&self, values: &[f64]) -> String {
        let numbers: Vec<String> = values.iter().copied().map(number).collect();
        let numbers = numbers.iter().map(String::as_str);
        wrapped(numbers, self.between, self.broken, "    ").join("\n")
    }

    /// Numbers as one line.
    pub fn short(&self, values: &[f64]) -> String {
        let numbers: Vec<String> = values.iter().copied().map(number).collect();
        numbers.join(self.between)
    }

    /// A matrix as the inside of one, a line for each row.
    pub fn matrix(&self, rows: &[Vec<f64>]) -> String {
        let (open, close) = self.row;
        let row = |row: &Vec<f64>| format!("    {open}{}{close}", self.short(row));
        rows.iter().map(row).collect::<Vec<_>>().join("\n")
    }
}

/// A number that is read back as the same one, in every language.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// Words in lines of [`WIDTH`] columns at most.
pub(super) fn wrapped<'a>(
    words: impl Iterator<Item = &'a str>,
    between: &str,
    broken: &str,
    begin: &str,
) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::new();
    for word in words {
        let longer = line.len() + between.len() + word.len() + broken.len();
        if line.is_empty() {
            line = format!("{begin}{word}");
        } else if longer <= WIDTH {
            line.push_str(between);
            line.push_str(word);
        } else {
            line.push_str(between.trim_end());
            line.push_str(broken);
            lines.push(std::mem::replace(&mut line, format!("{begin}{word}")));
        }
    }
    lines.push(line);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    const STYLE: Style = Style {
        comment: " * ",
        forbidden: &[("*/", "* /")],
        between: ", ",
        broken: "",
        row: ("{", "},"),
    };

    #[test]
    fn any_name_becomes_an_identifier() {
        assert_eq!(identifier("DS610 (bench)"), "servo_ds610_bench");
        assert_eq!(identifier("servo"), "servo");
        assert_eq!(identifier("Servo-2"), "servo_2");
        assert_eq!(identifier("servo5_a"), "servo5_a");
        assert_eq!(identifier("\"); system('rm');"), "servo_system_rm");
    }

    #[test]
    fn nothing_leaves_a_comment() {
        let hostile = "x */ int\nmain\r\u{2028}\u{202e}**//".to_owned();
        let comment = STYLE.comment(&[hostile]);
        assert!(
            !comment.contains("*/") && !comment.contains('\n'),
            "{comment}"
        );
        assert!(comment.is_ascii(), "{comment}");
    }

    #[test]
    fn numbers_come_back_as_they_were() {
        for value in [0.1 + 0.2, -1e-300, 1e22, 5e-324, 0.0] {
            assert_eq!(
                number(value).parse::<f64>().unwrap().to_bits(),
                value.to_bits()
            );
        }
        let values: Vec<f64> = (0..50).map(|k| f64::from(k) / 7.0).collect();
        let list = STYLE.list(&values);
        assert!(list.lines().all(|line| line.len() <= WIDTH));
        let back: Vec<f64> = list
            .split(',')
            .map(|text| text.trim().parse().unwrap())
            .collect();
        assert_eq!(back, values);
    }
}
