//! Scripts and headers: the languages, and the values that their templates share.

use super::model::Export;
use super::statement::{InFile, of_error, parameters_of};
use super::text::{
    C_STYLE, MATLAB_STYLE, PYTHON_STYLE, SCRIPT_STYLE, Style, identifier, number, plain, quoted,
    wrapped,
};
use crate::presentation::template::fill;
use servoid_identification::flight_model::FlightModel;
use servoid_identification::results::{FrequencyBounds, ParameterBounds, StepBounds};

/// Values for the gaps of a template.
type Values = Vec<(&'static str, String)>;

/// A language: its style, and its templates.
struct Language {
    style: Style,
    /// The file.
    file: &'static str,
    /// The low-order model in it.
    low_order: &'static str,
    /// Sections that are written only where bounds hold.
    bounds_of_parameters: &'static str,
    bounds_of_step: &'static str,
    bounds_of_frequency: &'static str,
    bounds_of_low_order: &'static str,
}

/// The language whose templates have this ending.
macro_rules! language {
    ($style:expr, $ending:literal) => {
        Language {
            style: $style,
            file: include_str!(concat!("templates/servo.", $ending)),
            low_order: include_str!(concat!("templates/low_order.", $ending)),
            bounds_of_parameters: include_str!(concat!("templates/bounds_of_parameters.", $ending)),
            bounds_of_step: include_str!(concat!("templates/bounds_of_step.", $ending)),
            bounds_of_frequency: include_str!(concat!("templates/bounds_of_frequency.", $ending)),
            bounds_of_low_order: include_str!(concat!("templates/bounds_of_low_order.", $ending)),
        }
    };
}

/// A C99 header.
pub(super) fn c(export: &Export<'_>) -> String {
    let holds = u8::from(export.model.bounds.valid().is_some());
    let values = vec![
        // A question mark could begin a trigraph.
        ("name", quoted(export.name, &['"', '?'])),
        ("bounds_hold", holds.to_string()),
        ("theta_count", export.model.theta.len().to_string()),
        ("of_response", export.about_response("\n * ")),
    ];
    let parameters = vec![("parameters", c_parameters(export))];
    export.in_language(&language!(C_STYLE, "h"), values, parameters)
}

/// The parameters that not every order has.
fn c_parameters(export: &Export<'_>) -> String {
    let Ok(flight) = &export.low_order else {
        return String::new();
    };
    let oscillator = flight.transfer.oscillator;
    let parameters = [
        ("OMEGA_RAD_S", oscillator.map(|o| o.omega_rad_s)),
        ("DAMPING", oscillator.map(|o| o.damping)),
        ("LAG_S", flight.transfer.lag_s),
    ];
    let id = identifier(export.name).to_ascii_uppercase();
    let known = parameters
        .into_iter()
        .filter_map(|(name, value)| Some((name, value?)));
    known
        .map(|(name, value)| format!("#define {id}_{name} {}\n", number(value)))
        .collect()
}

/// A Julia module.
pub(super) fn julia(export: &Export<'_>) -> String {
    let holds = export.model.bounds.valid().is_some();
    let values = vec![
        // A dollar would put the value of an expression in.
        ("name", quoted(export.name, &['"', '$'])),
        ("bounds_hold", holds.to_string()),
        ("of_response", export.about_response("\n")),
    ];
    // Short vectors are literals, and have commas.
    let literals = export.low_order.as_ref().map(|flight| {
        let discrete = flight.transfer.discrete(export.model.timing());
        vec![
            (
                "denominator",
                SCRIPT_STYLE.short(&flight.transfer.denominator()),
            ),
            ("b", SCRIPT_STYLE.short(&discrete.b)),
            ("c", SCRIPT_STYLE.short(&discrete.c)),
            ("rest", SCRIPT_STYLE.short(&discrete.rest)),
        ]
    });
    let style = Style {
        between: " ",
        ..SCRIPT_STYLE
    };
    export.in_language(
        &language!(style, "jl"),
        values,
        literals.unwrap_or_default(),
    )
}

/// A MATLAB script, which Octave runs too.
pub(super) fn matlab(export: &Export<'_>) -> String {
    let holds = export.model.bounds.valid().is_some();
    let warning = match holds {
        true => "",
        false => {
            "warning('servoid:bounds', 'No bounds can be given for this model: see the comments.');\n"
        }
    };
    let values = vec![
        ("name", plain(export.name).replace('\'', "''")),
        ("bounds_hold", holds.to_string()),
        ("warning", warning.to_owned()),
        ("of_response", export.about_response("\n% ")),
    ];
    export.in_language(&language!(MATLAB_STYLE, "m"), values, Vec::new())
}

/// A Python module.
pub(super) fn python(export: &Export<'_>) -> String {
    let style = Style {
        row: ("[", "],"),
        ..PYTHON_STYLE
    };
    let holds = export.model.bounds.valid().map_or("False", |_| "True");
    let values = vec![
        ("name", quoted(export.name, &['"'])),
        ("bounds_hold", holds.to_owned()),
        ("of_response", export.about_response("\n    ")),
    ];
    export.in_language(&language!(style, "py"), values, Vec::new())
}

impl Export<'_> {
    /// The file in a language; `more` are values that only this language has, `of_low_order` those of its
    /// low-order model.
    fn in_language(&self, language: &Language, more: Values, of_low_order: Values) -> String {
        let mut values = self.values(&language.style);
        values.extend(more);
        values.push(("low_order", self.low_order_part(language, of_low_order)));
        values.extend(self.sections_of_bounds(language));
        fill(language.file, &values)
    }

    /// What a reader must know of the response where it is called, on lines that begin with `line`; empty where there is nothing.
    fn about_response(&self, line: &str) -> String {
        let said = self.of_response();
        wrapped(said.split_whitespace(), " ", "", "")
            .iter()
            .filter(|text| !text.is_empty())
            .map(|text| format!("{line}{text}"))
            .collect()
    }

    /// A template with these values and the names.
    fn section(&self, template: &str, mut values: Values) -> String {
        let id = identifier(self.name);
        values.extend([("ID", id.to_ascii_uppercase()), ("id", id)]);
        fill(template, &values)
    }

    /// The values of the identified model, in the style of a language.
    fn values(&self, style: &Style) -> Values {
        let (model, step, frequency) = (self.model, &self.model.step, &self.model.frequency);
        let (taps, id) = (step.value.len(), identifier(self.name));
        let of_servo = self.servo_frequency();
        vec![
            ("about", style.comment(&self.statement(InFile::default()))),
            ("ID", id.to_ascii_uppercase()),
            ("id", id),
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
            ("servo_phase", style.list(&of_servo.phase_deg)),
        ]
    }

    /// The sections with bounds.
    fn sections_of_bounds(&self, language: &Language) -> Values {
        let style = &language.style;
        let parameters = |bounds: &ParameterBounds| {
            let count = bounds.covariance.len();
            let bytes = size_of::<f64>() * count * (count + 1);
            let values = vec![
                ("level", number(bounds.level)),
                ("theta_covariance", style.matrix(&bounds.covariance)),
                ("theta_bytes", bytes.to_string()),
            ];
            self.section(language.bounds_of_parameters, values)
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
            self.section(language.bounds_of_step, values)
        };
        let of_servo = self.servo_frequency();
        let of_servo = of_servo.bounds.valid();
        let frequency = |(bounds, of_servo): (&FrequencyBounds, &FrequencyBounds)| {
            let values = vec![
                ("magnitude_lower", style.list(&bounds.magnitude_db_lower)),
                ("magnitude_upper", style.list(&bounds.magnitude_db_upper)),
                ("phase_lower", style.list(&bounds.phase_deg_lower)),
                ("phase_upper", style.list(&bounds.phase_deg_upper)),
                ("servo_phase_lower", style.list(&of_servo.phase_deg_lower)),
                ("servo_phase_upper", style.list(&of_servo.phase_deg_upper)),
            ];
            self.section(language.bounds_of_frequency, values)
        };
        let model = self.model;
        let of_parameters = model.bounds.valid().map(parameters);
        let of_step = model.step.bounds.valid().map(step);
        let of_frequency = (model.frequency.bounds.valid().zip(of_servo)).map(frequency);
        vec![
            ("bounds_of_parameters", of_parameters.unwrap_or_default()),
            ("bounds_of_step", of_step.unwrap_or_default()),
            ("bounds_of_frequency", of_frequency.unwrap_or_default()),
        ]
    }

    /// The low-order model; empty where there is none. `values` come before the common ones.
    fn low_order_part(&self, language: &Language, mut values: Values) -> String {
        let Ok(flight) = &self.low_order else {
            return String::new();
        };
        let (style, transfer) = (&language.style, &flight.transfer);
        let discrete = transfer.discrete(self.model.timing());
        let at_rest = self.rest_at_neutral();
        let (numerator, denominator) = discrete.transfer_function();
        values.extend([
            ("order", flight.order.to_string()),
            ("gain", number(transfer.gain)),
            ("offset_at", number(at_rest.command)),
            (
                "low_order_offset",
                number(at_rest.position - transfer.gain * at_rest.command),
            ),
            ("delay", number(transfer.delay_s.max(0.0))),
            ("denominator", style.short(&transfer.denominator())),
            ("largest_error", number(self.largest_error_percent(flight))),
            ("of_error", of_error(flight)),
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
        self.section(language.low_order, values)
    }

    fn bounds_of_low_order(&self, flight: &FlightModel, language: &Language) -> String {
        let section = |bounds: &ParameterBounds| {
            let values = vec![
                ("covariance_of", parameters_of(flight).to_owned()),
                ("covariance", language.style.matrix(&bounds.covariance)),
                ("parameter_count", bounds.covariance.len().to_string()),
            ];
            self.section(language.bounds_of_low_order, values)
        };
        flight.bounds.valid().map(section).unwrap_or_default()
    }
}
