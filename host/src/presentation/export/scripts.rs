//! What the templates of scripts and headers have in common.

use super::Export;
use super::statement::parameters_of;
use super::text::{Style, identifier, number};
use crate::presentation::template::fill;
use servoid_identification::flight_model::FlightModel;

/// Values for the gaps of a template.
pub(super) type Values = Vec<(&'static str, String)>;

impl Export<'_> {
    /// The values of the identified model, in the style of a language.
    pub(super) fn values(&self, style: &Style) -> Values {
        let (model, step, frequency) = (self.model, &self.model.step, &self.model.frequency);
        let id = identifier(self.name);
        let taps = step.value.len();
        vec![
            ("about", style.comment(&self.statement(false))),
            ("ID", id.to_ascii_uppercase()),
            ("id", id),
            (
                "level",
                number(match model.bounds_hold() {
                    true => step.pointwise.level,
                    false => 0.0,
                }),
            ),
            ("period", number(model.sample_period_s)),
            ("phase", number(model.sample_phase_s)),
            ("frame", number(self.frame_s())),
            ("offset", number(model.offset)),
            ("taps", taps.to_string()),
            ("last", (taps - 1).to_string()),
            ("theta", style.list(&model.theta)),
            ("theta_covariance", style.matrix(&model.covariance)),
            ("impulse", style.list(&model.impulse_response())),
            ("step", style.list(&step.value)),
            ("sd", style.list(&step.sd)),
            ("lower", style.list(&step.pointwise.lower)),
            ("upper", style.list(&step.pointwise.upper)),
            ("lower_all", style.list(&step.simultaneous.lower)),
            ("upper_all", style.list(&step.simultaneous.upper)),
            ("omega", style.list(&frequency.omega_rad_s)),
            ("re", style.list(&frequency.re)),
            ("im", style.list(&frequency.im)),
            ("magnitude_lower", style.list(&frequency.magnitude_db_lower)),
            ("magnitude_upper", style.list(&frequency.magnitude_db_upper)),
            ("phase_lower", style.list(&frequency.phase_deg_lower)),
            ("phase_upper", style.list(&frequency.phase_deg_upper)),
        ]
    }

    /// `template` with the values of the low-order model; nothing where there is none.
    pub(super) fn low_order_part(&self, template: &str, style: &Style, more: Values) -> String {
        let Ok(flight) = &self.low_order else {
            return String::new();
        };
        let mut values = more;
        values.extend(low_order_values(flight, style));
        let largest_error = self.largest_error_percent(flight);
        values.push(("largest_error", number(largest_error)));
        let discrete = flight.transfer.discrete(self.model.timing());
        let (numerator, denominator) = discrete.transfer_function();
        let id = identifier(self.name);
        values.extend([
            ("ID", id.to_ascii_uppercase()),
            ("id", id),
            ("delay_samples", discrete.delay_samples.to_string()),
            ("a", style.matrix(&discrete.a)),
            ("b", style.short(&discrete.b)),
            ("c", style.short(&discrete.c)),
            ("d", number(discrete.d)),
            ("rest", style.short(&discrete.rest)),
            ("numerator_z", style.short(&numerator)),
            ("denominator_z", style.short(&denominator)),
        ]);
        fill(template, &values)
    }
}

fn low_order_values(flight: &FlightModel, style: &Style) -> Values {
    vec![
        ("order", flight.order.to_string()),
        ("gain", number(flight.transfer.gain)),
        ("delay", number(flight.transfer.delay_s.max(0.0))),
        ("denominator", style.short(&flight.transfer.denominator())),
        ("covariance_of", parameters_of(flight).to_owned()),
        ("covariance", style.matrix(&flight.covariance)),
        ("parameter_count", flight.covariance.len().to_string()),
    ]
}
