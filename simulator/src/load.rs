//! The aerodynamic load of a control surface on an aircraft with a turning propeller.

/// A load that grows with deflection, damps, and shakes with the propeller.
///
/// ```text
///  p     = p0 + g θ[deg]                                    surface angle (deg)
///  τload = cd ω + c1 p + c2 max(p - ps, 0)² + a1 sin φ + a4 sin 4φ,   φ = Ω t + φ0
/// ```
///
/// Positive torque turns towards negative angles. The quadratic part, beyond `ps`, makes the load
/// one-sided: the servo answers up and down strokes differently.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AerodynamicLoad {
    /// Surface angle at servo angle 0, p0 (deg).
    pub surface_offset: f64,
    /// Surface degrees per servo degree, g.
    pub surface_gain: f64,
    /// Stiffness c1 (N m/deg).
    pub stiffness: f64,
    /// Stiffening c2 beyond the stall angle (N m/deg²).
    pub stiffening: f64,
    /// Surface angle ps from which the load stiffens (deg).
    pub stiffening_from: f64,
    /// Damping cd (N m s/rad).
    pub damping: f64,
    /// Amplitude a1 of the torque once per revolution (N m).
    pub once_per_revolution: f64,
    /// Amplitude a4 of the torque four times per revolution (N m).
    pub four_per_revolution: f64,
    /// Speed Ω of the propeller (rad/s).
    pub rotor_speed: f64,
    /// Angle φ0 of the propeller at time 0 (rad).
    pub rotor_phase: f64,
}

impl AerodynamicLoad {
    /// τload (N m) at time `t` (s), servo angle `angle` (rad) and speed `speed` (rad/s).
    pub fn torque(&self, t: f64, angle: f64, speed: f64) -> f64 {
        let p = self.surface_offset + self.surface_gain * angle.to_degrees();
        let beyond = (p - self.stiffening_from).max(0.0);
        let rotor = self.rotor_speed * t + self.rotor_phase;
        self.damping * speed
            + self.stiffness * p
            + self.stiffening * beyond * beyond
            + self.once_per_revolution * rotor.sin()
            + self.four_per_revolution * (4.0 * rotor).sin()
    }
}

#[cfg(test)]
mod tests {
    use crate::aircraft::LOAD;

    /// By hand at θ = 0, ω = 1 rad/s, rotor at 0: cd + c1 6 + c2 (6 - 4.04)².
    #[test]
    fn torque_by_hand() {
        let expected = 0.10 + 0.016_74 * 6.0 + 0.033_21 * 1.96 * 1.96;
        assert!((LOAD.torque(0.0, 0.0, 1.0) - expected).abs() < 1e-12);
    }

    /// A quarter turn of the propeller: sin φ = 1, sin 4φ = 0.
    #[test]
    fn the_propeller_shakes_once_per_revolution() {
        let quarter = 60.0 / 1400.0 / 4.0;
        let shake = LOAD.torque(quarter, 0.0, 0.0) - LOAD.torque(0.0, 0.0, 0.0);
        assert!((shake - LOAD.once_per_revolution).abs() < 1e-12);
    }
}
