//! Models: their document, and what can be computed with them.

use crate::arguments::in_python;
use crate::arrays::lent;
use crate::compute::compute;
use crate::error::raised;
use crate::export::ExportOptions;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use servoid::analysis::{Exported, text_of_file, to_json};
use servoid::data::model_file::{ModelFile, ServoModelDocument};
use servoid::presentation::plots::{self, Named};
use servoid::presentation::summary::GainAndPhase;
use servoid::presentation::{report, summary};
use servoid_identification::Run;
use servoid_identification::results::{Bounds, Interval, Reason, Withdrawn};
use std::borrow::Cow;
use std::path::Path;

/// A model as its document has it.
#[pyclass(frozen, module = "servoid._servoid")]
pub(crate) struct Model {
    pub(crate) file: ModelFile,
    pub(crate) name: String,
    document: String,
    summary: Option<String>,
}

impl Model {
    /// The model of a document. The `summary` of an identification has more than that of its document.
    pub(crate) fn of(
        document: String,
        name: String,
        summary: Option<String>,
    ) -> anyhow::Result<Self> {
        let file = ModelFile::parse(&document, Path::new(&name))?;
        let document = with_quantities_of_draw(document, &file)?;
        Ok(Self {
            file,
            name,
            document,
            summary,
        })
    }

    fn run<'a>(
        input: Cow<'a, [f64]>,
        output: Cow<'a, [f64]>,
        at_rest: Option<f64>,
    ) -> PyResult<Run<'a>> {
        let run = Run::new(input, output).map_err(raised)?;
        Ok(match at_rest {
            Some(input) => run.with_input_at_rest(input),
            None => run,
        })
    }

    /// The servo model, and the number of the controller of this name.
    fn servo_with(&self, controller: Option<f64>) -> PyResult<(ServoModelDocument, usize)> {
        let found = self.file.servo_model().map_err(raised)?;
        let found =
            found.ok_or_else(|| raised(anyhow::anyhow!("{} has no servo model", self.name)))?;
        let known = &found.controller_names;
        let number = match controller {
            None if known.len() > 1 => Err(raised(anyhow::anyhow!(
                "the servo model has the controllers {known:?}: choose one (controller=)"
            ))),
            None => Ok(0),
            Some(name) => known
                .iter()
                .position(|other| *other == name)
                .ok_or_else(|| raised(no_controller(name, known))),
        }?;
        Ok((found, number))
    }
}

/// The document, in which a servo that was drawn has its own quantities: Python writes those of the estimate there.
fn with_quantities_of_draw(document: String, file: &ModelFile) -> anyhow::Result<String> {
    if !file.has_drawn_servo() {
        return Ok(document);
    }
    let Some(servo) = file.servo_model().ok().flatten() else {
        return Ok(document);
    };
    let mut found: serde_json::Value = serde_json::from_str(&document)?;
    if let Some(quantities) = found.pointer_mut("/servo_model/quantities") {
        *quantities = serde_json::to_value(&servo.model.quantities)?;
    }
    Ok(serde_json::to_string(&found)?)
}

/// Value, lower and upper bound.
type Ends = (Option<f64>, Option<f64>, Option<f64>);

/// Gain, phase and the phase of the slowest sines (degrees).
type Sine = (Ends, Ends, f64);

fn sine(found: GainAndPhase) -> Sine {
    let ends = |of: Interval| (of.value, of.lower, of.upper);
    (
        ends(found.gain),
        ends(found.phase_deg),
        found.phase_at_rest_deg,
    )
}

type Response<'py> = (
    Bound<'py, PyArray1<f64>>,
    Option<Bound<'py, PyArray1<f64>>>,
    Option<(String, String)>,
);

/// Text, remarks, warnings and document.
type ExportedFile = (String, Vec<String>, Vec<String>, String);

#[pymethods]
impl Model {
    /// The model of a document; errors call it `name`.
    #[staticmethod]
    fn parse(py: Python<'_>, document: String, name: String) -> PyResult<Self> {
        py.detach(|| Self::of(document, name, None)).map_err(raised)
    }

