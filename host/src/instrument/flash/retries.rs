//! Commands, repeated until they succeed.

use super::bootloader::{BLOCK, Version};
use super::error::{FlashError, State};
use super::exchange::{Exchange, Failure, Resynchronised};
use std::time::Duration;

/// How often a command is repeated on a bad line.
const ATTEMPTS: u32 = 20;
/// Refusals one after the other that are meant: a disturbed command is refused as well, but not so often.
const REFUSALS: u32 = 5;
/// The fewest bytes that are read or written at once: the commands around them have about as many.
const SMALLEST: usize = 16;
/// Exchanges after which more bytes are tried again.
const GROWS_AFTER: u32 = 4;
/// Silent rounds of one byte at the beginning, after which many bytes fill up a message that another program has left
/// behind, for as many rounds.
const FILLED_FROM: u32 = 4;

/// A bootloader that is asked again.
pub(super) struct Repeated<'p> {
    pub(super) exchange: Exchange<'p>,
    /// What the board holds if this fails.
    pub(super) state: State,
    /// Bytes that are read or written at once, and exchanges that have succeeded since it was last made smaller.
    block: usize,
    good: u32,
}

impl<'p> Repeated<'p> {
    pub(super) fn new(exchange: Exchange<'p>) -> Self {
        Self {
            exchange,
            state: State::Untouched,
            block: BLOCK,
            good: 0,
        }
    }

    fn gone(&self, failure: Failure) -> FlashError {
        match failure {
            Failure::Gone(error) => FlashError::Broken(self.state, error),
            Failure::Refused | Failure::Lost => FlashError::FellSilent(self.state),
        }
    }

    fn check_stop(&self) -> Result<(), FlashError> {
        match (self.exchange.stop)() {
            true => Err(FlashError::Stopped(self.state)),
            false => Ok(()),
        }
    }

    /// Waits for the bootloader, at most for `patience`; `waiting` is called in each silent round but the first ones.
    pub(super) fn synchronise(
        &mut self,
        patience: Duration,
        waiting: &mut dyn FnMut(),
    ) -> Result<(), FlashError> {
        let until = self.exchange.port.now() + patience;
        for round in 0.. {
            self.check_stop()?;
            let many = (FILLED_FROM..2 * FILLED_FROM).contains(&round);
            let heard = self.exchange.synchronise(many);
            if heard.map_err(|failure| self.gone(failure))? {
                return self.resynchronise("begin");
            }
            if self.exchange.port.now() >= until {
                break;
            }
            if round >= FILLED_FROM {
                waiting();
            }
        }
        Err(FlashError::NoAnswer)
    }

    fn resynchronise(&mut self, what: &'static str) -> Result<(), FlashError> {
        let resynchronised = self.exchange.resynchronise();
        self.check_stop()?;
        match resynchronised.map_err(|failure| self.gone(failure))? {
            Resynchronised::Yes => Ok(()),
            Resynchronised::Silent => Err(FlashError::FellSilent(self.state)),
            Resynchronised::No => Err(self.bad_line(what)),
        }
    }

    fn bad_line(&self, what: &'static str) -> FlashError {
        FlashError::BadLine {
            what,
            state: self.state,
        }
    }

