//! The unit in the name of a column.

use super::layout::is_unit;

/// "deg" of "angle \[deg\]", "angle (deg)", "angle_deg" or "deg"; `None` where a name has none.
///
/// ```
/// use servoid::data::table::unit_of;
/// assert_eq!(unit_of("Winkel [°]"), Some("°"));
/// assert_eq!(unit_of("pos_counts"), Some("counts"));
/// assert_eq!(unit_of("us"), Some("us"));
/// assert_eq!(unit_of("position"), None);
/// // The first of several servos, as flight logs name their columns.
/// assert_eq!(unit_of("servo[0]"), None);
/// ```
pub fn unit_of(column: &str) -> Option<&str> {
    let bracketed = column
        .trim_end()
        .strip_suffix([']', ')'])
        .and_then(|rest| rest.rsplit_once(['[', '(']))
        .map(|(_, unit)| unit.trim())
        .filter(|unit| !is_number(unit));
    let last = || last_word(column).map(|(_, unit)| unit);
    let alone = || Some(column).filter(|name| is_unit_of_letters(name));
    let found = bracketed.or_else(last).or_else(alone);
    found.filter(|unit| !unit.is_empty())
}

/// Whether what stands in brackets is the number of a column among several.
fn is_number(bracketed: &str) -> bool {
    bracketed.bytes().all(|byte| byte.is_ascii_digit())
}

/// "angle" and "deg" of "angle_deg" or "angle deg".
fn last_word(column: &str) -> Option<(&str, &str)> {
    let words = column.rsplit_once(['_', ' ']);
    words.filter(|(_, word)| is_unit_of_letters(word))
}

/// Whether a word is a unit of several letters: one alone is a name, too.
fn is_unit_of_letters(word: &str) -> bool {
    is_unit(word) && word.chars().count() > 1
}

/// "angle" for "angle [deg]", "angle (deg)" or "angle_deg".
pub(crate) fn without_unit(column: &str) -> &str {
    let bracketed = column.split_once(['[', '(']).map(|(name, _)| name);
    let last = || last_word(column).map(|(name, _)| name);
    bracketed.or_else(last).unwrap_or(column).trim()
}
