//! Model files: a model, and beside it its units, the fingerprints of its runs and a model of low order.

mod schema_1;

use crate::data::dataset::DatasetOptions;
use crate::data::model_metadata::ModelMetadata;
use crate::data::{fingerprint, input_file};
use serde::{Deserialize, Serialize, Serializer};
use serde_json::{Map, Value};
use servoid_identification::Record;
use servoid_identification::diagnostics::Explanation;
use servoid_identification::flight_model::FlightModel;
use servoid_identification::nonlinear::Limits;
use servoid_identification::results::{MODEL_SCHEMA, Model};
use servoid_identification::servo_model::ServoModel;
use std::path::{Path, PathBuf};

/// Whether a file is a model, by its ending; any other file is read as a recording.
#[must_use]
pub fn is_model(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "json")
}

/// A model as its file has it, to be written.
#[derive(Debug, Serialize)]
pub struct ModelDocument<'a> {
    /// The model.
    #[serde(flatten)]
    pub model: &'a Model,
    /// Units, and the pulse frame.
    #[serde(flatten)]
    pub metadata: ModelMetadata,
    /// The record that it is of, where that is at hand: written as its fingerprint.
    #[serde(
        rename = "runs_crc32",
        serialize_with = "as_fingerprints",
        skip_serializing_if = "Option::is_none"
    )]
    pub record: Option<&'a Record<'a>>,
    /// The servo model beside the linear one, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo_model: Option<&'a ServoModelDocument>,
}

/// Fingerprints cost a pass over all samples, and most models are printed for people, without them.
fn as_fingerprints<S: Serializer>(
    record: &Option<&Record>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    record.map(fingerprint::of).serialize(serializer)
}

/// Why a file is not read as a model. The text names the remedy.
#[derive(Debug, thiserror::Error)]
pub enum ModelFileError {
    /// The error of the system.
    #[error("the model {0:?} cannot be read: {1}")]
    NotRead(PathBuf, std::io::Error),
    /// Bytes that are no letters.
    #[error("the model {0:?} is not text")]
    NotText(PathBuf),
    /// Not an object of JSON.
    #[error(
        "{0:?} is no model: identify the recording first, with servoid identify RECORDING.csv -o MODEL.json"
    )]
    NotAModel(PathBuf),
    /// A later version wrote it.
    #[error(
        "the model {path:?} was made by a newer servoid (schema {schema}, this one reads up to {MODEL_SCHEMA}): update servoid"
    )]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its schema.
        schema: Value,
    },
    /// No version wrote it.
    #[error(
        "the model {path:?} has the schema {schema}, which no servoid writes (this one writes {MODEL_SCHEMA}): identify again"
    )]
    UnknownSchema {
        /// The file.
        path: PathBuf,
        /// Its schema.
        schema: Value,
    },
    /// Fields are missing, or are not what they should be.
    #[error("{0:?} is no model of 'servoid identify': {1}")]
    Malformed(PathBuf, serde_json::Error),
    /// It is not laid out as its schema says.
    #[error(
        "the model {0:?} says that it is of schema {schema}, and is not laid out like that ({1}): if its field schema was changed, write {MODEL_SCHEMA} there again, else identify again",
        schema = schema_1::SCHEMA
    )]
    NotOfItsSchema(PathBuf, serde_json::Error),
    /// Its parts do not fit together.
    #[error(
        "the model {0:?} contradicts itself: its lists do not have the lengths that its structure gives, its bounds are there in part, or its numbers are beyond what any servo could have; identify again"
    )]
    Inconsistent(PathBuf),
    /// The model of low order cannot be read.
    #[error("the low-order model in {0:?} cannot be read: {1}")]
    MalformedFlightModel(PathBuf, serde_json::Error),
    /// The parts of the model of low order do not fit together.
    #[error("the low-order model in {0:?} contradicts itself: identify again")]
    InconsistentFlightModel(PathBuf),
    /// The servo model cannot be read.
    #[error("the servo model in {0:?} cannot be read: {1}")]
    MalformedServoModel(PathBuf, serde_json::Error),
    /// The parts of the servo model do not fit together.
    #[error("the servo model in {0:?} contradicts itself: identify again")]
    InconsistentServoModel(PathBuf),
}

