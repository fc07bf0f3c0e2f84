//! From samples to the servo's own time.
//!
//! Sample m of a step response answers an edge of the input at sample 0, but it may be taken a known
//! phase φ after that edge: it is the servo at mTs + φ. The input is held between samples, so
//! h_i = g_i - g_{i-1} is the weight of the servo's impulse response between (i-1)Ts + φ and iTs + φ,
//! centred half a period before its sample. For a servo that is slow against the sampling its
//! frequency response is therefore
//!
//! ```text
//! G_servo(jω) = G(e^{jωTs}) e^{jω(Ts/2 - φ)} / sinc(ωTs/2)
//! ```
//!
//! up to aliases, which are of the order of |G_servo| beyond half the rate of sampling; the bounds of the servo's
//! response and of the figures that are read from it allow for them.

/// When samples are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Ts: time between samples \[s\].
    pub sample_period_s: f64,
    /// φ: time from an edge of the input to the first sample that counts as after it \[s\].
    pub sample_phase_s: f64,
}

impl Timing {
    /// The time after the edge of a sample, which may lie between samples \[s\].
    ///
    /// ```
    /// use servoid_identification::timing::Timing;
    /// let timing = Timing { sample_period_s: 0.002, sample_phase_s: 0.0005 };
    /// assert!((timing.seconds(10.0) - 0.0205).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn seconds(&self, samples: f64) -> f64 {
        samples * self.sample_period_s + self.sample_phase_s
    }

    /// What to add to the phase of G(e^{jωTs}) to have that of the servo \[rad\], at ω \[rad/s\].
    #[must_use]
    pub fn phase_lead(&self, omega: f64) -> f64 {
        omega * (self.sample_period_s / 2.0 - self.sample_phase_s)
    }

    /// What to multiply |G(e^{jωTs})| by to have that of the servo, at ω \[rad/s\].
    #[must_use]
    pub fn magnitude_factor(&self, omega: f64) -> f64 {
        let half = omega * self.sample_period_s / 2.0;
        if half == 0.0 { 1.0 } else { half / half.sin() }
    }
}
