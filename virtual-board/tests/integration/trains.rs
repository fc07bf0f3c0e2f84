//! Other pulses than the usual ones: their edges and the samples, tick by tick, and what no servo may get.

use servoid::data::recording::Ending;
use servoid::data::rig_file::{PulseTypeName, RigFile};
use servoid::instrument::rig::{Capture, RigClient};
use servoid_protocol::message::Command;
use servoid_protocol::pulse_train::PulseType;
use servoid_protocol::reference::{Reference, Staircase};
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_protocol::{Frame, PulseTrain};
use servoid_test_support::virtual_board::{OVERSAMPLING, SharedBoard, capture, options, rig_file};
use std::time::Duration;
use virtual_board::record::{Conversion, Pulse};
use virtual_board::time::{Ticks, microseconds};

/// How long a conversion takes: 252 cycles of 12 MHz.
const CONVERSION: Ticks = microseconds(21);

/// The three cycles of 12 MHz that the ADC takes to hear its trigger.
const TRIGGER: Ticks = microseconds(1) / 4;

/// A rig whose servo takes these pulses.
fn rig(pulse_type: PulseTypeName, pulse_rate_hz: f64) -> RigFile {
    let mut rig = rig_file();
    rig.servo.pulse_type = pulse_type;
    rig.servo.pulse_rate_hz = pulse_rate_hz;
    if pulse_type == PulseTypeName::Narrow {
        (rig.servo.neutral_us, rig.servo.us_per_degree) = (750, 5.0);
        (rig.limits.shortest_us, rig.limits.longest_us) = (650, 850);
    }
    rig
}

/// A short staircase, within a second.
fn short(rig: RigFile) -> Capture {
    let amplitude_us = (5.0 * rig.servo.us_per_degree) as u16;
    let staircase = Staircase {
        amplitude_us,
        longest_hold_frames: 3,
        shortest_hold_frames: 1,
        hold_step_frames: 1,
    };
    let mut capture = Capture::new(rig, Reference::Staircase(staircase));
    (
        capture.start.pre_roll_frames,
        capture.start.post_roll_frames,
    ) = (4, 4);
    capture
}

/// Every sample and every pulse since the first pulse, on one grid to the tick; the number of the sample at the first edge.
fn assert_on_the_grid(pulses: &[Pulse], conversions: &[Conversion], train: PulseTrain) -> usize {
    let begin = pulses[0].rise;
    let period = microseconds(train.period_us.into());
    for (n, pulse) in pulses.iter().enumerate() {
        assert_eq!(pulse.rise, begin + n as Ticks * period, "pulse {n}");
    }
    let first = conversions.iter().position(|c| c.start > begin).unwrap();
    assert_eq!(first % OVERSAMPLING, 0, "a sample is cut");
    let sample = microseconds(train.sample_us().into());
    let phase = microseconds(train.first_sample_us().into()) + TRIGGER;
    let end = pulses.last().unwrap().rise + period;
    for (n, conversion) in conversions[first..]
        .iter()
        .take_while(|c| c.start < end)
        .enumerate()
    {
        let (k, part) = (n / OVERSAMPLING, n % OVERSAMPLING);
        let expected = begin + phase + k as Ticks * sample + part as Ticks * CONVERSION;
        assert_eq!(conversion.start, expected, "conversion {n}");
    }
    first / OVERSAMPLING
}

/// The stream is what the models saw: the run begins a whole number of frames after the first pulse.
fn assert_true(frames: &[Frame], pulses: &[Pulse], codes: &[u16], train: PulseTrain) {
    let per_frame = usize::from(train.pulses_per_frame());
    let fits = |start: usize| {
        frames.iter().enumerate().all(|(n, frame)| {
            let number = start + n;
            let widths = pulses.get(number * per_frame..(number + 1) * per_frame);
            let sums = codes.get(number * SAMPLES_PER_FRAME..(number + 1) * SAMPLES_PER_FRAME);
            let width = microseconds(frame.pulse.0.into());
            widths.is_some_and(|pulses| pulses.iter().all(|pulse| pulse.width == width))
                && sums == Some(frame.samples.map(|counts| counts.0).as_slice())
        })
    };
    let places: Vec<usize> = (0..pulses.len() / per_frame).filter(|&n| fits(n)).collect();
    assert_eq!(places.len(), 1, "places that the stream fits: {places:?}");
}

fn run(board: &SharedBoard, client: &mut RigClient, job: &Capture) -> Vec<Frame> {
    let folder = tempfile::tempdir().unwrap();
    let (end, frames) = capture(client, job, &folder.path().join("run.csv"));
    let end = end.unwrap();
    assert_eq!(end.ending, Ending::Complete);
    assert_eq!((end.rejects, end.asked_again), (0, 0));
    assert_eq!(frames.len() as u32, job.start.frames());
    client.request(Command::Disarm).unwrap();
    board.pass(Duration::from_millis(80));
    let status = client.status().unwrap();
    assert_eq!((status.frames_lost_on_board, status.rejects), (0, 0));
    frames
}

