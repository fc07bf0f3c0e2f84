//! Simulated servos with exactly known answers, and the limits that real ones have.

use faer::c64;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Time between samples \[s\].
pub const PERIOD: f64 = 0.002;

/// K e^{-Ls} with one to three poles, answered exactly at any time.
#[derive(Debug, Clone)]
pub struct Linear {
    pub gain: f64,
    pub delay_s: f64,
    /// Distinct, with negative real parts; complex ones in pairs.
    poles: Vec<c64>,
}

/// Metrics of an exact response; times from the edge.
#[derive(Debug, Clone, Copy)]
pub struct Figures {
    pub delay_s: f64,
    pub t50_s: f64,
    pub rise_s: f64,
    pub overshoot_percent: f64,
    pub settling_s: f64,
    pub bandwidth_rad_s: f64,
    pub phase_minus_90_rad_s: f64,
}

impl Linear {
    /// K e^{-Ls} / (1 + 2ζs/ω + s²/ω²), ζ other than 1.
    pub fn second_order(gain: f64, delay_s: f64, zeta: f64, omega: f64) -> Self {
        let root = c64::new(zeta * zeta - 1.0, 0.0).sqrt();
        let pole = |side: f64| (root * side - zeta) * omega;
        Self {
            gain,
            delay_s,
            poles: vec![pole(1.0), pole(-1.0)],
        }
    }

    /// K e^{-Ls} / (1 + Ts).
    pub fn first_order(gain: f64, delay_s: f64, lag_s: f64) -> Self {
        Self {
            gain,
            delay_s,
            poles: vec![c64::new(-1.0 / lag_s, 0.0)],
        }
    }

    /// With a further lag 1/(1 + Ts).
    pub fn with_lag(mut self, lag_s: f64) -> Self {
        self.poles.push(c64::new(-1.0 / lag_s, 0.0));
        self
    }

    /// Number of poles.
    pub fn order(&self) -> usize {
        self.poles.len()
    }

    /// \[K, L, T\] of one pole, and \[K, L, ω, ζ\] of the first two of more.
    pub fn parameters(&self) -> Vec<f64> {
        let shape = match self.poles[..] {
            [pole] => vec![-pole.re.recip()],
            [one, other, ..] => {
                let omega = (one * other).re.sqrt();
                vec![omega, -(one + other).re / (2.0 * omega)]
            }
            [] => Vec::new(),
        };
        [vec![self.gain, self.delay_s], shape].concat()
    }

    /// Response to a unit step at time zero, by residues.
    pub fn step(&self, t: f64) -> f64 {
        let t = t - self.delay_s;
        if t <= 0.0 {
            return 0.0;
        }
        let all: c64 = self.poles.iter().map(|p| -p).product();
        let modes: c64 = (0..self.poles.len())
            .map(|i| {
                let p = self.poles[i];
                let others: c64 = (0..self.poles.len())
                    .filter(|&j| j != i)
                    .map(|j| p - self.poles[j])
                    .product();
                all / (p * others) * (p * t).exp()
            })
            .sum();
        self.gain * (1.0 + modes.re)
    }

    pub fn response(&self, omega: f64) -> c64 {
        let s = c64::new(0.0, omega);
        let lag: c64 = self.poles.iter().map(|p| -p / (s - p)).product();
        lag * self.gain * (s * -self.delay_s).exp()
    }

    /// The servo `phase` after each sample of a held input that had stood at `rest`.
    pub fn respond(&self, input: &[f64], rest: f64, phase: f64) -> Vec<f64> {
        respond_by_stroke(self, self, input, rest, phase)
    }

    /// The exact figures, by bisection on the formula.
    pub fn figures(&self) -> Figures {
        figures_of(|t| self.step(t), |omega| self.response(omega), self.gain)
    }
}

