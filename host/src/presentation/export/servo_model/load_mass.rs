//! The weight of a load as a mass in MuJoCo.

use crate::presentation::export::text::number;
use servoid_identification::servo_model::Load;

/// Gravity \[m/s²\].
pub(super) const GRAVITY: f64 = 9.81;

/// Length of the arm of a weight \[m\]: so short that the weight has a thousandth of the inertia or so.
const ARM_M: f64 = 0.001;

/// Mass of a joint without a weight \[kg\].
const NO_MASS: f64 = 1e-9;

/// Places to each side of the middle at which a weight is compared.
const PLACES: i32 = 50;

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
    /// Of a load; next to none where that is no weight. The arm turns with the joint, and that of the servo model with theta, in other degrees where
    /// the gain is not one: the mass and its place are those that come closest over the commands `middle` +- `most`.
    pub fn of(load: &Load<f64>, turn: Turn, (middle, most): (f64, f64)) -> Self {
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
        let places = (-PLACES..=PLACES).map(|place| most * f64::from(place) / f64::from(PLACES));
        // Beside the middle a sine and a cosine, which are orthogonal over such places.
        let [mut sine, mut cosine] = [(0.0, 0.0); 2];
        for beside in places {
            let torque = turn.each * gravity * (radians * (middle + beside + from)).sin();
            let (sin, cos) = (turn.each * beside).sin_cos();
            sine = (sine.0 + torque * sin, sine.1 + sin * sin);
            cosine = (cosine.0 + torque * cos, cosine.1 + cos * cos);
        }
        let [sine, cosine] = [sine, cosine].map(|(product, square)| product / square);
        Self {
            mass: (sine.hypot(cosine) / (GRAVITY * ARM_M)).max(NO_MASS),
            from: cosine.atan2(sine) - turn.at(middle),
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
