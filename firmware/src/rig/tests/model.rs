//! Every sequence of six requests, held against the table of states and transitions.
//!
//! The table in the documentation of [`rig`](crate::rig) is written down here once more, as plainly
//! as can be; each node of the tree of all sequences compares the rig with it, and looks at the line.

use super::*;
use servoid_protocol::lease::LEASE_FRAMES;

const LEASE: u16 = 3;
const DEPTH: usize = 6;

/// What may happen next. A frame follows each of them.
pub(super) const MOVES: [Move; 12] = [
    Move::Ask(1, Ask::Hello),
    Move::Ask(2, Ask::Hello),
    Move::Ask(1, Ask::Arm),
    Move::Ask(1, Ask::ArmOtherSchema),
    Move::Ask(1, Ask::Start),
    Move::Ask(1, Ask::StartTooFar),
    Move::Ask(1, Ask::Stop),
    Move::Ask(1, Ask::Disarm),
    Move::Silence,
    Move::Sick,
    Move::Late(Ask::Arm),
    Move::Late(Ask::Start),
];

/// Those in which nothing is held back.
const MOVES_IN_TIME: &[Move] = MOVES.split_at(MOVES.len() - 2).0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Move {
    Ask(u16, Ask),
    /// As long as a lease.
    Silence,
    /// The sensor fails in the frame that follows.
    Sick,
    /// The line holds back what session 1 says, with a copy of its request before, until the host may be gone.
    Late(Ask),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Ask {
    Hello,
    Arm,
    ArmOtherSchema,
    Start,
    StartTooFar,
    Stop,
    Disarm,
    KeepAlive,
    Resend,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Phase {
    Idle,
    Armed,
    /// Frames since the start was accepted.
    Running {
        frames: u16,
    },
    Ended,
}

/// The table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expected {
    pub(super) session: Option<u16>,
    phase: Phase,
    /// Frames since the last sign of life.
    silent: u16,
    /// Frames since the last one that was no copy.
    stale: u16,
    /// The session's newest request was refused because it came too late.
    lapsed: bool,
    /// Number of the last run that was accepted.
    run: Option<u16>,
    healthy: bool,
}

/// One frame longer than a lease: without a sign of life it lapses, with one the run completes.
const RUN_FRAMES: u16 = 4;

fn run_of_four_frames(run: u16) -> Start {
    Start {
        run,
        pre_roll_frames: 1,
        reference: Reference::Staircase(Staircase {
            amplitude_us: 50,
            longest_hold_frames: 1,
            shortest_hold_frames: 1,
            hold_step_frames: 1,
        }),
        post_roll_frames: 1,
    }
}

impl Expected {
    pub(super) fn ask(&mut self, session: u16, ask: Ask, run: u16) -> Option<Outcome> {
        if ask == Ask::Hello {
            if self.is_held_from(session) {
                return None;
            }
            self.session = Some(session);
            self.heard();
            (self.stale, self.lapsed) = (0, false);
            return None;
        }
        if self.session != Some(session) {
            return Some(Outcome::Refused(Refusal::UnknownSession));
        }
        let outcome = self.carry_out(ask, run);
        self.lapsed = outcome == Err(Refusal::LeaseLapsed);
        if !self.lapsed {
            self.heard();
            self.stale = 0;
        }
        Some(outcome.map_or_else(Outcome::Refused, |()| Outcome::Done))
    }

    fn heard(&mut self) {
        self.silent = 0;
    }

    /// A copy of the newest request renews the lease, but does not allow a start.
    pub(super) fn heard_copy(&mut self) {
        if !self.lapsed {
            self.heard();
        }
    }

    /// Whether another session has the rig, and its lease is not over.
    pub(super) fn is_held_from(&self, session: u16) -> bool {
        let others = self.session.is_some_and(|open| open != session);
        others && self.phase != Phase::Idle && self.silent < LEASE
    }

    fn carry_out(&mut self, ask: Ask, run: u16) -> Result<(), Refusal> {
        let running = matches!(self.phase, Phase::Running { .. });
        match ask {
            Ask::Hello | Ask::KeepAlive => {}
            Ask::Arm | Ask::ArmOtherSchema => {
                if running {
                    return Err(Refusal::Running);
                }
                if ask == Ask::ArmOtherSchema {
                    return Err(Refusal::SchemaDiffers);
                }
                if self.stale >= LEASE_FRAMES {
                    return Err(Refusal::LeaseLapsed);
                }
                if !self.healthy {
                    return Err(Refusal::SensorOutOfRange);
                }
                self.phase = Phase::Armed;
            }
            Ask::Start | Ask::StartTooFar => {
                if self.phase == Phase::Idle {
                    return Err(Refusal::NotArmed);
                }
                if running {
                    return Err(Refusal::Running);
                }
                if self.stale >= LEASE {
                    return Err(Refusal::LeaseLapsed);
                }
                if ask == Ask::StartTooFar {
                    return Err(Refusal::BeyondLimits);
                }
                if !self.healthy {
                    return Err(Refusal::SensorOutOfRange);
                }
                self.run = Some(run);
                self.phase = Phase::Running { frames: 0 };
            }
            Ask::Stop | Ask::Resend => {
                if self.run.is_none() {
                    return Err(Refusal::UnknownRun);
                }
                if running && ask == Ask::Stop {
                    self.phase = Phase::Ended;
                }
            }
            Ask::Disarm => self.phase = Phase::Idle,
        }
        Ok(())
    }

    fn frame(&mut self, healthy: bool) {
        self.healthy = healthy;
        self.silent = self.silent.saturating_add(1);
        self.stale = self.stale.saturating_add(1);
        if let Phase::Running { frames } = &mut self.phase {
            *frames += 1;
            // The frame under way at the start is none of the run's.
            if !healthy || self.silent >= LEASE || *frames > RUN_FRAMES {
                self.phase = Phase::Ended;
            }
        }
    }
}

#[derive(Clone)]
pub(super) struct Node {
    pub(super) bench: Bench,
    /// The session of the request before.
    last_session: u16,
    pub(super) expected: Expected,
}

impl Node {
    pub(super) fn make(&mut self, step: Move) {
        match step {
            Move::Ask(session, ask) => self.ask(session, ask),
            Move::Silence => (0..LEASE).for_each(|_| self.frame(HEALTHY)),
            Move::Sick => {}
            Move::Late(ask) => self.ask_late(ask),
        }
        self.frame(if step == Move::Sick {
            [SICK; 10]
        } else {
            HEALTHY
        });
        self.bench.sent.clear();
    }

    pub(super) fn ask(&mut self, session: u16, ask: Ask) {
        let next = self.next_run();
        let command = self.command(ask);
        let expected = self.expected.ask(session, ask, next);
        self.bench.id = self.bench.id.wrapping_add(1);
        let already = self.bench.sent.len();
        self.last_session = session;
        let outcome = self.bench.raw_request(session, self.bench.id, command);
        assert_eq!(outcome, expected, "{ask:?} of session {session}");
        if ask == Ask::Hello {
            // Whoever asks who the rig is hears it.
            let answer = &self.bench.sent[already..];
            assert!(answer.iter().any(|m| matches!(m, RigMessage::Hello(_))));
        }
    }

    /// Session 1 asks, and is heard when it has been silent for longer than any request is valid.
    fn ask_late(&mut self, ask: Ask) {
        // Frames that the board loses cost no time, and are time for a lease.
        let unseen = LEASE_FRAMES - 1;
        self.bench.lose(unseen.into());
        self.expected.silent = self.expected.silent.saturating_add(unseen);
        self.expected.stale = self.expected.stale.saturating_add(unseen);
        if let Phase::Running { frames } = &mut self.expected.phase {
            *frames += unseen;
        }
        self.frame(HEALTHY);
        let copy = self.bench.id;
        if self.expected.session == Some(1) && self.last_session == 1 {
            self.bench.raw_request(1, copy, Command::KeepAlive);
            self.expected.heard_copy();
        }
        self.ask(1, ask);
    }

    /// Another number than the last run's.
    pub(super) fn next_run(&self) -> u16 {
        self.expected.run.unwrap_or(0) + 1
    }

    pub(super) fn command(&self, ask: Ask) -> Command {
        let next = self.next_run();
        // What is asked of a run is asked of the last one.
        let run = next - 1;
        let arm = Arm {
            lease_frames: LEASE,
            ..arm()
        };
        let too_far = Reference::Staircase(Staircase {
            amplitude_us: 101,
            ..Staircase::PAPER
        });
        match ask {
            Ask::Hello => Command::Hello,
            Ask::Arm => Command::Arm(arm),
            Ask::ArmOtherSchema => Command::Arm(Arm {
                schema_hash: !SCHEMA_HASH,
                ..arm
            }),
            Ask::Start => Command::Start(run_of_four_frames(next)),
            Ask::StartTooFar => Command::Start(Start {
                reference: too_far,
                ..run_of_four_frames(next)
            }),
            Ask::Stop => Command::Stop { run },
            Ask::Disarm => Command::Disarm,
            Ask::KeepAlive => Command::KeepAlive,
            Ask::Resend => Command::Resend {
                run,
                first: 0,
                count: 9,
            },
        }
    }

    pub(super) fn frame(&mut self, samples: [Counts; 10]) {
        self.bench.frame_with(self.bench.on_line, samples);
        self.expected.frame(samples == HEALTHY);
        let line = self.bench.on_line;
        let phase = self.expected.phase;
        assert_eq!(line.is_none(), phase == Phase::Idle, "{phase:?}: {line:?}");
        assert_eq!(self.bench.rig.is_armed(), line.is_some());
        if let Some(pulse) = line {
            assert!((PulseWidth(1_400)..=PulseWidth(1_600)).contains(&pulse));
        }
        // What has just ended is at neutral from the very next frame on.
        if !matches!(phase, Phase::Running { .. }) {
            assert!(matches!(line, None | Some(NEUTRAL)), "{phase:?}: {line:?}");
        }
    }
}

fn explore(node: &Node, depth: usize, moves: &[Move], path: &mut Vec<Move>, visited: &mut u64) {
    *visited += 1;
    if depth == 0 {
        return;
    }
    for &step in moves {
        path.push(step);
        let mut next = node.clone();
        let made = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| next.make(step)));
        if let Err(why) = made {
            eprintln!("after {path:?}");
            std::panic::resume_unwind(why);
        }
        explore(&next, depth - 1, moves, path, visited);
        path.pop();
    }
}

pub(super) fn root() -> Node {
    let mut bench = Bench::new();
    bench.frame();
    let expected = Expected {
        session: None,
        phase: Phase::Idle,
        silent: 0,
        stale: 0,
        lapsed: false,
        run: None,
        healthy: true,
    };
    Node {
        bench,
        last_session: 0,
        expected,
    }
}

#[test]
fn all_sequences_of_six_requests_follow_the_table() {
    explore_all(DEPTH, MOVES_IN_TIME);
}

/// One fewer, with requests that a line holds back among them.
#[test]
fn all_sequences_of_five_requests_some_of_them_late_follow_the_table() {
    explore_all(DEPTH - 1, &MOVES);
}

fn explore_all(depth: usize, moves: &[Move]) {
    let mut visited = 0;
    explore(&root(), depth, moves, &mut Vec::new(), &mut visited);
    let all: u64 = (0..=depth as u32)
        .map(|depth| (moves.len() as u64).pow(depth))
        .sum();
    assert_eq!(visited, all);
}
