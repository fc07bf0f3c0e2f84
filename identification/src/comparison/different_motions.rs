//! Whether the references of two sides may be what makes their responses differ.

use super::motion::{Motion, larger_by, strokes_differ};
use super::outcome::Comparison;
use super::pair::Identified;
use super::sides::Sides;
use super::stroke_sizes::StrokeSizes;
use super::verdict::Verdict;
use crate::numerics::{four_digits, with_unit};
use crate::results::Bounds;
use crate::thresholds::{EQUALLY_LARGE, SIZES_COMPARED};

/// What the two sides were asked to do.
pub(super) struct Asked {
    pub(super) motions: Sides<Motion>,
    /// The motion of each run.
    runs: Sides<Vec<Motion>>,
    strokes: Sides<StrokeSizes>,
    /// Whether both servos look linear under it.
    pub(super) linear: bool,
    /// Whether both answer strokes up and down alike.
    symmetric: bool,
}

impl Asked {
    pub(super) fn of(sides: [&Identified<'_>; 2]) -> Self {
        Self {
            motions: Sides::of(sides, |side| Motion::of(side.record)),
            runs: Sides::of(sides, |side| {
                side.record.each_run().map(|run| Motion::of(&run)).collect()
            }),
            strokes: Sides::of(sides, |side| StrokeSizes::of(side.record)),
            linear: sides.iter().all(|side| side.alone.linear),
            symmetric: !sides.iter().any(|side| side.asymmetric()),
        }
    }

    /// Whether the sides are compared as under one reference.
    pub(super) fn is_one_motion(&self) -> bool {
        self.has_like_motions() || self.shows_one_response()
    }

    /// Whether both were asked for motions of one size and kind; where runs of a side are of several, for each of these.
    fn has_like_motions(&self) -> bool {
        let is_paired = |run: &Motion, others: &[Motion]| others.iter().any(|of| run.is_like(of));
        self.motions.a.is_like(&self.motions.b) && (!self.is_mixed() || self.pairs_all(is_paired))
    }

    /// Whether levels are random, and were drawn anew for the other side.
    fn is_another_draw(&self) -> bool {
        let Sides { a, b } = &self.motions;
        let is_drawn_again = |run: &Motion, others: &[Motion]| {
            others
                .iter()
                .any(|of| run.is_like(of) && !run.is_another_draw(of))
        };
        a.is_another_draw(b)
            || self.strokes.a.are_another_draw(&self.strokes.b)
            || self.is_mixed() && !self.pairs_all(is_drawn_again)
    }

    /// Whether the runs of a side are of several references.
    fn is_mixed(&self) -> bool {
        let is_mixed = |runs: &[Motion]| {
            let unlike = |pair: &[Motion]| !pair[0].is_like(&pair[1]);
            runs.windows(2).any(unlike)
        };
        is_mixed(&self.runs.a) || is_mixed(&self.runs.b)
    }

    /// Whether each run of either side has a partner among those of the other.
    fn pairs_all(&self, is_paired: impl Fn(&Motion, &[Motion]) -> bool) -> bool {
        let Sides { a, b } = &self.runs;
        let all =
            |runs: &[Motion], others: &[Motion]| runs.iter().all(|run| is_paired(run, others));
        all(a, b) && all(b, a)
    }

    /// Whether each servo answers strokes of several sizes alike, and the other was asked for about as large ones, held for about as long. Then each
    /// has one response to all of them, whatever levels were drawn.
    fn shows_one_response(&self) -> bool {
        let Sides { a, b } = &self.motions;
        self.linear
            && self.symmetric
            && a.held
            && b.held
            && a.mean_hold_s.max(b.mean_hold_s) <= SIZES_COMPARED * a.mean_hold_s.min(b.mean_hold_s)
            && self.strokes.a.show_linearity_alike(&self.strokes.b)
    }

    /// Whether there is no verdict because the servos were asked for different motions.
    ///
    /// A servo that is not linear has another response for each motion, and a servo that looks linear under strokes of one size need not
    /// be: one that is limited in speed is slower over a larger stroke by one and the same factor in all of it. "Different" is therefore said
    /// under one reference only, or where both look linear under strokes of several sizes. "The same" may be said of sides that both look linear. No
    /// motion makes a servo turn the other way.
    pub(super) fn may_explain(&self, found: &Comparison) -> bool {
        let Sides { a, b } = &self.motions;
        let different = found.verdict == Verdict::Different;
        let is_another_draw = self.is_another_draw();
        if self.shows_one_response() || (different && found.turns_the_other_way) {
            return false;
        }
        match self.has_like_motions() {
            false => different || !self.linear,
            true if is_another_draw && !self.linear => true,
            true if is_another_draw && !self.symmetric => different,
            true => different && strokes_may_explain(found, a.larger_by(b)),
        }
    }
}

/// The same of two models, of which `strokes` have the one size of each recording, where it has one.
///
/// Strokes of several sizes, to which a servo that looks linear has one response, show nothing of the reference of one that does not.
pub(super) fn references_of_models_may_explain(
    found: &Comparison,
    strokes: [Option<f64>; 2],
    linear: bool,
) -> bool {
    let different = found.verdict == Verdict::Different;
    if different && found.turns_the_other_way {
        return false;
    }
    match strokes {
        [Some(a), Some(b)] => {
            let larger_by = larger_by([a, b]);
            different && (larger_by > EQUALLY_LARGE || strokes_may_explain(found, larger_by))
        }
        [None, None] => !linear,
        _ => different || !linear,
    }
}

/// How the references of two models may differ, by the one size of the `strokes` of each.
pub(super) fn references_of_models_in_words(strokes: [Option<f64>; 2], unit: &str) -> String {
    let in_words = |size: f64| four_digits(size).to_string();
    match strokes {
        [Some(a), Some(b)] => strokes_differ([in_words(a), in_words(b)], unit),
        [None, None] => "at least one of the two servos is not linear, and models do not show whether both had one reference".to_owned(),
        [Some(size), None] | [None, Some(size)] => format!(
            "one model is of strokes of {} alone, the other of another reference",
            with_unit(in_words(size), unit)
        ),
    }
}

/// Whether what exceeds the margin may come from strokes that are nearly equal, such as those of a whole number of microseconds by two calibrations.
///
/// Over a stroke that is larger by the fraction e a servo goes no less far, and at most farther by e. As shares of the stroke, which a step
/// response is, the two then differ by e at most.
fn strokes_may_explain(found: &Comparison, larger_by: f64) -> bool {
    let Bounds::Valid(bounds) = found.bounds else {
        return false;
    };
    bounds.difference_percent.at_least <= found.margin_percent + 100.0 * larger_by
}
