//! Values that the templates of scripts and headers share.

use super::described_model::Export;
use super::statement::parameters_of;
use super::text::{Style, identifier, number};
use crate::presentation::template::fill;
use servoid_identification::flight_model::FlightModel;
use servoid_identification::results::{FrequencyBounds, ParameterBounds, StepBounds};

/// Values for the gaps of a template.
pub(super) type Values = Vec<(&'static str, String)>;

/// A language: how it is written, and its templates.
pub(super) struct Language {
    pub(super) style: Style,
    /// The file.
    pub(super) file: &'static str,
    /// The low-order model in it.
    pub(super) low_order: &'static str,
    /// Sections that are there where bounds hold, and only there.
    pub(super) bounds_of_parameters: &'static str,
    pub(super) bounds_of_step: &'static str,
    pub(super) bounds_of_frequency: &'static str,
    pub(super) bounds_of_low_order: &'static str,
}

impl Export<'_> {
    /// The file in a language; `more` are values that only this language has, `of_low_order` those of its
    /// low-order model.
    pub(super) fn in_language(
        &self,
        language: &Language,
        more: Values,
        of_low_order: Values,
    ) -> String {
        let mut values = self.values(&language.style);
        values.extend(more);
        values.push(("low_order", self.low_order_part(language, of_low_order)));
        values.extend(self.sections_of_bounds(language));
        fill(language.file, &values)
    }

    fn names(&self) -> [(&'static str, String); 2] {
        let id = identifier(self.name);
        [("ID", id.to_ascii_uppercase()), ("id", id)]
    }

    /// The values of the identified model, in the style of a language.
    fn values(&self, style: &Style) -> Values {
        let (model, step, frequency) = (self.model, &self.model.step, &self.model.frequency);
        let taps = step.value.len();
        let mut values = vec![
            ("about", style.comment(&self.statement(false))),
            ("period", number(model.sample_period_s)),
            ("phase", number(model.sample_phase_s)),
            ("frame", number(self.frame_s())),
            ("offset", number(model.offset)),
            ("taps", taps.to_string()),
            ("last", (taps - 1).to_string()),
            ("theta", style.list(&model.theta)),
            ("impulse", style.list(&model.impulse_response())),
            ("step", style.list(&step.value)),
            ("omega", style.list(&frequency.omega_rad_s)),
            ("re", style.list(&frequency.re)),
            ("im", style.list(&frequency.im)),
        ];
        values.extend(self.names());
        values
    }

    /// The sections with bounds.
    fn sections_of_bounds(&self, language: &Language) -> Values {
        let Language { style, .. } = language;
        let section = |template: &str, mut values: Values| {
            values.extend(self.names());
            fill(template, &values)
        };
        let parameters = |bounds: &ParameterBounds| {
            let count = bounds.covariance.len();
            let values = vec![
                ("level", number(bounds.level)),
                ("theta_covariance", style.matrix(&bounds.covariance)),
                (
                    "theta_bytes",
                    (size_of::<f64>() * count * (count + 1)).to_string(),
                ),
            ];
            section(language.bounds_of_parameters, values)
        };
        let step = |bounds: &StepBounds| {
            let (each, whole) = (&bounds.pointwise, &bounds.simultaneous);
            let values = vec![
                ("level", number(bounds.level)),
                ("sd", style.list(&bounds.sd)),
                ("lower", style.list(&each.lower)),
                ("upper", style.list(&each.upper)),
                ("lower_all", style.list(&whole.lower)),
                ("upper_all", style.list(&whole.upper)),
            ];
            section(language.bounds_of_step, values)
        };
        let frequency = |bounds: &FrequencyBounds| {
            let values = vec![
                ("magnitude_lower", style.list(&bounds.magnitude_db_lower)),
                ("magnitude_upper", style.list(&bounds.magnitude_db_upper)),
                ("phase_lower", style.list(&bounds.phase_deg_lower)),
                ("phase_upper", style.list(&bounds.phase_deg_upper)),
            ];
            section(language.bounds_of_frequency, values)
        };
        let model = self.model;
        [
            ("bounds_of_parameters", model.bounds.valid().map(parameters)),
            ("bounds_of_step", model.step.bounds.valid().map(step)),
            (
                "bounds_of_frequency",
                model.frequency.bounds.valid().map(frequency),
            ),
        ]
        .map(|(name, section)| (name, section.unwrap_or_default()))
        .into()
    }

    /// The low-order model; nothing where there is none.
    fn low_order_part(&self, language: &Language, more: Values) -> String {
        let Ok(flight) = &self.low_order else {
            return String::new();
        };
        let style = &language.style;
        let discrete = flight.transfer.discrete(self.model.timing());
        let (numerator, denominator) = discrete.transfer_function();
        let mut values = more;
        values.extend([
            ("order", flight.order.to_string()),
            ("gain", number(flight.transfer.gain)),
            ("delay", number(flight.transfer.delay_s.max(0.0))),
            ("denominator", style.short(&flight.transfer.denominator())),
            ("largest_error", number(self.largest_error_percent(flight))),
            ("delay_samples", discrete.delay_samples.to_string()),
            ("a", style.matrix(&discrete.a)),
            ("b", style.short(&discrete.b)),
            ("c", style.short(&discrete.c)),
            ("d", number(discrete.d)),
            ("rest", style.short(&discrete.rest)),
            ("numerator_z", style.short(&numerator)),
            ("denominator_z", style.short(&denominator)),
            (
                "bounds_of_low_order",
                self.bounds_of_low_order(flight, language),
            ),
        ]);
        values.extend(self.names());
        fill(language.low_order, &values)
    }

    fn bounds_of_low_order(&self, flight: &FlightModel, language: &Language) -> String {
        let section = |bounds: &ParameterBounds| {
            let mut values = vec![
                ("covariance_of", parameters_of(flight).to_owned()),
                ("covariance", language.style.matrix(&bounds.covariance)),
                ("parameter_count", bounds.covariance.len().to_string()),
            ];
            values.extend(self.names());
            fill(language.bounds_of_low_order, &values)
        };
        flight.bounds.valid().map(section).unwrap_or_default()
    }
}
