//! Shared by the tests, examples, benches and fuzz targets of the workspace.
//!
//! - [`plants`], [`servos`] and [`limited_drive`]: simulated servos with exactly known answers, references and noises. They
//!   know nothing of the crates under test.
//! - [`coverage`], [`figures_coverage`], [`metrics_coverage`]: how often bounds hold the exact answer. The
//!   tests run few seeds, the examples of the same names run hundreds and print the documentation's tables.
//! - [`closed_loop`]: recordings whose input a controller computes from the output.
//! - [`hard_lines`]: recordings with glitches, tails, jitter, hum and runs that differ, for [`coverage`].
//! - [`drawn_lines`]: such recordings whose numbers are drawn.
//! - [`scattering_runs`]: several runs of one servo that differ, or do not.
//! - [`changing_servos`]: several runs of servos whose dynamics change.
//! - [`drifting_servos`]: servos whose gain changes along a recording, slow ones, and others.
//! - [`noisy_commands`]: recordings whose column of the command has noise.
//! - [`low_order_coverage`]: how often the intervals of low-order models hold the numbers of drawn servos.
//! - [`smooth_inputs`]: sweeps and sums of sines, whose answer is known in a band.
//! - [`loggers`]: recordings of one servo by loggers with faults of time.
//! - [`compared_ends`]: comparisons of servos whose responses have slow ends.
//! - [`shifted_pairs`]: comparisons of recordings that differ by a shift in time alone, or otherwise.
//! - [`servo_means`]: comparisons of servos whose runs scatter.
//! - [`arguments`]: the arguments of these examples.
//! - [`tools`]: what a test does whose tool is not there.
//! - `bad_line` (feature `rig`): a port that loses, damages and delays frames by chance.
//! - `hello` (feature `rig`): the answer of a rig that has just been started.
//! - `trials` (feature `rig`): captures over bad lines, killed captures, recordings of simulated rigs and
//!   whether they are what the board sampled.
//! - `stepped` (feature `board`): a processor with something done around each of its steps.
//! - `virtual_board` (feature `board`): the flash image on the virtual board, as a port.

pub mod arguments;
#[cfg(feature = "rig")]
pub mod bad_line;
pub mod changing_servos;
pub mod closed_loop;
pub mod compared_ends;
pub mod coverage;
pub mod drawn_lines;
pub mod drifting_servos;
pub mod figures_coverage;
pub mod hard_lines;
#[cfg(feature = "rig")]
pub mod hello;
pub mod limited_drive;
pub mod loggers;
pub mod low_order_coverage;
pub mod metrics_coverage;
pub mod noisy_commands;
pub mod oracle;
pub mod plants;
pub mod scattering_holds;
pub mod scattering_runs;
pub mod servo_means;
pub mod servos;
pub mod shifted_pairs;
pub mod smooth_inputs;
#[cfg(feature = "board")]
pub mod stepped;
pub mod tools;
pub mod trial;
#[cfg(feature = "rig")]
pub mod trials;
#[cfg(feature = "board")]
pub mod virtual_board;
