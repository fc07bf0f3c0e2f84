//! A whole rig in the caller's own thread.
//!
//! The firmware's [`serve()`] runs over a [`SimulatedBoard`] and a serial line, all in simulated time. Time passes only
//! while the caller waits in [`InProcessRig::read`]. So nothing depends on the speed or load of the computer, and
//! leases and time-outs have the same meaning as on a real rig.

use crate::apparatus::SimulatedFrame;
use crate::board::{FrameClock, SimulatedBoard, TrainInUse};
use crate::options::{OptionsError, SimulationOptions};
use crate::serial_line::{RigEnd, SerialLine};
use servoid_firmware::serve;
use std::cell::RefCell;
use std::pin::Pin;
use std::rc::Rc;
use std::task::{Context, Waker};
use std::time::{Duration, Instant};

/// A simulated rig behind a simulated serial line. Simulated time passes only in [`read`](Self::read).
///
/// ```
/// use servoid_protocol::{Command, Decoder, Request, RigMessage, framing};
/// use servoid_simulator::InProcessRig;
/// use std::time::Duration;
///
/// let mut rig = InProcessRig::new(&"linear".parse()?)?;
/// let hello = Request { session: 1, id: 0, command: Command::Hello };
/// rig.write(framing::encode(&hello, &mut [0; framing::MAX_WIRE])?);
/// let (mut decoder, mut buffer) = (Decoder::new(), [0; 64]);
/// let answer = loop {
///     let count = rig.read(&mut buffer, Duration::from_millis(100));
///     assert_ne!(count, 0, "no answer within 100 ms");
///     let messages = buffer[..count].iter().filter_map(|&byte| decoder.push(byte));
///     if let Some(RigMessage::Hello(answer)) = messages.last() {
///         break answer;
///     }
/// };
/// assert_eq!(answer.board.as_str(), "sim:linear");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct InProcessRig {
    /// The future of `serve`, which owns the board and the link. It never ends.
    rig: Pin<Box<dyn Future<Output = ()>>>,
    clock: FrameClock,
    train: TrainInUse,
    line: Rc<RefCell<SerialLine>>,
    now: Duration,
    next_edge: Duration,
    /// The instant of simulated time 0, if simulated time follows the clock on the wall.
    started: Option<Instant>,
}

impl InProcessRig {
    /// A rig that was just switched on.
    pub fn new(options: &SimulationOptions) -> Result<Self, OptionsError> {
        Self::observed(options, |_| {})
    }

    /// A rig that passes every PWM frame to `observer`, with the true angles behind its samples.
    pub fn observed(
        options: &SimulationOptions,
        observer: impl FnMut(&SimulatedFrame) + 'static,
    ) -> Result<Self, OptionsError> {
        let clock = FrameClock::default();
        let mut board = SimulatedBoard::new(options, clock.clone(), Box::new(observer))?;
        let train = board.train_in_use();
        let next_edge = frame_length(&train);
        let line = Rc::new(RefCell::new(SerialLine::new(options.line)));
        let mut link = RigEnd(line.clone());
        Ok(Self {
            rig: Box::pin(async move { serve(&mut board, &mut link).await }),
            clock,
            train,
            line,
            now: Duration::ZERO,
            next_edge,
            started: options.realtime.then(Instant::now),
        })
    }

    /// Simulated time since the rig was switched on.
    pub fn now(&self) -> Duration {
        self.now
    }

    /// Whether simulated time follows the clock on the wall.
    pub fn is_realtime(&self) -> bool {
        self.started.is_some()
    }

    /// Sends `bytes`. They take their time on the line, which passes in [`read`](Self::read).
    pub fn write(&mut self, bytes: &[u8]) {
        self.line.borrow_mut().host_writes(bytes);
    }

    /// Waits until bytes have come and copies them to `buffer`; returns how many, or 0 when
    /// `timeout` of simulated time has passed without any.
    ///
    /// With a `timeout` of 0 no time passes, so an endless loop of such reads waits for ever.
    pub fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> usize {
        let deadline = self.now.saturating_add(timeout);
        loop {
            let count = self.line.borrow_mut().host_reads(buffer);
            if count > 0 || self.now >= deadline {
                return count;
            }
            self.advance(deadline.min(self.next_edge));
        }
    }

    /// Advances simulated time to `to`, which is not beyond the next frame edge.
    fn advance(&mut self, to: Duration) {
        if let Some(started) = self.started {
            std::thread::sleep(to.saturating_sub(started.elapsed()));
        }
        self.line.borrow_mut().advance(to - self.now);
        self.now = to;
        let is_edge = self.now == self.next_edge;
        if is_edge {
            self.clock.set(self.clock.get() + 1);
        }
        // One poll is enough: it checks both the frame and the link.
        let mut context = Context::from_waker(Waker::noop());
        let _ = self.rig.as_mut().poll(&mut context);
        if is_edge {
            self.next_edge += frame_length(&self.train);
        }
    }
}

fn frame_length(train: &TrainInUse) -> Duration {
    Duration::from_micros(train.get().frame_us().into())
}
