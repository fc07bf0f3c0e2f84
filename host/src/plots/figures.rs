//! The paper's figures, made from recordings and models.

use super::figure::{Band, Curve, Figure, Ink, Legend, Panel};
use crate::summary::{Units, level_text};
use servoid_identification::frequency::FrequencyResponse;
use servoid_identification::{Model, Record, Run};

/// A model with the name that its curves carry.
#[derive(Clone, Copy, Debug)]
pub struct Named<'a> {
    /// What the legend calls it.
    pub name: &'a str,
    /// The model.
    pub model: &'a Model,
}

/// What the legend calls the response of a model whose errors are not noise.
fn without_bounds(name: &str) -> String {
    format!("{name}: no bounds can be given")
}

const INKS: [Ink; 2] = [Ink::Model, Ink::SecondModel];

/// "angle (deg)", or the quantity alone where the unit is not known.
fn with_unit(quantity: &str, unit: Option<&str>) -> String {
    unit.map_or_else(
        || quantity.to_owned(),
        |unit| format!("{quantity} ({unit})"),
    )
}

/// Points of a long record that are still drawn one by one.
const MOST_POINTS: usize = 6_000;

/// A signal over time. Of a long one, each stretch of samples is drawn as its smallest and its
/// largest value: at the width of a page that looks the same, and the file stays small.
fn signal(period_s: f64, values: &[f64]) -> Vec<(f64, f64)> {
    let time = |k: usize| k as f64 * period_s;
    if values.len() <= MOST_POINTS {
        return values
            .iter()
            .enumerate()
            .map(|(k, &value)| (time(k), value))
            .collect();
    }
    let stretch = (2 * values.len()).div_ceil(MOST_POINTS);
    let extremes = |(index, part): (usize, &[f64])| {
        let placed = || (index * stretch..).map(time).zip(part.iter().copied());
        let low = placed().min_by(|a, b| a.1.total_cmp(&b.1))?;
        // A missing sample (NaN) counts as the largest, so that gaps stay visible.
        let high = placed().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(if low.0 <= high.0 {
            [low, high]
        } else {
            [high, low]
        })
    };
    values
        .chunks(stretch)
        .enumerate()
        .filter_map(extremes)
        .flatten()
        .collect()
}

/// Runs of a record that are drawn; of more, these are the first.
pub const MOST_RUNS: usize = 3;

/// Figs 4 and 8: the reference and the measurement of each run, in one panel, or in two where one scale
/// does not serve both.
#[must_use]
pub fn input_output(name: &str, title: &str, record: &Record, units: Units<'_>) -> Figure {
    let period = record.sample_period_s();
    let panel = |y_label: String, curves: Vec<Curve>| Panel {
        x_label: "time (s)".into(),
        y_label,
        legend: Legend::Above,
        curves,
        ..Panel::default()
    };
    let panels = record.runs().iter().take(MOST_RUNS).flat_map(|run| {
        let measured = Curve::solid("measured", Ink::Measured, signal(period, run.output()));
        let reference = Curve::solid("reference", Ink::Reference, signal(period, run.input()));
        let position = with_unit("position", units.output);
        if share_a_scale(run, units) {
            return vec![panel(position, vec![measured, reference])];
        }
        vec![
            panel(with_unit("reference", units.input), vec![reference]),
            panel(position, vec![measured]),
        ]
    });
    Figure {
        name: name.into(),
        title: title.into(),
        panels: panels.collect(),
    }
}

/// A signal whose span is less than this part of what both take together would be drawn as a flat line.
const FLAT: f64 = 0.1;

/// Whether input and output can be read off one axis: they have one unit, as far as is known, and neither
/// is flat beside the other, as degrees are beside microseconds.
fn share_a_scale(run: &Run, units: Units<'_>) -> bool {
    let ends = |values: &[f64]| {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        [
            finite().fold(f64::INFINITY, f64::min),
            finite().fold(f64::NEG_INFINITY, f64::max),
        ]
    };
    let ([low, high], [bottom, top]) = (ends(run.input()), ends(run.output()));
    let both = high.max(top) - low.min(bottom);
    let differ = units.gain().is_some();
    !differ && high - low >= FLAT * both && top - bottom >= FLAT * both
}

