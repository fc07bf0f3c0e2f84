//! Identification of the servo behind a capture from the image.

use servoid::data::dataset::{self, DatasetOptions};
use servoid::data::recording::Ending;
use servoid::instrument::rig::RigClient;
use servoid_identification::results::Model;
use servoid_identification::{Options, Settling, identify};
use servoid_simulator::linear::LinearParameters;
use servoid_test_support::virtual_board::{FIRST_SAMPLE, SharedBoard, capture, options, staircase};
use std::path::Path;
use virtual_board::time::to_duration;

/// Long enough for every simulated servo here: 0.15 s after the delay, the linear one's remainder is
/// e^(-0.5·60·0.15) = 0.01, and what is left after N samples is in the last element.
const SETTLING: usize = 140;

fn model(client: &mut RigClient, file: &Path) -> Model {
    let (end, _) = capture(client, &staircase(), file);
    assert_eq!(end.unwrap().ending, Ending::Complete);
    let data = dataset::load(&[file.into()], &DatasetOptions::default()).unwrap();
    let options = Options {
        settling: Settling::Samples(SETTLING),
        ..Options::default()
    };
    identify(&data.record, &options).unwrap()
}

fn of_board(servo: &str) -> (Model, SharedBoard) {
    let board = SharedBoard::new(&options(servo, &[]));
    let folder = tempfile::tempdir().unwrap();
    let model = model(&mut board.connect(), &folder.path().join("board.csv"));
    assert_eq!(board.violations(), [""; 0]);
    (model, board)
}

/// From a pulse's edge to the middle of the instants at which a sample's conversions hold the input
/// (s): with a servo at speed, this is when the sample is of.
fn phase(board: &SharedBoard) -> f64 {
    board.with(|board| {
        let chip = board.chip();
        let sample = &chip.record.conversions[..4];
        let edge = sample[0].start - FIRST_SAMPLE;
        let held = sample
            .iter()
            .map(|c| to_duration(c.held - edge).as_secs_f64());
        held.sum::<f64>() / 4.0
    })
}

#[test]
fn the_linear_servos_exact_step_response_is_in_the_band() {
    let (model, board) = of_board("linear?seed=11");
    let (truth, phase) = (LinearParameters::default(), phase(&board));
    let bounds = model.step.bounds.valid().unwrap();
    let band = &bounds.simultaneous;
    assert_eq!(bounds.level, 0.99);
    let last = model.step.value.len() - 1;
    let mut widest: f64 = 0.0;
    for m in 0..=last {
        // The last element is the final value.
        let exact = if m == last {
            truth.gain
        } else {
            truth.step_response(m as f64 * model.sample_period_s + phase)
        };
        widest = widest.max(band.upper[m] - band.lower[m]);
        assert!(
            (band.lower[m]..=band.upper[m]).contains(&exact),
            "sample {m}: {exact} is not in {}..{}",
            band.lower[m],
            band.upper[m]
        );
    }
    println!(
        "widest band {widest:.4} of a unit step, phase {:.1} us",
        phase * 1e6
    );
    // A band that holds everything says nothing.
    assert!(widest < 0.2, "{widest}");
}

/// The same servo, once behind the image and once behind the rig in this process, with other noise.
/// Each band is right with 99 %; their difference has the root of the sum of both squares.
#[test]
fn the_image_and_the_rig_in_this_process_find_the_same_servo() {
    for servo in ["bench", "aircraft"] {
        let (on_board, board) = of_board(&format!("{servo}?seed=1"));
        // Whole microseconds: what is left is 0.5 µs at 500 deg/s, 0.0003 deg.
        let phase_us = (phase(&board) * 1e6).round();
        let address = format!("sim:{servo}?seed=2&first-sample-us={phase_us}");
        let port = servoid::instrument::port::open(&address).unwrap();
        let mut client = RigClient::connect(port, &address).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let in_process = model(&mut client, &folder.path().join("in-process.csv"));
        let half_width = |model: &Model, m: usize| {
            let whole = &model.step.bounds.valid().unwrap().simultaneous;
            (whole.upper[m] - whole.lower[m]) / 2.0
        };
        assert_eq!(on_board.step.value.len(), in_process.step.value.len());
        let worst = (0..on_board.step.value.len())
            .map(|m| {
                let difference = on_board.step.value[m] - in_process.step.value[m];
                difference.abs() / half_width(&on_board, m).hypot(half_width(&in_process, m))
            })
            .fold(0.0, f64::max);
        println!("{servo}: largest difference {worst:.2} of what the bands allow");
        assert!(worst < 1.0, "{servo}: {worst}");
    }
}
