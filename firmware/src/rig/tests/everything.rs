//! Any sequence of events.

use super::*;
use proptest::prelude::*;
use servoid_protocol::pulse_train::PulseType;
use servoid_protocol::reference::{Multisine, Prbs, Stairs, Step, Steps, Sweep};

fn any_command() -> impl Strategy<Value = Command> {
    prop_oneof![
        Just(Command::Unused),
        Just(Command::Hello),
        Just(Command::Status),
        Just(Command::KeepAlive),
        Just(Command::Disarm),
        (0u16..3).prop_map(|run| Command::Stop { run }),
        (0u16..3, any::<u16>(), any::<u16>()).prop_map(|(run, first, count)| Command::Resend {
            run,
            first,
            count
        }),
        (any::<bool>(), 700u16..2_300, 700u16..2_300, 0u16..9).prop_map(
            |(schema, shortest, longest, lease_frames)| {
                Command::Arm(Arm {
                    schema_hash: if schema { SCHEMA_HASH } else { 0 },
                    shortest: PulseWidth(shortest),
                    longest: PulseWidth(longest),
                    lease_frames,
                    ..arm()
                })
            }
        ),
        (any::<bool>(), 0usize..6, 300u16..2_300, 300u16..2_300).prop_map(
            |(narrow, rate, shortest, longest)| {
                let pulses = if narrow {
                    PulseType::Narrow
                } else {
                    PulseType::Wide
                };
                let period_us = [20_000, 10_000, 4_000, 3_004, 1_786, 1_000][rate];
                let [low, high] = [shortest.min(longest), shortest.max(longest)];
                Command::ArmFor(ArmFor {
                    train: PulseTrain { pulses, period_us },
                    arm: Arm {
                        shortest: PulseWidth(low),
                        neutral: PulseWidth(low.midpoint(high)),
                        longest: PulseWidth(high),
                        ..arm()
                    },
                })
            }
        ),
        (0u16..3, 0u16..4, any_reference()).prop_map(|(run, pre_roll_frames, reference)| {
            Command::Start(Start {
                run,
                pre_roll_frames,
                reference,
                post_roll_frames: 1,
            })
        }),
    ]
}

/// Every kind, short ones, sensible or not, within the limits and beyond.
fn any_reference() -> impl Strategy<Value = Reference> {
    let amplitude = || prop_oneof![0u16..700, any::<u16>()];
    let step = (-700i16..700, 0u16..4).prop_map(|(offset_us, hold_frames)| Step {
        offset_us,
        hold_frames,
    });
    prop_oneof![
        (amplitude(), 0u16..4, 0u16..4).prop_map(|(amplitude_us, longest, shortest)| {
            Reference::Staircase(Staircase {
                amplitude_us,
                longest_hold_frames: longest,
                shortest_hold_frames: shortest,
                hold_step_frames: 1,
            })
        }),
        (amplitude(), 0u16..18, 0u16..3).prop_map(|(amplitude_us, levels, hold_frames)| {
            Reference::Stairs(Stairs {
                amplitude_us,
                levels,
                hold_frames,
                cycles: 1,
            })
        }),
        (amplitude(), 0u16..18, any::<u16>(), 0u16..40).prop_map(
            |(amplitude_us, register, seed, chips)| {
                Reference::Prbs(Prbs {
                    amplitude_us,
                    register,
                    seed,
                    chip_frames: 1,
                    chips,
                })
            }
        ),
        (amplitude(), 0u16..30_000, 0u16..30_000, 0u16..40).prop_map(
            |(amplitude_us, first_millihertz, last_millihertz, frames)| {
                Reference::Sweep(Sweep {
                    amplitude_us,
                    first_millihertz,
                    last_millihertz,
                    frames,
                })
            }
        ),
        (amplitude(), any::<u16>(), 0u16..40, 0u16..4, 0u16..20).prop_map(
            |(amplitude_us, tone_64ths_us, period_frames, first, tones)| {
                Reference::Multisine(Multisine {
                    amplitude_us,
                    tone_64ths_us,
                    period_frames,
                    first,
                    spacing: 1,
                    tones,
                    periods: 1,
                })
            }
        ),
        (0u16..3, proptest::collection::vec(step, 0..6)).prop_map(|(repeats, steps)| {
            Reference::Steps(Steps::new(repeats, &steps).expect("it is a short table"))
        }),
    ]
}

#[derive(Clone, Debug)]
enum Event {
    /// Of one session or, now and then, the other.
    Request(u16, Command),
    /// The newest request once more.
    Again,
    Frame {
        late: bool,
        sick: bool,
    },
    Lose(u32),
}

fn any_event() -> impl Strategy<Value = Event> {
    prop_oneof![
        3 => (prop_oneof![9 => Just(1u16), 1 => Just(2u16)], any_command())
            .prop_map(|(session, command)| Event::Request(session, command)),
        1 => Just(Event::Again),
        6 => (prop::bool::weighted(0.1), prop::bool::weighted(0.05))
            .prop_map(|(late, sick)| Event::Frame { late, sick }),
        1 => prop_oneof![0u32..5, any::<u32>()].prop_map(Event::Lose),
    ]
}

proptest! {
    /// Whatever is asked: no pulse while idle, every other pulse within the limits of the last
    /// arming that was accepted and of its train, all of the type of the first arming, and a run that was accepted ends at
    /// most once.
    #[test]
    fn no_sequence_of_events_makes_a_pulse_outside_the_limits(
        events in proptest::collection::vec(any_event(), 0..120),
    ) {
        let mut bench = Bench::connected();
        let mut trains: Vec<PulseTrain> = Vec::new();
        let (mut limits, mut line_before, mut newest, mut starts) = (None, None, (1, Command::Hello), 0);
        for event in events {
            match event {
                Event::Request(session, command) => {
                    bench.id += 1;
                    let outcome = bench.raw_request(session, bench.id, command);
                    newest = (session, command);
                    match (command, outcome) {
                        (Command::Arm(arm), Some(Outcome::Done)) => {
                            limits = Some((arm.shortest, arm.longest));
                            trains.push(PulseTrain::USUAL);
                        }
                        (Command::ArmFor(ArmFor { train, arm }), Some(Outcome::Done)) => {
                            limits = Some((arm.shortest, arm.longest));
                            trains.push(train);
                        }
                        (Command::Start(_), Some(Outcome::Done)) => starts += 1,
                        _ => {}
                    }
                }
                Event::Again => { bench.raw_request(newest.0, bench.id, newest.1); }
                Event::Lose(count) => bench.lose(count),
                Event::Frame { late, sick } => {
                    let applied = if late { line_before } else { bench.on_line };
                    line_before = bench.on_line;
                    let samples = if sick { [SICK; 10] } else { HEALTHY };
                    bench.frame_with(applied, samples);
                    prop_assert!(bench.on_line.is_none() || bench.rig.is_armed());
                    if let Some(pulse) = bench.on_line {
                        let (shortest, longest) = limits.unwrap();
                        prop_assert!((shortest..=longest).contains(&pulse));
                        let train = *trains.last().unwrap();
                        let [shortest, longest] = train.pulses.board_limits();
                        prop_assert!((shortest..=longest).contains(&pulse));
                        prop_assert_eq!((bench.train, train.pulses), (train, trains[0].pulses));
                    }
                }
            }
        }
        prop_assert!(bench.ends().len() <= starts);
        prop_assert!(bench.sent_frames().iter().all(|frame| frame.pulse.0 != 0));
    }
}