    /// Does something until it succeeds; `None` where it is refused.
    fn unless_refused<T>(
        &mut self,
        what: &'static str,
        mut attempt: impl FnMut(&mut Exchange<'_>) -> Result<T, Failure>,
    ) -> Result<Option<T>, FlashError> {
        let mut refused = 0;
        for _ in 0..ATTEMPTS {
            self.check_stop()?;
            match attempt(&mut self.exchange) {
                Ok(done) => return Ok(Some(done)),
                Err(Failure::Refused) => refused += 1,
                Err(Failure::Lost) => refused = 0,
                Err(gone @ Failure::Gone(_)) => return Err(self.gone(gone)),
            }
            // Also after a refusal: half a command may be left over, and each one after it would be refused.
            self.resynchronise(what)?;
            if refused >= REFUSALS {
                return Ok(None);
            }
        }
        Err(self.bad_line(what))
    }

    fn often<T>(
        &mut self,
        what: &'static str,
        attempt: impl FnMut(&mut Exchange<'_>) -> Result<T, Failure>,
    ) -> Result<T, FlashError> {
        let state = self.state;
        let done = self.unless_refused(what, attempt)?;
        done.ok_or(FlashError::Refused { what, state })
    }

    /// An answer without a checksum counts when it comes twice in a row; `None` where the question is refused.
    fn twice<T: PartialEq>(
        &mut self,
        what: &'static str,
        mut attempt: impl FnMut(&mut Exchange<'_>) -> Result<T, Failure>,
    ) -> Result<Option<T>, FlashError> {
        let mut before = None;
        for _ in 0..ATTEMPTS {
            let answer = self.unless_refused(what, &mut attempt)?;
            if answer.is_none() || answer == before {
                return Ok(answer);
            }
            before = answer;
        }
        Err(self.bad_line(what))
    }

    /// What the bootloader says of itself.
    pub(super) fn version(&mut self) -> Result<Option<Version>, FlashError> {
        self.twice("name its version", |rom| rom.get())
    }

    /// What the chip is.
    pub(super) fn product_id(&mut self) -> Result<Option<u16>, FlashError> {
        self.twice("name the chip", |rom| rom.get_id())
    }

    /// Bytes of the memory; `None` where the chip does not show them.
    pub(super) fn read(
        &mut self,
        address: u32,
        length: usize,
    ) -> Result<Option<Vec<u8>>, FlashError> {
        self.twice("read its memory", |exchange| exchange.read(address, length))
    }

    /// Does something once; `None` where it fails.
    fn once<T>(
        &mut self,
        what: &'static str,
        attempt: impl FnOnce(&mut Exchange<'_>) -> Result<T, Failure>,
    ) -> Result<Option<T>, FlashError> {
        self.check_stop()?;
        match attempt(&mut self.exchange) {
            Ok(done) => {
                self.good += 1;
                if self.good.is_multiple_of(GROWS_AFTER) {
                    self.block = (2 * self.block).min(BLOCK);
                }
                Ok(Some(done))
            }
            Err(gone @ Failure::Gone(_)) => Err(self.gone(gone)),
            Err(Failure::Refused | Failure::Lost) => {
                self.shrink();
                self.resynchronise(what)?;
                Ok(None)
            }
        }
    }

    /// On a bad line small blocks come through where large ones do not.
    fn shrink(&mut self) {
        self.good = 0;
        self.block = (self.block / 2).max(SMALLEST);
    }

    /// Whether the memory holds these bytes. A difference is looked at again in a smaller block: the line may have made it.
    /// One that is there twice, the same both times, is there.
    pub(super) fn holds(&mut self, address: u32, bytes: &[u8]) -> Result<bool, FlashError> {
        const WHAT: &str = "read its memory";
        let (mut done, mut failures, mut seen) = (0, 0, None);
        while let Some(rest) = bytes.get(done..).filter(|rest| !rest.is_empty()) {
            let expected = rest.get(..self.block).unwrap_or(rest);
            let at = address + done as u32;
            let read = self.once(WHAT, |rom| rom.read(at, expected.len()))?;
            match read {
                Some(read) if read == expected => {
                    (done, failures, seen) = (done + expected.len(), 0, None);
                    continue;
                }
                Some(read) if seen.as_ref() == Some(&read) => return Ok(false),
                other => seen = other,
            }
            self.shrink();
            failures += 1;
            if failures > ATTEMPTS {
                return Err(self.bad_line(WHAT));
            }
        }
        Ok(true)
    }

    /// Writes whole words. A repetition changes nothing: flash takes a value once.
    pub(super) fn write(&mut self, address: u32, bytes: &[u8]) -> Result<(), FlashError> {
        const WHAT: &str = "write to its flash";
        let (mut done, mut failures) = (0, 0);
        while let Some(rest) = bytes.get(done..).filter(|rest| !rest.is_empty()) {
            let block = rest.get(..self.block).unwrap_or(rest);
            let at = address + done as u32;
            match self.once(WHAT, |rom| rom.write(at, block))? {
                Some(()) => (done, failures) = (done + block.len(), 0),
                None => failures += 1,
            }
            if failures > ATTEMPTS {
                return Err(self.bad_line(WHAT));
            }
        }
        Ok(())
    }

    /// Erases pages.
    pub(super) fn erase(&mut self, pages: &[u8]) -> Result<(), FlashError> {
        match pages {
            [] => Ok(()),
            _ => self.often("erase its flash", |rom| rom.erase(pages)),
        }
    }

    /// Removes the protection against reading. The chip is then reset, so an answer that is lost is no failure: what the
    /// chip shows afterwards counts.
    pub(super) fn read_unprotect(&mut self) -> Result<(), FlashError> {
        self.check_stop()?;
        match self.exchange.read_unprotect() {
            Err(gone @ Failure::Gone(_)) => Err(self.gone(gone)),
            _ => Ok(()),
        }
    }

    /// Starts the program at the address; returns whether that was acknowledged. Where the acknowledgement is lost and
    /// the bootloader is silent, it has started the program.
    pub(super) fn go(&mut self, address: u32) -> Result<bool, FlashError> {
        for _ in 0..ATTEMPTS {
            match self.exchange.go(address) {
                Ok(()) => return Ok(true),
                Err(gone @ Failure::Gone(_)) => return Err(self.gone(gone)),
                Err(Failure::Refused | Failure::Lost) => {}
            }
            let resynchronised = self.exchange.resynchronise();
            match resynchronised.map_err(|failure| self.gone(failure))? {
                Resynchronised::Yes => {}
                Resynchronised::Silent | Resynchronised::No => return Ok(false),
            }
        }
        Err(self.bad_line("start the program"))
    }
}
