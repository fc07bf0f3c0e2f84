//! How often the intervals of low-order models hold the numbers of simulated servos whose poles, delays and inputs are drawn.

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use servoid_identification::flight_model::{self, FlightModel, FlightModelOptions};
use servoid_identification::results::Interval;
use servoid_identification::{Options, Record, identify};
use std::f64::consts::TAU;
use std::fmt;

use crate::plants::{normal, random};
use crate::servos::Linear;

/// Half of the span of all commands \[deg\].
const AMPLITUDE: f64 = 10.0;

/// What is left of a response that counts as over, of its gain.
const OVER: f64 = 1e-9;

/// What the servo is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// One pole.
    FirstOrder,
    /// A pair of poles.
    SecondOrder,
    /// A pair, and a lag that is faster than it.
    PairAndLag,
    /// A pair, and a lag that is slower than it.
    PairAndSlowerLag,
    /// Three real poles.
    RealPoles,
    /// A pair, with .3 to .6 % of the response in .15 s: a servo with zeros, almost of second order.
    SlowEnd,
    /// A pair, with 3 to 30 % of the response in a slower lag: a servo with zeros, of no order.
    TwoTimeScales,
}

/// What is commanded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// Levels that are held, of a staircase or drawn.
    Steps,
    /// A sweep to 5 or 12 Hz, a sum of sines, or noise that was low-passed.
    Band,
}

/// A line of the table.
#[derive(Debug, Clone, Copy)]
pub struct LowOrderLine {
    pub kind: Kind,
    pub input: Input,
}

/// The drawn servo.
struct Servo {
    fast: Linear,
    /// A lag beside it \[s\], and its share of the response.
    slow: Option<(f64, f64)>,
    /// Time constants of real poles, longest first, or of the only lag \[s\].
    lags_s: Vec<f64>,
    /// Natural frequency \[rad/s\] and damping of a complex pair.
    pair: Option<[f64; 2]>,
}

/// How many of the intervals that there are hold.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    pub held: usize,
    pub of: usize,
}

/// How the intervals of the low-order models of one line hold.
#[derive(Debug, Clone, Default)]
pub struct OfLowOrder {
    /// Models.
    pub fitted: usize,
    /// Those whose order is rejected, which have no intervals.
    pub rejected: usize,
    /// Of the others: gain, delay, natural frequency, damping, lag.
    pub held: [Tally; 5],
    /// Half width of the intervals of the gain, in the mean of those that there are \[% of it\].
    half_gain_percent: f64,
}

/// Gain, delay \[s\], natural frequency \[rad/s\], damping and lag \[s\] of a servo, as a model names them.
pub type Exact = [Option<f64>; 5];

impl Tally {
    fn count(&mut self, interval: Interval, exact: f64) {
        if interval.lower.and(interval.upper).is_some() {
            self.of += 1;
            self.held += usize::from(interval.contains(exact));
        }
    }
}

/// Such as `148 of 150`; empty where there is none.
impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.of {
            0 => Ok(()),
            of => write!(f, "{} of {of}", self.held),
        }
    }
}

