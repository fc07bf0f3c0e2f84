//! Guesses the input and the output of a foreign file by the names of its columns: for a command to try,
//! never to compute with.

use super::time_column::{self, TimeUnit};

/// Names that people give to the command, the plainest first.
const INPUTS: &str = "u input in command commanded cmd reference ref setpoint set desired target demand goal \
                      pwm pulse soll sollwert vorgabe consigne consigna stick";

/// Names that people give to the measured position, the plainest first.
const OUTPUTS: &str = "y output out position pos angle measured measurement meas actual response feedback \
                       sensor ist istwert winkel lage ángulo posición posizione pot poti potentiometer adc a0";

/// Names of a column whose value changes from run to run.
const RUNS: [&str; 11] = [
    "run",
    "run_id",
    "trial",
    "repetition",
    "experiment",
    "episode",
    "versuch",
    "lauf",
    "essai",
    "prueba",
    "prova",
];

/// Names of a column that says which controller, or which gain of it, drove a run.
const CONTROLLERS: [&str; 4] = ["kp", "k_p", "gain", "controller"];

/// "--input u --output y --period SECONDS" for a file with these columns; words in capitals where no name
/// is known.
pub(super) fn options(columns: &[String]) -> String {
    named_options(columns, false)
}

/// The same for columns without names, of which the first is one of times: what is left of three is the command and then the position, usually.
pub(super) fn options_behind_times(columns: &[String]) -> String {
    match columns {
        [time, input, output] => format!("--time {time} --input {input} --output {output}"),
        _ => named_options(columns, true),
    }
}

fn named_options(columns: &[String], first_is_time: bool) -> String {
    let input = named(columns, INPUTS, None).or_else(|| pulse_width(columns));
    let output = named(columns, OUTPUTS, input);
    let word = |column: Option<&String>| column.map_or_else(|| "COLUMN".to_owned(), |c| quoted(c));
    let timed = time_column::column(columns).is_some();
    let taken = |column: &&String| Some(*column) != input && Some(*column) != output;
    let called = |option: &str, names: &[&str]| {
        let found = one_of(columns.iter().filter(taken), names);
        found.map_or_else(String::new, |column| {
            format!(" {option} {}", quoted(column))
        })
    };
    format!(
        "--input {} --output {}{}{}{}",
        word(input),
        word(output),
        match (first_is_time, timed) {
            (true, _) => " --time 1".to_owned(),
            (false, true) => String::new(),
            // What is left beside a command and a position.
            (false, false) => match columns.iter().filter(taken).find(|one| is_only_us(one)) {
                Some(time) => format!(" --time {}", quoted(time)),
                None => " --period SECONDS".to_owned(),
            },
        },
        called("--run", &RUNS),
        called("--controller", &CONTROLLERS)
    )
}

/// A column in microseconds that is called otherwise than a time: of a servo, its pulse width.
fn pulse_width(columns: &[String]) -> Option<&String> {
    let in_us = |column: &&String| {
        let of_time = time_column::unit(column).is_some();
        !of_time && time_column::unit_in(column) == Some(TimeUnit::Microseconds)
    };
    let all = || columns.iter().filter(in_us);
    all()
        .find(|column| !is_only_us(column))
        .or_else(|| all().next())
}

/// "us" without another word.
fn is_only_us(column: &str) -> bool {
    ["us", "µs", "μs"].contains(&column.trim().to_lowercase().as_str())
}

/// Another column of the command than `input`, by its name.
pub(super) fn another_input(columns: &[String], used: [&str; 2]) -> Option<String> {
    let others = columns.iter();
    let others = others.filter(|column| !used.contains(&column.as_str()));
    let others: Vec<String> = others.cloned().collect();
    named(&others, INPUTS, None).cloned()
}

/// The column that says which controller drove a run, by its name.
pub(super) fn controller(columns: &[String]) -> Option<&String> {
    one_of(columns.iter(), &CONTROLLERS)
}

