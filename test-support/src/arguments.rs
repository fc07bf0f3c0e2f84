//! Arguments of the programs that print tables.

use std::str::FromStr;

/// How many runs, pairs or seeds are asked for: the first argument, `usual` without one.
///
/// # Panics
/// When it is not a number.
pub fn count<T: FromStr>(usual: T) -> T {
    std::env::args()
        .nth(1)
        .map_or(usual, |text| match text.parse() {
            Ok(count) => count,
            Err(_) => panic!("the first argument is a number, not {text:?}"),
        })
}
