//! The flash image, a board with it, and a capture from it by the host's own code.

use servoid::data::recording::{Header, RecordingWriter};
use servoid::data::rig_file::RigFile;
use servoid::instrument::port::Port;
use servoid::instrument::rig::RigClient;
use servoid::instrument::rig::{Capture, CaptureEnd, CaptureError};
use servoid_protocol::message::Arm;
use servoid_protocol::reference::{Reference, Staircase};
use servoid_protocol::schema::SCHEMA_HASH;
use servoid_protocol::{Counts, Frame, PulseWidth};
use servoid_simulator::SENSOR_SCALE;
use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;
use std::time::Duration;
use virtual_board::cpu::Core;
use virtual_board::cpu::rsemu::RsemuCore;
use virtual_board::time::{Ticks, microseconds, milliseconds, to_duration};
use virtual_board::{BoardOptions, Image, VirtualBoard};

/// The image, built if it has to be.
pub fn image() -> Image {
    Image::read(&servoid_firmware_image::build().unwrap()).unwrap()
}

/// Options of a board with this servo and these faults, as on the command line.
pub fn options(servo: &str, faults: &[&str]) -> BoardOptions {
    let mut options = BoardOptions::new(servo.parse().unwrap());
    options.faults = faults.iter().map(|fault| fault.parse().unwrap()).collect();
    options
}

/// Conversions summed into one sample.
pub const OVERSAMPLING: usize = 4;
/// From the beginning of a frame to its first conversion: half a millisecond, and the three cycles of 12 MHz that the
/// ADC takes to hear its trigger.
pub const FIRST_SAMPLE: Ticks = microseconds(500) + microseconds(1) / 4;
/// Period of the pulses.
pub const FRAME: Ticks = milliseconds(20);

/// Text of the board's log about frames that the board lost.
pub const LOST: &str = "frames lost";

/// Without a crystal the board waits for one for 50 ms; then comes a frame of 20 ms.
const BOOT: Ticks = milliseconds(150);

/// A board whose time goes on while the host waits for it.
pub struct SharedBoard<C: Core = RsemuCore>(Rc<RefCell<VirtualBoard<C>>>);

impl SharedBoard {
    pub fn new(options: &BoardOptions) -> Self {
        VirtualBoard::new(image(), options).unwrap().into()
    }
}

impl<C: Core> From<VirtualBoard<C>> for SharedBoard<C> {
    /// A board that has been on for long enough to hear and to have sampled a frame.
    fn from(mut board: VirtualBoard<C>) -> Self {
        board.run_until(BOOT);
        Self(Rc::new(RefCell::new(board)))
    }
}

impl<C: Core + 'static> SharedBoard<C> {
    pub fn with<T>(&self, look: impl FnOnce(&mut VirtualBoard<C>) -> T) -> T {
        look(&mut self.0.borrow_mut())
    }

    /// Lets `time` pass.
    pub fn pass(&self, time: Duration) {
        self.with(|board| {
            let until = board.now() + virtual_board::time::from_duration(time);
            board.run_until(until);
        });
    }

    /// Simulated time since the board was switched on.
    pub fn time(&self) -> Ticks {
        self.with(|board| board.now())
    }

    /// Another hand on the board's line.
    pub fn port(&self) -> Self {
        Self(self.0.clone())
    }

    pub fn connect(&self) -> RigClient {
        RigClient::connect(Box::new(self.port()), "the virtual board").unwrap()
    }

    /// Irregularities of the program, as text.
    pub fn violations(&self) -> Vec<String> {
        self.with(|board| {
            let chip = board.chip();
            // A handful is enough.
            chip.record
                .violations
                .iter()
                .take(5)
                .map(ToString::to_string)
                .collect()
        })
    }
}

impl<C: Core + 'static> Port for SharedBoard<C> {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> std::io::Result<usize> {
        Ok(self.with(|board| board.read(buffer, timeout)))
    }

    fn write_all(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.with(|board| board.write(bytes));
        Ok(())
    }

    fn now(&self) -> Duration {
        self.with(|board| to_duration(board.now()))
    }
}

/// The rig file of a simulated servo and sensor.
pub fn rig_file() -> RigFile {
    let mut rig = RigFile::default();
    rig.sensor.zero_counts = SENSOR_SCALE.zero_counts;
    rig.sensor.degrees_per_count = SENSOR_SCALE.degrees_per_count;
    rig
}

/// The limits of the rig file, with a lease of two seconds.
pub fn arm() -> Arm {
    let rig = rig_file();
    let [sensor_low, sensor_high] = rig.sensor.healthy_counts.map(Counts);
    Arm {
        schema_hash: SCHEMA_HASH,
        neutral: PulseWidth(rig.servo.neutral_us),
        shortest: PulseWidth(rig.limits.shortest_us),
        longest: PulseWidth(rig.limits.longest_us),
        sensor_low,
        sensor_high,
        lease_frames: 100,
    }
}

/// The paper's staircase.
pub fn staircase() -> Capture {
    Capture::new(rig_file(), Reference::Staircase(Staircase::PAPER))
}

/// Captures into `file`; the frames as they came, in order.
pub fn capture(
    client: &mut RigClient,
    capture: &Capture,
    file: &Path,
) -> (Result<CaptureEnd, CaptureError>, Vec<Frame>) {
    capture.arm(client).unwrap();
    let header = Header::of_run(client.hello(), &capture.rig, &capture.start);
    let writer = RecordingWriter::create(file, true, &header).unwrap();
    let mut frames = Vec::new();
    let end = capture.record(client, writer, &|| None, &mut |progress| {
        frames.push(*progress.frame);
    });
    (end, frames)
}