/// The first column with one of these names.
fn one_of<'a>(mut columns: impl Iterator<Item = &'a String>, names: &[&str]) -> Option<&'a String> {
    columns.find(|column| names.contains(&column.to_lowercase().as_str()))
}

/// The first column that is called so, or else whose name has such a word in it, and is not `taken`.
fn named<'a>(columns: &'a [String], names: &str, taken: Option<&String>) -> Option<&'a String> {
    let free = || columns.iter().filter(move |column| Some(*column) != taken);
    let whole = |name: &str| free().find(|column| column.to_lowercase() == name);
    let part = |name: &str| {
        free().find(|column| {
            let lower = column.to_lowercase();
            // "pos_cmd" and "Command [deg]" are two words each.
            lower
                .split(|letter: char| !letter.is_alphanumeric())
                .any(|word| word == name)
        })
    };
    let mut all = names.split(' ');
    all.clone().find_map(whole).or_else(|| all.find_map(part))
}

/// A name for a command line.
pub(crate) fn quoted(name: &str) -> String {
    let plain = |letter: char| letter.is_alphanumeric() || "_-./:=+,".contains(letter);
    if !name.is_empty() && name.chars().all(plain) {
        return name.to_owned();
    }
    format!("'{}'", name.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(columns: &[&str]) -> String {
        options(
            &columns
                .iter()
                .map(|&column| column.to_owned())
                .collect::<Vec<_>>(),
        )
    }

    #[test]
    fn another_column_of_the_command_is_named_and_not_one_that_is_used() {
        let columns = ["t", "ref_deg", "u_deg", "y_deg"].map(str::to_owned);
        let found = |used| another_input(&columns, used);
        assert_eq!(found(["u_deg", "y_deg"]).as_deref(), Some("ref_deg"));
        assert_eq!(another_input(&columns[2..], ["u_deg", "y_deg"]), None);
        assert_eq!(
            options_behind_times(&["1", "2", "3"].map(str::to_owned)),
            "--time 1 --input 2 --output 3"
        );
    }

    #[test]
    fn a_word_that_both_names_have_goes_to_the_one_that_is_left() {
        assert_eq!(
            of(&["Time [s]", "Set angle", "Meas angle"]),
            "--input 'Set angle' --output 'Meas angle'"
        );
    }

    #[test]
    fn a_logger_of_pulses_and_of_a_potentiometer_is_understood() {
        for (columns, options) in [
            (["ms", "servo_us", "A0"], "--input servo_us --output A0"),
            (
                ["time_us", "ch1_us", "pot_adc"],
                "--input ch1_us --output pot_adc",
            ),
            (
                ["us", "servo_us", "pot"],
                "--input servo_us --output pot --time us",
            ),
            (["millis", "us", "adc"], "--input us --output adc"),
        ] {
            assert_eq!(of(&columns), options);
        }
    }

    #[test]
    fn names_in_other_languages_are_known() {
        assert_eq!(
            of(&["Zeit", "Sollwert", "Istwert", "Versuch"]),
            "--input Sollwert --output Istwert --run Versuch"
        );
        assert_eq!(
            of(&["Temps [ms]", "Consigne [°]", "Position [°]"]),
            "--input 'Consigne [°]' --output 'Position [°]'"
        );
    }

    #[test]
    fn columns_are_guessed_by_name_and_left_open_otherwise() {
        assert_eq!(of(&["t", "u", "y"]), "--input u --output y");
        assert_eq!(
            of(&["Command [deg]", "Measured Angle"]),
            "--input 'Command [deg]' --output 'Measured Angle' --period SECONDS"
        );
        assert_eq!(of(&["time", "a", "b"]), "--input COLUMN --output COLUMN");
        assert_eq!(
            of(&["t", "u", "y", "Run"]),
            "--input u --output y --run Run"
        );
        assert_eq!(
            of(&["t", "u", "y", "run", "kp"]),
            "--input u --output y --run run --controller kp"
        );
        assert_eq!(
            of(&["pos_cmd", "pos"]),
            "--input pos_cmd --output pos --period SECONDS"
        );
    }
}
