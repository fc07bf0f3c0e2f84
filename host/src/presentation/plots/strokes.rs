//! The response of servo models to single strokes: a servo that is not linear answers a large one otherwise than a small one.

use super::figure::{
    Band, Curve, INKS, Ink, Legend, Panel, SINCE_EDGE_LABEL, milliseconds, with_unit,
};
use crate::data::units::Units;
use crate::presentation::summary::percent;
use servoid_identification::Timing;
use servoid_identification::results::Bounds;
use servoid_identification::servo_model::ServoModel;

/// A servo model with the name of its curves.
#[derive(Clone, Copy, Debug)]
pub struct NamedServo<'a> {
    /// Name in the legend; empty where there is one servo only.
    pub name: &'a str,
    /// The servo.
    pub model: &'a ServoModel,
    /// The middle of the commands that it was recorded with.
    pub middle: f64,
}

/// A small stroke, as a share of a large one.
const SMALL: f64 = 0.25;

/// Samples that are simulated, at the most.
const MOST_SAMPLES: usize = 3000;

/// A response is drawn until it stays so close to its end \[of the stroke\], and a quarter of that time longer.
const ARRIVED: f64 = 0.01;

/// One servo: a large stroke, as far as its command ran ahead of it in the record, and a small one. Two servos: the large
/// stroke that both have seen.
pub(super) fn stroke_panel(servos: &[NamedServo<'_>], units: Units<'_>) -> Panel {
    let y_label = with_unit(
        "motion for each unit of the stroke",
        units.gain().as_deref(),
    );
    let mut panel = Panel::new(SINCE_EDGE_LABEL, y_label, Legend::LowerRight);
    let seen = servos.iter().map(|servo| servo.model.fit.largest_error);
    let large = three_digits(seen.fold(f64::INFINITY, f64::min));
    let strokes: Vec<Stroke<'_>> = match servos {
        [servo] => vec![(servo, large), (servo, three_digits(SMALL * large))],
        _ => servos.iter().map(|servo| (servo, large)).collect(),
    }
    .into_iter()
    .map(|(servo, size)| Stroke::of(servo, size))
    .collect();
    let until = strokes.iter().map(Stroke::arrived_after).max().unwrap_or(0);
    for (stroke, ink) in strokes.iter().zip(INKS) {
        stroke.draw_into(&mut panel, ink, until + until / 4 + 2, units);
    }
    panel
}

/// A stroke and the answer to it.
struct Stroke<'a> {
    servo: &'a NamedServo<'a>,
    size: f64,
    /// The commands that it goes from and to.
    ends: [f64; 2],
    /// Motion for each unit of the stroke, from its edge on.
    motion: Vec<f64>,
    half_width: Bounds<Vec<f64>>,
}

impl<'a> Stroke<'a> {
    fn of(servo: &'a NamedServo<'a>, size: f64) -> Self {
        let (from, to) = (servo.middle - size / 2.0, servo.middle + size / 2.0);
        // The sample before the edge is at rest.
        let input: Vec<f64> = std::iter::once(from)
            .chain(std::iter::repeat_n(to, MOST_SAMPLES))
            .collect();
        let response = servo.model.respond(&input, 0);
        let rest = response.value.first().copied().unwrap_or_default();
        let each = |value: &f64| (value - rest) / size;
        Self {
            servo,
            size,
            ends: [from, to],
            motion: response.value.iter().skip(1).map(each).collect(),
            half_width: response
                .half_width
                .map(|half| half.iter().skip(1).map(|half| half / size).collect()),
        }
    }

    /// The sample from which the response stays near its end.
    fn arrived_after(&self) -> usize {
        let end = self.motion.last().copied().unwrap_or_default();
        let away = |value: &f64| (value - end).abs() > ARRIVED * end.abs();
        self.motion.iter().rposition(away).unwrap_or(0)
    }

    fn draw_into(&self, panel: &mut Panel, ink: Ink, samples: usize, units: Units<'_>) {
        let model = self.servo.model;
        let timing = Timing {
            sample_period_s: model.sample_period_s,
            sample_phase_s: model.sample_phase_s,
        };
        let times = (0..samples).map(|m| milliseconds(timing.seconds(m as f64)));
        let unit = units
            .input
            .map(|unit| format!(" {unit}"))
            .unwrap_or_default();
        // The direction decides where a load helps.
        let [from, to] = self
            .ends
            .map(|end| format!("{end:.*}", decimals(self.size)));
        let stroke = format!("stroke from {from} to {to}{unit}");
        let name = match self.servo.name {
            "" => stroke,
            servo => format!("{servo}: {stroke}"),
        };
        if let Bounds::Valid(half) = &self.half_width {
            let edge = |sign: f64| -> Vec<f64> {
                let both = self.motion.iter().zip(half);
                both.map(|(value, half)| value + sign * half).collect()
            };
            let level = model
                .covariance
                .as_ref()
                .map(|found| found.level)
                .into_valid();
            let level = level.map_or_else(String::new, |level| format!(", {} %", percent(level)));
            let band = format!("{name}: each point{level}");
            let times = times.clone();
            panel
                .bands
                .push(Band::between(band, ink, times, &edge(-1.0), &edge(1.0)));
        }
        let points = times.zip(self.motion.iter().copied());
        panel.curves.push(Curve::solid(name, ink, points));
    }
}

/// Decimals with which a size has three digits.
fn decimals(size: f64) -> usize {
    (2.0 - size.log10().floor()).clamp(0.0, 9.0) as usize
}

/// A size that reads well.
fn three_digits(size: f64) -> f64 {
    format!("{size:.2e}").parse().unwrap_or(size)
}
