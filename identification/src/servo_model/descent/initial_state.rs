//! The state in which a stretch begins.
//!
//! Most runs begin at rest, and their first output is all that is needed. A stretch that begins in motion has a
//! speed, and a command that was given before its first sample and still acts during the delay. Both are found from its
//! first samples, for given parameters of the servo.

use super::coordinates::Point;
use crate::numerics::{backward_solve, cholesky, forward_solve, square_about_mean};
use crate::servo_model::stretches::{Stretch, noise_sd};
use faer::Mat;
use servoid_dynamics::{Dual, Grid, Scalar, Start, simulate};

/// Time in which the motion must show itself \[s\]: shorter than the delay of any R/C servo, whose answer to the first
/// commands of the stretch must not pass for a motion before them.
const LEAD_S: f64 = 0.01;

/// Standard deviations of the noise that count as motion.
const MOTION: f64 = 4.0;

/// Leads that show the noise of a rise, at least.
const FEWEST: usize = 8;

/// Samples from which a start is found, at the most.
const WINDOW: usize = 200;

/// Finds the start of every stretch anew for the servo `point`.
pub(crate) fn find_starts(stretches: &mut [Stretch], point: &Point, grid: &Grid) {
    for stretch in stretches {
        if stretch.at_rest.is_none() && in_motion(stretch, grid.period_s) {
            stretch.start = in_motion_start(stretch, point, grid);
        } else if point.terms.play {
            stretch.start.in_play = place_in_play(stretch, point, grid);
        }
    }
}

/// Places of the shaft in its play that are tried.
const PLACES: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];

/// Time after the first command of a stretch in which a shaft crosses its play \[s\].
const CROSSED_S: f64 = 0.2;

/// Where in its play the shaft is at the beginning of a stretch, as its answer to the first command shows it.
fn place_in_play(stretch: &Stretch, point: &Point, grid: &Grid) -> f64 {
    let physics = point.servo_of(stretch, |_, value| value);
    let before = stretch.at_rest.unwrap_or(stretch.input[0]);
    let held = (stretch.input.iter()).take_while(|u| **u == before).count();
    let longest = ((physics.delay_s + CROSSED_S) / grid.period_s) as usize;
    let window = (held + longest + 1).min(stretch.input.len());
    let cost = |in_play: f64| {
        let start = Start {
            in_play,
            ..stretch.start
        };
        let mut cost = 0.0;
        simulate(
            &physics,
            grid,
            &start,
            stretch.commands().first(window),
            |k, y| {
                let error = stretch.output[k] - y;
                cost += if error.is_nan() { 0.0 } else { error * error };
            },
        );
        cost
    };
    let costs = PLACES.map(|place| (cost(place), place));
    let lowest = costs.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    lowest.map_or(0.0, |(_, place)| place)
}

/// Whether the first samples rise or fall by more than their noise.
fn in_motion(stretch: &Stretch, period_s: f64) -> bool {
    let lead = ((LEAD_S / period_s).round() as usize).max(2);
    let Some(first) = stretch.output.get(..lead) else {
        return false;
    };
    // Short holds show white noise alone.
    let white =
        noise_sd(&stretch.output) * (lead as f64 / squares_from_middle(lead).sqrt()).max(1.0);
    let noise = white.max(noise_of_rise(stretch, lead));
    rise(first).is_some_and(|rise| rise.abs() > MOTION * noise)
}

/// The rise of a line through the samples over their length, in least squares; `None` where they are missing.
fn rise(samples: &[f64]) -> Option<f64> {
    let middle = (samples.len() - 1) as f64 / 2.0;
    let known = samples.iter().enumerate().filter(|(_, y)| !y.is_nan());
    let (moments, squares) = known.fold((0.0, 0.0), |(moments, squares), (k, y)| {
        let from_middle = k as f64 - middle;
        (
            moments + from_middle * y,
            squares + from_middle * from_middle,
        )
    });
    (squares > 0.0).then(|| moments / squares * samples.len() as f64)
}

/// Sum of the squared distances of `count` samples from their middle.
fn squares_from_middle(count: usize) -> f64 {
    let count = count as f64;
    count * (count * count - 1.0) / 12.0
}

/// Standard deviation of [`rise`] by noise of any colour, from the later half of the first hold, where the servo has come to rest; 0 where that is short.
fn noise_of_rise(stretch: &Stretch, lead: usize) -> f64 {
    let first = stretch.input[0];
    let held = (stretch.input.iter()).take_while(|u| **u == first).count();
    let later = &stretch.output[held / 2..held];
    let rises: Vec<f64> = later.chunks_exact(lead).filter_map(rise).collect();
    match rises.len() {
        0..FEWEST => 0.0,
        count => (square_about_mean(&rises) / (count - 1) as f64).sqrt(),
    }
}

