//! The open session, and the order of its requests.

use servoid_protocol::message::{Command, Outcome, Refusal, Request};

/// The treatment of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Admission {
    /// Execute it.
    New,
    /// It was executed before: give the same answer.
    Again(Outcome),
    /// A `Hello` while another session holds the rig: answer it, and change nothing.
    Visit,
    /// Refuse it; it does not renew the lease either.
    Refused(Refusal),
}

/// The session that is open, if any.
#[derive(Debug, Default)]
#[cfg_attr(test, derive(Clone))]
pub(crate) struct Session(Option<Open>);

#[derive(Debug)]
#[cfg_attr(test, derive(Clone))]
struct Open {
    number: u16,
    newest: u16,
    /// The outcome of the newest request.
    outcome: Outcome,
}

impl Session {
    /// Admits or refuses a request; `holds`: the open session holds the rig. Ids wrap: the half of the circle ahead of
    /// the newest id is newer, the other half older.
    pub(crate) fn admit(&self, request: &Request, holds: bool) -> Admission {
        match &self.0 {
            Some(open) if open.number == request.session => {
                match request.id.wrapping_sub(open.newest) {
                    0 => Admission::Again(open.outcome),
                    1..=0x7fff => Admission::New,
                    _ => Admission::Refused(Refusal::Outdated),
                }
            }
            Some(_) if holds && request.command == Command::Hello => Admission::Visit,
            _ if request.command == Command::Hello => Admission::New,
            _ => Admission::Refused(Refusal::UnknownSession),
        }
    }

    /// Whether this is the session that is open.
    pub(crate) fn is_open(&self, session: u16) -> bool {
        self.0.as_ref().is_some_and(|open| open.number == session)
    }

    /// Stores the outcome of an admitted request, and opens the session of a `Hello`.
    pub(crate) fn settle(&mut self, request: &Request, outcome: Outcome) {
        self.0 = Some(Open {
            number: request.session,
            newest: request.id,
            outcome,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(session: u16, id: u16, command: Command) -> Request {
        Request {
            session,
            id,
            command,
        }
    }

    #[test]
    fn ids_are_ordered_around_the_wrap() {
        let mut session = Session::default();
        session.settle(&request(1, u16::MAX, Command::Hello), Outcome::Done);
        for (id, expected) in [
            (u16::MAX, Admission::Again(Outcome::Done)),
            (0, Admission::New),
            (0x7ffe, Admission::New),
            (0x7fff, Admission::Refused(Refusal::Outdated)),
            (u16::MAX - 1, Admission::Refused(Refusal::Outdated)),
        ] {
            assert_eq!(
                session.admit(&request(1, id, Command::KeepAlive), true),
                expected,
                "{id}"
            );
        }
    }

    /// Every id, against every place of the newest one that may make a difference, for both kinds of requests.
    #[test]
    fn every_id_is_the_newest_a_newer_one_or_an_older_one() {
        for newest in [0, 1, 0x7ffe, 0x7fff, 0x8000, u16::MAX] {
            let mut session = Session::default();
            session.settle(&request(1, newest, Command::Hello), Outcome::Done);
            let half = |from: u32| (from..from + 0x7fff).map(|id| (u32::from(newest) + id) as u16);
            let mut seen = 1;
            let admit = |id, command| session.admit(&request(1, id, command), true);
            for command in [Command::KeepAlive, Command::Hello] {
                assert_eq!(admit(newest, command), Admission::Again(Outcome::Done));
                for id in half(1) {
                    assert_eq!(admit(id, command), Admission::New, "{newest} {id}");
                    seen += 1;
                }
                for id in half(0x8000).chain([newest.wrapping_sub(1)]) {
                    let outdated = Admission::Refused(Refusal::Outdated);
                    assert_eq!(admit(id, command), outdated, "{newest} {id}");
                    seen += 1;
                }
            }
            assert_eq!(seen, 2 * 0xffff + 1);
        }
    }

    #[test]
    fn only_a_hello_opens_a_session_and_its_late_copy_does_not_reopen_it() {
        let mut session = Session::default();
        let unknown = Admission::Refused(Refusal::UnknownSession);
        assert_eq!(
            session.admit(&request(5, 1, Command::Disarm), false),
            unknown
        );
        let hello = request(5, 1, Command::Hello);
        assert_eq!(session.admit(&hello, false), Admission::New);
        session.settle(&hello, Outcome::Done);
        session.settle(&request(5, 2, Command::KeepAlive), Outcome::Done);
        let outdated = Admission::Refused(Refusal::Outdated);
        assert_eq!(session.admit(&hello, false), outdated);
        assert_eq!(
            session.admit(&request(6, 3, Command::Disarm), false),
            unknown
        );
        let other = request(6, 1, Command::Hello);
        assert_eq!(session.admit(&other, false), Admission::New);
        assert_eq!(session.admit(&other, true), Admission::Visit);
    }
}