/// The figures of a response to a step and its frequency response, with this gain.
pub fn figures_of(step: impl Fn(f64) -> f64, response: impl Fn(f64) -> c64, gain: f64) -> Figures {
    let relative = |t: f64| step(t) / gain;
    let grid = 1e-5;
    let at = |k: usize| relative(k as f64 * grid);
    const COUNT: usize = 100_000; // One second.
    let first = |level: f64| {
        let k = (0..COUNT).find(|&k| at(k) >= level).unwrap();
        bisect(
            |t| relative(t) - level,
            (k - 1) as f64 * grid,
            k as f64 * grid,
        )
    };
    let top = (0..COUNT).map(at).fold(1.0, f64::max);
    let settled = (0..COUNT).rfind(|&k| (at(k) - 1.0).abs() > 0.02).unwrap();
    let edge = 1.0 + 0.02 * (at(settled) - 1.0).signum();
    let settling_s = bisect(
        |t| relative(t) - edge,
        settled as f64 * grid,
        (settled + 1) as f64 * grid,
    );
    let fall = |w: f64| response(w).norm() / gain - 0.5f64.sqrt();
    let turn = |w: f64| {
        // Continued from rest in small steps.
        (1..=1000).fold(0.0, |phase: f64, k| {
            let next = response(w * f64::from(k) / 1000.0).arg();
            next - std::f64::consts::TAU * ((next - phase) / std::f64::consts::TAU).round()
        }) + std::f64::consts::FRAC_PI_2
    };
    let falls = (1..2000)
        .find(|&k| fall(f64::from(k)) < 0.0)
        .map(f64::from)
        .unwrap();
    let turns = (1..2000)
        .find(|&k| turn(f64::from(k)) < 0.0)
        .map(f64::from)
        .unwrap();
    Figures {
        delay_s: first(0.05),
        t50_s: first(0.5),
        rise_s: first(0.9) - first(0.1),
        overshoot_percent: 100.0 * (top - 1.0),
        settling_s,
        bandwidth_rad_s: bisect(fall, falls - 1.0, falls),
        phase_minus_90_rad_s: bisect(turn, turns - 1.0, turns),
    }
}

/// Each change of the command is answered by `up` or `down`: with one gain both ways, the servo
/// that the direction-split model describes exactly.
pub fn respond_by_stroke(
    up: &Linear,
    down: &Linear,
    input: &[f64],
    rest: f64,
    phase: f64,
) -> Vec<f64> {
    let mut edges = Vec::new();
    let mut before = rest;
    for (k, &u) in input.iter().enumerate() {
        if u != before {
            edges.push((k, u - before));
        }
        before = u;
    }
    (0..input.len())
        .map(|k| {
            let moved: f64 = edges
                .iter()
                .take_while(|(edge, _)| *edge <= k)
                .map(|(edge, size)| {
                    let servo = if *size > 0.0 { up } else { down };
                    size * servo.step((k - edge) as f64 * PERIOD + phase)
                })
                .sum();
            up.gain * rest + moved
        })
        .collect()
}

/// The shift that brings the step response of `a` closest to that of `b`, each relative to its gain:
/// every shift within 40 ms tried on the formulas, 0.01 ms apart, over 130 samples.
pub fn exact_shift(a: &Linear, b: &Linear) -> f64 {
    let relative = |servo: &Linear, t: f64| servo.step(t.max(0.0)) / servo.gain;
    let distance = |shift: f64| -> f64 {
        (0..130)
            .map(|m| f64::from(m) * PERIOD)
            .map(|t| (relative(a, t - shift) - relative(b, t)).powi(2))
            .sum()
    };
    (-4000..=4000)
        .map(|k| f64::from(k) * 1e-5)
        .min_by(|&s, &t| distance(s).total_cmp(&distance(t)))
        .unwrap()
}

fn bisect(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let start = f(a) > 0.0;
    for _ in 0..60 {
        let middle = f64::midpoint(a, b);
        if (f(middle) > 0.0) == start {
            a = middle
        } else {
            b = middle
        }
    }
    f64::midpoint(a, b)
}

