//! `servoid selftest` on the board: it passes, and it names each fault that it is meant to find.

use servoid::instrument::selftest::{SelfTestExtent, SelfTestReport, measure};
use servoid_test_support::virtual_board::{SharedBoard, options};
use std::time::Duration;
use virtual_board::BoardOptions;
use virtual_board::time::microseconds;

/// A board that is wired to itself.
fn wired(wire: &str, faults: &[&str]) -> BoardOptions {
    let mut options = options("linear?seed=1", faults);
    options.loop_wire = Some(wire.parse().unwrap());
    options
}

/// Enough to find a fault.
const SHORT: SelfTestExtent = SelfTestExtent {
    counting: Duration::from_secs(1),
    pulses_us: &[1_500],
};

fn test_itself(options: &BoardOptions, extent: SelfTestExtent) -> (SharedBoard, SelfTestReport) {
    let board = SharedBoard::new(options);
    let measured = measure(&mut board.connect(), extent, &|| false, &mut |_| {}).unwrap();
    let report = SelfTestReport::new(measured, "the virtual board", None);
    (board, report)
}

#[test]
fn a_good_board_passes_with_the_figures_of_the_chip() {
    let (board, report) = test_itself(&wired("divider,noise=2", &[]), SelfTestExtent::FULL);
    assert!(report.passed(), "{}", report.text());
    assert_eq!(board.violations(), [""; 0]);
    let measured = &report.measured;
    let [least, most] = measured.frame_ms.unwrap();
    assert!((least..=most).contains(&20.0), "{least} {most}");
    assert!(most - least < 0.1, "{least} {most}");
    for pulse in &measured.pulses {
        let width = pulse.width_us.unwrap();
        assert!(
            (width - f64::from(pulse.asked_us)).abs() <= 1.0,
            "{pulse:?}"
        );
    }
    // 239.5 cycles of 12 MHz and three of latency.
    let holds = measured.probe_holds_us.unwrap();
    assert!((holds - 20.2).abs() <= 0.5, "{holds}");
    // 1.21 V of this chip's reference are taken for 1.20 V.
    let volts = measured.supply_volts().unwrap();
    assert!((volts - 3.3 * 1.20 / 1.21).abs() < 0.01, "{volts}");
    // The pulses end with the test, and none was longer than asked for.
    let longest = board.with(|board| {
        let chip = board.chip();
        let widths = chip.record.pulses.iter().map(|pulse| pulse.width);
        widths.max()
    });
    assert_eq!(longest, Some(microseconds(2_000)));
    let before = pulses(&board);
    board.pass(Duration::from_millis(500));
    assert!(pulses(&board) <= before + 1);
}

fn pulses(board: &SharedBoard) -> usize {
    board.with(|board| board.chip().record.pulses.len())
}

/// The board's own measure of its load, against the cycles that the model counted.
#[test]
fn the_load_and_the_stack_are_what_the_model_counts() {
    let board = SharedBoard::new(&wired("divider", &[]));
    let mut client = board.connect();
    let cycles = || board.with(|board| board.awake_cycles());
    let (before, counted) = (client.vitals().unwrap(), cycles());
    for _ in 0..100 {
        client.status().unwrap();
    }
    let (after, counted) = (client.vitals().unwrap(), cycles() - counted);
    let measured = f64::from(after.awake_us - before.awake_us);
    let truth = counted as f64 / 72.0;
    assert!((measured / truth - 1.0).abs() < 0.1, "{measured} {truth}");
    assert_eq!(after.stack_bytes, 10_240);
    let untouched = board.with(|board| {
        let words = (0..2_560).map(|word| board.ram().read(0x2000_0000 + 4 * word, 4));
        words.take_while(|word| *word == Some(0x5afe_57ac)).count()
    });
    assert!(4 * untouched >= usize::from(after.stack_unused));
    assert!(4 * untouched < usize::from(after.stack_unused) + 200);
    assert!(after.stack_unused > 1_024, "{after:?}");
}

type Change = fn(&mut BoardOptions);

/// The wire, faults as on the command line, another change of the board, and what the self-test has to find.
type Row = (
    &'static str,
    &'static [&'static str],
    Change,
    &'static [&'static str],
);

const FAULTS: [Row; 13] = [
    ("open", &[], |_| {}, &["wire_missing"]),
    ("3v3", &[], |_| {}, &["pin_driven"]),
    ("straight", &[], |_| {}, &["divider"]),
    ("divider,noise=60", &[], |_| {}, &["noise"]),
    ("divider,capacitor=10", &[], |_| {}, &["slow_edge"]),
    ("divider,capacitor=2", &[], |_| {}, &["converter_clock"]),
    ("divider,falls-late=4", &[], |_| {}, &["pulse_width"]),
    ("divider", &["no-crystal"], |_| {}, &["internal_oscillator"]),
    (
        "divider",
        &["no-crystal"],
        |o| o.hsi_error = 0.02,
        &["internal_oscillator", "frame_period"],
    ),
    (
        "divider",
        &[],
        |o| o.crystal_error = -0.01,
        &["frame_period"],
    ),
    (
        "divider",
        &[],
        |o| o.samples_late = microseconds(20),
        &["sample_phase"],
    ),
    ("divider", &[], |o| o.supply_millivolts = 3_000, &["supply"]),
    ("divider", &["flip:0.001"], |_| {}, &["line"]),
];

/// Of the wire, of the capacitor, and of the line.
const FEW: [usize; 3] = [0, 5, 12];

#[test]
fn a_fault_is_named_and_no_other() {
    require_named(&FEW.map(|row| FAULTS[row]));
}

#[test]
#[ignore = "five seconds: cargo test -p virtual-board --test integration -- --ignored each_fault_is_named"]
fn each_fault_is_named_and_no_other() {
    require_named(&FAULTS);
}

fn require_named(faults: &[Row]) {
    for &(wire, faults, change, expected) in faults {
        let mut options = wired(wire, faults);
        change(&mut options);
        let (_, report) = test_itself(&options, SHORT);
        let found: Vec<_> = report.findings.iter().map(|f| f.fault).collect();
        assert_eq!(found, expected, "{wire} {faults:?}\n{}", report.text());
        assert!(!report.passed());
    }
}

/// A rig with its sensor gets no pulse at all, and a wire that is missing ends them after three.
#[test]
fn without_the_wire_there_are_no_pulses_for_a_servo() {
    let (board, report) = test_itself(&options("bench?seed=1", &[]), SHORT);
    let found: Vec<_> = report.findings.iter().map(|f| f.fault).collect();
    assert_eq!((found, pulses(&board)), (vec!["pin_driven"], 0));
    let (board, _) = test_itself(&wired("open", &[]), SHORT);
    assert!((1..=3).contains(&pulses(&board)), "{}", pulses(&board));
}