/// The start that lets the servo follow the first samples best (Gauss-Newton from two guesses of the command before).
fn in_motion_start(stretch: &Stretch, point: &Point, grid: &Grid) -> Start<f64> {
    let physics = point.servo_of(stretch, |_, value| value);
    let time_constant_s = physics.stiffness.sqrt().recip().max(1.0 / physics.damping);
    let samples = ((physics.delay_s + 5.0 * time_constant_s) / grid.period_s) as usize;
    let window = samples.clamp(6, WINDOW).min(stretch.input.len());
    let rate = (stretch.output[1] - stretch.output[0]) / grid.period_s;
    let rate = if rate.is_nan() { 0.0 } else { rate };
    let angle = (stretch.output[0] - physics.offset) / physics.gain;
    let fits = [stretch.input[0], physics.holding_command(angle)].map(|command_before| {
        let mut start = [stretch.output[0], rate, command_before];
        let mut cost = f64::INFINITY;
        for _ in 0..8 {
            let (at, step) = gauss_newton(stretch, point, grid, window, start);
            if at.is_nan() || at >= cost {
                break;
            }
            cost = at;
            let Some(step) = step else { break };
            for (value, change) in start.iter_mut().zip(step) {
                *value += change;
            }
        }
        (cost, start)
    });
    let best = if fits[1].0 < fits[0].0 {
        fits[1].1
    } else {
        fits[0].1
    };
    if best.iter().all(|value| value.is_finite()) {
        Start {
            output: best[0],
            rate: best[1],
            command_before: Some(best[2]),
            in_play: in_play(best[1], physics.gain),
        }
    } else {
        Start::at_rest(stretch.output[0], None)
    }
}

/// Where a shaft is in its play that takes the output along at `rate`.
fn in_play(rate: f64, gain: f64) -> f64 {
    (rate * gain).signum()
}

/// Sum of squared errors over the window, and the step that lowers it.
fn gauss_newton(
    stretch: &Stretch,
    point: &Point,
    grid: &Grid,
    window: usize,
    start: [f64; 3],
) -> (f64, Option<Vec<f64>>) {
    let physics = point.servo_of(stretch, |_, value| Dual::<3>::constant(value));
    let [output, rate, command] = [0, 1, 2].map(|i| Dual::<3>::variable(start[i], i));
    let start = Start {
        output,
        rate,
        command_before: Some(command),
        in_play: in_play(rate.value, physics.gain.value),
    };
    let mut normal = Mat::<f64>::zeros(3, 3);
    let (mut gradient, mut cost) = (vec![0.0; 3], 0.0);
    simulate(
        &physics,
        grid,
        &start,
        stretch.commands().first(window),
        |k, y| {
            let error = stretch.output[k] - y.value;
            if error.is_nan() {
                return;
            }
            cost += error * error;
            for i in 0..3 {
                gradient[i] += y.slope[i] * error;
                for j in 0..3 {
                    normal[(i, j)] += y.slope[i] * y.slope[j];
                }
            }
        },
    );
    for i in 0..3 {
        // What the window does not show stays where it is.
        normal[(i, i)] = normal[(i, i)] * 1.001 + 1e-9;
    }
    let step =
        cholesky(&normal).map(|lower| backward_solve(&lower, &forward_solve(&lower, &gradient)));
    (cost, step)
}

#[cfg(test)]
mod tests {
    use super::in_motion;
    use crate::data::Record;
    use crate::servo_model::stretches::stretches;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    const PERIOD_S: f64 = 0.001;

    /// Whether strokes every half second that begin with this motion are taken to begin in motion, in noise that keeps .8 of its last value.
    fn begins_in_motion(seed: u64, motion: impl Fn(f64) -> f64) -> bool {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut noise = 0.0;
        let input: Vec<f64> = (0..10_000).map(|k| (k / 500 % 4) as f64).collect();
        let mut angle = input[0];
        let output: Vec<f64> = (0..input.len())
            .map(|k| {
                let v: f64 = StandardNormal.sample(&mut random);
                noise = 0.8 * noise + 0.03 * v;
                angle += PERIOD_S / 0.02 * (input[k] - angle);
                angle + noise + motion(PERIOD_S * k as f64)
            })
            .collect();
        let record = Record::of_run(PERIOD_S, &input, &output).unwrap();
        let (all, _) = stretches(&record, &[]);
        in_motion(&all[0], PERIOD_S)
    }

    #[test]
    fn slow_noise_is_no_motion_and_motion_is_seen_in_it() {
        let still = (0..200).filter(|&seed| begins_in_motion(seed, |_| 0.0));
        // Four standard deviations: 1 of 16 000. By the white part of that noise it would be half of them.
        assert_eq!(still.count(), 0);
        let moving = (0..200).filter(|&seed| begins_in_motion(seed, |t| 3.0 * (-t / 0.03).exp()));
        assert_eq!(moving.count(), 200);
    }
}
