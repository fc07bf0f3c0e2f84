//! Long walks by chance through what the exhaustive test leaves out, held against the same table:
//! several requests within one frame, signs of life, frames asked for again, requests that come twice
//! or too late.

use super::model::{Ask, MOVES, Move, root};
use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Steps of one walk.
const STEPS: usize = 2_000;
/// Walks that every test run makes, and the 200 000 steps of those that take their time.
const FEW: u32 = 15;
const MANY: u32 = 100;

/// An id so much older than the newest is old, however long another session was open.
const LONG_AGO: u16 = 1_000;

#[derive(Clone, Copy, Debug)]
enum Step {
    /// A move of the exhaustive test, with the frame that follows it.
    WithFrame(Move),
    /// A request, and no frame: the next one comes within the same.
    Within(u16, Ask),
    /// The request before once more, as a host says it whose answer was lost.
    Again,
    /// A request that has been overtaken by newer ones.
    TooLate(u16, Ask),
    Frame,
}

fn any_ask() -> impl Strategy<Value = Ask> {
    prop::sample::select(vec![
        Ask::Hello,
        Ask::Arm,
        Ask::ArmOtherSchema,
        Ask::Start,
        Ask::StartTooFar,
        Ask::Stop,
        Ask::Disarm,
        Ask::KeepAlive,
        Ask::Resend,
    ])
}

/// Mostly the one session, so that runs get somewhere.
fn any_session() -> impl Strategy<Value = u16> {
    prop_oneof![9 => Just(1u16), 1 => Just(2u16)]
}

fn any_step() -> impl Strategy<Value = Step> {
    prop_oneof![
        3 => prop::sample::select(MOVES.to_vec()).prop_map(Step::WithFrame),
        3 => (any_session(), any_ask()).prop_map(|(session, ask)| Step::Within(session, ask)),
        1 => Just(Step::Again),
        1 => (any_session(), any_ask()).prop_map(|(session, ask)| Step::TooLate(session, ask)),
        2 => Just(Step::Frame),
    ]
}

fn walks(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(walks(FEW))]
    #[test]
    fn long_walks_follow_the_table(steps in prop::collection::vec(any_step(), STEPS)) {
        walk(steps)?;
    }
}

proptest! {
    #![proptest_config(walks(MANY))]
    #[test]
    #[ignore = "five seconds: cargo test -p servoid-firmware --lib -- --ignored many_long_walks"]
    fn many_long_walks_follow_the_table(steps in prop::collection::vec(any_step(), STEPS)) {
        walk(steps)?;
    }
}

fn walk(steps: Vec<Step>) -> Result<(), TestCaseError> {
    let mut node = root();
    // Ids before the first one are those of a walk that has begun long ago.
    node.bench.id = 2 * LONG_AGO;
    // The request before: who said it, its id, and its answer.
    let mut before: Option<(u16, u16, Command, Option<Outcome>)> = None;
    for step in steps {
        match step {
            Step::WithFrame(step) => {
                node.make(step);
                before = None;
            }
            Step::Within(session, ask) => {
                let command = node.command(ask);
                let expected = node.expected.clone().ask(session, ask, node.next_run());
                node.ask(session, ask);
                before = Some((session, node.bench.id, command, expected));
            }
            Step::Again => {
                let Some((session, id, command, outcome)) = before else {
                    continue;
                };
                if node.expected.session == Some(session) {
                    node.expected.heard_copy();
                } else if command == Command::Hello {
                    // It may open the session now, where the lease of the other one is over.
                    node.expected.ask(session, Ask::Hello, node.next_run());
                }
                prop_assert_eq!(node.bench.raw_request(session, id, command), outcome);
            }
            Step::TooLate(session, ask) => {
                // A Hello of another session may open it, whatever its id.
                if node.expected.session != Some(session) {
                    continue;
                }
                let (id, command) = (node.bench.id - LONG_AGO, node.command(ask));
                let outcome = node.bench.raw_request(session, id, command);
                prop_assert_eq!(outcome, Some(Outcome::Refused(Refusal::Outdated)));
            }
            Step::Frame => node.frame(HEALTHY),
        }
        node.bench.sent.clear();
    }
    Ok(())
}
