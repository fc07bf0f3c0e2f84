//! Two programs on one rig: the one that has a run keeps it, and one that is gone can be replaced.

use servoid::data::recording::Ending;
use servoid::data::rig_file::RigFile;
use servoid::instrument::port::Port;
use servoid::instrument::rig::ClientError;
use servoid::instrument::rig::{Capture, CaptureError};
use servoid::instrument::rig::{RigClient, TalkError};
use servoid_protocol::message::{Activity, Start};
use servoid_protocol::{Command, Request, framing};
use servoid_simulator::InProcessRig;
use servoid_test_support::trials::chaos::{capture, rig, short_run};
use servoid_test_support::trials::judge::{Outcome, check};
use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

/// One hand on a line that others have a hand on as well.
struct Shared<F> {
    rig: Rc<RefCell<InProcessRig>>,
    /// What the others do whenever this one waits.
    others: F,
}

impl<F: FnMut(&mut InProcessRig)> Port for Shared<F> {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> std::io::Result<usize> {
        let mut rig = self.rig.borrow_mut();
        (self.others)(&mut rig);
        Port::read(&mut *rig, buffer, timeout)
    }

    fn write_all(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.rig.borrow_mut().write_all(bytes)
    }

    fn now(&self) -> Duration {
        Port::now(&*self.rig.borrow())
    }
}

fn say(rig: &mut InProcessRig, session: u16, id: u16, command: Command) {
    let request = Request {
        session,
        id,
        command,
    };
    rig.write(framing::encode(&request, &mut [0; framing::MAX_WIRE]).unwrap());
}

const LEASE: Duration = Duration::from_secs(2);
const A_FRAME: Duration = Duration::from_millis(20);

/// A run that goes on for long after the lease.
fn long_run() -> Start {
    Start {
        post_roll_frames: 1_000,
        ..short_run()
    }
}

/// A rig with the long run under way, begun by session 1, which has said nothing since; and when.
fn abandoned() -> (Rc<RefCell<InProcessRig>>, Duration) {
    let rig = Rc::new(RefCell::new(rig("linear?noise=white").0));
    let port = Shared {
        rig: rig.clone(),
        others: |_: &mut InProcessRig| (),
    };
    let mut client = RigClient::connect_as(Box::new(port), "the line", 1).unwrap();
    let run = Capture {
        rig: RigFile::default(),
        start: long_run(),
    };
    run.arm(&mut client).unwrap();
    client.request(Command::Start(run.start)).unwrap();
    let now = client.now();
    (rig, now)
}

#[test]
fn a_program_that_wants_the_rig_in_mid_run_costs_the_run_nothing() {
    let (rig, log) = rig("linear?noise=white");
    let mut id = 0;
    let port = Shared {
        rig: Rc::new(RefCell::new(rig)),
        others: move |rig: &mut InProcessRig| {
            if Port::now(rig) > Duration::from_millis(600) {
                id += 2;
                say(rig, 1, id, Command::Hello);
                say(rig, 1, id + 1, Command::Disarm);
            }
        },
    };
    let (end, bytes) = capture(Box::new(port), short_run(), &|| false);
    let end = end.unwrap();
    let result = check(
        &bytes.unwrap(),
        short_run().frames(),
        Some(&end),
        &log.borrow(),
    );
    assert_eq!(result, Ok(Outcome::Complete), "{end:?}");
    assert_eq!(end, Ending::Complete);
}

#[test]
fn a_rig_whose_program_is_gone_is_had_when_the_lease_is_over() {
    let (rig, abandoned_at) = abandoned();
    let port = Shared {
        rig,
        others: |_: &mut InProcessRig| (),
    };
    let mut second = RigClient::connect_as(Box::new(port), "the line", 2).unwrap();
    let waited = second.now() - abandoned_at;
    // To the tenth of a second in which it asks again, and two frames for question and answer.
    let soon = LEASE + Duration::from_millis(100) + 2 * A_FRAME;
    assert!(waited > LEASE - 2 * A_FRAME && waited < soon, "{waited:?}");
    let activity = second.status().unwrap().activity;
    assert!(matches!(activity, Activity::Ended(_)), "{activity:?}");
    let run = Capture::new(RigFile::default(), short_run().reference);
    run.arm(&mut second).unwrap();
}

#[test]
fn a_rig_whose_program_goes_on_is_not_had() {
    let (rig, _) = abandoned();
    // Ids that no request of the first program has had.
    let mut id = 100;
    let port = Shared {
        rig,
        others: move |rig: &mut InProcessRig| {
            id += 1;
            say(rig, 1, id, Command::KeepAlive);
        },
    };
    let refused = RigClient::connect_as(Box::new(port), "the line", 2).err();
    let refused = refused.expect("the first program has the rig");
    assert!(
        matches!(refused, TalkError::Rig(ClientError::RunOfAnother)),
        "{refused:?}"
    );
    assert!(refused.to_string().contains("wait for its end"));
}

#[test]
fn a_program_that_was_silent_for_too_long_and_has_lost_its_rig_says_so() {
    let (rig, log) = rig("linear?noise=white");
    let rig = Rc::new(RefCell::new(rig));
    // For three seconds of the run nothing of this program gets through, and another one comes.
    let away = Duration::from_millis(600)..Duration::from_millis(3_600);
    let mut taken = false;
    let port = Cut {
        away: away.clone(),
        inner: Shared {
            rig,
            others: move |rig: &mut InProcessRig| {
                if !taken && Port::now(rig) > away.start + LEASE + Duration::from_millis(600) {
                    taken = true;
                    say(rig, 1, 1, Command::Hello);
                }
            },
        },
    };
    let (end, bytes) = capture(Box::new(port), long_run(), &|| false);
    let forgotten = matches!(
        end,
        Err(CaptureError::Talk(TalkError::Rig(
            ClientError::RunForgotten
        )))
    );
    assert!(forgotten, "{end:?}");
    let bytes = bytes.unwrap();
    let result = check(&bytes, long_run().frames(), None, &log.borrow());
    assert_eq!(result, Ok(Outcome::Partial));
}

/// A line that carries nothing for a while.
struct Cut<P> {
    inner: P,
    away: std::ops::Range<Duration>,
}

impl<P: Port> Port for Cut<P> {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> std::io::Result<usize> {
        let count = self.inner.read(buffer, timeout)?;
        let is_away = self.away.contains(&self.inner.now());
        Ok(if is_away { 0 } else { count })
    }

    fn write_all(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        if self.away.contains(&self.inner.now()) {
            return Ok(());
        }
        self.inner.write_all(bytes)
    }

    fn now(&self) -> Duration {
        self.inner.now()
    }
}