/// Imperfections of a real servo beside its dynamics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// Largest speed \[deg/s\] up and down.
    Rate(f64, f64),
    /// Backlash, full width \[deg\].
    Play(f64),
    /// Stops \[deg\].
    Clip(f64, f64),
}

/// A second-order servo (ζ, ω, delay 21.5 ms) with a limit, in steps of 0.1 ms.
pub fn limited(zeta: f64, omega: f64, limit: Limit, input: &[f64], rest: f64) -> Vec<f64> {
    limited_in_steps(zeta, omega, limit, input, rest, (PERIOD / 20.0, 20, 215))
}

/// The same in steps of `dt` \[s\], so many for each sample of the input, with a delay of `late` steps.
pub fn limited_in_steps(
    zeta: f64,
    omega: f64,
    limit: Limit,
    input: &[f64],
    rest: f64,
    (dt, steps, late): (f64, usize, usize),
) -> Vec<f64> {
    let (mut x, mut v, mut shaft) = (rest, 0.0, rest);
    let mut output = Vec::with_capacity(input.len());
    for k in 0..input.len() {
        shaft = match limit {
            Limit::Play(width) => shaft.clamp(x - width / 2.0, x + width / 2.0),
            Limit::Clip(low, high) => x.clamp(low, high),
            Limit::Rate(..) => x,
        };
        output.push(shaft);
        for step in 0..steps {
            let now = k * steps + step;
            let u = now
                .checked_sub(late)
                .map_or(rest, |then| input[then / steps]);
            v += dt * (omega * omega * (u - x) - 2.0 * zeta * omega * v);
            if let Limit::Rate(up, down) = limit {
                v = v.clamp(-down, up);
            }
            x += dt * v;
            if let Limit::Play(width) = limit {
                shaft = shaft.clamp(x - width / 2.0, x + width / 2.0);
            }
        }
    }
    output
}

/// White noise of 0.02 degrees, coloured noise driven by 0.015, and a converter of 12 bits over
/// 150 degrees, as the rig's sensor.
pub fn measured(clean: &[f64], scale: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
    let (mut one, mut two) = (0.0, 0.0);
    for _ in 0..200 {
        let next = 1.5 * one - 0.7 * two + 0.015 * normal();
        (two, one) = (one, next);
    }
    const LSB: f64 = 150.0 / 4096.0;
    clean
        .iter()
        .map(|y| {
            let next = 1.5 * one - 0.7 * two + 0.015 * normal();
            (two, one) = (one, next);
            let analogue = y + scale * (0.02 * normal() + one);
            (analogue / LSB).round() * LSB
        })
        .collect()
}

/// The paper's reference: ±5 degrees, holds of 800 ms down to 100 ms.
pub fn staircase() -> Vec<f64> {
    (1..=8)
        .rev()
        .flat_map(|hold| [(5.0, hold), (-5.0, hold)])
        .flat_map(|(level, hold)| std::iter::repeat_n(level, 50 * hold))
        .collect()
}

/// Up and down through `levels`, `visits` times, each held for `hold` samples.
pub fn stairs(levels: &[f64], visits: usize, hold: usize) -> Vec<f64> {
    let down = levels.iter().rev().skip(1);
    let round: Vec<f64> = levels.iter().skip(1).chain(down).copied().collect();
    std::iter::once(levels[0])
        .chain(round.iter().copied().cycle().take(visits * round.len()))
        .flat_map(|level| std::iter::repeat_n(level, hold))
        .collect()
}

/// Strokes of 2 to 10 degrees (times `scale`), three of each size both ways.
pub fn sizes(scale: f64, hold: usize) -> Vec<f64> {
    let mut input = vec![0.0; hold];
    for size in [2.0, 4.0, 6.0, 8.0, 10.0] {
        for _ in 0..3 {
            for side in [-0.5, 0.5] {
                input.extend(std::iter::repeat_n(side * size * scale, hold));
            }
        }
    }
    input
}
