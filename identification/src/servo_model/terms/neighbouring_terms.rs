//! The terms beside others on the ladder: one more, or one fewer.

use crate::servo_model::descent::coordinates::{LoadKind, Terms};

/// The same terms and one more, or another load.
pub(super) fn richer(terms: Terms) -> Vec<Terms> {
    let simpler = terms.load.simpler();
    let more_load = |load: &LoadKind| !simpler.contains(load) && *load != terms.load;
    let with = [
        (
            terms.speed_limit && !terms.limit,
            Terms {
                limit: true,
                ..terms
            },
        ),
        (
            !terms.two_speeds,
            Terms {
                two_speeds: true,
                ..terms
            },
        ),
        (
            !terms.dead_band,
            Terms {
                dead_band: true,
                ..terms
            },
        ),
        (
            !terms.play,
            Terms {
                play: true,
                ..terms
            },
        ),
        (
            !terms.friction,
            Terms {
                friction: true,
                ..terms
            },
        ),
        (
            !terms.friction_of_gears,
            Terms {
                friction: true,
                friction_of_gears: true,
                ..terms
            },
        ),
    ];
    let loads = LoadKind::BY_COORDINATES.into_iter().filter(more_load);
    with_loads(with, loads, terms)
}

/// The same terms with all that holds a servo off its command, where they have some of it: dead band, friction and play rest alike, so that one of them stands for the three.
pub(super) fn all_of_rest(terms: Terms) -> Option<Terms> {
    let has_some = terms.dead_band || terms.friction || terms.play;
    has_some.then_some(Terms {
        dead_band: true,
        play: true,
        friction: true,
        ..terms
    })
}

/// The same terms and one fewer, or a simpler load.
pub(super) fn poorer(terms: Terms) -> Vec<Terms> {
    let without = [
        (
            terms.speed_limit && terms.limit,
            Terms {
                limit: false,
                ..terms
            },
        ),
        (
            terms.two_speeds,
            Terms {
                two_speeds: false,
                ..terms
            },
        ),
        (
            terms.dead_band,
            Terms {
                dead_band: false,
                ..terms
            },
        ),
        (
            terms.play,
            Terms {
                play: false,
                ..terms
            },
        ),
        (
            terms.friction,
            Terms {
                friction: false,
                friction_of_gears: false,
                ..terms
            },
        ),
        (
            terms.friction_of_gears,
            Terms {
                friction_of_gears: false,
                ..terms
            },
        ),
    ];
    with_loads(without, terms.load.simpler().iter().copied(), terms)
}

/// The terms that are possible, and `terms` with each of the loads.
fn with_loads(
    terms_if_possible: [(bool, Terms); 6],
    loads: impl Iterator<Item = LoadKind>,
    terms: Terms,
) -> Vec<Terms> {
    let possible = |(possible, terms): (bool, Terms)| possible.then_some(terms);
    let with_load = |load| Terms { load, ..terms };
    let others = terms_if_possible.into_iter().filter_map(possible);
    let all = others.chain(loads.map(with_load));
    all.filter(|terms| shows_its_load(*terms)).collect()
}

/// Whether the motion can show the load: a spring around a linear loop is another gain of a stiffer one.
fn shows_its_load(terms: Terms) -> bool {
    terms.load != LoadKind::Spring || terms.is_limited() || terms.dead_band || terms.friction
}
