//! A recording without board, rig and wire, which is fast enough for Monte-Carlo.

use crate::apparatus::{Apparatus, SimulatedFrame};
use crate::options::{OptionsError, SimulationOptions};
use servoid_protocol::{PulseTrain, PulseWidth};

/// Commands the servo with one pulse per frame of the usual train, and yields the measured frames.
///
/// The servo starts at rest at 0 degrees, without a pulse before the first one. The samples are
/// those that a rig on the same options would send, frame for frame.
///
/// ```
/// use servoid_protocol::PulseWidth;
/// use servoid_simulator::{SimulationOptions, simulate};
/// let options: SimulationOptions = "linear?noise=none".parse()?;
/// let pulses = [1550; 50].map(|us| Some(PulseWidth(us)));
/// let last = simulate(&options, pulses)?.last().unwrap();
/// assert!((last.angles[9] - 5.0).abs() < 1e-9);
/// assert!((last.degrees()[9] - 5.0).abs() < 0.0366 / 2.0); // half a step of the ADC
/// # Ok::<(), servoid_simulator::OptionsError>(())
/// ```
pub fn simulate(
    options: &SimulationOptions,
    pulses: impl IntoIterator<Item = Option<PulseWidth>>,
) -> Result<impl Iterator<Item = SimulatedFrame>, OptionsError> {
    simulate_train(options, PulseTrain::USUAL, pulses)
}

/// [`simulate`] with another train: each frame has its number of equal pulses.
pub fn simulate_train(
    options: &SimulationOptions,
    train: PulseTrain,
    pulses: impl IntoIterator<Item = Option<PulseWidth>>,
) -> Result<impl Iterator<Item = SimulatedFrame>, OptionsError> {
    let mut apparatus = Apparatus::new(options)?;
    Ok(pulses
        .into_iter()
        .map(move |pulse| apparatus.frame_of(train, pulse)))
}