/// Figs 5 and 10: the step response, with its bounds where they can be given.
#[must_use]
pub fn step_response(name: &str, title: &str, models: &[Named<'_>], units: Units<'_>) -> Figure {
    let mut panel = Panel {
        x_label: "time since the edge of the command (s)".into(),
        y_label: with_unit("response to a unit step", units.gain().as_deref()),
        ..Panel::default()
    };
    for (Named { name, model }, ink) in models.iter().zip(INKS) {
        let step = &model.step;
        let timing = model.timing();
        let line = |values: &[f64]| -> Vec<(f64, f64)> {
            let place = |(m, &value)| (timing.seconds(m as f64), value);
            values.iter().enumerate().map(place).collect()
        };
        if !model.bounds_hold() {
            let name = without_bounds(name);
            panel
                .curves
                .push(Curve::solid(name, ink, line(&step.value)));
            continue;
        }
        let level = level_text(model);
        let bounds = line(&step.simultaneous.lower)
            .into_iter()
            .zip(&step.simultaneous.upper);
        panel.bands.push(Band {
            name: format!("{name}: the whole curve, {level}"),
            ink,
            points: bounds
                .map(|((t, lower), &upper)| (t, lower, upper))
                .collect(),
        });
        panel
            .curves
            .push(Curve::solid(*name, ink, line(&step.value)));
        let each = format!("{name}: each point, {level}");
        panel
            .curves
            .push(Curve::dashed(each, ink, line(&step.pointwise.lower)));
        panel.curves.push(Curve {
            name: String::new(),
            ..Curve::dashed("", ink, line(&step.pointwise.upper))
        });
    }
    Figure {
        name: name.into(),
        title: title.into(),
        panels: vec![panel],
    }
}

/// Figs 6 and 11: magnitude and phase of the servo, freed of the hold and the phase of the samples, with
/// their bounds where they can be given.
#[must_use]
pub fn bode(name: &str, title: &str, models: &[Named<'_>]) -> Figure {
    let panel = |y_label: &str| Panel {
        x_label: "frequency (rad/s)".into(),
        x_logarithmic: true,
        y_label: y_label.into(),
        legend: Legend::UpperRight,
        ..Panel::default()
    };
    let (mut magnitude, mut phase) = (panel("magnitude (dB)"), panel("phase (deg)"));
    for (Named { name, model }, ink) in models.iter().zip(INKS) {
        // Only a model made by hand can have no response of its own; its samples' is at hand then.
        let own = model.servo_response(&model.frequency.omega_rad_s);
        let f = &own.unwrap_or_else(|_| model.frequency.clone());
        let shown = shown_frequencies(f);
        let level = format!("{name}: {}", level_text(model));
        let points = |values: &[f64]| {
            let points = f.omega_rad_s.iter().copied().zip(values.iter().copied());
            points
                .skip(shown.start)
                .take(shown.len())
                .collect::<Vec<_>>()
        };
        let band = |lower: &[f64], upper: &[f64]| {
            let bounds = points(lower).into_iter().zip(points(upper));
            let points = bounds
                .map(|((w, lower), (_, upper))| (w, lower, upper))
                .collect();
            Band {
                name: level.clone(),
                ink,
                points,
            }
        };
        let named = match model.bounds_hold() {
            true => (*name).to_owned(),
            false => without_bounds(name),
        };
        let curve = |values: &[f64]| Curve::solid(&named, ink, points(values));
        magnitude.curves.push(curve(&f.magnitude_db));
        phase.curves.push(curve(&f.phase_deg));
        if model.bounds_hold() {
            let lower = floored(f);
            magnitude.bands.push(band(&lower, &f.magnitude_db_upper));
            phase
                .bands
                .push(band(&f.phase_deg_lower, &f.phase_deg_upper));
        }
    }
    Figure {
        name: name.into(),
        title: title.into(),
        panels: vec![magnitude, phase],
    }
}

/// The lower bounds of the magnitude, no lower than a little below the lowest point of the curve:
/// where zero is possible, minus infinity would flatten everything else.
fn floored(response: &FrequencyResponse) -> Vec<f64> {
    let shown = response.magnitude_db.get(shown_frequencies(response));
    let floor = shown
        .unwrap_or_default()
        .iter()
        .copied()
        .fold(0.0, f64::min)
        - 10.0;
    response
        .magnitude_db_lower
        .iter()
        .map(|&lower| lower.max(floor))
        .collect()
}

/// The frequencies that can be drawn and mean something: above 0, which has no place on a
/// logarithmic axis, and below the first one where the response cannot be told from zero and any
/// phase is possible.
fn shown_frequencies(response: &FrequencyResponse) -> std::ops::Range<usize> {
    let start = response
        .omega_rad_s
        .iter()
        .take_while(|&&w| w <= 0.0)
        .count();
    let margins = response
        .phase_deg_upper
        .iter()
        .zip(&response.phase_deg_lower);
    let known = margins
        .skip(start)
        .take_while(|(upper, lower)| *upper - *lower < 360.0)
        .count();
    start..start + known
}

/// Figs 7, 9 and 12: models against a measurement, with the residual below.
#[must_use]
pub fn validation(
    name: &str,
    title: &str,
    models: &[Named<'_>],
    run: &Run,
    unit: Option<&str>,
) -> Figure {
    let Some(first) = models.first() else {
        return Figure {
            name: name.into(),
            title: title.into(),
            panels: Vec::new(),
        };
    };
    let period = first.model.sample_period_s;
    let measured = run.output();
    let mut above = Panel {
        x_label: "time (s)".into(),
        y_label: with_unit("position", unit),
        legend: Legend::Above,
        curves: vec![Curve::solid(
            "measured",
            Ink::Measured,
            signal(period, measured),
        )],
        ..Panel::default()
    };
    let mut below = Panel {
        x_label: "time (s)".into(),
        y_label: with_unit("measured - model", unit),
        legend: Legend::Above,
        ..Panel::default()
    };
    for (Named { name, model }, ink) in models.iter().zip(INKS) {
        let simulated = model.simulate(run);
        let residual: Vec<f64> = measured
            .iter()
            .zip(&simulated)
            .map(|(y, s)| y - s)
            .collect();
        above
            .curves
            .push(Curve::solid(*name, ink, signal(period, &simulated)));
        below
            .curves
            .push(Curve::solid(*name, ink, signal(period, &residual)));
    }
    Figure {
        name: name.into(),
        title: title.into(),
        panels: vec![above, below],
    }
}

/// Everything that is drawn of one identification: Figs 4-7 of the paper for this record.
#[must_use]
pub fn identification(
    prefix: &str,
    record: &Record,
    model: &Model,
    units: Units<'_>,
) -> Vec<Figure> {
    let named = [Named {
        name: "model",
        model,
    }];
    let mut figures = vec![
        input_output(
            &format!("{prefix}-input-output"),
            "Reference and measurement",
            record,
            units,
        ),
        step_response(&format!("{prefix}-step"), "Step response", &named, units),
        bode(&format!("{prefix}-bode"), "Frequency response", &named),
    ];
    figures.extend(record.runs().iter().zip(1..).map(|(run, number)| {
        let name = match record.runs().len() {
            1 => format!("{prefix}-validation"),
            _ => format!("{prefix}-validation-run-{number}"),
        };
        validation(
            &name,
            "Model against measurement",
            &named,
            run,
            units.output,
        )
    }));
    figures
}

/// One servo under one condition: what a report draws.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// What it is called: bench, aircraft, a file's name.
    pub name: &'a str,
    /// Its model.
    pub model: &'a Model,
    /// The record it was identified from, where that is at hand.
    pub record: Option<&'a Record>,
    /// The units of its record, where they are known.
    pub units: Units<'a>,
}

impl<'a> Subject<'a> {
    fn named(&self) -> Named<'a> {
        Named {
            name: self.name,
            model: self.model,
        }
    }

    fn first_run(&self) -> Option<&'a Run> {
        self.record.and_then(|record| record.runs().first())
    }
}

