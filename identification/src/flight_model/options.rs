//! Options of the fit.

/// Options of the fit of a flight model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlightModelOptions {
    /// Largest difference of the step response from the identified one that an approximation may have \[% of the step\].
    pub largest_error_percent: f64,
    /// Period at which the command is held, for the statement in the result \[s\].
    pub frame_period_s: Option<f64>,
}

impl Default for FlightModelOptions {
    fn default() -> Self {
        Self {
            largest_error_percent: 3.0,
            frame_period_s: None,
        }
    }
}
