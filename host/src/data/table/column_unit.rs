//! The unit in the name of a column.

use super::layout::is_unit;

/// "deg" of "angle \[deg\]", "angle (deg)" or "angle_deg"; `None` where a name has none.
///
/// ```
/// use servoid::data::table::unit_of;
/// assert_eq!(unit_of("Winkel [°]"), Some("°"));
/// assert_eq!(unit_of("pos_counts"), Some("counts"));
/// assert_eq!(unit_of("position"), None);
/// ```
pub fn unit_of(column: &str) -> Option<&str> {
    let bracketed = column
        .trim_end()
        .strip_suffix([']', ')'])
        .and_then(|rest| rest.rsplit_once(['[', '(']))
        .map(|(_, unit)| unit.trim());
    let last = || {
        column
            .rsplit_once(['_', ' '])
            .map(|(_, word)| word)
            .filter(|word| is_unit(word) && word.chars().count() > 1)
    };
    bracketed.or_else(last).filter(|unit| !unit.is_empty())
}

/// "angle" for "angle [deg]" or "angle (deg)".
pub(crate) fn without_unit(column: &str) -> &str {
    column
        .split_once(['[', '('])
        .map_or(column, |(name, _)| name)
        .trim()
}
