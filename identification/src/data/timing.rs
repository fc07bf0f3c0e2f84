//! Sample times, and the correction from the sampled to the servo's own response.
//!
//! Sample m of a step response follows an edge of the input at sample 0. It may be taken a known phase φ
//! after that edge, and shows the servo at the time mTs + φ. The input is held between samples, so
//! h_i = g_i - g_{i-1} is the integral of the servo's impulse response from (i-1)Ts + φ to iTs + φ, centred
//! half a period before its sample. The frequency response of a servo that is slow compared with the
//! sampling rate is therefore
//!
//! ```text
//! G_servo(jω) = G(e^{jωTs}) e^{jω(Ts/2 - φ)} / sinc(ωTs/2)
//! ```
//!
//! up to aliasing, which is of the order of |G_servo| above half the sampling rate. The bounds of the servo's
//! response and of its metrics include an allowance for aliasing.

/// When samples are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Ts: time between samples \[s\].
    pub sample_period_s: f64,
    /// φ: time from an edge of the input to the first sample that counts as after it \[s\].
    pub sample_phase_s: f64,
}

impl Timing {
    /// The time of a sample after the edge \[s\]. The sample number may be fractional.
    ///
    /// ```
    /// use servoid_identification::Timing;
    /// let timing = Timing { sample_period_s: 0.002, sample_phase_s: 0.0005 };
    /// assert!((timing.seconds(10.0) - 0.0205).abs() < 1e-12);
    /// ```
    pub fn seconds(&self, samples: f64) -> f64 {
        samples * self.sample_period_s + self.sample_phase_s
    }

    /// Phase of the servo less that of G(e^{jωTs}) \[rad\], at ω \[rad/s\].
    pub fn phase_lead(&self, omega: f64) -> f64 {
        omega * (self.sample_period_s / 2.0 - self.sample_phase_s)
    }

    /// |G_servo| over |G(e^{jωTs})|, at ω \[rad/s\].
    pub fn magnitude_factor(&self, omega: f64) -> f64 {
        let half = omega * self.sample_period_s / 2.0;
        if half == 0.0 { 1.0 } else { half / half.sin() }
    }
}
