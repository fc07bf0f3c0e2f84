//! Captures over bad lines: complete or labelled, never silently wrong.

use servoid::data::recording::Ending;
use servoid::instrument::port::Port;
use servoid::instrument::rig::CaptureError;
use servoid::instrument::rig::ClientError;
use servoid::instrument::rig::TalkError;
use servoid_protocol::PulseWidth;
use servoid_protocol::message::Start;
use servoid_simulator::InProcessRig;
use servoid_simulator::SimulatedFrame;
use servoid_test_support::bad_line::Faults;
use servoid_test_support::trials::chaos::{capture, rig, short_run, trial};
use servoid_test_support::trials::judge::{self, Outcome, capture_to_disk};
use std::time::Duration;

/// What a capture of the short run is.
fn check(bytes: &[u8], ending: Option<&Ending>, log: &[SimulatedFrame]) -> Result<Outcome, String> {
    judge::check(bytes, short_run().frames(), ending, log)
}

fn tally(seeds: std::ops::Range<u64>, faults: Faults) -> (usize, usize) {
    let results: Vec<Outcome> = seeds
        .map(|seed| trial(seed, faults, faults).unwrap_or_else(|how| panic!("seed {seed}: {how}")))
        .collect();
    let complete = results.iter().filter(|r| **r == Outcome::Complete).count();
    (complete, results.len())
}

#[test]
fn bad_lines_cost_little_and_are_never_silently_wrong() {
    assert_eq!(tally(0..100, Faults::of_rate(0.01)), (100, 100));
    let (complete, all) = tally(0..50, Faults::of_rate(0.05));
    assert!(complete * 10 >= all * 9, "{complete} of {all}");
    tally(0..6, Faults::of_rate(0.3));
}

#[test]
#[ignore = "five seconds: cargo test -p servoid --test integration -- --ignored chaos"]
fn a_line_that_loses_and_corrupts_one_in_a_hundred_costs_nothing() {
    let (complete, all) = tally(0..1_000, Faults::of_rate(0.01));
    // 99.9 % are promised.
    assert!(complete * 1_000 >= all * 999, "{complete} of {all}");
}

#[test]
#[ignore = "two seconds: cargo test -p servoid --test integration -- --ignored chaos"]
fn a_line_that_loses_and_corrupts_five_in_a_hundred_is_never_silently_wrong() {
    let (complete, all) = tally(0..400, Faults::of_rate(0.05));
    assert!(complete * 10 >= all * 9, "{complete} of {all}");
}

#[test]
#[ignore = "three seconds: cargo test -p servoid --test integration -- --ignored chaos"]
fn a_hopeless_line_is_never_silently_wrong() {
    tally(0..60, Faults::of_rate(0.3));
}

/// Does something to the line between the host and a rig at one moment.
struct Meddled<F> {
    rig: InProcessRig,
    at: Duration,
    meddle: Option<F>,
    cut_for: Duration,
}

impl<F: FnOnce(&mut InProcessRig)> Port for Meddled<F> {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> std::io::Result<usize> {
        if self.rig.now() >= self.at
            && let Some(meddle) = self.meddle.take()
        {
            meddle(&mut self.rig);
        }
        let count = Port::read(&mut self.rig, buffer, timeout)?;
        Ok(if self.is_cut() { 0 } else { count })
    }

    fn write_all(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        if !self.is_cut() {
            self.rig.write(bytes);
        }
        Ok(())
    }

    fn now(&self) -> Duration {
        Port::now(&self.rig)
    }
}

impl<F> Meddled<F> {
    fn is_cut(&self) -> bool {
        (self.at..self.at + self.cut_for).contains(&self.rig.now())
    }
}

const IN_MID_RUN: Duration = Duration::from_millis(600);
const NO_TIME: Duration = Duration::ZERO;

fn reason(ending: &Ending) -> &str {
    match ending {
        Ending::Complete | Ending::Early { .. } => panic!("it is not partial"),
        Ending::Partial { reason, .. } => reason,
    }
}

#[test]
fn a_rig_that_is_reset_in_mid_run_leaves_what_came_and_no_pulse() {
    let (old, log) = rig("linear?noise=white");
    let (new, log_after) = rig("linear?noise=white");
    let port = Meddled {
        rig: old,
        at: IN_MID_RUN,
        meddle: Some(|rig: &mut InProcessRig| *rig = new),
        cut_for: NO_TIME,
    };
    let (end, bytes) = capture(Box::new(port), short_run(), &|| false);
    assert!(
        matches!(
            end,
            Err(CaptureError::Talk(TalkError::Rig(
                ClientError::RunForgotten
            )))
        ),
        "{end:?}"
    );
    let bytes = bytes.unwrap();
    assert_eq!(check(&bytes, None, &log.borrow()), Ok(Outcome::Partial));
    assert!(bytes.iter().filter(|b| **b == b'\n').count() > 150);
    assert!(log_after.borrow().iter().all(|frame| frame.pulse.is_none()));
}

#[test]
fn a_cable_that_is_out_for_a_second_costs_nothing() {
    let (rig, log) = rig("linear?noise=white");
    let port = Meddled {
        rig,
        at: IN_MID_RUN,
        meddle: Some(|_: &mut InProcessRig| ()),
        cut_for: Duration::from_millis(1_200),
    };
    let (end, bytes) = capture(Box::new(port), short_run(), &|| false);
    let end = end.unwrap();
    let result = check(&bytes.unwrap(), Some(&end), &log.borrow());
    assert_eq!(result, Ok(Outcome::Complete), "{end:?}");
}

