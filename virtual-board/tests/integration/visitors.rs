//! A second program on the line of a run.

use servoid::data::recording::Ending;
use servoid::instrument::port::Port;
use servoid::instrument::rig::{Capture, RigClient};
use servoid_protocol::framing::{self, Decoder};
use servoid_protocol::message::{Command, Request};
use servoid_protocol::reference::{Reference, Staircase};
use servoid_test_support::virtual_board::{FRAME, SharedBoard, capture, image, options, rig_file};
use std::time::Duration;
use virtual_board::VirtualBoard;
use virtual_board::time::to_duration;

/// Requests of the visitor in a frame: with ten of about twelve bytes each it has half of what the
/// line can carry.
const VISITS_PER_FRAME: u32 = 10;

/// Longest time that a run may take beyond its frames, with arming and its end.
const LATEST: Duration = Duration::from_secs(1);

/// The line of a board, on which somebody else says hello over and over.
struct Besieged {
    board: SharedBoard,
    /// The visitor's session, not that of the host; it comes when the host has armed the rig, which
    /// was anybody's before.
    session: Option<u16>,
    heard: Decoder,
    next: Duration,
    id: u16,
}

impl Besieged {
    fn visit(&mut self) {
        let Some(session) = self.session else {
            return;
        };
        while self.next <= self.board.now() {
            self.next += to_duration(FRAME) / VISITS_PER_FRAME;
            self.id = self.id.wrapping_add(1);
            let request = Request {
                session,
                id: self.id,
                command: Command::Hello,
            };
            let mut wire = [0; framing::MAX_WIRE];
            let wire = framing::encode(&request, &mut wire).unwrap();
            self.board.with(|board| board.write(wire));
        }
    }
}

impl Port for Besieged {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> std::io::Result<usize> {
        self.visit();
        // Short waits, so that the visitor is as regular as the line.
        let visit = to_duration(FRAME) / VISITS_PER_FRAME;
        self.board.read(buffer, timeout.min(visit))
    }

    fn write_all(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        for &byte in bytes {
            let request = self.heard.push::<Request>(byte);
            if let Some(request) = request.filter(|r| matches!(r.command, Command::Arm(_))) {
                self.session = Some(request.session.wrapping_add(1));
            }
        }
        self.board.write_all(bytes)
    }

    fn now(&self) -> Duration {
        self.board.now()
    }
}

#[test]
#[ignore = "ten seconds: cargo test -p virtual-board --test integration -- --ignored a_visitor"]
fn a_visitor_who_floods_the_line_costs_a_run_no_frame() {
    let board = VirtualBoard::new(image(), &options("linear?seed=8", &[])).unwrap();
    let board = SharedBoard::from(board);
    let besieged = Besieged {
        board: board.port(),
        session: None,
        heard: Decoder::new(),
        next: board.port().now(),
        id: 0,
    };
    let mut client = RigClient::connect(Box::new(besieged), "the virtual board").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let job = Capture::new(
        rig_file(),
        Reference::Staircase(Staircase {
            longest_hold_frames: 20,
            ..Staircase::PAPER
        }),
    );
    let begin = board.port().now();
    let (end, frames) = capture(&mut client, &job, &folder.path().join("run.csv"));
    let end = end.unwrap();
    assert_eq!(end.ending, Ending::Complete);
    assert_eq!(end.asked_again, 0);
    let frames = u32::try_from(frames.len()).unwrap();
    assert!(frames * VISITS_PER_FRAME > 1_000, "{frames}");
    // The board remembers more frames than this run has, so one that it cannot send in time is not lost but late.
    let late = (board.port().now() - begin).saturating_sub(frames * to_duration(FRAME));
    assert!(late < LATEST, "{late:?}");
    assert_eq!(client.status().unwrap().frames_lost_on_board, 0);
    assert_eq!(board.violations(), [""; 0]);
}
