//! A model together with the facts that an export states.

use crate::data::model_metadata::ModelMetadata;
use crate::data::neutral::neutral;
use servoid_identification::flight_model;
use servoid_identification::flight_model::{FlightModel, FlightModelOptions};
use servoid_identification::results::{FrequencyResponse, Model};
use servoid_identification::servo_model::{CommandRange, ServoModel};
use std::f64::consts::TAU;

/// A model, ready to be written.
#[derive(Clone, Debug)]
pub struct Export<'a> {
    /// Name of the servo; any text.
    pub name: &'a str,
    /// Origin of the model; any text.
    pub source: &'a str,
    /// The model.
    pub model: &'a Model,
    /// The model of low order, or why there is none.
    pub low_order: Result<FlightModel, String>,
    /// Units, and the pulse frame that holds a command, where they are known.
    pub metadata: ModelMetadata,
    /// The servo model of the same recording, where there is one.
    pub servo_model: Option<&'a ServoModel>,
}

/// The position at rest under the neutral command, and that.
pub(super) struct RestAtNeutral {
    pub(super) command: f64,
    pub(super) position: f64,
}

impl<'a> Export<'a> {
    /// A model with the low-order model that was fitted with it, or else one that is fitted now.
    #[must_use]
    pub fn new(
        name: &'a str,
        source: &'a str,
        model: &'a Model,
        fitted: Option<FlightModel>,
        metadata: ModelMetadata,
    ) -> Self {
        let options = FlightModelOptions {
            frame_period_s: metadata.pulse_frame_s.filter(|frame| *frame > 0.0),
            ..FlightModelOptions::default()
        };
        let low_order = match fitted {
            Some(fitted) => Ok(fitted),
            None => flight_model::of_model(model, &options)
                .map(|flight| flight.with_delay_error(metadata.sensor_delay_uncertainty_s))
                .map_err(|error| error.to_string()),
        };
        Self {
            name,
            source,
            model,
            low_order,
            metadata,
            servo_model: None,
        }
    }

    /// The same, which knows of the servo model beside it.
    #[must_use]
    pub fn beside(self, servo_model: Option<&'a ServoModel>) -> Self {
        Self {
            servo_model,
            ..self
        }
    }

    /// The range of the recorded commands, where one of the models of the file has it.
    pub(super) fn commands(&self) -> Option<CommandRange> {
        let recorded = self.metadata.recorded.map(|recorded| recorded.commands);
        recorded.or_else(|| self.servo_model?.commands)
    }

    /// Where the identified response, whose gain that of low order does not have to the last digit, rests under the neutral command.
    pub(super) fn rest_at_neutral(&self) -> RestAtNeutral {
        let command = neutral(self.metadata.units(), self.commands());
        let gain = self.model.step.value.last().copied().unwrap_or(f64::NAN);
        RestAtNeutral {
            command,
            position: self.model.offset + gain * command,
        }
    }

    /// The frame that holds a command \[s\]: 0 where there is none, or none is known.
    pub(super) fn frame_s(&self) -> f64 {
        self.metadata.pulse_frame_s.unwrap_or(0.0)
    }

    /// The frequency response of the servo itself, freed of the hold of the samples.
    pub(super) fn servo_frequency(&self) -> FrequencyResponse {
        let of_samples = self.model.frequency.clone();
        of_samples.freed_of_hold(self.model.timing())
    }

    /// Largest distance of the low-order model's step response from the identified one at any sample
    /// but the last, which stands for all later ones \[% of the step\]; at least that of its own fit. In a band, where no step response is identified, that of the
    /// frequency response, at most.
    pub(super) fn largest_error_percent(&self, flight: &FlightModel) -> f64 {
        if let Some(band_hz) = flight.band_hz {
            return flight.largest_error_percent + self.without_lead_percent(flight, band_hz);
        }
        let step = &self.model.step.value;
        let count = step.len().saturating_sub(1);
        let discrete = flight.transfer.discrete(self.model.timing());
        let gain = step.last().copied().unwrap_or(f64::NAN).abs();
        let response = discrete.simulate(&vec![1.0; count], 0.0);
        let pairs = response.iter().zip(step);
        let errors = pairs.map(|(a, b)| 100.0 * (a - b).abs() / gain);
        errors.fold(flight.largest_error_percent, f64::max)
    }

    /// By how much the frequency response in a band changes where no program has a delay below zero \[% of that at its lowest frequency\]: |exp(jω L) - 1| |G|.
    fn without_lead_percent(&self, flight: &FlightModel, [from, to]: [f64; 2]) -> f64 {
        let lead_s = (-flight.transfer.delay_s).max(0.0);
        let found = self.servo_frequency();
        let within = |omega: f64| (from..=to).contains(&(omega / TAU));
        let points = found.omega_rad_s.iter().zip(&found.magnitude_db);
        let points: Vec<(f64, f64)> = points
            .filter(|(omega, _)| within(**omega))
            .map(|(omega, db)| (*omega, 10f64.powf(db / 20.0)))
            .collect();
        let lowest = points.first().map_or(f64::NAN, |(_, size)| *size);
        let changed = points
            .iter()
            .map(|(omega, size)| 200.0 * (0.5 * omega * lead_s).sin().abs() * size / lowest);
        changed.fold(0.0, f64::max)
    }
}