impl OfLowOrder {
    /// Of models, held against what `exact` says of the servo in the names of each.
    pub fn of<'a>(
        models: impl Iterator<Item = &'a FlightModel>,
        exact: impl Fn(&FlightModel) -> Exact,
    ) -> Self {
        let mut found = Self::default();
        for model in models {
            found.add(model, exact(model));
        }
        found
    }

    fn add(&mut self, model: &FlightModel, exact: Exact) {
        self.fitted += 1;
        if model.approximation {
            self.rejected += 1;
            return;
        }
        let intervals = [
            Some(model.gain),
            Some(model.delay_s),
            model.omega_rad_s,
            model.damping,
            model.lag_s,
        ];
        for (tally, (interval, exact)) in self.held.iter_mut().zip(intervals.iter().zip(exact)) {
            if let (Some(interval), Some(exact)) = (interval, exact) {
                tally.count(*interval, exact);
            }
        }
        if let (Some(lower), Some(upper)) = (model.gain.lower, model.gain.upper) {
            self.half_gain_percent += 50.0 * (upper - lower) / model.transfer.gain.abs();
        }
    }

    fn with(mut self, other: &Self) -> Self {
        self.fitted += other.fitted;
        self.rejected += other.rejected;
        for (tally, further) in self.held.iter_mut().zip(other.held) {
            tally.held += further.held;
            tally.of += further.of;
        }
        self.half_gain_percent += other.half_gain_percent;
        self
    }

    /// Half width of the intervals of the gain, in the mean of those that there are \[% of it\].
    #[must_use]
    pub fn half_gain_percent(&self) -> Option<f64> {
        let of = self.held[0].of;
        (of > 0).then(|| self.half_gain_percent / of as f64)
    }
}

impl LowOrderLine {
    /// Its first column.
    #[must_use]
    pub fn label(&self) -> String {
        let input = match self.input {
            Input::Steps => "steps",
            Input::Band => "band",
        };
        let servo = match self.kind {
            Kind::FirstOrder => "first order",
            Kind::SecondOrder => "second order",
            Kind::PairAndLag => "pair and a lag",
            Kind::PairAndSlowerLag => "pair and a slower lag",
            Kind::RealPoles => "three real poles",
            Kind::SlowEnd => "second order, .3 to .6 % in .15 s",
            Kind::TwoTimeScales => "second order, 3 to 30 % in a slower lag",
        };
        format!("{input}, {servo}")
    }

    /// The recordings of `runs` seeds from `first` on.
    #[must_use]
    pub fn measure(&self, runs: usize, first: u64) -> OfLowOrder {
        let all = (first..first + runs as u64).into_par_iter();
        let one = |seed| self.of_seed(seed).unwrap_or_default();
        let both = |one: OfLowOrder, other: OfLowOrder| one.with(&other);
        all.map(one).reduce(OfLowOrder::default, both)
    }

    fn of_seed(&self, seed: u64) -> Option<OfLowOrder> {
        let mut random = random(seed);
        let (period_s, duration_s) = self.times(&mut random);
        let servo = Servo::drawn(self.kind, &mut random);
        let count = (duration_s / period_s).round() as usize;
        let input = match self.input {
            Input::Steps => levels(&mut random, count, period_s),
            Input::Band => motion(&mut random, count, period_s),
        };
        let clean = servo.respond(&input, period_s);
        let output = with_noise(&mut random, clean);
        let record = Record::of_run(period_s, input, output).ok()?;
        let model = identify(&record, &Options::default()).ok()?;
        if self.input == Input::Band {
            model.band()?;
        }
        let fitted = flight_model::fit(&record, &model, &FlightModelOptions::default()).ok()?;
        let exact = |model: &FlightModel| servo.exact(model);
        Some(OfLowOrder::of(std::iter::once(&fitted), exact))
    }

    /// Time between rows, and length \[s\].
    fn times(&self, random: &mut ChaCha8Rng) -> (f64, f64) {
        match self.input {
            Input::Steps => (
                one_of(random, &[0.002, 0.004, 0.005, 0.01]),
                random.random_range(25.0..40.0),
            ),
            Input::Band => (
                one_of(random, &[0.004, 0.005, 0.01, 0.02]),
                random.random_range(30.0..60.0),
            ),
        }
    }
}

fn one_of<T: Copy>(random: &mut ChaCha8Rng, all: &[T]) -> T {
    *all.choose(random).expect("there are some")
}