/// A model file that was read.
#[derive(Debug)]
pub struct ModelFile {
    /// The model.
    pub model: Model,
    /// Units, and the pulse frame.
    pub metadata: ModelMetadata,
    /// The fingerprints of its runs; none in a file that has none.
    pub fingerprints: Vec<String>,
    /// How the files of its runs were read, where that was said.
    pub read_as: DatasetOptions,
    flight_model: Value,
    servo_model: Value,
    /// What was found beside the models, and what was said of it.
    said: Map<String, Value>,
    path: PathBuf,
}

/// The text of a model file.
///
/// # Errors
/// The file cannot be read, or is not text.
pub fn read_text(path: &Path) -> Result<String, ModelFileError> {
    let bytes = input_file::read(path)
        .map_err(|reason| ModelFileError::NotRead(path.to_owned(), reason))?;
    String::from_utf8(bytes).map_err(|_| ModelFileError::NotText(path.to_owned()))
}

/// The fields beside the model.
#[derive(Default, Deserialize)]
struct Beside {
    #[serde(default)]
    runs_crc32: Vec<String>,
    #[serde(default)]
    read_as: DatasetOptions,
}

impl ModelFile {
    /// Reads a model that `servoid identify` has written.
    pub fn read(path: &Path) -> Result<Self, ModelFileError> {
        Self::parse(&read_text(path)?, path)
    }

    /// [`ModelFile::read`] of a text; errors call it `path`.
    pub fn parse(text: &str, path: &Path) -> Result<Self, ModelFileError> {
        if !text.trim_start().starts_with('{') {
            return Err(ModelFileError::NotAModel(path.to_owned()));
        }
        let malformed = |reason| ModelFileError::Malformed(path.to_owned(), reason);
        let document: Value = serde_json::from_str(text).map_err(malformed)?;
        let is_old = document
            .get("schema")
            .is_some_and(|schema| *schema == schema_1::SCHEMA);
        let document = to_todays_schema(document, path)?;
        let model = Model::deserialize(&document).map_err(|reason| match is_old {
            true => ModelFileError::NotOfItsSchema(path.to_owned(), reason),
            false => malformed(reason),
        })?;
        if !model.is_consistent() {
            return Err(ModelFileError::Inconsistent(path.to_owned()));
        }
        let beside = Beside::deserialize(&document).unwrap_or_default();
        Ok(Self {
            model,
            metadata: ModelMetadata::in_document(&document),
            fingerprints: beside.runs_crc32,
            read_as: beside.read_as,
            flight_model: document.get("flight_model").cloned().unwrap_or_default(),
            servo_model: document.get("servo_model").cloned().unwrap_or_default(),
            said: said(&document),
            path: path.to_owned(),
        })
    }

    /// The model of low order that the file may carry beside the model.
    ///
    /// # Errors
    /// It cannot be read, or it contradicts itself or the model.
    pub fn flight_model(&self) -> Result<Option<FlightModel>, ModelFileError> {
        let found: Option<FlightModel> = Deserialize::deserialize(&self.flight_model)
            .map_err(|reason| ModelFileError::MalformedFlightModel(self.path.clone(), reason))?;
        // That of a band, where nothing else has bounds.
        let level = self.model.frequency.bounds.as_ref();
        let level = level.map(|bounds| bounds.level).into_valid();
        match &found {
            Some(flight)
                if !flight.is_consistent()
                    || flight
                        .bounds
                        .valid()
                        .is_some_and(|bounds| Some(bounds.level) != level) =>
            {
                Err(ModelFileError::InconsistentFlightModel(self.path.clone()))
            }
            _ => Ok(found),
        }
    }
}

impl ModelFile {
    /// Whether its servo model is one that was drawn at random; nothing else of it is read.
    #[must_use]
    pub fn has_drawn_servo(&self) -> bool {
        self.servo_model.get("drawn") == Some(&Value::Bool(true))
    }