/// The paper's Figs 4-7 of one servo and, where there is a second one, Figs 8-12 as well. As in the
/// paper, the second one's results are drawn with the first one's.
#[must_use]
pub fn paper(first: &Subject<'_>, second: Option<&Subject<'_>>) -> Vec<Figure> {
    let mut all = of_one(first, &[first.named()], ["04", "05", "06", "07"]);
    if let Some(second) = second {
        let both = [first.named(), second.named()];
        let mut later = of_one(second, &both, ["08", "10", "11", "12"]);
        if let Some(run) = second.first_run() {
            let title = format!("Fig. 9: {} model on {} data", first.name, second.name);
            let figure = validation(
                "fig-09-first-on-second",
                &title,
                &[first.named()],
                run,
                second.units.output,
            );
            later.insert(1, figure);
        }
        all.extend(later);
    }
    all
}

/// Measurement, step response, frequency response and validation of one servo, with these numbers
/// of the paper's figures.
fn of_one(subject: &Subject<'_>, models: &[Named<'_>], numbers: [&str; 4]) -> Vec<Figure> {
    let [io, step, frequency, fit] = numbers;
    let names: Vec<&str> = models.iter().map(|m| m.name).collect();
    let names = names.join(" and ");
    let title =
        |number: &str, what: &str| format!("Fig. {}: {what}", number.trim_start_matches('0'));
    let mut figures = Vec::new();
    if let Some(record) = subject.record {
        let title = title(io, &format!("{}, reference and measurement", subject.name));
        figures.push(input_output(
            &format!("fig-{io}-measurement"),
            &title,
            record,
            subject.units,
        ));
    }
    figures.push(step_response(
        &format!("fig-{step}-step-response"),
        &title(step, &format!("step response, {names}")),
        models,
        subject.units,
    ));
    figures.push(bode(
        &format!("fig-{frequency}-frequency-response"),
        &title(frequency, &format!("frequency response, {names}")),
        models,
    ));
    if let Some(run) = subject.first_run() {
        let title = title(
            fit,
            &format!(
                "model against measurement, {names} on {} data",
                subject.name
            ),
        );
        figures.push(validation(
            &format!("fig-{fit}-validation"),
            &title,
            models,
            run,
            subject.units.output,
        ));
    }
    figures
}