    /// The model in a file.
    #[staticmethod]
    fn read(py: Python<'_>, path: std::path::PathBuf) -> PyResult<Self> {
        let read = || -> anyhow::Result<Self> {
            let (document, name) = (servoid::data::model_file::read_text(&path)?, path.display());
            Self::of(document, name.to_string(), None)
        };
        py.detach(read).map_err(raised)
    }

    /// What the model, or its data, are called.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// The JSON that the program writes.
    #[getter]
    fn document(&self) -> &str {
        &self.document
    }

    /// What kind of servo, how fast, how sure.
    #[getter]
    fn sentence(&self) -> String {
        in_python(&summary::model_sentence(
            &self.file.model,
            &self.file.metadata,
        ))
    }

    /// The text that the program prints.
    #[getter]
    fn summary(&self) -> PyResult<String> {
        match &self.summary {
            Some(summary) => Ok(summary.clone()),
            None => text_of_file(&self.file, &self.name).map_err(raised),
        }
    }

    /// The text that the program prints of the low-order model, where there is one.
    #[getter]
    fn flight_summary(&self) -> PyResult<Option<String>> {
        let found = self.file.flight_model().map_err(raised)?;
        let text = |flight| summary::of_flight_model(&flight, self.file.model.linear);
        Ok(found.map(text))
    }

    /// What kind of servo as a machine, where there is a servo model and that is the answer.
    #[getter]
    fn servo_sentence(&self) -> PyResult<Option<String>> {
        let (model, units) = (&self.file.model, self.file.metadata.units());
        let servo = self.file.servo_model().map_err(raised)?;
        let answer = servo.and_then(|servo| summary::answer_of_servo_model(&servo, model, units));
        Ok(answer.map(|answer| in_python(&answer)))
    }

    /// Whether the servo is called linear, by the linear model and by the servo model beside it.
    #[getter]
    fn linear(&self) -> PyResult<bool> {
        let servo = self.file.servo_model().map_err(raised)?;
        let servo = servo.as_ref().map(|found| &found.model);
        Ok(summary::is_called_linear(&self.file.model, servo))
    }

    /// The frequency response of the servo alone, as the document has that of the samples, and the first frequency and the one behind
    /// the last that are drawn.
    fn servo_frequency(&self) -> PyResult<(String, (usize, usize))> {
        let response = plots::servo_frequency(&self.file.model);
        let shown = plots::shown_frequencies(&response);
        let document = serde_json::to_string(&response).map_err(raised)?;
        Ok((document, (shown.start, shown.end)))
    }

    /// The page of `servoid report`.
    fn report(&self, py: Python<'_>, name: String, title: Option<String>) -> PyResult<String> {
        let page = || -> anyhow::Result<String> {
            let servo = report::Servo::of_file(name, &self.file)?;
            report::page(&report::Page {
                title: title.as_deref().unwrap_or(report::TITLE),
                first: servo.part(),
                second: None,
                comparison: None,
                servo_models: None,
                paper: &[],
            })
        };
        py.detach(page).map_err(raised)
    }

    /// The file of `servoid export`: its text, its remarks, its warnings, and the document without the text.
    fn export(&self, py: Python<'_>, options: ExportOptions) -> PyResult<ExportedFile> {
        let request = options.request().map_err(raised)?;
        let write = || -> anyhow::Result<(Exported, String)> {
            let found = Exported::of(&self.file, &request)?;
            let document = to_json(&found.document(request.target))?;
            Ok((found, document))
        };
        let (found, document) = py.detach(write).map_err(raised)?;
        let [remarks, warnings] = [&found.remarks, &found.warnings]
            .map(|said| said.iter().map(|sentence| in_python(sentence)).collect());
        Ok((found.text, remarks, warnings, document))
    }

    /// The step response with its band, drawn.
    fn step_svg(&self) -> PyResult<String> {
        let model = Named {
            name: "model",
            model: &self.file.model,
        };
        let units = self.file.metadata.units();
        let figure = plots::step_response("step", "Step response", &[model], units);
        plots::draw(&figure).map_err(|error| raised(anyhow::anyhow!("{error}")))
    }

