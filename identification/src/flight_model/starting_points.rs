//! Starting points of the search for a flight model.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4};

use super::low_order::{LowOrder, Oscillator};
use crate::results::{FrequencyResponse, Model};

/// Metrics of the response from which starting points follow.
pub(super) struct Guess {
    gain: f64,
    t50_s: f64,
    rise_s: f64,
}

impl Guess {
    pub(super) fn new(model: &Model) -> Option<Self> {
        let metrics = &model.metrics;
        Some(Self {
            gain: metrics.dc_gain.value?,
            t50_s: metrics.t50_s.value?,
            rise_s: metrics.rise_time_s.value?.max(model.sample_period_s / 2.0),
        })
    }

    /// From the frequency response in a band, whose lowest frequency has nearly the gain: the frequency of an eighth of a turn, which is a fourth of a turn for each
    /// time to half way, and the bandwidth. The gain has the sign with which that frequency is less than a quarter of a turn late; `None` where it would be early instead,
    /// as it is later than that.
    pub(super) fn in_band(model: &Model) -> Option<Self> {
        let found = model.frequency.clone().freed_of_hold(model.timing());
        let lowest = *found.re.first()?;
        let gain = lowest.signum() * lowest.hypot(*found.im.first()?);
        let turned = |k: usize| (found.im[k] / gain).atan2(found.re[k] / gain);
        let late = (0..found.re.len()).find(|&k| turned(k).abs() >= FRAC_PI_4);
        let late = found.omega_rad_s[late.unwrap_or(found.re.len() - 1)];
        (turned(0) < FRAC_PI_4).then(|| Self {
            gain,
            t50_s: FRAC_PI_4 / late,
            // Of a lag, ln 9 time constants.
            rise_s: 9f64.ln() / bandwidth(&found, gain),
        })
    }

    /// Where the search for an `order` begins, after the fits of `first` and `second` order.
    pub(super) fn starts(
        &self,
        order: usize,
        first: Option<LowOrder>,
        second: Option<LowOrder>,
    ) -> Vec<LowOrder> {
        let plain = LowOrder {
            gain: self.gain,
            delay_s: 0.0,
            oscillator: None,
            lag_s: None,
        };
        match order {
            1 => {
                // 10 to 90 % takes ln 9 time constants, half takes ln 2.
                let lag = self.rise_s / 9f64.ln();
                vec![LowOrder {
                    delay_s: (self.t50_s - lag * 2f64.ln()).max(0.0),
                    lag_s: Some(lag),
                    ..plain
                }]
            }
            2 => [0.4, 0.7, 0.95, 1.5]
                .iter()
                .map(|&damping| {
                    let oscillator = |omega_rad_s| {
                        Some(Oscillator {
                            omega_rad_s,
                            damping,
                        })
                    };
                    // Rise and half time of this shape at ω = 1 set ω and the delay.
                    let unit = LowOrder {
                        gain: 1.0,
                        oscillator: oscillator(1.0),
                        ..plain
                    };
                    let reach = |level: f64| {
                        (1..4000)
                            .map(|k| 0.005 * f64::from(k))
                            .find(|&t| unit.step(t) >= level)
                            .unwrap_or(20.0)
                    };
                    let omega = (reach(0.9) - reach(0.1)) / self.rise_s;
                    LowOrder {
                        delay_s: (self.t50_s - reach(0.5) / omega).max(0.0),
                        oscillator: oscillator(omega),
                        ..plain
                    }
                })
                .collect(),
            _ => {
                let beside_fast_lag = second.into_iter().flat_map(|start| {
                    let omega = start
                        .oscillator
                        .map_or(1.0 / self.rise_s, |o| o.omega_rad_s);
                    [0.2, 0.7].map(|share| LowOrder {
                        // A lag delays by its time constant.
                        delay_s: (start.delay_s - share / omega).max(0.0),
                        lag_s: Some(share / omega),
                        ..start
                    })
                });
                let beside_slow_lag = first.into_iter().flat_map(beside_slow_lag);
                beside_fast_lag.chain(beside_slow_lag).collect()
            }
        }
    }
}

/// Pairs of poles that are quicker than the lag of a servo of `first` order, and take its delay for a part of their own.
fn beside_slow_lag(first: LowOrder) -> Vec<LowOrder> {
    let lag = first.lag_s.unwrap_or_default();
    let pairs = [(2.0, 0.7), (2.0, 1.1), (6.0, 0.7)];
    pairs
        .into_iter()
        .map(|(faster, damping)| {
            let omega_rad_s = faster / lag;
            LowOrder {
                delay_s: (first.delay_s - damping / omega_rad_s).max(0.0),
                oscillator: Some(Oscillator {
                    omega_rad_s,
                    damping,
                }),
                ..first
            }
        })
        .collect()
}

/// Where the magnitude has fallen by 3 dB, or the end of the band \[rad/s\].
fn bandwidth(found: &FrequencyResponse, gain: f64) -> f64 {
    let parts = found.re.iter().zip(&found.im);
    let fallen = parts
        .zip(&found.omega_rad_s)
        .find(|((re, im), _)| re.hypot(**im) < FRAC_1_SQRT_2 * gain.abs());
    let end = found.omega_rad_s.last();
    fallen
        .map(|(_, omega)| omega)
        .or(end)
        .copied()
        .unwrap_or(1.0)
}
