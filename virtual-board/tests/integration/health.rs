//! What the board says of its chip, its supply and its last fault.

use crate::faults::{next_run_of_it_works, start};
use servoid::data::rig_file::RigFile;
use servoid_protocol::health::FaultKind;
use servoid_protocol::lease::LONGEST_LEASE_S;
use servoid_protocol::message::{Activity, EndReason};
use servoid_protocol::{Health, PulseTrain};
use servoid_test_support::virtual_board::{SharedBoard, options, staircase};
use std::time::Duration;

/// The health of a board with `fault`, a second after its start.
fn health(fault: &[&str]) -> Health {
    let board = SharedBoard::new(&options("linear?seed=1", fault));
    board.pass(Duration::from_secs(1));
    board.connect().health().unwrap()
}

#[test]
fn a_fault_is_reported_after_the_reset_that_it_led_to() {
    let fault = |text: &str| {
        let fault = health(&[text]).last_fault;
        fault.map(|fault| (fault.kind, fault.detail))
    };
    assert_eq!(health(&[]).last_fault, None);
    let (kind, pc) = fault("hard-fault@0.5").unwrap();
    assert_eq!(kind, FaultKind::HardFault);
    assert!((0x0800_0000..0x0801_0000).contains(&pc), "{pc:#x}");
    // The core of the virtual board does not give the number.
    let (kind, _) = fault("stray-interrupt@0.5").unwrap();
    assert_eq!(kind, FaultKind::StrayInterrupt);
    let crystal = Some((FaultKind::CrystalStopped, 0));
    assert_eq!(fault("crystal-stops@0.5"), crystal);
    // These leave no record: memory is random after the one, and nothing runs before the other.
    assert_eq!(fault("brown-out@0.5"), None);
    assert_eq!(fault("cpu-stuck@0.5"), None);
}

/// The errata sheet: without a debugger the code of the device reads as 0.
#[test]
fn a_chip_hides_its_type_without_a_debugger() {
    let without = health(&[]);
    assert_eq!((without.flash_kib, without.device), (64, 0));
    let with = health(&["debugger-halts@100"]);
    assert_eq!(with.device & 0xfff, 0x410);
}

#[test]
fn a_sagging_supply_shows_in_the_reference_voltage() {
    let steady = health(&[]);
    assert_eq!(
        (steady.supply_ratio(), steady.low_supply_frames),
        (Some(1.0), 0)
    );
    let sagged = health(&["supply-sags@0.6"]);
    let ratio = sagged.supply_ratio().unwrap();
    // From 3.3 to 2.6 V, in steps of one in 1500.
    assert!((ratio - 2.6 / 3.3).abs() < 0.002, "{ratio}");
    assert!((20..40).contains(&sagged.low_supply_frames), "{sagged:?}");
}

/// A USB supply is within 5 %: the sensor's zero is then off by 3.75 degrees. Without a calibration the rig file has to
/// allow for that.
#[test]
fn the_uncertainty_of_an_uncalibrated_sensor_is_that_of_its_supply() {
    let sensor = RigFile::default().sensor;
    for error in [-0.05, 0.05] {
        let mut options = options("linear?noise=none", &[]);
        options.sensor_supply_error = error;
        let board = SharedBoard::new(&options);
        let counts = f64::from(board.connect().status().unwrap().sensor.0);
        let degrees = (counts - sensor.zero_counts) * sensor.degrees_per_count;
        assert!((degrees.abs() - 3.75).abs() < 0.05, "{degrees}");
        // Two standard deviations, of both: what is off is proportional to the supply.
        assert!(degrees.abs() < 2.0 * sensor.zero_sd_deg, "{degrees}");
        assert!(100.0 * error.abs() < 2.0 * sensor.scale_sd_percent);
    }
}

/// The readings of the sensor would be wrong by the same ratio, and still within their healthy range. The second sag lasts
/// for less than half a frame.
#[test]
fn a_run_ends_where_the_supply_sags() {
    for sag in ["supply-sags@3-5", "supply-sags@3-3.008"] {
        let board = SharedBoard::new(&options("linear?seed=1", &[sag]));
        let mut client = board.connect();
        start(&mut client, PulseTrain::USUAL.frames_in(LONGEST_LEASE_S));
        board.pass(Duration::from_secs(4));
        let Activity::Ended(ended) = client.status().unwrap().activity else {
            panic!("{sag}: still running");
        };
        assert_eq!(ended.reason, EndReason::SupplyLow, "{sag}");
        if sag.ends_with("-5") {
            let refused = staircase().arm(&mut client).unwrap_err();
            assert!(refused.to_string().contains("3.3 V"), "{refused}");
            board.pass(Duration::from_secs(1));
        }
        next_run_of_it_works(&mut client);
        assert_eq!(board.violations(), [""; 0], "{sag}");
    }
}