impl Servo {
    fn drawn(kind: Kind, random: &mut ChaCha8Rng) -> Self {
        let gain = one_of(random, &[1.0, -1.0]) * random.random_range(0.5..2.0);
        let delay_s = random.random_range(0.003..0.025);
        let omega: f64 = random.random_range(25.0..80.0);
        let zeta = random.random_range(0.5..0.95);
        let pair = || Linear::second_order(gain, delay_s, zeta, omega);
        let complex = Some([omega, zeta]);
        let of = |fast, slow, lags_s, pair| Self {
            fast,
            slow,
            lags_s,
            pair,
        };
        match kind {
            Kind::FirstOrder => {
                let lag = random.random_range(0.02..0.08);
                let servo = Linear::first_order(gain, delay_s, lag);
                of(servo, None, vec![lag], None)
            }
            Kind::SecondOrder => of(pair(), None, Vec::new(), complex),
            Kind::PairAndLag | Kind::PairAndSlowerLag => {
                let ratios = match kind {
                    Kind::PairAndLag => 0.1..0.8,
                    _ => 1.0..3.0,
                };
                let lag = random.random_range(ratios) / omega;
                of(pair().with_lag(lag), None, vec![lag], complex)
            }
            Kind::RealPoles => {
                let long = random.random_range(0.02..0.06);
                let middle = long * random.random_range(0.2..0.9);
                let short = middle * random.random_range(0.2..0.9);
                let servo = Linear::first_order(gain, delay_s, long);
                let servo = servo.with_lag(middle).with_lag(short);
                of(servo, None, vec![long, middle, short], None)
            }
            Kind::SlowEnd => {
                let share = random.random_range(0.003..0.006);
                of(pair(), Some((0.15, share)), Vec::new(), complex)
            }
            Kind::TwoTimeScales => {
                let slow = random.random_range(4.0..12.0) / omega;
                let share = random.random_range(0.03..0.3);
                of(pair(), Some((slow, share)), Vec::new(), complex)
            }
        }
    }

    /// What `model` names: of one pole, the slowest; of two, the slower ones. Three real poles are the same servo whichever is called the lag, so of both names the one
    /// whose lag is nearer. A servo with zeros has a pair that all orders but the first name.
    fn exact(&self, model: &FlightModel) -> Exact {
        let (pair, lag) = match (self.pair, &self.lags_s[..]) {
            // The slowest of a pair and a lag is no pole of its own.
            (pair, _) if model.order == 1 && pair.is_some() => (None, None),
            (Some(pair), lags) => (Some(pair), lags.first().copied()),
            (None, &[lag]) => (None, Some(lag)),
            (None, &[long, middle, short]) => {
                let found = model.transfer.lag_s.unwrap_or(short);
                match model.order {
                    1 => (None, Some(long)),
                    3 if (found / long).ln().abs() < (found / short).ln().abs() => {
                        (Some(as_pair(middle, short)), Some(long))
                    }
                    _ => (Some(as_pair(long, middle)), Some(short)),
                }
            }
            (None, _) => (None, None),
        };
        let [omega, zeta] = pair.map_or([None; 2], |pair| pair.map(Some));
        [
            Some(self.fast.gain),
            Some(self.fast.delay_s),
            omega,
            zeta,
            lag,
        ]
    }

    fn step(&self, t: f64) -> f64 {
        let fast = self.fast.step(t);
        self.slow.map_or(fast, |(lag_s, share)| {
            let slow = Linear::first_order(self.fast.gain, self.fast.delay_s, lag_s);
            (1.0 - share) * fast + share * slow.step(t)
        })
    }

    /// Its answer to commands that are held between rows, from rest.
    fn respond(&self, input: &[f64], period_s: f64) -> Vec<f64> {
        let mut impulse = Vec::new();
        let mut before = 0.0;
        // Six seconds are forty of the longest time constants that there are.
        for k in 0..(6.0 / period_s).round() as usize {
            let now = self.step(k as f64 * period_s);
            impulse.push(now - before);
            before = now;
            let late = k as f64 * period_s > 0.1;
            if late && (now - self.fast.gain).abs() < OVER && impulse[k].abs() < OVER {
                break;
            }
        }
        let at = |k: usize| {
            let past = input[..=k].iter().rev();
            let moved = past.zip(&impulse).map(|(u, h)| (u - input[0]) * h);
            self.fast.gain * input[0] + moved.sum::<f64>()
        };
        (0..input.len()).map(at).collect()
    }
}

