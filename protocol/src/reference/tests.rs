//! What holds for every reference.

use super::*;
use crate::framing;
use crate::message::{Command, Request, Start};
use proptest::prelude::*;

/// The paper's sentence, spelled out frame by frame.
fn paper_by_hand() -> Vec<i16> {
    let mut offsets = Vec::new();
    for hold_ms in [800, 700, 600, 500, 400, 300, 200, 100] {
        for sign in [1, -1] {
            offsets.extend(std::iter::repeat_n(sign * 50, hold_ms / 20));
        }
    }
    offsets
}

#[test]
fn the_paper_staircase_is_the_papers() {
    let reference = Reference::Staircase(Staircase::PAPER);
    assert!(reference.offsets_us().eq(paper_by_hand()));
    assert_eq!(reference.frames(), 360);
    assert_eq!(reference.extremes_us(), (-50, 50));
}

/// Any message, sensible or not. Small numbers are as likely as any.
fn any_reference() -> impl Strategy<Value = Reference> {
    let number = || prop_oneof![0u16..20, 0u16..700, any::<u16>()];
    let step =
        (prop_oneof![-600i16..600, any::<i16>()], number()).prop_map(|(offset_us, hold)| Step {
            offset_us,
            hold_frames: hold,
        });
    prop_oneof![
        [number(), number(), number(), number()].prop_map(|[a, b, c, d]| Reference::Staircase(
            Staircase {
                amplitude_us: a,
                longest_hold_frames: b,
                shortest_hold_frames: c,
                hold_step_frames: d,
            }
        )),
        [number(), number(), number(), number()].prop_map(|[a, b, c, d]| Reference::Stairs(
            Stairs {
                amplitude_us: a,
                levels: b,
                hold_frames: c,
                cycles: d,
            }
        )),
        [number(), number(), number(), number(), number()].prop_map(|[a, b, c, d, e]| {
            Reference::Prbs(Prbs {
                amplitude_us: a,
                register: b,
                seed: c,
                chip_frames: d,
                chips: e,
            })
        }),
        [number(), number(), number(), number()].prop_map(|[a, b, c, d]| Reference::Sweep(Sweep {
            amplitude_us: a,
            first_millihertz: b,
            last_millihertz: c,
            frames: d,
        })),
        (
            [number(), number(), number()],
            [number(), number(), number(), number()]
        )
            .prop_map(|([a, b, c], [d, e, f, g])| Reference::Multisine(Multisine {
                amplitude_us: a,
                tone_64ths_us: b,
                period_frames: c,
                first: d,
                spacing: e,
                tones: f,
                periods: g,
            })),
        (number(), proptest::collection::vec(step, 0..=MAX_STEPS))
            .prop_map(|(repeats, steps)| Reference::Steps(Steps::new(repeats, &steps).unwrap())),
    ]
}

/// Frames looked at one by one: a run can have no more.
const LONGEST_RUN: u32 = u16::MAX as u32;

proptest! {
    // Each case may be as long as the longest run.
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn length_expansion_and_extremes_agree(reference in any_reference()) {
        let frames = reference.frames();
        let expanded: Vec<i16> = reference.offsets_us().take(LONGEST_RUN as usize).collect();
        prop_assert_eq!(expanded.len() as u32, frames.min(LONGEST_RUN));
        prop_assert_eq!(reference.offset_us(frames), None);
        prop_assert_eq!(frames > 0, reference.offset_us(0).is_some());
        let (low, high) = reference.extremes_us();
        prop_assert!(expanded.iter().all(|offset| (low..=high).contains(offset)));
        if reference.is_well_formed() {
            prop_assert!(frames > 0 && (low < 0 || high > 0));
        }
    }

}

proptest! {
    #[test]
    fn far_beyond_its_end_there_is_nothing_and_no_panic(reference in any_reference(), frame in any::<u32>()) {
        prop_assert_eq!(reference.offset_us(frame).is_some(), frame < reference.frames());
    }

    #[test]
    fn every_reference_fits_a_message_and_comes_back(reference in any_reference(), run in any::<u16>()) {
        let request = start(reference, run);
        let mut buffer = [0; framing::MAX_WIRE];
        let wire = framing::encode(&request, &mut buffer).unwrap();
        let mut decoder = framing::Decoder::new();
        let read: Vec<Request> = wire.iter().filter_map(|&byte| decoder.push(byte)).collect();
        prop_assert_eq!(read, [request]);
    }
}

