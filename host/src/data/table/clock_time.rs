//! Times of a clock, as programs write them: `00:00:01.230`, `2026-03-01T14:00:01.230Z`. Only their differences matter, so a day is a day.

/// Seconds since midnight, or since a day of long ago where there is a date; `None` for what is no such time.
pub(super) fn seconds(cell: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?;
    let (day, time) = match text.split_once(['T', ' ']) {
        Some((date, time)) => (days(date)?, time.trim_start()),
        None => (0.0, text),
    };
    let (time, zone_s) = without_zone(time)?;
    Some(86_400.0 * day + of_day(time)? - zone_s)
}

/// A day in 1916, from which days count: `f64` knows seconds of this century to a tenth of a microsecond then.
const LONG_AGO: i64 = 700_000;

/// The days up to `2026-03-01`, `2026/03/01` in a calendar without end (H. Hinnant, "chrono-compatible low-level date algorithms").
fn days(date: &str) -> Option<f64> {
    let parts: Vec<i64> = date.split(['-', '/']).map(whole).collect::<Option<_>>()?;
    let [year, month @ 1..=12, day @ 1..=31] = parts[..] else {
        return None;
    };
    // Years begin in March, so that a leap day is the last.
    let (year, month) = match month {
        1..=2 => (year - 1, month + 9),
        _ => (year, month - 3),
    };
    let leap_days = year / 4 - year / 100 + year / 400;
    Some((365 * year + leap_days + (153 * month + 2) / 5 + day - LONG_AGO) as f64)
}

/// `14:00:01.230`, with a comma for the point, too.
fn of_day(time: &str) -> Option<f64> {
    let parts: Vec<&str> = time.split(':').collect();
    let [hours, minutes, seconds] = parts[..] else {
        return None;
    };
    let seconds: f64 = match seconds.split_once(['.', ',']) {
        None => whole(seconds)? as f64,
        Some((full, part)) => {
            let power = 10f64.powi(i32::try_from(part.len()).ok()?);
            whole(full)? as f64 + whole(part)? as f64 / power
        }
    };
    let (hours, minutes) = (whole(hours)?, whole(minutes)?);
    let is_time = minutes < 60 && seconds < 61.0;
    is_time.then_some(3600.0 * hours as f64 + 60.0 * minutes as f64 + seconds)
}

/// The time without its zone, and how far that is ahead of Greenwich \[s\].
fn without_zone(time: &str) -> Option<(&str, f64)> {
    if let Some(time) = time.strip_suffix('Z') {
        return Some((time, 0.0));
    }
    let Some(at) = time.find(['+', '-']) else {
        return Some((time, 0.0));
    };
    let (time, zone) = time.split_at(at);
    let sign = if zone.starts_with('-') { -1.0 } else { 1.0 };
    let digits: String = zone.chars().filter(char::is_ascii_digit).collect();
    let (hours, minutes) = match digits.len() {
        2 => (whole(&digits)?, 0),
        4 => (whole(digits.get(..2)?)?, whole(digits.get(2..)?)?),
        _ => return None,
    };
    Some((time, sign * 60.0 * (60 * hours + minutes) as f64))
}

/// A number of digits alone, which no file has more than twelve of.
fn whole(digits: &str) -> Option<i64> {
    let is_plain = (1..=12).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_digit());
    is_plain.then(|| digits.parse().ok()).flatten()
}

/// Longest step backwards that is one over midnight, in days.
const OVER_MIDNIGHT: f64 = 0.5;

/// The times of a column counted from its first, with a day more after each midnight where they have no date.
pub(super) fn from_first(times: &mut [f64]) {
    let first = times.iter().copied().find(|time| time.is_finite());
    let Some(first) = first else { return };
    let (mut midnights, mut before) = (0.0, first);
    for time in times.iter_mut().filter(|time| time.is_finite()) {
        let has_date = *time >= 86_400.0 * 366.0;
        if !has_date && *time < before - 86_400.0 * OVER_MIDNIGHT {
            midnights += 1.0;
        }
        before = *time;
        *time += 86_400.0 * midnights - first;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_a_clock_have_the_differences_of_the_clock() {
        let between = |a: &str, b: &str| {
            let [a, b] = [a, b].map(|text| seconds(text.as_bytes()).unwrap());
            b - a
        };
        for (a, b, expected) in [
            ("00:00:01.230", "00:00:01.240", 0.01),
            ("9:59:59", "10:00:00,5", 1.5),
            ("2026-03-01T14:00:01.230Z", "2026-03-01T14:00:01.250Z", 0.02),
            ("2024-02-28 23:59:59.5", "2024-03-01 00:00:00", 86_400.5),
            ("2023-12-31T23:59:59", "2024/01/01 00:00:01", 2.0),
            ("2026-03-29T01:59:59+01:00", "2026-03-29T03:00:00+0200", 1.0),
        ] {
            let found = between(a, b);
            assert!((found - expected).abs() < 1e-6, "{a} {b}: {found}");
        }
        for other in [
            "",
            "1.23",
            "12:30",
            "2026-03-01",
            "25 C",
            "a:b:c",
            "00:61:00",
            "1:2:3:4",
            "2026-13-01 00:00:00",
        ] {
            assert_eq!(seconds(other.as_bytes()), None, "{other}");
        }
    }

    #[test]
    fn a_column_counts_on_over_midnight() {
        let mut times = [86_399.0, f64::NAN, 86_399.5, 0.0, 0.5, 0.2];
        from_first(&mut times);
        let known: Vec<f64> = times.into_iter().filter(|time| time.is_finite()).collect();
        assert_eq!(known, [0.0, 0.5, 1.0, 1.5, 1.2]);
    }
}
