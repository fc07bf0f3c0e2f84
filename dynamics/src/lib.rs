//! The servo as a machine: its [equation](ServoParameters), where it rests, and the one integrator for it.
//!
//! Everything that moves a servo on paper uses this crate: identification fits it, prediction and exports are tested against it,
//! simulated rigs run on it. It is generic over the [number](Scalar): `f64`, or [`Dual`] for exact derivatives by the
//! parameters.
//!
//! ```
//! use servoid_dynamics::{Grid, ServoParameters, Start, simulate};
//! // 30 rad/s, well damped, 10 ms late, linear.
//! let servo = ServoParameters {
//!     delay_s: 0.01,
//!     ..ServoParameters::linear(900.0, 60.0)
//! };
//! let grid = Grid::for_stiffness(0.002, 0.0, servo.stiffness);
//! let mut output = Vec::new();
//! simulate(&servo, &grid, &Start::at_rest(0.0, Some(0.0)), &[5.0; 500], |_, y| output.push(y));
//! assert!(output[5] < 1e-30); // within the delay, but for the rounding of times
//! // A second later it has settled: (1 + 30 t) e^(-30 t) of the stroke is left.
//! assert!((output[499] - 5.0).abs() < 1e-9);
//! ```

mod commands;
mod dual;
mod equation;
mod rest;
mod simulation;
mod sloped_stepper;
mod start;
mod stepper;

pub use commands::Commands;
pub use dual::{Dual, Scalar};
pub use equation::{
    AtRest, DriveLimit, Friction, Load, PARAMETERS, PulseEnd, ServoParameters, Slopes, SpeedLimit,
    Stops,
};
pub use simulation::{Grid, simulate, simulate_with_slopes};
pub use start::Start;
pub use stepper::{State, Stepper};
