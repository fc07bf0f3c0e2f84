//! The two plots: motion against time, and the step response with its band.

use super::state::{ScopeState, WINDOW_S};
use ratatui::backend::TestBackend;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, Paragraph};
use ratatui::{Frame, Terminal};
use servoid_identification::results::{Bounds, StepResponse};

/// Yellow is the reference, cyan the measured motion, in both plots.
pub(super) const REFERENCE: Color = Color::Yellow;
pub(super) const POSITION: Color = Color::Cyan;
const BAND: Color = Color::Magenta;

/// Room above and below a curve, as part of its range.
const MARGIN: f64 = 0.1;

/// Reference and position against time.
pub(super) fn trace(frame: &mut Frame<'_>, area: Rect, state: &ScopeState) {
    let title = Line::from(vec![
        " ".into(),
        Span::styled("reference", REFERENCE),
        " and ".into(),
        Span::styled("position", POSITION),
        " (deg) against time (s) ".into(),
    ]);
    let points = |value: fn(&super::state::TracePoint) -> f64| -> Vec<(f64, f64)> {
        let points = state.trace.iter().map(|p| (p.time_s, value(p)));
        points.filter(|(_, y)| y.is_finite()).collect()
    };
    let (reference, position) = (points(|p| p.reference_deg), points(|p| p.position_deg));
    let end = state.time_s().max(WINDOW_S);
    let x = [end - WINDOW_S, end];
    let values = reference.iter().chain(&position).map(|(_, y)| *y);
    let y = range(values, [-1.0, 1.0]);
    let curves = vec![curve(&reference, REFERENCE), curve(&position, POSITION)];
    chart(frame, area, title, curves, (x, 1), y);
}

/// The step response with its band, once there is an estimate.
pub(super) fn step(frame: &mut Frame<'_>, area: Rect, state: &ScopeState) {
    let Some(step) = &state.step else {
        let text = " starts with the second cycle of the reference";
        let block = Block::bordered().title(" step response ");
        return frame.render_widget(Paragraph::new(text).block(block), area);
    };
    step_response(frame, area, &step.step, [0.0, 1.0]);
}

/// A step response as text: braille letters in a frame, a line end after each line.
pub fn step_as_text(step: &StepResponse, columns: u16, rows: u16) -> String {
    let Ok(mut terminal) = Terminal::new(TestBackend::new(columns, rows));
    let Ok(_) = terminal.draw(|frame| step_response(frame, frame.area(), step, [0.0; 2]));
    let buffer = terminal.backend().buffer();
    let row = |row: u16| {
        let cells = (0..columns).map(|column| buffer[(column, row)].symbol());
        cells.collect::<String>().trim_end().to_owned() + "\n"
    };
    (0..rows).map(row).collect()
}

/// `least` is what the axis shows whatever the values are.
fn step_response(frame: &mut Frame<'_>, area: Rect, step: &StepResponse, least: [f64; 2]) {
    let line = |values: &[f64]| -> Vec<(f64, f64)> {
        let times = step.time_s.iter().map(|t| 1e3 * t);
        times.zip(values.iter().copied()).collect()
    };
    let value = line(&step.value);
    let mut title = vec![" ".into(), Span::styled("step response", POSITION)];
    let mut edges = Vec::new();
    if let Bounds::Valid(bounds) = &step.bounds {
        let percent = format!("{} % band", 100.0 * bounds.level);
        title.extend([" and its ".into(), Span::styled(percent, BAND)]);
        let whole = &bounds.simultaneous;
        edges.extend([line(&whole.lower), line(&whole.upper)]);
    }
    title.push(", against time (ms) ".into());
    let end = value.last().map_or(1.0, |(t, _)| *t);
    let values = edges.iter().flatten().chain(&value).map(|(_, y)| *y);
    let y = range(values, least);
    let mut curves: Vec<_> = edges.iter().map(|edge| curve(edge, BAND)).collect();
    curves.push(curve(&value, POSITION));
    chart(frame, area, Line::from(title), curves, ([0.0, end], 0), y);
}

/// The range of the values and of `least`, with a margin.
fn range(values: impl Iterator<Item = f64>, least: [f64; 2]) -> [f64; 2] {
    let [low, high] = values.fold(least, |[low, high], y| [low.min(y), high.max(y)]);
    let margin = MARGIN * (high - low);
    [low - margin, high + margin]
}

fn curve(points: &[(f64, f64)], colour: Color) -> Dataset<'_> {
    Dataset::default()
        .marker(Marker::Braille)
        .graph_type(GraphType::Line)
        .style(Style::new().fg(colour))
        .data(points)
}

/// `x` is the range, and the number of decimals of its labels.
fn chart(
    frame: &mut Frame<'_>,
    area: Rect,
    title: Line<'_>,
    curves: Vec<Dataset<'_>>,
    x: ([f64; 2], usize),
    y: [f64; 2],
) {
    // The library places up to three labels correctly.
    let labels = |[low, high]: [f64; 2], decimals: usize| {
        [low, f64::midpoint(low, high), high].map(|value| format!("{value:.decimals$}"))
    };
    // Two digits of the range, and one decimal at least.
    let decimals = (1.5 - (y[1] - y[0]).log10()).ceil().clamp(1.0, 9.0) as usize;
    let (x, x_decimals) = x;
    let chart = Chart::new(curves)
        .block(Block::bordered().title(title))
        .x_axis(Axis::default().bounds(x).labels(labels(x, x_decimals)))
        .y_axis(Axis::default().bounds(y).labels(labels(y, decimals)))
        .legend_position(None);
    frame.render_widget(chart, area);
}
