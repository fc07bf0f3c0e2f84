//! Servos with exactly known answers, and recordings of real ones: whether estimates, bounds, verdicts and
//! findings hold for them.

mod changing_servos;
mod clocks;
mod closed_loop;
mod coarse_sampling;
mod coarse_sensor;
mod comparison;
mod coverage;
mod different_motions;
mod drift;
mod flight_model;
mod hard_lines;
mod in_band;
mod limits;
mod linearity;
mod metrics;
mod noisy_commands;
mod poor_records;
mod prior;
mod real_data;
mod repeated_references;
mod rests;
mod rounded_commands;
mod run_gains;
mod runs_at_levels;
mod scattering_holds;
mod servo_model;
mod several_runs;
mod smooth;
mod starts;
mod streaming;
