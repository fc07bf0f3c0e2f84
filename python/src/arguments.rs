//! Options of the command line in a sentence, as arguments of Python: `--period 0.02` is `period=0.02`.

use pyo3::prelude::*;

/// Options that are arguments too, and take a value.
const VALUED: [&str; 24] = [
    "input",
    "output",
    "period",
    "time",
    "time-unit",
    "run",
    "controller",
    "at-rest",
    "settling",
    "frequencies",
    "noise-order",
    "level",
    "detrend",
    "prior",
    "margin",
    "to",
    "step-ms",
    "full-command",
    "frame-ms",
    "reference",
    "amplitude",
    "hold",
    "length",
    "levels",
];

/// Options that are arguments too, and true where they are given.
const FLAGS: [&str; 7] = [
    "explain",
    "servo-model",
    "flight-model",
    "limits",
    "polled",
    "exact-command",
    "with-rest",
];

/// Values that are words.
const WORDS: [&str; 16] = [
    "s",
    "ms",
    "us",
    "ns",
    "auto",
    "none",
    "offset",
    "linear",
    "narrow",
    "stable",
    "ardupilot",
    "staircase",
    "stairs",
    "prbs",
    "sweep",
    "multisine",
];

/// Words between two options.
const JOINING: [&str; 2] = ["and", "or"];

/// What sentences say of commands for a shell, and the same in Python.
const CALLS: [(&str, &str); 8] = [
    (
        "is no model: identify the recording first, with servoid identify RECORDING.csv -o MODEL.json",
        "is no model: make one of a recording with servoid.identify(), and write it with model.save(path)",
    ),
    (
        "is no model of 'servoid identify'",
        "is no model as model.save() writes it",
    ),
    (
        "this model file has no servo model: identify it with 'servoid identify RECORDING.csv --servo-model -o MODEL.json'",
        "this model has no servo model: identify its recording with servo_model=True",
    ),
    (
        "is a model as 'servoid identify -o' writes it, and recordings are needed here: name the CSV file that it comes from",
        "is a model, and recordings are needed here: read it with servoid.Model.load(path), or give the CSV file that it comes from",
    ),
    (
        "record both at one rate of pulses ('servoid init --pulse-rate'), or",
        "record both at one rate of pulses, or",
    ),
    (
        "'servoid compare --servo-model', models as 'servoid identify --servo-model' writes them",
        "servoid.compare() with servo_model=True, models that were identified with servo_model=True",
    ),
    (
        "compare them ('servoid compare')",
        "compare them with servoid.compare()",
    ),
    ("('--servo-model')", "(servo_model=True)"),
];

/// The sentence with calls and arguments where it names commands and options. Commands for a shell that have no call, which stand between
/// quotes, stay what they are.
pub(crate) fn in_python(sentence: &str) -> String {
    let calls = CALLS.iter();
    with_options_named(&calls.fold(sentence.to_owned(), |said, (command, call)| {
        said.replace(command, call)
    }))
}

fn with_options_named(sentence: &str) -> String {
    let command = sentence.split_once(SHELL).and_then(|(before, after)| {
        let (command, behind) = after.split_once('\'')?;
        Some(format!(
            "{}{SHELL}{command}'{}",
            with_arguments(before),
            with_options_named(behind)
        ))
    });
    command.unwrap_or_else(|| with_arguments(sentence))
}

/// The sentence of a document as the package shows it.
#[pyfunction]
pub(crate) fn with_arguments_for_options(sentence: &str) -> String {
    in_python(sentence)
}

/// What commands for a shell begin with.
const SHELL: &str = "'servoid ";

fn with_arguments(sentence: &str) -> String {
    let (mut text, mut rest, mut follows_argument) = (String::new(), sentence, false);
    while let Some((before, after)) = rest.split_once(MARK) {
        // One option behind another is one argument behind another.
        text.push_str(match follows_argument && before == " " {
            true => ", ",
            false => before,
        });
        let found = argument(after);
        follows_argument = found.is_some();
        rest = match found {
            Some((argument, behind)) => {
                text += &argument;
                behind
            }
            None => {
                text += MARK;
                after
            }
        };
    }
    text + rest
}

/// What options begin with.
const MARK: &str = "--";

/// The argument for the option at the beginning of `text`, and what is behind; `None` for an option that is none in Python.
fn argument(text: &str) -> Option<(String, &str)> {
    let end = text.find(|c: char| !c.is_ascii_lowercase() && c != '-');
    let (option, behind) = text.split_at(end.unwrap_or(text.len()));
    let name = option.replace('-', "_");
    if FLAGS.contains(&option) {
        return Some((format!("{name}=True"), behind));
    }
    VALUED.contains(&option).then(|| match value(behind) {
        Some((value, behind)) => (format!("{name}={value}"), behind),
        None => (name, behind),
    })
}

/// The value of an option at the beginning of `text`, as Python writes it, and what is behind.
fn value(text: &str) -> Option<(String, &str)> {
    let text = text.strip_prefix(' ')?;
    if let Some((quoted, behind)) = text
        .strip_prefix('\'')
        .and_then(|rest| rest.split_once('\''))
    {
        return Some((format!("{quoted:?}"), behind));
    }
    let end = text.find([' ', ',', ';', ':', ')']).unwrap_or(text.len());
    let (word, behind) = text.split_at(end);
    let (word, behind) = match word.strip_suffix('.') {
        Some(short) => (short, text.split_at(short.len()).1),
        None => (word, behind),
    };
    let placeholder = !word.is_empty() && word.chars().all(|c| c.is_ascii_uppercase());
    if placeholder || word.parse::<f64>().is_ok() {
        return Some((word.to_owned(), behind));
    }
    // A name of a column stands before another option or at the end; any other word goes on with the sentence.
    let ends_here = behind.is_empty() || behind.starts_with(" --");
    if JOINING.contains(&word) {
        return None;
    }
    (WORDS.contains(&word) || (ends_here && !word.is_empty()))
        .then(|| (format!("{word:?}"), behind))
}