/// Natural frequency and damping of two real poles.
fn as_pair(long: f64, short: f64) -> [f64; 2] {
    let omega = (long * short).sqrt().recip();
    [omega, omega * (long + short) / 2.0]
}

/// Levels that are held for .2 to .8 s: some of a staircase, or any.
fn levels(random: &mut ChaCha8Rng, count: usize, period_s: f64) -> Vec<f64> {
    let hold = (random.random_range(0.2..0.8) / period_s).round() as usize;
    let steps: f64 = one_of(random, &[2.0, 4.0, 6.0, 1e6]);
    let mut level = 0.0;
    (0..count)
        .map(|k| {
            if k % hold == 0 {
                let drawn: f64 = random.random_range(-0.5..=0.5);
                level = 2.0 * AMPLITUDE * (drawn * steps).round() / steps;
            }
            level
        })
        .collect()
}

/// Motion in a band, within the amplitude.
fn motion(random: &mut ChaCha8Rng, count: usize, period_s: f64) -> Vec<f64> {
    let times = (0..count).map(|k| k as f64 * period_s);
    let duration = count as f64 * period_s;
    match random.random_range(0..3) {
        0 => {
            let (from, to): (f64, f64) =
                (random.random_range(0.2..0.4), one_of(random, &[5., 12.]));
            let rate = (to / from).ln() / duration;
            let cycles = |t: f64| from / rate * ((rate * t).exp() - 1.0);
            times.map(|t| AMPLITUDE * (TAU * cycles(t)).sin()).collect()
        }
        1 => {
            let base = one_of(random, &[0.2, 0.25]);
            let mut line = |k: u32| (TAU * base * f64::from(k), random.random_range(0.0..TAU));
            let lines: Vec<(f64, f64)> = (1..=60).map(&mut line).collect();
            let at = |t: f64| lines.iter().map(|(w, p)| (w * t + p).cos()).sum::<f64>();
            scaled(times.map(at).collect())
        }
        _ => {
            let keeps = (-period_s / random.random_range(0.02..0.05)).exp();
            let (mut once, mut twice) = (0.0, 0.0);
            let next = |_| {
                once = keeps * once + (1.0 - keeps) * normal(random);
                twice = keeps * twice + (1.0 - keeps) * once;
                twice
            };
            scaled((0..count).map(next).collect())
        }
    }
}

fn scaled(values: Vec<f64>) -> Vec<f64> {
    let largest = values.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    values.iter().map(|x| AMPLITUDE * x / largest).collect()
}

/// White noise, or such as keeps .9 of its last value; .02 to .2 degrees.
fn with_noise(random: &mut ChaCha8Rng, clean: Vec<f64>) -> Vec<f64> {
    let keeps: f64 = one_of(random, &[0.0, 0.9]);
    let spread = one_of(random, &[0.02, 0.05, 0.1, 0.2]);
    let drive = spread * (1.0 - keeps * keeps).sqrt();
    let mut noise = spread * normal(random);
    let next = |y: f64| {
        let output = y + noise;
        noise = keeps * noise + drive * normal(random);
        output
    };
    clean.into_iter().map(next).collect()
}

/// The lines of the documentation.
#[must_use]
pub fn low_order_lines() -> Vec<LowOrderLine> {
    let kinds = [
        Kind::FirstOrder,
        Kind::SecondOrder,
        Kind::PairAndLag,
        Kind::PairAndSlowerLag,
        Kind::RealPoles,
        Kind::SlowEnd,
        Kind::TwoTimeScales,
    ];
    let of = |input: Input| kinds.map(|kind| LowOrderLine { kind, input });
    [Input::Steps, Input::Band].map(of).concat()
}
