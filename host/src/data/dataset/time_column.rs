//! The column of time of a foreign file, and its unit.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// The unit of a column of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeUnit {
    /// Seconds
    #[value(name = "s")]
    Seconds,
    /// Milliseconds
    #[value(name = "ms")]
    Milliseconds,
    /// Microseconds
    #[value(name = "us")]
    Microseconds,
    /// Nanoseconds
    #[value(name = "ns")]
    Nanoseconds,
}

impl TimeUnit {
    /// One of it, in seconds.
    pub(super) fn seconds(self) -> f64 {
        match self {
            Self::Seconds => 1.0,
            Self::Milliseconds => 1e-3,
            Self::Microseconds => 1e-6,
            Self::Nanoseconds => 1e-9,
        }
    }

    /// The unit with this symbol: s, ms, us or ns.
    #[must_use]
    pub fn of_symbol(symbol: &str) -> Option<Self> {
        Self::value_variants()
            .iter()
            .copied()
            .find(|unit| unit.names().0 == symbol)
    }

    /// Its symbol and its name.
    pub(crate) fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Seconds => ("s", "seconds"),
            Self::Milliseconds => ("ms", "milliseconds"),
            Self::Microseconds => ("us", "microseconds"),
            Self::Nanoseconds => ("ns", "nanoseconds"),
        }
    }

    /// What people write for it, in lower letters.
    fn of_word(word: &str) -> Option<Self> {
        Some(match word {
            "s" | "sec" | "secs" | "second" | "seconds" | "sek" | "sekunden" | "seg"
            | "segundos" | "secondes" | "secondi" | "sekund" => Self::Seconds,
            "ms" | "msec" | "millis" | "millisec" | "millisecond" | "milliseconds" => {
                Self::Milliseconds
            }
            "us" | "µs" | "μs" | "usec" | "micros" | "microsec" | "microsecond"
            | "microseconds" => Self::Microseconds,
            "ns" | "nsec" | "nanos" | "nanosecond" | "nanoseconds" => Self::Nanoseconds,
            _ => return None,
        })
    }
}

/// Words that a column of time is called by: in English, German, French, Spanish, Portuguese and Italian,
/// the Nordic languages, Dutch, Polish, Czech, Hungarian, Turkish, Russian, Chinese and Japanese.
const WORDS: &str = "t time timestamp elapsed zeit zeitstempel temps horodatage tiempo tempo tid aika tijd \
                     czas čas cas idő ido zaman время datetime uhrzeit clock 时间 時間 时刻 時刻";

/// Words that mean time without another word.
const ALONE: &str = "seconds ms millis milliseconds micros microseconds";

/// Words that may stand beside them.
const BESIDE: &str = "stamp since start rel relative in date of day";

/// The column of time, and its unit where its name has one: the first that has, or else the first.
pub(super) fn column(columns: &[String]) -> Option<(&str, Option<TimeUnit>)> {
    let named = || {
        let name = |column: &'_ String| unit(column).map(|_| ());
        columns.iter().filter(move |column| name(column).is_some())
    };
    let with_unit = named().find(|column| unit(column).flatten().is_some());
    let found = with_unit.or_else(|| named().next())?;
    Some((found, unit(found)?))
}

/// The unit of a column that is called like one of time; `None` for a column that is not.
pub(super) fn unit(column: &str) -> Option<Option<TimeUnit>> {
    let lower = with_spaces(column).to_lowercase();
    let words: Vec<&str> = words(&lower).collect();
    let among = |list: &str, word: &str| list.split(' ').any(|known| known == word);
    let time = |word: &&str| among(WORDS, word);
    let known =
        |word: &&str| time(word) || among(BESIDE, word) || TimeUnit::of_word(word).is_some();
    // "millis", and "Millis [ms]", which says it twice.
    let unit_of = |word: &&str| TimeUnit::of_word(word);
    let first = words.first().and_then(unit_of);
    let is_one_unit = first.is_some() && words.iter().all(|word| unit_of(word) == first);
    let is_alone = is_one_unit && words.iter().any(|word| among(ALONE, word));
    let is_time = words.iter().any(time) || is_alone;
    (is_time && words.iter().all(known))
        .then(|| words.iter().find_map(|word| TimeUnit::of_word(word)))
}

/// The unit that a name has in it, whatever else is in it.
pub(super) fn unit_in(column: &str) -> Option<TimeUnit> {
    words(&column.to_lowercase()).find_map(TimeUnit::of_word)
}

/// "Time US" of "TimeUS", as ArduPilot calls it.
fn with_spaces(column: &str) -> String {
    let mut spaced = String::new();
    let mut before = None;
    for letter in column.chars() {
        if letter.is_uppercase() && before.is_some_and(char::is_lowercase) {
            spaced.push(' ');
        }
        spaced.push(letter);
        before = Some(letter);
    }
    spaced
}

fn words(lower: &str) -> impl Iterator<Item = &str> {
    lower
        .split(|letter: char| !letter.is_alphanumeric())
        .filter(|word| !word.is_empty())
}

/// "2.000 ms" for a time in seconds.
pub(super) fn shown(seconds: f64) -> String {
    let (scale, unit) = match seconds {
        s if s >= 1.0 => (1.0, "s"),
        s if s >= 1e-4 => (1e3, "ms"),
        _ => (1e6, "us"),
    };
    format!("{:.3} {unit}", seconds * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_of_time_is_known_by_its_name_and_its_unit_too() {
        use TimeUnit::{Microseconds, Milliseconds, Seconds};
        for (name, expected) in [
            ("t", Some(None)),
            ("Time", Some(None)),
            ("time_s", Some(Some(Seconds))),
            ("Time [ms]", Some(Some(Milliseconds))),
            ("t (µs)", Some(Some(Microseconds))),
            ("timestamp_us", Some(Some(Microseconds))),
            ("TimeUS", Some(Some(Microseconds))),
            ("TimeS", Some(Some(Seconds))),
            ("millis", Some(Some(Milliseconds))),
            ("ms", Some(Some(Milliseconds))),
            ("Millis [ms]", Some(Some(Milliseconds))),
            ("millis (us)", None),
            // As often a pulse width as a time.
            ("us", None),
            ("elapsed time in seconds", Some(Some(Seconds))),
            ("Zeit [s]", Some(Some(Seconds))),
            ("Temps (ms)", Some(Some(Milliseconds))),
            ("Tiempo", Some(None)),
            ("czas_ms", Some(Some(Milliseconds))),
            ("ВРЕМЯ", Some(None)),
            ("rise time", None),
            ("riseTime", None),
            ("temperature", None),
            ("s", None),
            ("", None),
        ] {
            assert_eq!(unit(name), expected, "{name}");
        }
        let columns = ["t", "time_ms", "u"].map(str::to_owned);
        assert_eq!(column(&columns), Some(("time_ms", Some(Milliseconds))));
    }
}
