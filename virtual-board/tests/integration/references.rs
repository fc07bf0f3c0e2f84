//! Every reference as the image plays it: the same to the microsecond as the host expands it.

use servoid::data::recording::Ending;
use servoid::instrument::rig::Capture;
use servoid_protocol::reference::{
    MAX_TONES, Multisine, Prbs, Reference, Stairs, Step, Steps, Sweep,
};
use servoid_test_support::virtual_board::{SharedBoard, capture, options, rig_file};

fn references() -> [Reference; 5] {
    let steps = [(120, 9), (-70, 8), (1, 7)].map(|(offset_us, hold_frames)| Step {
        offset_us,
        hold_frames,
    });
    // As many tones as there can be: the most that a frame can cost.
    let multisine = Multisine {
        amplitude_us: 200,
        tone_64ths_us: 0,
        period_frames: 2 * MAX_TONES + 2,
        first: 1,
        spacing: 1,
        tones: MAX_TONES,
        periods: 1,
    };
    [
        Reference::Stairs(Stairs {
            amplitude_us: 60,
            levels: 5,
            hold_frames: 3,
            cycles: 1,
        }),
        Reference::Prbs(Prbs {
            amplitude_us: 50,
            register: 15,
            seed: 12_345,
            chip_frames: 1,
            chips: 60,
        }),
        Reference::Sweep(Sweep {
            amplitude_us: 80,
            first_millihertz: 200,
            last_millihertz: 20_000,
            frames: 80,
        }),
        Reference::Multisine(multisine.with_largest_tones()),
        Reference::Steps(Steps::new(2, &steps).unwrap()),
    ]
}

#[test]
fn the_image_plays_every_reference_as_the_host_expands_it() {
    let board = SharedBoard::new(&options("linear?seed=5", &[]));
    let folder = tempfile::tempdir().unwrap();
    let mut client = board.connect();
    for reference in references() {
        let mut job = Capture::new(rig_file(), reference);
        job.start.pre_roll_frames = 5;
        job.start.post_roll_frames = 5;
        let (end, frames) = capture(&mut client, &job, &folder.path().join("run.csv"));
        assert_eq!(
            end.unwrap().ending,
            Ending::Complete,
            "{}",
            reference.name()
        );
        let neutral = job.rig.servo.neutral_us;
        let expected = (0..job.start.frames())
            .map(|frame| neutral.saturating_add_signed(job.start.offset_us(frame).unwrap()));
        assert!(
            frames.iter().map(|frame| frame.pulse.0).eq(expected),
            "{}",
            reference.name()
        );
    }
    assert_eq!(board.violations(), [""; 0]);
}
