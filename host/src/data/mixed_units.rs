//! Recordings of one servo that seem to be in different units, where no column names its own.

use servoid_identification::Run;
use servoid_identification::column::span;
use servoid_identification::results::{Advice, Check};

/// Ratio of travels from which on recordings of one servo are hardly in one unit: degrees are 57 times as large as radians, and few
/// people record strokes of a thirtieth of others.
const APART: f64 = 30.0;

/// That the output of one of these moves this many times as far as that of the other.
pub(crate) fn advice_on_units(names: [&str; 2], runs: [&[Run<'_>]; 2]) -> Option<Advice> {
    let travel = |runs: &[Run<'_>]| span(runs.iter().flat_map(Run::output).copied()).unwrap_or(0.0);
    let [a, b] = runs.map(travel);
    let (small, large, times) = if a > APART * b {
        (names[1], names[0], a / b)
    } else if b > APART * a {
        (names[0], names[1], b / a)
    } else {
        return None;
    };
    Some(Advice::new(
        Check::UnitMix,
        format!(
            "The output moves {times:.0} times as far in {large} as in {small}, and their columns name no units: one may be in degrees \
             and the other in radians (57 times)."
        ),
        times,
        APART,
        "Make sure that both are in one unit; a unit in the name of a column, such as 'angle [deg]', is held against that of the other file.",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(scale: f64) -> Run<'static> {
        let column = |shift: i32| {
            (0..50)
                .map(|k| scale * f64::from((k + shift) % 9))
                .collect()
        };
        let (input, output): (Vec<f64>, Vec<f64>) = (column(0), column(4));
        Run::new(input, output).unwrap()
    }

    #[test]
    fn degrees_beside_radians_are_noticed_and_smaller_strokes_are_not() {
        let [degrees, radians] = [run(1.0), run(1f64.to_radians())];
        for [a, b] in [[&degrees, &radians], [&radians, &degrees]] {
            let runs = [a, b].map(std::slice::from_ref);
            let advice = advice_on_units(["a.csv", "b.csv"], runs).unwrap();
            assert!((advice.value - 1f64.to_degrees()).abs() < 1e-9);
        }
        let small = run(0.1);
        let runs = [&degrees, &small].map(std::slice::from_ref);
        assert!(advice_on_units(["a.csv", "b.csv"], runs).is_none());
    }
}
