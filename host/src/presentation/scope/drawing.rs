//! The picture of a [`ScopeState`] on a terminal of any size.

use super::state::ScopeState;
use super::status_panel;
use super::terminal_plots;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Style, Stylize};
use ratatui::text::Line;
use ratatui::widgets::{Gauge, Paragraph};

/// Smallest plot that can be read (columns, rows).
const SMALLEST_PLOT: (u16, u16) = (40, 10);

/// From this width on (columns) the text is beside both plots; below it, beside the lower one.
const WIDE: u16 = 110;

/// Width of the text (columns).
const TEXT: u16 = 40;

/// Height of the text without the band's history, with its borders (rows).
const PANEL: u16 = 12;

/// Draws the scope over the whole of `frame`, whatever its size.
pub fn draw(frame: &mut Frame<'_>, state: &ScopeState) {
    let area = frame.area();
    let (width, height) = SMALLEST_PLOT;
    if area.width < width || area.height < height {
        // The most important line first.
        let mut lines = status_panel::in_short(state);
        lines.push(keys_line(state));
        return frame.render_widget(Paragraph::new(lines), area);
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
        terminal_plots::trace(frame, upper, state);
        terminal_plots::step(frame, lower, state);
        status_panel::draw(frame, text, state);
    } else if area.width >= 2 * SMALLEST_PLOT.0 && area.height >= 2 * SMALLEST_PLOT.1 {
        let rows = PANEL.max(area.height / 2);
        let [upper, lower] =
            Layout::vertical([Constraint::Fill(1), Constraint::Length(rows)]).areas(area);
        terminal_plots::trace(frame, upper, state);
        let [left, text] =
            Layout::horizontal([Constraint::Fill(1), Constraint::Length(TEXT)]).areas(lower);
        terminal_plots::step(frame, left, state);
        status_panel::draw(frame, text, state);
    } else {
        let lines = status_panel::in_short(state);
        let [upper, lower] =
            Layout::vertical([Constraint::Fill(1), Constraint::Length(lines.len() as u16)])
                .areas(area);
        terminal_plots::trace(frame, upper, state);
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
        Line::from(" stopping: the servo goes to neutral, then the file is closed").yellow()
    } else {
        Line::from(" q or Ctrl-C: stop safely (servo to neutral, file closed, data kept)").dim()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instrument::live::LiveStep;
    use crate::instrument::rig::roll_frames;
    use crate::presentation::scope::{FrameSeen, Link, ScopeEvent};
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;
    use servoid_identification::results::{
        Bounds, PointwiseBand, SimultaneousBand, StepBounds, StepResponse,
    };
    use servoid_protocol::Counts;
    use servoid_protocol::message::{Activity, Start, Status};
    use servoid_protocol::reference::{Reference, Staircase};
    use servoid_protocol::timing::SAMPLES_PER_FRAME;
    use servoid_protocol::{PulseTrain, Rejects};
    use std::sync::Arc;

    fn empty() -> ScopeState {
        let start = Start {
            run: 1,
            pre_roll_frames: roll_frames(PulseTrain::USUAL),
            reference: Reference::Staircase(Staircase::PAPER),
            post_roll_frames: roll_frames(PulseTrain::USUAL),
        };
        ScopeState::new("sim:bench".to_owned(), start, PulseTrain::USUAL, Some(1.0))
    }

    /// After 200 of 440 frames, with a fault of each class and a band of ±0.5 %.
    fn in_the_middle() -> ScopeState {
        let mut state = empty();
        let rejects = Rejects {
            crc: 11,
            malformed: 12,
            too_long: 13,
            unknown: 14,
            left_over: 15,
        };
        let link = Link {
            rejects,
            asked_again: 16,
            lost: 17,
            stands_still: false,
            status: Some(Status {
                activity: Activity::Armed,
                sensor: Counts(8192),
                frames_since_start: 200,
                frames_lost_on_board: 19,
                rejects: 20,
                backlog_high_water: 18,
            }),
        };
        for index in 0..200 {
            state.apply(ScopeEvent::Frame(FrameSeen {
                index,
                reference_deg: 5.0,
                positions_deg: [4.25; SAMPLES_PER_FRAME],
                link,
            }));
        }
        let value: Vec<f64> = (0..60)
            .map(|k| 1.0 - (-f64::from(k) / 10.0).exp())
            .collect();
        let beside = |distance: f64| value.iter().map(|g| g + distance).collect::<Vec<f64>>();
        let (lower, upper) = (beside(-0.005), beside(0.005));
        let bounds = StepBounds {
            level: 0.99,
            sd: vec![0.001; value.len()],
            pointwise: PointwiseBand {
                lower: lower.clone(),
                upper: upper.clone(),
            },
            simultaneous: SimultaneousBand {
                critical_value: 2.58,
                lower,
                upper,
            },
            truncation_bias: 0.0024,
            rounding_bias: 0.0,
        };
        state.apply(ScopeEvent::Step(Arc::new(LiveStep {
            samples: 1600,
            step: StepResponse::new(0.002, value, Bounds::Valid(bounds)),
        })));
        state
    }

    fn picture(state: &ScopeState, width: u16, height: u16) -> String {
        let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
        terminal.draw(|frame| draw(frame, state)).unwrap();
        // TestBackend's own text of an empty buffer divides it into rows of no cells.
        if width == 0 {
            return String::new();
        }
        terminal.backend().to_string()
    }

    #[test]
    fn what_matters_is_on_a_common_and_on_a_large_terminal() {
        let state = in_the_middle();
        for (width, height) in [(80, 24), (120, 40)] {
            let picture = picture(&state, width, height);
            for text in [
                "sim:bench",
                "(deg) against time (s)",
                "step response",
                "done: the band is ±0.50 %",
                "4.8 s left",
                "frame 200 of 440, sample 2000 of 4400",
                "ref +5.0",
                "pos +4.25 deg",
                "unreadable 65: CRC 11, malformed 12",
                "too long 13, unknown 14, left over 15",
                "asked again 16, lost 17",
                "frames waited, at most 18",
                "19 lost on board, 20 unreadable",
                "q or Ctrl-C",
            ] {
                assert!(
                    picture.contains(text),
                    "{text} at {width}x{height}:\n{picture}"
                );
            }
        }
    }

    #[test]
    fn a_small_terminal_has_the_counters_and_the_band() {
        let picture = picture(&in_the_middle(), 40, 12);
        for text in ["4.8 s left, frame 200 of 440", "unreadable 65", "done"] {
            assert!(picture.contains(text), "{text}:\n{picture}");
        }
    }

    #[test]
    fn no_size_is_too_small() {
        for state in [empty(), in_the_middle()] {
            for width in [0, 1, 2, 3, 39, 40, 41, 79, 80, 109, 110, 360] {
                for height in [0, 1, 2, 9, 10, 11, 19, 20, 21] {
                    let _picture = picture(&state, width, height);
                }
            }
        }
    }
}