    /// The output for an input, NaN where the input's history is not known.
    fn simulate<'py>(
        &self,
        py: Python<'py>,
        input: PyReadonlyArray1<'py, f64>,
        at_rest: Option<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let unknown = vec![f64::NAN; input.as_array().len()];
        let run = Self::run(lent(&input), unknown.into(), at_rest)?;
        let output = py.detach(|| self.file.model.simulate(&run));
        Ok(PyArray1::from_vec(py, output))
    }

    /// The output predicted one step ahead.
    fn predict<'py>(
        &self,
        py: Python<'py>,
        input: PyReadonlyArray1<'py, f64>,
        output: PyReadonlyArray1<'py, f64>,
        at_rest: Option<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let run = Self::run(lent(&input), lent(&output), at_rest)?;
        let predicted = py.detach(|| self.file.model.predict(&run));
        Ok(PyArray1::from_vec(py, predicted))
    }

    /// Gain and phase (degrees) of the linear model under a sine, or why there are none.
    fn sine(&self, hertz: f64) -> PyResult<(Option<Sine>, Option<String>)> {
        let found = summary::sine_of_linear_model(&self.file.model, hertz).map_err(raised)?;
        Ok(match found {
            Ok(found) => (Some(sine(found)), None),
            Err(why) => (None, Some(in_python(&why))),
        })
    }

    /// The same of the servo model, of this amplitude, and why it has no bounds, where it has none.
    fn servo_sine(
        &self,
        py: Python<'_>,
        hertz: f64,
        amplitude: f64,
        controller: Option<f64>,
    ) -> PyResult<(Sine, Option<(String, String)>)> {
        let (servo, number) = self.servo_with(controller)?;
        let metadata = self.file.metadata.clone();
        let (found, reason) = compute(py, move |_| {
            Ok(summary::sine_of_machine(
                &servo.model,
                &metadata,
                hertz,
                amplitude,
                number,
            ))
        })?;
        Ok((sine(found), reason.map(in_words).transpose()?))
    }

    /// The response of the servo model to an input from rest at its first value, the half width of its band, and why there is
    /// no band.
    fn servo_response<'py>(
        &self,
        py: Python<'py>,
        input: PyReadonlyArray1<'py, f64>,
        controller: Option<f64>,
    ) -> PyResult<Response<'py>> {
        let (found, number) = self.servo_with(controller)?;
        // It checks that the values can be computed with; a servo model knows no missing input.
        let unknown = vec![f64::NAN; input.as_array().len()];
        let run = Self::run(lent(&input), unknown.into(), None)?.into_owned();
        if run.is_empty() {
            return Err(raised(anyhow::anyhow!(
                "the input is empty: give one value for each sample"
            )));
        }
        if run.input().iter().any(|value| value.is_nan()) {
            return Err(raised(anyhow::anyhow!(
                "the servo model needs an input without missing samples"
            )));
        }
        let response = compute(py, move |_| Ok(found.model.respond(run.input(), number)))?;
        let half_width = match response.half_width {
            Bounds::Valid(half_width) => Ok(half_width),
            Bounds::Withdrawn(reason) => Err(reason),
        };
        let value = PyArray1::from_vec(py, response.value);
        Ok(match half_width {
            Ok(half_width) => (value, Some(PyArray1::from_vec(py, half_width)), None),
            Err(reason) => (value, None, Some(in_words(reason)?)),
        })
    }
}

/// What to do where no controller has the `name`.
fn no_controller(name: f64, known: &[f64]) -> anyhow::Error {
    match known.is_empty() {
        true => anyhow::anyhow!(
            "the servo model has one controller, which has no name: leave controller out"
        ),
        false => anyhow::anyhow!("the servo model has no controller {name}: it has {known:?}"),
    }
}

/// The stable name of a reason, and the reason in a few words.
fn in_words(reason: Reason) -> PyResult<(String, String)> {
    let document = serde_json::to_value(Withdrawn(reason)).map_err(raised)?;
    let field = |name: &str| document.get(name)?.as_str().map(str::to_owned);
    let name = field("reason").unwrap_or_default();
    Ok((name, reason.because().to_owned()))
}
