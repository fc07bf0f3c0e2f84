//! The picture of a state: nothing but [`ScopeState`] and the size of the terminal decides it.

use super::panel;
use super::plots;
use super::state::ScopeState;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Style, Stylize};
use ratatui::text::Line;
use ratatui::widgets::{Gauge, Paragraph};

/// Below this size a plot shows nothing that can be read.
const SMALLEST_PLOT: (u16, u16) = (40, 10);

/// From this width on the text stands beside both plots, below it beside the lower one only.
const WIDE: u16 = 110;

/// Columns that the text takes.
const TEXT: u16 = 40;

/// Draws the scope over the whole of `frame`, whatever its size.
pub fn draw(frame: &mut Frame<'_>, state: &ScopeState) {
    let area = frame.area();
    let (width, height) = SMALLEST_PLOT;
    if area.width < width || area.height < height {
        return draw_text_alone(frame, area, state);
    }
    let [title, body, bar, keys] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Fill(1),
        Constraint::Length(1),
        Constraint::Length(1),
    ])
    .areas(area);
    let name = Line::from(format!(" servoid capture  {}", state.title));
    frame.render_widget(name.style(Style::new().bold().reversed()), title);
    draw_body(frame, body, state);
    draw_bar(frame, bar, state);
    frame.render_widget(keys_line(state), keys);
}

fn draw_body(frame: &mut Frame<'_>, area: Rect, state: &ScopeState) {
    if area.width >= WIDE {
        let [left, text] =
            Layout::horizontal([Constraint::Fill(1), Constraint::Length(TEXT)]).areas(area);
        let [upper, lower] = Layout::vertical([Constraint::Fill(1); 2]).areas(left);
        plots::trace(frame, upper, state);
        plots::step(frame, lower, state);
        panel::draw(frame, text, state);
    } else if area.width >= 2 * SMALLEST_PLOT.0 && area.height >= 2 * SMALLEST_PLOT.1 {
        let [upper, lower] = Layout::vertical([Constraint::Fill(1); 2]).areas(area);
        plots::trace(frame, upper, state);
        let [left, text] =
            Layout::horizontal([Constraint::Fill(1), Constraint::Length(TEXT)]).areas(lower);
        plots::step(frame, left, state);
        panel::draw(frame, text, state);
    } else {
        let lines = panel::in_short(state);
        let [upper, lower] =
            Layout::vertical([Constraint::Fill(1), Constraint::Length(lines.len() as u16)])
                .areas(area);
        plots::trace(frame, upper, state);
        frame.render_widget(Paragraph::new(lines), lower);
    }
}

fn draw_bar(frame: &mut Frame<'_>, area: Rect, state: &ScopeState) {
    let label = format!("{:.1} s left", state.left_s());
    let bar = Gauge::default()
        .ratio(state.done())
        .label(label)
        .gauge_style(Style::new().blue().on_black())
        .use_unicode(true);
    frame.render_widget(bar, area);
}

fn keys_line(state: &ScopeState) -> Line<'static> {
    if state.stopping {
        Line::from(" stopping: the servo goes to neutral, the file is closed").yellow()
    } else {
        Line::from(" q or Ctrl-C: stop safely (servo to neutral, file closed, data kept)").dim()
    }
}

/// As many lines as there is room for, the most important first.
fn draw_text_alone(frame: &mut Frame<'_>, area: Rect, state: &ScopeState) {
    let mut lines = panel::in_short(state);
    lines.push(keys_line(state));
    frame.render_widget(Paragraph::new(lines), area);
}
