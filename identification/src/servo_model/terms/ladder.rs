//! Which terms the servo has: those that predict parts of the record that the fit has not seen.
//!
//! The blocks of the record are dealt to a few folds. A servo is fitted without one fold and predicts it, for each fold
//! in turn; its errors in the blocks that it has not seen are compared, block by block, with those of another. A
//! term is taken out where its advantage is not larger than its scatter over the blocks.

use super::begun_terms::{that_moves, with_shared_rest, with_softer_loop};
use super::neighbouring_terms::{all_of_rest, poorer, richer};
use crate::results::fit_percent;
use crate::servo_model::descent::coordinates::{ArmTurn, Coordinate, LoadKind, Point, Terms};
use crate::servo_model::descent::fit::Problem;
use crate::servo_model::descent::initial_state::find_starts;
use crate::servo_model::descent::starting_values::{Shown, other_starts, search};
use crate::servo_model::search_progress::Watch;
use crate::servo_model::stretches::{FOLDS, Stretch};
use crate::thresholds::{SERVO_LARGE_ADVANTAGE, SERVO_MATERIAL_ADVANTAGE, SERVO_TERM_ADVANTAGE};
use rayon::prelude::*;
use servoid_dynamics::Grid;

/// Steps of a descent from the servo with one term fewer.
const STEPS: usize = 20;

/// Steps of a descent that shows whether it is worth more, and the share of the rung's own cost that it must come to.
const SHORT: usize = 3;
const PROMISING: f64 = 1.2;

/// Share of the held-out errors that a term must take away for another one to be tried after it.
const WORTH_ANOTHER: f64 = 0.01;

/// Share of a spring that holds the drive in the stiffness of servo and spring together.
const HARD_SPRING: f64 = 0.3;

/// Steps of a descent without a fold.
const FOLD_STEPS: usize = 6;

/// A servo with certain terms, and how it predicts what it has not seen.
#[derive(Clone, Debug)]
pub(crate) struct Rung {
    pub(crate) terms: Terms,
    /// Fitted to the whole record.
    pub(crate) fit: Point,
    /// The cost of that fit.
    pub(crate) cost: f64,
    /// Clipped sum of squared errors in each block, by the fit that has not seen it.
    pub(crate) held_out: Vec<f64>,
}

impl Rung {
    pub(crate) fn total(&self) -> f64 {
        total(&self.held_out)
    }

    /// Whether `self` predicts better than `other` by more than the scatter of its advantage. The advantage in a block is
    /// the logarithm of the ratio of the errors, so that no block decides by its size.
    pub(super) fn beats(&self, other: &Self) -> bool {
        beats(&self.held_out, &other.held_out)
    }
}

/// [`Rung::beats`] of the errors by block.
pub(crate) fn beats(mine: &[f64], theirs: &[f64]) -> bool {
    let advantage = |(mine, theirs): (&f64, &f64)| (theirs / mine).ln();
    let gains: Vec<f64> = (mine.iter().zip(theirs))
        .map(advantage)
        .filter(|gain| gain.is_finite())
        .collect();
    let count = gains.len() as f64;
    let mean = gains.iter().sum::<f64>() / count;
    let squares: f64 = gains.iter().map(|gain| (gain - mean).powi(2)).sum();
    let scatter = (squares / (count - 1.0) / count).sqrt();
    total(mine) < total(theirs) && mean > SERVO_TERM_ADVANTAGE * scatter
}

/// Whether a servo with the errors `poorer` by block is worse than the `best` by more than scatter, or by very much.
pub(crate) fn misses(poorer: &[f64], best: &[f64]) -> bool {
    beats(best, poorer) || total(best) < (1.0 - SERVO_LARGE_ADVANTAGE) * total(poorer)
}

fn total(by_block: &[f64]) -> f64 {
    by_block.iter().sum()
}

/// The choice among terms.
pub(crate) struct Ladder<'a> {
    pub(crate) stretches: &'a mut Vec<Stretch>,
    /// The fold that each block belongs to.
    pub(crate) fold_of: &'a [usize],
    /// A coarse one for the search, and then that of the servo that it finds.
    pub(crate) grid: Grid,
    pub(crate) shown: Shown,
    pub(crate) clip: f64,
    pub(crate) longest_delay_s: f64,
    pub(crate) controllers: usize,
    pub(crate) arm: ArmTurn,
    /// Where runs have offsets of their own, what these begin with.
    pub(crate) run_offsets: &'a [f64],
    pub(crate) watch: &'a dyn Watch,
    /// Every rung that was tried, in order.
    pub(crate) tried: Vec<Rung>,
}