/// However long the processor takes: it is not in the timing path.
#[test]
fn jitter_is_zero_at_every_rate() {
    let rates = [
        (PulseTypeName::Wide, 50.0),
        (PulseTypeName::Wide, 100.0),
        (PulseTypeName::Wide, 250.0),
        (PulseTypeName::Wide, 333.0),
        (PulseTypeName::Narrow, 560.0),
    ];
    for (pulse_type, hz) in rates {
        let job = short(rig(pulse_type, hz));
        let train = job.rig.train();
        let servo = format!("linear?seed=3&pulses={}", pulse_type.as_str());
        let mut options = options(&servo, &[]);
        options.slow_flash = true;
        let board = SharedBoard::new(&options);
        let mut client = board.connect();
        let frames = run(&board, &mut client, &job);
        board.with(|board| {
            let record = &board.chip().record;
            let first = assert_on_the_grid(&record.pulses, &record.conversions, train);
            let samples = record.conversions[first * OVERSAMPLING..].chunks_exact(OVERSAMPLING);
            let codes: Vec<u16> = samples
                .map(|sample| sample.iter().map(|c| c.code).sum())
                .collect();
            assert_true(&frames, &record.pulses, &codes, train);
        });
        for (index, frame) in (0..).zip(&frames) {
            let offset = job.start.offset_us(index).unwrap();
            let expected = job.rig.servo.neutral_us.checked_add_signed(offset);
            assert_eq!(Some(frame.pulse.0), expected, "{hz} Hz, frame {index}");
        }
        assert_eq!(board.violations(), [""; 0], "{hz} Hz");
    }
}

/// One run after the other at other rates, between which the timers are changed. The numbers of the frames go on.
#[test]
fn the_rate_changes_between_runs_and_no_pulse_is_cut() {
    let board = SharedBoard::new(&options("linear?seed=4", &[]));
    let mut client = board.connect();
    let mut widths = Vec::new();
    for hz in [333.0, 50.0, 70.0, 333.0] {
        let job = short(rig(PulseTypeName::Wide, hz));
        let begin = board.with(|board| board.chip().record.pulses.len());
        run(&board, &mut client, &job);
        board.with(|board| {
            let record = &board.chip().record;
            let conversions = record.conversions.as_slice();
            let pulses = &record.pulses[begin..];
            let since = conversions.iter().position(|c| c.start > pulses[0].rise);
            assert_on_the_grid(pulses, &conversions[since.unwrap()..], job.rig.train());
            widths.extend(pulses.iter().map(|pulse| pulse.width / microseconds(1)));
        });
    }
    assert!(
        widths
            .iter()
            .all(|width| [1_450, 1_500, 1_550].contains(width))
    );
    assert_eq!(board.violations(), [""; 0]);
}

/// A second arming without a disarming between them: pulses of the first train end before the second one begins.
#[test]
fn arming_anew_at_another_rate_leaves_whole_pulses() {
    let board = SharedBoard::new(&options("linear?seed=5", &[]));
    let mut client = board.connect();
    for hz in [250.0, 333.0, 50.0] {
        short(rig(PulseTypeName::Wide, hz))
            .arm(&mut client)
            .unwrap();
        board.pass(Duration::from_millis(200));
    }
    board.with(|board| {
        let pulses = &board.chip().record.pulses;
        assert!(
            pulses
                .iter()
                .all(|pulse| pulse.width == microseconds(1_500))
        );
        let steps = pulses
            .windows(2)
            .map(|pair| (pair[1].rise - pair[0].rise) / microseconds(1));
        let mut steps: Vec<_> = steps.filter(|us| *us <= 20_000).collect();
        steps.dedup();
        assert_eq!(steps, [4_000, 3_004, 20_000]);
    });
    assert_eq!(board.violations(), [""; 0]);
}

/// The board holds the type: neither a wide arming nor the self-test follows a narrow one, until the next start.
#[test]
fn no_wide_pulse_reaches_a_narrow_pulse_servo() {
    let board = SharedBoard::new(&options("linear?seed=6&pulses=narrow", &[]));
    let mut client = board.connect();
    let narrow = short(rig(PulseTypeName::Narrow, 560.0));
    run(&board, &mut client, &narrow);
    let wide = short(rig(PulseTypeName::Wide, 50.0));
    let refused = wide.arm(&mut client).unwrap_err().to_string();
    assert!(refused.contains("reset button"), "{refused}");
    let mut stretched = narrow.clone();
    stretched.rig.limits.longest_us = 1_101;
    stretched.arm(&mut client).unwrap_err();
    board.pass(Duration::from_millis(300));
    board.with(|board| {
        let [_, longest] = PulseType::Narrow.board_limits();
        let pulses = &board.chip().record.pulses;
        let most = pulses.iter().map(|pulse| pulse.width).max().unwrap();
        assert!(most <= microseconds(longest.0.into()));
        assert_eq!(most, microseconds(775), "the staircase's own");
    });
}
