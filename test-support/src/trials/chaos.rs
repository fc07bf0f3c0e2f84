//! One capture over a bad line, compared with the samples of the board.

use super::judge::{Outcome, capture_to_disk, check};
use crate::bad_line::{ChaosPort, Faults};
use servoid::data::recording::Ending;
use servoid::instrument::port::Port;
use servoid::instrument::rig::CaptureError;
use servoid::instrument::rig::TalkError;
use servoid_protocol::message::Start;
use servoid_protocol::reference::{Reference, Staircase};
use servoid_simulator::{InProcessRig, SimulatedFrame};
use std::cell::RefCell;
use std::io::Result as IoResult;
use std::rc::Rc;
use std::time::Duration;

/// Simulated time after which a capture of two seconds counts as hung.
const HANGS: Duration = Duration::from_secs(300);

/// A short run: 30 frames of reference, 10 of rest.
pub fn short_run() -> Start {
    Start {
        run: 0x5151,
        pre_roll_frames: 5,
        reference: Reference::Staircase(Staircase {
            amplitude_us: 50,
            longest_hold_frames: 10,
            shortest_hold_frames: 5,
            hold_step_frames: 5,
        }),
        post_roll_frames: 5,
    }
}

/// The samples of the board, frame by frame.
pub type Log = Rc<RefCell<Vec<SimulatedFrame>>>;

/// A simulated rig and its log.
pub fn rig(options: &str) -> (InProcessRig, Log) {
    let log = Log::default();
    let seen = log.clone();
    let options = options.parse().expect("the options are good");
    let rig = InProcessRig::observed(&options, move |frame| seen.borrow_mut().push(*frame));
    (rig.expect("the options are good"), log)
}

/// Captures `start` over `port` into memory; also returns the report of the capture itself.
pub fn capture(
    port: Box<dyn Port>,
    start: Start,
    should_stop: &dyn Fn() -> bool,
) -> (Result<Ending, CaptureError>, Option<Vec<u8>>) {
    capture_to_disk(port, start, should_stop, 1 << 20)
}

/// One capture over a line of these faults.
pub fn trial(seed: u64, to_rig: Faults, to_host: Faults) -> Result<Outcome, String> {
    let (rig, log) = rig(&format!("linear?seed={seed}&noise=white"));
    let watched = Watched { rig };
    let port = ChaosPort::new(watched, seed, to_rig, to_host);
    let (end, bytes) = capture(Box::new(port), short_run(), &|| false);
    if let Err(CaptureError::Talk(TalkError::Broken(error))) = &end
        && error.kind() == std::io::ErrorKind::TimedOut
    {
        return Err("it hangs".to_owned());
    }
    match bytes {
        None => Ok(Outcome::Refused),
        Some(bytes) => check(
            &bytes,
            short_run().frames(),
            end.as_ref().ok(),
            &log.borrow(),
        ),
    }
}

/// A rig that breaks off when far more time has passed than any capture takes.
struct Watched {
    rig: InProcessRig,
}

impl Port for Watched {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> IoResult<usize> {
        if self.rig.now() > HANGS {
            return Err(std::io::ErrorKind::TimedOut.into());
        }
        Port::read(&mut self.rig, buffer, timeout)
    }

    fn write_all(&mut self, bytes: &[u8]) -> IoResult<()> {
        self.rig.write_all(bytes)
    }

    fn now(&self) -> Duration {
        Port::now(&self.rig)
    }
}
