//! Tops of the output that a stop cuts off: it comes there at speed, and stays while the command goes on.
//!
//! Any other servo slows down on its way to a top, and one with a dead band, friction or play that rests there has done so, too. The top of one
//! that only its speed limits is a point. Where the command is held, any servo rests, some without having slowed down.

use crate::data::column::span;
use std::ops::Range;

/// Rows that such a top lasts at the least.
const FEWEST_ROWS: usize = 4;

/// Share of the range of the output on the way to the top. The time that this way takes is held against that of as long a way before.
const WAY: f64 = 0.1;

/// How many times as long it takes at the most. The top of a sine takes 1.9 times as long, one that is cut off at 0.9 of it 1.4 times.
const SLOWER: f64 = 1.6;

/// Largest tolerance, as a share of the range of the output. Counted from so far below it, the top of a sine takes 1.7 times as long; from four times as far, 1.4 times,
/// as one that is cut off.
const TOLERANCE: f64 = 0.005;

/// The tops of one side of a record. Outputs are times its sign.
pub(super) struct Tops {
    /// The farthest output, and how far from there an output still is at the level of the top.
    pub(super) farthest: f64,
    pub(super) tolerance: f64,
    /// The range of the output, and outputs for each unit of the command, by the ranges of both.
    pub(super) range: f64,
    pub(super) ratio: f64,
}

impl Tops {
    /// The rows of the top of the crest `within` these outputs, where a stop cuts it off.
    pub(super) fn cut_off(
        &self,
        outputs: &[f64],
        commands: &[f64],
        within: Range<usize>,
    ) -> Option<Range<usize>> {
        if self.tolerance > TOLERANCE * self.range {
            return None;
        }
        let nearest = self.farthest - 2.0 * self.tolerance;
        let is_there = |row: &usize| outputs[*row] > nearest;
        let first = within.clone().find(is_there)?;
        let last = within.rev().find(is_there)?;
        let rows = last + 1 - first;
        let way = WAY * self.range;
        let [late, middle, early] =
            [0.0, way, 2.0 * way].map(|below| reached(outputs, first, nearest - below));
        let (late, middle, early) = (late?, middle?, early?);
        let (last_way, way_before) = (late - middle, middle - early);
        let comes_at_speed = last_way < SLOWER * way_before;
        let stays = rows >= FEWEST_ROWS && rows as f64 > last_way;
        // What the command does later reaches the output after the top, if the servo is slow.
        let meanwhile = commands[first..=first + rows / 2].iter().copied();
        let goes_on = span(meanwhile).is_some_and(|way| self.ratio * way > 2.0 * self.tolerance);
        (comes_at_speed && stays && goes_on).then_some(first..last + 1)
    }
}

/// Where the outputs before `row` came to `level` last, in rows.
fn reached(outputs: &[f64], row: usize, level: f64) -> Option<f64> {
    let before = (0..row).rev().find(|k| outputs[*k] <= level)?;
    let (from, to) = (outputs[before], outputs[before + 1]);
    Some(before as f64 + (level - from) / (to - from))
}
