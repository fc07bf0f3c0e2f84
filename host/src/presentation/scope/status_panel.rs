//! The numbers beside the plots.

use super::charts::{POSITION, REFERENCE};
use super::state::{Phase, ScopeState};
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style, Stylize};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Paragraph, Wrap};
use servoid_identification::results::Bounds;
use servoid_protocol::timing::SAMPLES_PER_FRAME;

/// The whole panel, 40 columns wide. Where the height is too small, the lowest lines are cut off.
pub(super) fn draw(frame: &mut Frame<'_>, area: Rect, state: &ScopeState) {
    // The borders take two lines.
    let room = usize::from(area.height.saturating_sub(2));
    let mut lines = band(state);
    let (run, link) = (run(state), link(state));
    if lines.len() + run.len() + link.len() > room {
        // The history of the band matters least.
        lines.truncate(2);
    }
    let spaced = lines.len() + run.len() + link.len() + 2 <= room;
    for part in [run, link] {
        if spaced {
            lines.push(Line::default());
        }
        lines.extend(part);
    }
    let block = Block::bordered().title(" run and link ");
    frame.render_widget(
        Paragraph::new(lines)
            .wrap(Wrap { trim: false })
            .block(block),
        area,
    );
}

/// Four lines for a small terminal.
pub(super) fn in_short(state: &ScopeState) -> Vec<Line<'static>> {
    let link = &state.link;
    vec![
        Line::from(format!(
            "{:.1} s left, frame {} of {}",
            state.left_s(),
            state.frames,
            state.frames_total()
        )),
        motion(state),
        Line::from(format!(
            "unreadable {}, again {}, lost {}",
            link.rejects.total(),
            link.asked_again,
            link.lost
        ))
        .style(health(link.rejects.total() + link.lost)),
        band(state).swap_remove(0),
    ]
}

fn run(state: &ScopeState) -> Vec<Line<'static>> {
    let samples = |frames: u32| u64::from(frames) * SAMPLES_PER_FRAME as u64;
    let phase = match state.phase() {
        Phase::RestBefore => "rest before the reference",
        Phase::Reference => "the reference",
        Phase::RestAfter => "rest after the reference",
    };
    vec![
        Line::from(format!("{:.1} s left, {phase}", state.left_s())),
        Line::from(format!(
            "frame {} of {}, sample {} of {}",
            state.frames,
            state.frames_total(),
            samples(state.frames),
            samples(state.frames_total())
        )),
        motion(state),
    ]
}

fn motion(state: &ScopeState) -> Line<'static> {
    let Some(newest) = state.trace.back() else {
        return Line::from("no frame yet");
    };
    Line::from(vec![
        Span::styled(format!("ref {:+.1}", newest.reference_deg), REFERENCE),
        Span::styled(format!("  pos {:+.2} deg", newest.position_deg), POSITION),
    ])
}

fn link(state: &ScopeState) -> Vec<Line<'static>> {
    let link = &state.link;
    let rejects = link.rejects;
    let mut lines = vec![
        Line::from(format!(
            "frames asked again {}, lost {}",
            link.asked_again, link.lost
        ))
        .style(health(link.lost)),
    ];
    if let Some(status) = &link.status {
        lines.push(Line::from(format!(
            "rig: at most {} frames waited,",
            status.backlog_high_water
        )));
        lines.push(
            Line::from(format!(
                "  {} lost on board, {} unreadable",
                status.frames_lost_on_board, status.rejects
            ))
            .style(health(status.frames_lost_on_board + status.rejects)),
        );
    }
    lines.extend([
        Line::from(format!(
            "unreadable {}: CRC {}, malformed {},",
            rejects.total(),
            rejects.crc,
            rejects.malformed
        ))
        .style(health(rejects.total())),
        Line::from(format!(
            " too long {}, unknown {}, left over {}",
            rejects.too_long, rejects.unknown, rejects.left_over
        ))
        .style(health(rejects.total())),
    ]);
    lines
}

fn band(state: &ScopeState) -> Vec<Line<'static>> {
    let Some(step) = &state.step else {
        let wanted = match state.until_percent {
            Some(percent) => format!("band: none yet; run ends at ±{percent} %"),
            None => "band: none yet".to_owned(),
        };
        return vec![Line::from(wanted)];
    };
    let Bounds::Valid(bounds) = &step.step.bounds else {
        return vec![Line::from("no band: see 'servoid identify'").red().bold()];
    };
    let width = 100.0 * bounds.widest_half_width();
    let first = if state.enough() {
        Line::from(format!("done: the band is ±{width:.2} %")).green()
    } else if let Some(percent) = state.until_percent {
        Line::from(format!("band ±{width:.2} %, run ends at ±{percent} %"))
    } else {
        Line::from(format!("band ±{width:.2} %"))
    };
    let history: Vec<String> = state.widths.iter().map(|w| format!("{w:.1}")).collect();
    vec![
        first.bold(),
        Line::from(format!(
            "  of the step, whole curve, {:.0} %",
            100.0 * bounds.level
        )),
        Line::from(format!("  before: ±{} %", history.join(" "))),
    ]
}

/// Red where something went wrong.
fn health(faults: u32) -> Style {
    if faults > 0 {
        Style::new().fg(Color::Red)
    } else {
        Style::new()
    }
}
