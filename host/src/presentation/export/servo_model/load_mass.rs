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

/// A mass on an arm that turns with a joint of MuJoCo.
#[derive(Clone, Copy)]
pub(super) struct Weight {
    /// For an inertia of 1 kg m² \[kg\].
    pub mass: f64,
    /// The arm hangs where the joint's angle is minus this \[rad\].
    from: f64,
    /// Radians for each unit of the command.
    radians: f64,
}

impl Weight {
    /// Of a load; next to none where that is no weight.
    pub fn of(load: &Load<f64>, radians: f64) -> Self {
        let (gravity, from) = match *load {
            // What pulls the other way hangs on the other side.
            Load::Pendulum { gravity, from, .. } if gravity < 0.0 => {
                (-gravity, from * radians + PI)
            }
            Load::Pendulum { gravity, from, .. } => (gravity, from * radians),
            Load::None | Load::Constant(_) | Load::Air { .. } => (0.0, 0.0),
        };
        Self {
            mass: (gravity * radians / (GRAVITY * ARM_M)).max(NO_MASS),
            from,
            radians,
        }
    }

    /// The acceleration that it takes.
    pub fn at(self, angle: f64) -> f64 {
        let torque = self.mass * GRAVITY * ARM_M;
        torque * (angle * self.radians + self.from).sin() / self.radians
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
