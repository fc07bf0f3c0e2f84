//! Advice, with what to do, below a text for a terminal.

use super::lines::wrapped;
use servoid_identification::results::Advice;
use std::fmt::Write;

/// Each finding and its remedy, marked and indented.
pub(super) fn write_advice(text: &mut String, advice: &[Advice]) -> std::fmt::Result {
    for item in advice {
        let [finding, remedy] = [&item.finding, &item.remedy].map(|text| wrapped(text, 4));
        writeln!(text, "\n  ! {finding}\n    {remedy}")?;
    }
    Ok(())
}
