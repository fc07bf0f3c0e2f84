//! Strokes by the direction of the output.

use crate::data::{Record, Stroke, strokes};

/// The strokes towards larger outputs, and those towards smaller ones.
pub(super) fn strokes_by_direction(
    record: &Record,
    settling: usize,
    reversed: bool,
) -> [Vec<Stroke>; 2] {
    let mut strokes = strokes(record, settling);
    if reversed {
        // The output goes against the command, and that is no travel back.
        strokes.iter_mut().for_each(|stroke| stroke.travel *= -1.0);
    }
    let (up, down) = (strokes.into_iter()).partition(|stroke| (stroke.size > 0.0) != reversed);
    [up, down]
}
