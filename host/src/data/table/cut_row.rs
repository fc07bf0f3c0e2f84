//! A last row that was cut off within its last number.
//!
//! "205.7" where all others have two decimals may be "205.71" of a file whose writing was stopped: a number like any other, and wrong.

/// Rows before the last one whose decimals are looked at.
const LOOKED_AT: usize = 20;

/// Where the last row of `rows` begins, if it has no end of line and fewer decimals in its last cell than all before it have.
pub(super) fn cut_row(rows: &[u8], separator: u8) -> Option<usize> {
    if rows.ends_with(b"\n") || rows.ends_with(b"\r") {
        return None;
    }
    let begins = memchr::memrchr(b'\n', rows)? + 1;
    let decimals = |line: &[u8]| {
        let cell = line.rsplit(|byte| *byte == separator).next()?.trim_ascii();
        let point = cell.iter().position(|byte| matches!(byte, b'.' | b','))?;
        Some(cell.len() - point - 1)
    };
    let (before, last) = rows.split_at(begins);
    let earlier = before.strip_suffix(b"\n")?.rsplit(|byte| *byte == b'\n');
    let earlier: Vec<Option<usize>> = earlier.take(LOOKED_AT).map(decimals).collect();
    let usual = *earlier.first()?;
    let agree = earlier.len() == LOOKED_AT && earlier.iter().all(|found| *found == usual);
    (agree && decimals(last).unwrap_or(0) < usual?).then_some(begins)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_last_number_that_is_shorter_than_all_others_was_cut() {
        let begin = "0.02,1.00\n".repeat(LOOKED_AT);
        let cut = |last: &str| cut_row(format!("{begin}{last}").as_bytes(), b',');
        for last in ["0.04,205.7", "0.04,205.", "0.04,205"] {
            assert_eq!(cut(last), Some(begin.len()), "{last}");
        }
        for last in ["0.04,205.71", "0.04,205.7\n", "0.04,205.7\r\n"] {
            assert_eq!(cut(last), None, "{last}");
        }
        // Numbers without their last zeros.
        let uneven = format!("0.02,1.5\n{}0.04,205.7", "0.02,1.00\n".repeat(5));
        assert_eq!(cut_row(uneven.as_bytes(), b','), None);
    }
}
