//! Draws the live scope of a simulated capture into an SVG:
//! `cargo run --example scope_picture -p servoid-benches -- docs/scope.svg`
//!
//! The run is `sim:bench?seed=1`, half of the paper's staircase; equal programs give equal pictures.

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::{Buffer, Cell};
use ratatui::style::{Color, Modifier};
use servoid::data::DegreeScale;
use servoid::data::recording::{Header, RecordingWriter};
use servoid::data::rig_file::RigFile;
use servoid::instrument::live::{Estimator, RunSamples, second_cycle};
use servoid::instrument::port;
use servoid::instrument::rig::{Capture, Progress, RigClient, StopReason};
use servoid::presentation::scope::{FrameSeen, Link, ScopeEvent, ScopeState, draw};
use servoid_identification::Options;
use servoid_protocol::reference::{Reference, Staircase};
use servoid_protocol::timing::{FRAMES_PER_SECOND, SAMPLE_US};
use std::cell::RefCell;
use std::error::Error;
use std::fmt::Write;
use std::sync::Arc;

const ADDRESS: &str = "sim:bench?seed=1";

/// Columns and rows of the terminal.
const SIZE: (u16, u16) = (120, 36);

/// A cell (px), and the text in it.
const CELL: (u32, u32) = (8, 17);
const TEXT_PX: u32 = 13;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args()
        .nth(1)
        .ok_or("name the SVG file to write")?;
    let state = half_of_a_run()?;
    let mut terminal = Terminal::new(TestBackend::new(SIZE.0, SIZE.1))?;
    terminal.draw(|frame| draw(frame, &state))?;
    std::fs::write(path, svg(terminal.backend().buffer()))?;
    Ok(())
}

/// The state of the scope in the middle of the staircase.
fn half_of_a_run() -> Result<ScopeState, Box<dyn Error>> {
    let directory = tempfile::tempdir()?;
    let rig = RigFile::default();
    let capture = Capture::new(rig.clone(), Reference::Staircase(Staircase::PAPER));
    let mut client = RigClient::connect_as(port::open(ADDRESS)?, ADDRESS, 1)?;
    capture.arm(&mut client)?;
    let header = Header::of_run(client.hello(), &rig, &capture.start);
    let file = RecordingWriter::create(&directory.path().join("run.csv"), false, &header)?;

    let title = format!("{ADDRESS}  to bench.csv");
    let state = RefCell::new(ScopeState::new(
        title,
        capture.start,
        capture.rig.train(),
        None,
    ));
    let mut samples = RunSamples::new(&rig, &capture.start);
    let mut estimator = Estimator::new(f64::from(SAMPLE_US) * 1e-6, Options::default());
    let before = u32::from(capture.start.pre_roll_frames);
    let estimate_from = before + second_cycle(&capture.start.reference).unwrap_or(0);
    let half = capture.start.frames() / 2;
    let stop = || (state.borrow().frames > half).then_some(StopReason::User);
    capture.record(&mut client, file, &stop, &mut |progress| {
        let mut state = state.borrow_mut();
        if state.frames > half {
            return;
        }
        state.apply(ScopeEvent::Frame(seen(&rig, &progress)));
        let (input, output) = samples.take(progress.frame);
        if input.is_empty() {
            return;
        }
        estimator.push(&input, &output);
        let index = u32::from(progress.frame.index);
        if index >= estimate_from
            && index.is_multiple_of(FRAMES_PER_SECOND / 2)
            && let Ok(step) = estimator.estimate()
        {
            state.apply(ScopeEvent::Step(Arc::new(step)));
        }
    })?;
    Ok(state.into_inner())
}

fn seen(rig: &RigFile, progress: &Progress<'_>) -> FrameSeen {
    let scale = DegreeScale::of_rig(rig);
    FrameSeen {
        index: progress.frame.index.into(),
        reference_deg: scale.reference(progress.frame.pulse),
        positions_deg: progress.frame.samples.map(|counts| scale.angle(counts)),
        link: Link {
            rejects: progress.rejects,
            asked_again: progress.asked_again,
            lost: progress.lost,
            status: progress.status.copied(),
            stands_still: progress.stands_still.is_some(),
        },
    }
}

/// Text as text, plots as dots: few fonts have Braille patterns of the right width.
fn svg(buffer: &Buffer) -> String {
    let (width, height) = (u32::from(SIZE.0) * CELL.0, u32::from(SIZE.1) * CELL.1);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"DejaVu Sans Mono, Menlo, Consolas, monospace\" font-size=\"{TEXT_PX}\" xml:space=\"preserve\">\n<title>servoid capture: the live scope</title>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#16181d\"/>\n"
    );
    for row in 0..SIZE.1 {
        for column in 0..SIZE.0 {
            draw_cell(
                &mut svg,
                u32::from(column),
                u32::from(row),
                &buffer[(column, row)],
            );
        }
    }
    svg + "</svg>\n"
}

fn draw_cell(svg: &mut String, column: u32, row: u32, cell: &Cell) {
    let (x, y) = (column * CELL.0, row * CELL.1);
    let (mut ink, mut paper) = (css(cell.fg, "#d7dae0"), css(cell.bg, "#16181d"));
    if cell.modifier.contains(Modifier::REVERSED) {
        std::mem::swap(&mut ink, &mut paper);
    }
    let (w, h) = CELL;
    let mut rect = |x: u32, y: u32, w: u32, h: u32, fill: &str| {
        writeln!(svg, "<path d=\"M{x} {y}h{w}v{h}h-{w}z\" fill=\"{fill}\"/>")
            .expect("a string has room");
    };
    if paper != "#16181d" {
        rect(x, y, w, h, paper);
    }
    let symbol = cell.symbol().chars().next().unwrap_or(' ');
    match symbol {
        ' ' => {}
        '█' => rect(x, y, w, h, ink),
        // Two columns of four dots; bits 0 to 2 and 6 are the left one.
        '\u{2800}'..='\u{28ff}' => {
            let bits = u32::from(symbol) - 0x2800;
            let places = [
                (0, 0),
                (0, 1),
                (0, 2),
                (1, 0),
                (1, 1),
                (1, 2),
                (0, 3),
                (1, 3),
            ];
            for (bit, (right, down)) in places.into_iter().enumerate() {
                if bits >> bit & 1 == 1 {
                    rect(x + 1 + 4 * right, y + 1 + 4 * down, 2, 2, ink);
                }
            }
        }
        _ => {
            let text = match symbol {
                '&' => "&amp;".to_owned(),
                '<' => "&lt;".to_owned(),
                other => other.to_string(),
            };
            // The baseline stands three quarters down.
            let base = y + h * 3 / 4;
            writeln!(
                svg,
                "<text x=\"{x}\" y=\"{base}\" fill=\"{ink}\">{text}</text>"
            )
            .expect("a string has room");
        }
    }
}

fn css(color: Color, otherwise: &'static str) -> &'static str {
    match color {
        Color::Yellow => "#e5c07b",
        Color::Cyan => "#56c7d6",
        Color::Magenta => "#c678dd",
        Color::Green => "#98c379",
        Color::Red => "#e06c75",
        Color::Blue => "#4d8fe0",
        Color::Black => "#000000",
        _ => otherwise,
    }
}
