//! The answer in two sentences: is it different and by how much, and what that feels like.

use super::outcome::{Comparison, Levels, Sides, Stroke, Verdict};
use super::{CHANCE, explained_by_chance};

/// A shift in time below this is not worth a word \[s\]: an eighth of a sample of the rig.
const SHIFT_S: f64 = 0.25e-3;

pub(super) fn summary(found: &Comparison) -> String {
    format!("{} {}", answer(found), feel(found))
}

fn answer(found: &Comparison) -> String {
    let bounds = &found.difference_percent;
    let stroke = match bounds.stroke {
        Stroke::Both => "",
        Stroke::Up => " on the way up",
        Stroke::Down => " on the way down",
    };
    let apart = format!(
        "where they differ most they are at least {:.1} % and at most {:.1} % of the step apart ({} % \
         sure), most clearly {:.0} ms after a command{stroke}",
        bounds.at_least,
        bounds.at_most,
        100.0 * found.level,
        1e3 * bounds.at_s
    );
    let margin = found.margin_percent;
    match found.verdict {
        _ if !found.bounds_hold => {
            "Not decided: the errors of one model or both are not noise, so that no \
                                    bounds can be given (see the advice)."
                .to_owned()
        }
        Verdict::Different => format!(
            "The two servos are different: {apart}, and {margin} % would still have counted as the same."
        ),
        Verdict::Same => {
            format!("The two servos are the same within the margin of {margin} %: {apart}.")
        }
        Verdict::Undecided if explained_by_chance(found.p_value) && bounds.at_least > margin => {
            format!("Not decided: {apart}, but runs of one servo differ as much among themselves.")
        }
        Verdict::Undecided => {
            format!("Not decided: {apart}, and the margin of {margin} % lies between.")
        }
    }
}

fn feel(found: &Comparison) -> String {
    let shift = found.delay_shift_s;
    let time = if shift.abs() < SHIFT_S {
        "The second answers at the same time as the first".to_owned()
    } else {
        let when = if shift > 0.0 { "later" } else { "earlier" };
        format!(
            "The second answers about {:.1} ms {when}",
            1e3 * shift.abs()
        )
    };
    let rest = found.levels.as_ref().and_then(rest).unwrap_or_default();
    let runs = match found.p_value {
        Some(p) if p > CHANCE => {
            format!("what differs from run to run is counted, and may be all there is (p = {p:.3})")
        }
        Some(p) => format!(
            "what differs from run to run is counted, and does not explain it (p {})",
            if p < 0.001 {
                "< 0.001".to_owned()
            } else {
                format!("= {p:.3}")
            }
        ),
        None => {
            "what differs from run to run is not included, which takes three runs a side".to_owned()
        }
    };
    format!("{time}{rest}; {runs}.")
}

/// The end of the command at which the two rest farthest apart.
fn rest(levels: &Sides<Levels>) -> Option<String> {
    let (a, b) = (&levels.a, &levels.b);
    let ends = [
        (a.command_plus, b.command_plus, a.plus.value, b.plus.value),
        (
            a.command_minus,
            b.command_minus,
            a.minus.value,
            b.minus.value,
        ),
    ];
    ends.into_iter()
        .filter(|(command_a, command_b, ..)| command_a == command_b)
        .filter_map(|(command, _, a, b)| Some((command, a?, b?)))
        .max_by(|(_, a, b), (_, c, d)| (b - a).abs().total_cmp(&(d - c).abs()))
        .map(|(command, a, b)| {
            format!(
                " and comes to rest at {b:.2} where the first does at {a:.2} (told {command:+})"
            )
        })
}
