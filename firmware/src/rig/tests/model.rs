//! Every sequence of six requests, held against the table of states and transitions.
//!
//! The table in the documentation of [`rig`](crate::rig) is written down here once more, as plainly
//! as can be; each node of the tree of all sequences compares the rig with it, and looks at the line.

use super::*;

const LEASE: u16 = 3;
const DEPTH: usize = 6;

/// What may happen next. A frame follows each of them.
pub(super) const MOVES: [Move; 10] = [
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
];

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Move {
    Ask(u16, Ask),
    /// As long as a lease.
    Silence,
    /// The sensor fails in the frame that follows.
    Sick,
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
            return None;
        }
        if self.session != Some(session) {
            return Some(Outcome::Refused(Refusal::UnknownSession));
        }
        let outcome = self.carry_out(ask, run);
        self.heard();
        Some(outcome.map_or_else(Outcome::Refused, |()| Outcome::Done))
    }

    pub(super) fn heard(&mut self) {
        self.silent = 0;
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
    pub(super) expected: Expected,
}

impl Node {
    pub(super) fn make(&mut self, step: Move) {
        match step {
            Move::Ask(session, ask) => self.ask(session, ask),
            Move::Silence => (0..LEASE).for_each(|_| self.frame(HEALTHY)),
            Move::Sick => {}
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
        let outcome = self.bench.raw_request(session, self.bench.id, command);
        assert_eq!(outcome, expected, "{ask:?} of session {session}");
        if ask == Ask::Hello {
            // Whoever asks who the rig is hears it.
            let answer = &self.bench.sent[already..];
            assert!(answer.iter().any(|m| matches!(m, RigMessage::Hello(_))));
        }
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

fn explore(node: &Node, depth: usize, path: &mut Vec<Move>, visited: &mut u64) {
    *visited += 1;
    if depth == 0 {
        return;
    }
    for step in MOVES {
        path.push(step);
        let mut next = node.clone();
        let made = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| next.make(step)));
        if let Err(why) = made {
            eprintln!("after {path:?}");
            std::panic::resume_unwind(why);
        }
        explore(&next, depth - 1, path, visited);
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
        run: None,
        healthy: true,
    };
    Node { bench, expected }
}

#[test]
fn all_sequences_of_six_requests_follow_the_table() {
    let root = root();
    let mut visited = 0;
    explore(&root, DEPTH, &mut Vec::new(), &mut visited);
    let all: u64 = (0..=DEPTH as u32)
        .map(|depth| (MOVES.len() as u64).pow(depth))
        .sum();
    assert_eq!(visited, all);
}