fn start(reference: Reference, number: u16) -> Request {
    Request {
        session: number,
        id: number,
        command: Command::Start(Start {
            run: number,
            pre_roll_frames: number,
            reference,
            post_roll_frames: number,
        }),
    }
}

#[test]
fn the_longest_table_leaves_no_room_for_another_step() {
    let step = Step {
        offset_us: i16::MIN,
        hold_frames: u16::MAX,
    };
    let steps = Steps::new(u16::MAX, &[step; MAX_STEPS]).unwrap();
    let request = start(Reference::Steps(steps), u16::MAX);
    let mut buffer = [0; framing::MAX_PAYLOAD];
    let length = framing::to_payload(&request, &mut buffer).unwrap().len();
    let of_a_step = postcard::to_slice(&step, &mut [0; 16]).unwrap().len();
    assert!(length + of_a_step > framing::MAX_PAYLOAD, "{length} bytes");
    assert_eq!(Steps::new(1, &[step; MAX_STEPS + 1]), None);
}

#[test]
fn what_makes_no_sense_is_not_well_formed() {
    let stairs = Stairs {
        amplitude_us: 50,
        levels: 5,
        hold_frames: 15,
        cycles: 1,
    };
    let prbs = Prbs {
        amplitude_us: 50,
        register: 9,
        seed: 1,
        chip_frames: 1,
        chips: 511,
    };
    let sweep = Sweep {
        amplitude_us: 50,
        first_millihertz: 100,
        last_millihertz: 25_000,
        frames: 500,
    };
    let multisine = Multisine {
        amplitude_us: 50,
        tone_64ths_us: 1,
        period_frames: 255,
        first: 1,
        spacing: 1,
        tones: 127,
        periods: 1,
    };
    let step = |offset_us, hold_frames| Step {
        offset_us,
        hold_frames,
    };
    let steps = |repeats, table: &[Step]| Reference::Steps(Steps::new(repeats, table).unwrap());
    for good in [
        Reference::Stairs(stairs),
        Reference::Prbs(prbs),
        Reference::Sweep(sweep),
        Reference::Multisine(multisine),
        steps(1, &[step(0, 5), step(9, 5)]),
    ] {
        assert!(good.is_well_formed(), "{good:?}");
    }
    for bad in [
        Reference::Stairs(Stairs {
            levels: 1,
            ..stairs
        }),
        Reference::Stairs(Stairs {
            levels: 17,
            ..stairs
        }),
        // Five levels within two microseconds.
        Reference::Stairs(Stairs {
            amplitude_us: 1,
            ..stairs
        }),
        Reference::Stairs(Stairs {
            cycles: 0,
            ..stairs
        }),
        Reference::Prbs(Prbs { seed: 0, ..prbs }),
        Reference::Prbs(Prbs { seed: 512, ..prbs }),
        Reference::Prbs(Prbs {
            register: 16,
            ..prbs
        }),
        Reference::Prbs(Prbs {
            register: 1,
            ..prbs
        }),
        Reference::Sweep(Sweep {
            last_millihertz: 25_001,
            ..sweep
        }),
        Reference::Sweep(Sweep {
            first_millihertz: 0,
            last_millihertz: 0,
            ..sweep
        }),
        // The highest tone would be at half the frame rate.
        Reference::Multisine(Multisine {
            period_frames: 254,
            ..multisine
        }),
        Reference::Multisine(Multisine {
            tone_64ths_us: 0,
            ..multisine
        }),
        Reference::Multisine(Multisine {
            spacing: 0,
            ..multisine
        }),
        Reference::Multisine(Multisine {
            first: 0,
            ..multisine
        }),
        steps(1, &[step(0, 5)]),
        steps(0, &[step(9, 5)]),
        steps(1, &[step(9, 5), step(0, 0), step(9, 5)]),
    ] {
        assert!(!bad.is_well_formed(), "{bad:?}");
    }
}
