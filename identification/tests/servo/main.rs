//! Servos with exactly known answers, and whether the figures, verdicts and findings hold for them.

mod comparison;
mod direction;
mod figures_coverage;
mod flight_model;
mod limits;
mod linearity;
mod metrics;
mod metrics_coverage;
mod plants;
mod poor_records;
mod smooth;