#[test]
fn a_cable_that_is_out_for_longer_than_the_lease_costs_only_what_was_not_made() {
    let (rig, log) = rig("linear?noise=white");
    let port = Meddled {
        rig,
        at: IN_MID_RUN,
        meddle: Some(|_: &mut InProcessRig| ()),
        cut_for: Duration::from_secs(4),
    };
    let long = Start {
        post_roll_frames: 400,
        ..short_run()
    };
    let (end, bytes) = capture(Box::new(port), long, &|| false);
    let end = end.unwrap();
    assert!(reason(&end).contains("for 2 s"), "{end:?}");
    let bytes = bytes.unwrap();
    assert_eq!(
        check(&bytes, Some(&end), &log.borrow()),
        Ok(Outcome::Partial)
    );
    // Everything from the start of the run to two seconds after the cut, without a gap.
    let rows = bytes
        .split(|b| *b == b'\n')
        .filter(|l| l.first() != Some(&b'#'))
        .count();
    // The start was heard as well, so the lease gave 100 frames, less the one or two before the first.
    assert!(rows >= 970, "{rows}");
    // One stretch: what the run would still have had.
    let missing = rows as u32 / 10..long.frames();
    assert!(matches!(end, Ending::Partial { lost_frames, .. } if lost_frames == [missing]));
}

#[test]
fn a_cable_that_stays_out_ends_with_a_sentence_and_the_servo_at_neutral() {
    let (rig, log) = rig("linear?noise=white");
    let port = Meddled {
        rig,
        at: IN_MID_RUN,
        meddle: Some(|_: &mut InProcessRig| ()),
        cut_for: Duration::from_secs(1_000),
    };
    let (end, bytes) = capture(Box::new(port), short_run(), &|| false);
    assert!(
        matches!(
            end,
            Err(CaptureError::Talk(TalkError::Rig(
                ClientError::FellSilent { .. }
            )))
        ),
        "{end:?}"
    );
    assert_eq!(
        check(&bytes.unwrap(), None, &log.borrow()),
        Ok(Outcome::Partial)
    );
    let last = log.borrow().last().and_then(|frame| frame.pulse);
    assert_eq!(last, Some(PulseWidth::NEUTRAL));
}

#[test]
fn a_user_who_stops_before_the_run_begins_moves_nothing() {
    let (rig, log) = rig("linear?noise=white");
    let (end, bytes) = capture(Box::new(rig), short_run(), &|| true);
    let end = end.unwrap();
    assert!(reason(&end).contains("before the run"), "{end:?}");
    assert_eq!(
        check(&bytes.unwrap(), Some(&end), &log.borrow()),
        Ok(Outcome::Partial)
    );
    let neutral = Some(PulseWidth::NEUTRAL);
    assert!(
        log.borrow()
            .iter()
            .all(|f| f.pulse.is_none() || f.pulse == neutral)
    );
}

#[test]
fn the_check_of_the_trials_sees_one_wrong_count() {
    let (rig, log) = rig("linear?noise=white");
    let (end, bytes) = capture(Box::new(rig), short_run(), &|| false);
    let (end, bytes) = (end.unwrap(), bytes.unwrap());
    let mut log = log.borrow().clone();
    assert_eq!(check(&bytes, Some(&end), &log), Ok(Outcome::Complete));
    let moved = log.iter().position(|f| f.pulse == Some(PulseWidth(1_550)));
    log[moved.unwrap() + 3].samples[4].0 ^= 1;
    assert!(check(&bytes, Some(&end), &log).is_err());
}

/// A rig that goes on for three frames after the capture has let go of it: pulses change at frame
/// edges.
struct GoesOn(InProcessRig);

impl Port for GoesOn {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> std::io::Result<usize> {
        Port::read(&mut self.0, buffer, timeout)
    }

    fn write_all(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.0.write_all(bytes)
    }

    fn now(&self) -> Duration {
        Port::now(&self.0)
    }
}

impl Drop for GoesOn {
    fn drop(&mut self) {
        let until = Port::now(self) + Duration::from_millis(60);
        while Port::now(self) < until {
            self.0.read(&mut [0; 64], Duration::from_millis(10));
        }
    }
}

#[test]
fn a_disk_that_fills_up_in_mid_run_leaves_the_servo_at_neutral_and_the_rows() {
    let (rig, log) = rig("linear?noise=white");
    let (end, bytes) = capture_to_disk(Box::new(GoesOn(rig)), short_run(), &|| false, 8_000);
    assert!(matches!(end, Err(CaptureError::Write(_))), "{end:?}");
    let bytes = bytes.unwrap();
    assert_eq!(check(&bytes, None, &log.borrow()), Ok(Outcome::Partial));
    assert!(bytes.len() > 7_000, "{}", bytes.len());
    let log = log.borrow();
    let moved = log.iter().any(|f| f.pulse == Some(PulseWidth(1_550)));
    let last = log.last().and_then(|frame| frame.pulse);
    assert!(moved, "the run was under way");
    assert_eq!(last, Some(PulseWidth::NEUTRAL));
}
