//! Whether the time between samples can be that of a recording of a servo: a column in milliseconds is easily read as seconds.

use servoid_identification::results::{Advice, Check, six_digits};

/// Sample periods of recordings of a servo \[s\]: with a longer one its motion is over between two samples, and no converter for
/// servos has a shorter one.
const PERIODS_S: std::ops::RangeInclusive<f64> = 20e-6..=0.2;

/// That no servo is recorded with this time between samples.
pub(crate) fn unlikely_period(seconds: f64) -> Option<Advice> {
    if PERIODS_S.contains(&seconds) {
        return None;
    }
    let (limit, rather) = match seconds > *PERIODS_S.end() {
        true => (*PERIODS_S.end(), 1e-3 * seconds),
        false => (*PERIODS_S.start(), 1e3 * seconds),
    };
    Some(Advice::new(
        Check::Period,
        format!(
            "The time between samples is taken to be {seconds} s, which is not that of a recording of a servo: all times and frequencies \
             follow from it."
        ),
        seconds,
        limit,
        format!(
            "State the unit of the column of time with --time-unit s, ms or us; without such a column state the period in seconds: --period {} \
             if it is {} ms.",
            six_digits(rather),
            six_digits(1e3 * rather)
        ),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn milliseconds_that_were_read_as_seconds_are_stated_in_seconds() {
        let said = unlikely_period(5.0).unwrap();
        assert_eq!(
            said.remedy,
            "State the unit of the column of time with --time-unit s, ms or us; without such a column state the period in seconds: \
             --period 0.005 if it is 5 ms."
        );
        let said = unlikely_period(2e-6).unwrap();
        assert!(said.remedy.contains("--period 0.002"), "{}", said.remedy);
        for usual in [50e-6, 2e-3, 0.1] {
            assert_eq!(unlikely_period(usual), None, "{usual}");
        }
    }
}
