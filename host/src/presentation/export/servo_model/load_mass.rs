//! The weight of a load as a mass in MuJoCo.

use crate::presentation::export::text::number;
use servoid_identification::servo_model::Load;
use std::f64::consts::PI;

/// Gravity \[m/s²\].
pub(super) const GRAVITY: f64 = 9.81;

/// Length of the arm of a weight \[m\]: so short that the weight has a thousandth of the inertia or so.
const ARM_M: f64 = 0.001;

/// Mass of a joint without a weight \[kg\].
const NO_MASS: f64 = 1e-9;

/// How the joint turns with theta.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turn {
    /// Its angle at theta = 0 \[rad\].
    pub at_zero: f64,
    /// Its angle for each unit of theta \[rad\], negative where it turns against theta.
    pub each: f64,
}

impl Turn {
    /// The joint's angle.
    pub fn at(self, theta: f64) -> f64 {
        self.at_zero + self.each * theta
    }
}

/// A mass on an arm that turns with a joint of MuJoCo.
#[derive(Clone, Copy)]
pub(super) struct Weight {
    /// For an inertia of 1 kg m² \[kg\].
    pub mass: f64,
    /// The arm hangs where the joint's angle is minus this \[rad\].
    from: f64,
}

impl Weight {
    /// Of a load; next to none where that is no weight. The arm turns with the joint, and is where the servo model has it at the angle `middle` of
    /// theta: beyond that both differ by as much as the gain differs from one.
    pub fn of(load: &Load<f64>, turn: Turn, middle: f64) -> Self {
        let Load::Pendulum {
            gravity,
            from,
            radians,
        } = *load
        else {
            return Self {
                mass: NO_MASS,
                from: 0.0,
            };
        };
        let arm = radians * (middle + from);
        let from = turn.each.signum() * arm - turn.at(middle);
        // What pulls the other way hangs on the other side.
        let from = if gravity < 0.0 { from + PI } else { from };
        let torque = (gravity * turn.each).abs();
        Self {
            mass: (torque / (GRAVITY * ARM_M)).max(NO_MASS),
            from,
        }
    }

    /// The acceleration that it takes.
    pub fn at(self, angle: f64) -> f64 {
        self.mass * GRAVITY * ARM_M * (angle + self.from).sin()
    }

    /// Its inertia about the joint \[kg m²\].
    pub fn inertia(self) -> f64 {
        self.mass * ARM_M * ARM_M
    }

    /// Its place, with the joint's axis along y.
    pub fn place(self) -> String {
        let (sin, cos) = self.from.sin_cos();
        format!("{} 0 {}", number(-ARM_M * sin), number(-ARM_M * cos))
    }
}