/// The ladder after the climb.
pub(crate) struct Climbed {
    /// Every rung that was tried, in order.
    pub(crate) tried: Vec<Rung>,
    /// The index of the chosen one.
    pub(crate) chosen: usize,
    /// The indices of those that predict as well.
    pub(crate) others: Vec<usize>,
}

impl Climbed {
    /// The chosen rung.
    pub(crate) fn best(&self) -> &Rung {
        &self.tried[self.chosen]
    }

    /// With another one of those that predict as well chosen.
    pub(crate) fn with_chosen(self, rung: usize) -> Self {
        let before = std::iter::once(self.chosen);
        let others = before.chain(self.others.into_iter().filter(|other| *other != rung));
        Self {
            tried: self.tried,
            chosen: rung,
            others: others.collect(),
        }
    }

    /// The linear servo.
    pub(crate) fn linear(&self) -> Option<&Rung> {
        self.tried
            .iter()
            .find(|rung| rung.terms == Terms::default())
    }
}

impl Ladder<'_> {
    /// Climbs.
    pub(crate) fn climbed(mut self) -> Climbed {
        let chosen = self.climb();
        let others = self.not_beaten(chosen);
        Climbed {
            tried: self.tried,
            chosen,
            others,
        }
    }

    /// Climbs: returns the index of the chosen rung among those tried.
    fn climb(&mut self) -> usize {
        let chosen = self.climb_without_speed_limit();
        self.with_speed_limit(chosen)
    }

    /// The same among servos whose speed is not cut off.
    fn climb_without_speed_limit(&mut self) -> usize {
        let limited = Terms {
            limit: true,
            ..Terms::default()
        };
        // A limit by itself predicts little where strokes up and down differ, so its companions are tried with it.
        let both = Terms {
            two_speeds: true,
            ..limited
        };
        let from = [Terms::default(), both].map(|terms| self.searched(terms));
        let stiffness = |point: &Point| point.physics(0, |_, value| value).stiffness;
        let stiffest = stiffness(&from[0]).max(stiffness(&from[1]));
        let fine = Grid::for_stiffness(self.grid.period_s, self.grid.phase_s, stiffest);
        self.grid = fine.coarser();
        find_starts(self.stretches, &from[1], &self.grid);
        let linear = self.add(Terms::default(), &from[0]);
        let two_speeds = self.add(both, &from[1]);
        let mut best = two_speeds;
        for companion in [
            limited,
            Terms {
                friction: true,
                ..limited
            },
            Terms {
                dead_band: true,
                ..limited
            },
            Terms {
                play: true,
                ..limited
            },
            Terms {
                load: LoadKind::Constant,
                ..limited
            },
            Terms {
                load: LoadKind::Pendulum,
                ..limited
            },
            Terms {
                load: LoadKind::Spring,
                ..limited
            },
            // A spring decides at which edge of a dead band the shaft rests: neither helps by itself.
            Terms {
                dead_band: true,
                load: LoadKind::Spring,
                ..limited
            },
            Terms {
                load: LoadKind::TiltedPendulum,
                ..limited
            },
            Terms {
                load: LoadKind::Air,
                ..limited
            },
        ] {
            let rung = self.extended(two_speeds, companion);
            best = self.better(best, rung);
        }
        best = self.add_terms(best);
        best = self.seed_all_from(best);
        best = self.drop_terms(best);
        let needed = self.tried[best].total()
            < (1.0 - SERVO_MATERIAL_ADVANTAGE) * self.tried[linear].total();
        if needed && self.tried[best].beats(&self.tried[linear]) {
            // Those that prediction hardly distinguishes from it.
            let terms = self.tried[best].terms;
            for terms in richer(terms).into_iter().chain(all_of_rest(terms)) {
                self.extended(best, terms);
            }
            best
        } else {
            linear
        }
    }

    /// The rungs that the best one does not beat, the best first, without `chosen`.
    fn not_beaten(&self, chosen: usize) -> Vec<usize> {
        let mut all: Vec<usize> = (0..self.tried.len()).collect();
        all.sort_by(|&a, &b| self.tried[a].total().total_cmp(&self.tried[b].total()));
        let best = all[0];
        all.retain(|&rung| rung != chosen && !self.misses(rung, best));
        all
    }

    /// Adds the term that helps most, as long as one helps: with or without significance, because some help only
    /// together.
    pub(super) fn add_terms(&mut self, mut best: usize) -> usize {
        loop {
            self.try_other_starts(best);
            let before = self.tried[best].total();
            let from = best;
            for terms in richer(self.tried[from].terms) {
                let rung = self.extended(from, terms);
                best = self.better(best, rung);
            }
            let gained = self.tried[best].total() < (1.0 - WORTH_ANOTHER) * before;
            if !gained {
                return best;
            }
        }
    }

    /// Descends to every rung from the best one too, so that none loses by the valley that it was found in. Returns the
    /// best rung after that.
    fn seed_all_from(&mut self, best: usize) -> usize {
        let all = |_: usize| true;
        let from = self.tried[best].fit.clone();
        for rung in 0..self.tried.len() {
            let terms = self.tried[rung].terms;
            let problem = self.problem(&all);
            let fresh = |at: Coordinate| self.shown.fresh(at, self.arm);
            let mut point = from.with_terms(terms, self.controllers, fresh);
            let mut cost = problem.descend(&mut point, SHORT);
            if cost < PROMISING * self.tried[rung].cost {
                cost = problem.descend(&mut point, STEPS - SHORT);
            }
            if cost < self.tried[rung].cost {
                self.tried[rung] = self.rung(terms, (cost, point));
            }
        }
        (0..self.tried.len()).fold(best, |best, rung| self.better(best, rung))
    }

    /// Takes out terms that prediction does not miss, the least missed first: the result is the poorest servo that the
    /// best one does not beat.
    pub(super) fn drop_terms(&mut self, best: usize) -> usize {
        let mut kept = best;
        loop {
            let mut least = None;
            for terms in poorer(self.tried[kept].terms) {
                let rung = self.extended(kept, terms);
                least = Some(least.map_or(rung, |other| self.better(other, rung)));
            }
            match least {
                Some(poorer) if !self.misses(poorer, best) => kept = poorer,
                _ => return kept,
            }
        }
    }

    /// Whether the rung `poorer` predicts worse than `best` by more than scatter, or by very much.
    fn misses(&self, poorer: usize, best: usize) -> bool {
        misses(&self.tried[poorer].held_out, &self.tried[best].held_out)
    }

    /// The lowest total so far.
    fn lowest(&self) -> f64 {
        let totals = self.tried.iter().map(Rung::total);
        totals.fold(f64::INFINITY, f64::min)
    }

    pub(super) fn better(&self, a: usize, b: usize) -> usize {
        if self.tried[b].total() < self.tried[a].total() {
            b
        } else {
            a
        }
    }

    /// Descends again from elsewhere.
    fn try_other_starts(&mut self, rung: usize) {
        let Rung {
            terms,
            ref fit,
            cost,
            ..
        } = self.tried[rung];
        let all = |_: usize| true;
        let problem = self.problem(&all);
        let found = problem.best_descent(other_starts(fit, &problem, &self.shown), STEPS);
        if found.0 < cost {
            self.tried[rung] = self.rung(terms, found);
        }
    }

    /// A servo found from far away.
    pub(super) fn searched(&self, terms: Terms) -> Point {
        let all = |_: usize| true;
        let (problem, controllers) = (self.problem(&all), self.controllers);
        let own = (self.arm, self.run_offsets);
        search(&problem, &self.shown, terms, controllers, own)
    }

    /// A rung found from another one.
    pub(super) fn extended(&mut self, from: usize, terms: Terms) -> usize {
        if let Some(known) = self.tried.iter().position(|rung| rung.terms == terms) {
            return known;
        }
        let from = self.tried[from].fit.clone();
        self.add(terms, &from)
    }

    pub(super) fn add(&mut self, terms: Terms, from: &Point) -> usize {
        self.add_lowest(terms, self.variants(from, terms))
    }

    /// The rung of the lowest minimum from these starts.
    pub(super) fn add_lowest(&mut self, terms: Terms, starts: Vec<Point>) -> usize {
        let fit = self.fit(starts);
        self.tried.push(self.rung(terms, fit));
        let percent = fit_percent(self.lowest(), self.shown.output_square);
        self.watch.tried(self.tried.len(), percent);
        self.tried.len() - 1
    }

    /// The best fit to the whole record, and its cost.
    fn fit(&self, starts: Vec<Point>) -> (f64, Point) {
        let all = |_: usize| true;
        let problem = self.problem(&all);
        problem.best_descent(starts, STEPS)
    }

    /// How the fit predicts blocks that it has not seen: the fits without their folds are near, a few steps from that to the
    /// whole record. Where another rung is better by far, how it follows all blocks.
    fn rung(&self, terms: Terms, (cost, fit): (f64, Point)) -> Rung {
        let mut held_out = self.by_block(&fit);
        // Worse by far on what it has seen: no fit without a fold is needed to know that it is worse. The figure of the linear
        // servo is what others are held against.
        let hopeless = self.lowest() < (1.0 - SERVO_LARGE_ADVANTAGE) * cost;
        let folds = match hopeless && terms != Terms::default() {
            true => 0..0,
            false => 0..FOLDS,
        };
        let of_folds = folds.into_par_iter().map(|fold| {
            let others = |block: usize| self.fold_of[block] != fold;
            let problem = Problem {
                converged: 1e-3,
                ..self.problem(&others)
            };
            let mut without = fit.clone();
            problem.descend(&mut without, FOLD_STEPS);
            (fold, self.by_block(&without))
        });
        for (fold, costs) in of_folds.collect::<Vec<_>>() {
            for (block, of) in self.fold_of.iter().enumerate() {
                if *of == fold {
                    held_out[block] = costs[block];
                }
            }
        }
        Rung {
            terms,
            fit,
            cost,
            held_out,
        }
    }

    /// Clipped sum of squared errors in each block.
    fn by_block(&self, point: &Point) -> Vec<f64> {
        let all = |_: usize| true;
        self.problem(&all).by_block(point, self.fold_of.len())
    }

    /// The servo `from` with other terms. Those with more than one valley are tried from more than one side.
    pub(super) fn variants(&self, from: &Point, terms: Terms) -> Vec<Point> {
        let fresh = |at: Coordinate| self.shown.fresh(at, self.arm);
        let plain = that_moves(from, from.with_terms(terms, self.controllers, fresh));
        let varied = |coordinate: Coordinate, value: f64| {
            let mut point = plain.clone();
            point.set(coordinate, value);
            point
        };
        if terms.speed_limit && !from.terms.speed_limit {
            return self.with_speed_cut_off(from, plain);
        }
        if from.terms.load == terms.load {
            return with_softer_loop(from, with_shared_rest(from, plain), &self.shown);
        }
        match terms.load {
            LoadKind::None | LoadKind::Constant | LoadKind::Pendulum => vec![plain],
            LoadKind::Spring => {
                // The middle of the motion keeps its load. A spring that holds the drive is in another valley than a soft one.
                let before = plain.get(Coordinate::ConstantLoad).unwrap_or(0.0);
                let spring = |share: f64| {
                    let mut point = varied(Coordinate::Spring, share);
                    point.set(Coordinate::ConstantLoad, before - share * self.shown.middle);
                    point
                };
                vec![spring(fresh(Coordinate::Spring)), spring(HARD_SPRING)]
            }
            LoadKind::TiltedPendulum => {
                let quarter = std::f64::consts::FRAC_PI_2 / self.arm.radians(self.shown.gain);
                let level = fresh(Coordinate::GravityFrom) + quarter;
                vec![varied(Coordinate::GravityFrom, level), plain]
            }
            LoadKind::Air => {
                let mut below =
                    varied(Coordinate::AirStiffening, -fresh(Coordinate::AirStiffening));
                below.set(
                    Coordinate::AirFrom,
                    self.shown.middle + 0.5 * self.shown.spread,
                );
                vec![plain, below]
            }
        }
    }

    fn problem<'b>(&'b self, used: &'b (dyn Fn(usize) -> bool + Sync)) -> Problem<'b> {
        Problem {
            stretches: self.stretches,
            grid: self.grid,
            used,
            clip: self.clip,
            longest_delay_s: self.longest_delay_s,
            converged: 1e-4,
            watch: self.watch,
        }
    }
}
