//! The board as a port of this machine, with the host's own ports on the other side.

use clap::Parser as _;
use servoid::commands::Cli;
use servoid::data::dataset::{self, DatasetOptions};
use servoid::data::recording::Ending;
use servoid::instrument::port::Port as _;
use servoid::instrument::rig::Capture;
use servoid::instrument::rig::RigClient;
use servoid_identification::results::Check;
use servoid_protocol::reference::{Reference, Staircase};
use servoid_test_support::virtual_board::{SharedBoard, capture, image, options, staircase};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use virtual_board::server::{HostEnd, Pace, TcpServer, serve};
use virtual_board::{BoardOptions, VirtualBoard};

/// Runs a good board behind `end` while `host` talks to it.
fn with_board(end: impl HostEnd + Send, host: impl FnOnce()) {
    with(&options("linear?seed=1", &[]), end, host);
}

/// Runs a board behind `end` while `host` talks to it.
fn with(options: &BoardOptions, end: impl HostEnd + Send, host: impl FnOnce()) {
    // Not in the thread: building the image may take longer than a host waits.
    serving(VirtualBoard::new(image(), options).unwrap(), end, host);
}

/// Runs `board` behind `end` while `host` talks to it, for 30 s at most; returns it.
pub fn serving(
    mut board: VirtualBoard,
    mut end: impl HostEnd + Send,
    host: impl FnOnce(),
) -> VirtualBoard {
    let done = AtomicBool::new(false);
    let deadline = Instant::now() + Duration::from_secs(30);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let should_stop = || done.load(Ordering::Relaxed) || Instant::now() > deadline;
            serve(
                &mut board,
                &mut end,
                Pace::FASTEST,
                &should_stop,
                &mut |_| {},
            )
            .unwrap();
        });
        // Also where it panics: the board must not go on for ever.
        struct Done<'a>(&'a AtomicBool);
        impl Drop for Done<'_> {
            fn drop(&mut self) {
                self.0.store(true, Ordering::Relaxed);
            }
        }
        let _done = Done(&done);
        host();
    });
    board
}

/// Half a second of reference, with a short rest around it: real time passes here.
fn short_run() -> Capture {
    let mut job = staircase();
    job.start.pre_roll_frames = 5;
    job.start.post_roll_frames = 5;
    job.start.reference = Reference::Staircase(Staircase {
        longest_hold_frames: 10,
        hold_step_frames: 5,
        ..Staircase::PAPER
    });
    job
}

fn capture_at(address: &str, file: &Path) {
    let mut client =
        RigClient::connect(servoid::instrument::port::open(address).unwrap(), address).unwrap();
    let job = short_run();
    let (end, frames) = capture(&mut client, &job, file);
    assert_eq!(end.unwrap().ending, Ending::Complete);
    assert_eq!(frames.len() as u32, job.start.frames());
}

fn two_captures_at(address: &str) {
    let folder = tempfile::tempdir().unwrap();
    for name in ["first.csv", "second.csv"] {
        capture_at(address, &folder.path().join(name));
    }
}

#[test]
fn over_the_network() {
    let server = TcpServer::listen("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", server.address().unwrap());
    with_board(server, || {
        // A host goes, the next one comes.
        two_captures_at(&address);
    });
}

#[cfg(unix)]
#[test]
fn over_a_pseudo_terminal() {
    let terminal = virtual_board::server::PseudoTerminal::open().unwrap();
    let address = terminal.path().display().to_string();
    with_board(terminal, || {
        two_captures_at(&address);
    });
}

/// Runs the program `servoid`.
pub fn servoid(line: &str) -> Result<String, String> {
    let words = std::iter::once("servoid").chain(line.split_whitespace());
    let cli = Cli::try_parse_from(words).unwrap();
    cli.run().map_err(|error| format!("{error:#}"))
}

/// An internal oscillator that is 2.5 % fast makes pulses of 1463 µs for 1500 µs: 3.7 degrees.
#[test]
fn a_board_without_its_crystal_moves_a_servo_only_if_that_is_allowed() {
    let mut options = options("linear?seed=1", &["no-crystal"]);
    options.hsi_error = 0.025;
    let server = TcpServer::listen("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", server.address().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.csv");
    let command = format!("capture --port {address} -o {}", file.display());
    with(&options, server, || {
        let refused = servoid(&command).unwrap_err();
        assert!(refused.contains("crystal"), "{refused}");
        assert!(refused.contains("--inexact-clock"), "{refused}");
        assert!(!file.exists());
        capture_at(&address, &file);
    });
    let data = dataset::load(&[file], &DatasetOptions::default()).unwrap();
    let about = &data.about;
    assert!(about.inexact_clock);
    let checks: Vec<&Check> = about.advice.iter().map(|advice| &advice.check).collect();
    assert_eq!(checks, [&Check::InexactClock]);
}

/// A host that waits until a moment, by its own clock in nanoseconds, gets there.
#[test]
fn the_shortest_wait_takes_time() {
    let board = SharedBoard::new(&options("linear?seed=1", &[]));
    let mut port = board.port();
    let shortest = Duration::from_nanos(1);
    for _ in 0..1_000 {
        let before = port.now();
        if port.read(&mut [0; 16], shortest).unwrap() == 0 {
            assert!(port.now() >= before + shortest);
        }
    }
}