    /// The servo model that the file may carry beside the linear one.
    ///
    /// # Errors
    /// It cannot be read, or it contradicts itself.
    pub fn servo_model(&self) -> Result<Option<ServoModelDocument>, ModelFileError> {
        if self.servo_model.is_null() {
            return Ok(None);
        }
        let malformed = |reason| ModelFileError::MalformedServoModel(self.path.clone(), reason);
        let model = ServoModel::deserialize(&self.servo_model).map_err(malformed)?;
        let beside = BesideServoModel::deserialize(&self.servo_model).map_err(malformed)?;
        match model.is_consistent() {
            true => Ok(Some(ServoModelDocument {
                is_of_rows: self.metadata.pulse_frame_s.is_none()
                    && !self.metadata.exact_command
                    && model.fit.waits_for_pulses.is_none(),
                model: model.with_todays_quantities(),
                controller_names: beside.controller_names,
                stroke_of_60_degrees_s: beside.stroke_of_60_degrees_s,
                polled: self.metadata.polled,
                common_wait_s: self.metadata.common_wait_s,
            })),
            false => Err(ModelFileError::InconsistentServoModel(self.path.clone())),
        }
    }
}

/// The fields with what was found beside the models.
const SAID: [&str; 5] = [
    "explanation",
    "no_servo_model",
    "no_flight_model",
    "limits",
    "directions",
];

fn said(document: &Value) -> Map<String, Value> {
    let field = |name: &str| Some((name.to_owned(), document.get(name)?.clone()));
    SAID.into_iter().filter_map(field).collect()
}

/// What is said beside the models is left out where it cannot be read: nothing is computed of it.
impl ModelFile {
    /// The choice of the structure, where the file has it.
    #[must_use]
    pub fn explanation(&self) -> Option<Explanation> {
        Explanation::deserialize(self.said.get("explanation")?).ok()
    }

    /// Motion that is not linear, where it was looked for.
    #[must_use]
    pub fn limits(&self) -> Option<Limits> {
        Limits::deserialize(self.said.get("limits")?).ok()
    }

    /// Whether limits were looked for in a record with strokes in both directions.
    #[must_use]
    pub fn compares_strokes(&self) -> bool {
        self.said.contains_key("directions")
    }

    /// How up and down strokes compare, in words; older files do not say it.
    #[must_use]
    pub fn strokes_in_words(&self) -> Option<&str> {
        self.said.get("directions")?.get("statement")?.as_str()
    }

    /// A field that is a text.
    #[must_use]
    pub fn text(&self, field: &str) -> Option<&str> {
        self.said.get(field)?.as_str()
    }
}

/// A servo model as a file has it.
#[derive(Clone, Debug, Serialize)]
pub struct ServoModelDocument {
    /// The model.
    #[serde(flatten)]
    pub model: ServoModel,
    /// What its controllers are called, in order; empty where it has one.
    pub controller_names: Vec<f64>,
    /// How long a whole stroke of 60 degrees takes upwards and downwards \[s\]; `None` where the output is no angle, or the model does not say it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stroke_of_60_degrees_s: Option<[f64; 2]>,
    /// Whether another program wrote the recording, whose commands may change beside the pulses: a file without their frame, of which nothing else is stated.
    #[serde(skip)]
    pub is_of_rows: bool,
    /// Whether its logger is stated to have polled the commands.
    #[serde(skip)]
    pub polled: bool,
    /// By how much a wait for pulses may make its delay longer, as its model file says of the recording \[s\].
    #[serde(skip)]
    pub common_wait_s: f64,
}

/// The fields beside a servo model.
#[derive(Deserialize)]
struct BesideServoModel {
    #[serde(default)]
    controller_names: Vec<f64>,
    #[serde(default)]
    stroke_of_60_degrees_s: Option<[f64; 2]>,
}

/// The document as this version would have written it.
fn to_todays_schema(mut document: Value, path: &Path) -> Result<Value, ModelFileError> {
    // A document without one is no model at all, which reading it reports better.
    let Some(schema) = document.get("schema").cloned() else {
        return Ok(document);
    };
    let number = match &schema {
        Value::String(text) => text.trim().parse().ok(),
        other => other.as_f64(),
    };
    if schema == schema_1::SCHEMA {
        schema_1::upgrade(&mut document);
    } else if number.is_some_and(|number| number > f64::from(MODEL_SCHEMA)) {
        let path = path.to_owned();
        return Err(ModelFileError::Newer { path, schema });
    } else if schema != MODEL_SCHEMA {
        let path = path.to_owned();
        return Err(ModelFileError::UnknownSchema { path, schema });
    }
    Ok(document)
}
