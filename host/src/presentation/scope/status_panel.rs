//! The numbers beside the plots.

use super::state::{Link, Phase, ScopeState};
use super::terminal_plots::{POSITION, REFERENCE};
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Stylize};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Paragraph, Wrap};
use servoid_identification::results::Bounds;
use servoid_protocol::Rejects;
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
    let text = Paragraph::new(lines).wrap(Wrap { trim: false });
    frame.render_widget(text.block(block), area);
}

/// Four lines for a small terminal.
pub(super) fn in_short(state: &ScopeState) -> Vec<Line<'static>> {
    let (left, total, frames) = (state.left_s(), state.frames_total(), state.frames);
    let Link {
        rejects,
        asked_again,
        lost,
        ..
    } = state.link;
    let unreadable = rejects.total();
    vec![
        Line::from(format!("{left:.1} s left, frame {frames} of {total}")),
        motion(state),
        counted(
            unreadable + lost,
            format!("unreadable {unreadable}, again {asked_again}, lost {lost}"),
        ),
        band(state).swap_remove(0),
    ]
}

fn run(state: &ScopeState) -> Vec<Line<'static>> {
    let phase = match state.phase() {
        Phase::RestBefore => "rest before the reference",
        Phase::Reference => "the reference",
        Phase::RestAfter => "rest after the reference",
    };
    let (left, [frame, frames]) = (state.left_s(), [state.frames, state.frames_total()]);
    let [sample, samples] = [frame, frames].map(|n| u64::from(n) * SAMPLES_PER_FRAME as u64);
    let progress = format!("frame {frame} of {frames}, sample {sample} of {samples}");
    vec![
        Line::from(format!("{left:.1} s left, {phase}")),
        Line::from(progress),
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
    let Link {
        rejects,
        asked_again,
        lost,
        status,
        stands_still,
    } = state.link;
    let mut lines = vec![counted(
        lost,
        format!("frames asked again {asked_again}, lost {lost}"),
    )];
    if stands_still {
        lines.insert(
            0,
            counted(1, "THE SENSOR'S READING STANDS STILL".to_owned()),
        );
    }
    if let Some(status) = status {
        let (waited, unreadable) = (status.backlog_high_water, status.rejects);
        let lost = status.frames_lost_on_board;
        lines.push(Line::from(format!("rig: frames waited, at most {waited};")));
        let counters = format!("  {lost} lost on board, {unreadable} unreadable");
        lines.push(counted(lost + unreadable, counters));
    }
    let Rejects {
        crc,
        malformed,
        too_long,
        unknown,
        left_over,
    } = rejects;
    let all = rejects.total();
    let (first, second) = (
        format!("unreadable {all}: CRC {crc}, malformed {malformed},"),
        format!(" too long {too_long}, unknown {unknown}, left over {left_over}"),
    );
    lines.extend([counted(all, first), counted(all, second)]);
    lines
}

fn band(state: &ScopeState) -> Vec<Line<'static>> {
    let Some(step) = &state.step else {
        let end = state
            .until_percent
            .map(|percent| format!("; run ends at ±{percent} %"));
        return vec![Line::from(format!(
            "band: none yet{}",
            end.unwrap_or_default()
        ))];
    };
    let bounds = match &step.step.bounds {
        Bounds::Valid(bounds) => bounds,
        Bounds::Withdrawn(reason) => {
            let because = reason.because();
            return vec![Line::from(format!("no band: {because}")).red().bold()];
        }
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
    let level = 100.0 * bounds.level;
    vec![
        first.bold(),
        Line::from(format!("  of the step, whole curve, {level:.0} %")),
        Line::from(format!("  before: ±{} %", history.join(" "))),
    ]
}

/// Counters, red where there are faults.
fn counted(faults: u32, text: String) -> Line<'static> {
    let line = Line::from(text);
    if faults > 0 {
        line.fg(Color::Red)
    } else {
        line
    }
}
