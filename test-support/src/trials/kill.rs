//! `kill -9` in the middle of a capture at real pace.

use servoid::data::recording::{Completeness, Recording};
use servoid_protocol::timing::{FRAME_US, SAMPLES_PER_FRAME};
use servoid_protocol::{Decoder, RigMessage};
use servoid_simulator::InProcessRig;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The loop below turns so often, unless the machine has no time for it.
const TURN: Duration = Duration::from_millis(1);

/// The cost of a kill.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// From the last row in the file to the moment of the kill.
    pub missing: Duration,
    /// By how much this program itself was late at worst meanwhile: what the machine, not the
    /// capture, may be blamed for.
    pub lateness: Duration,
}

/// Captures with the program `servoid` from a rig in this process, which keeps real time, and kills
/// it when the rig is `at` old; then reads the file.
pub fn trial(servoid: &Path, folder: &Path, at: Duration) -> Result<Cost, String> {
    let file = folder.join(format!("killed-{}.csv", at.as_micros()));
    let listener = TcpListener::bind("127.0.0.1:0").map_err(|e| e.to_string())?;
    let address = listener.local_addr().map_err(|e| e.to_string())?;
    let mut child = Command::new(servoid)
        .args([
            "capture",
            "--quiet",
            "--port",
            &format!("tcp:{address}"),
            "-o",
        ])
        .arg(&file)
        .stdout(Stdio::null())
        .spawn()
        .map_err(|e| e.to_string())?;
    let (stream, _) = listener.accept().map_err(|e| e.to_string())?;
    let served = serve_until_killed(stream, &mut child, at);
    let _reaped = child.wait();
    let killed = served.map_err(|e| e.to_string())?;
    let recording = Recording::read(&file).map_err(|e| e.to_string())?;
    let _best_effort = std::fs::remove_file(&file);
    killed.hold_against(&recording)
}

/// The state of the rig when the program was killed.
struct Killed {
    newest: Option<u16>,
    /// From the end of the newest frame to the kill.
    since_newest: Duration,
    lateness: Duration,
}

fn serve_until_killed(
    mut stream: TcpStream,
    child: &mut Child,
    at: Duration,
) -> std::io::Result<Killed> {
    stream.set_nonblocking(true)?;
    stream.set_nodelay(true)?;
    let options = "linear?realtime&noise=white"
        .parse()
        .map_err(std::io::Error::other)?;
    let mut rig = InProcessRig::new(&options).map_err(std::io::Error::other)?;
    let (mut decoder, mut buffer) = (Decoder::new(), [0; 512]);
    let (mut newest, mut lateness) = (None, Duration::ZERO);
    while rig.now() < at {
        let turn = Instant::now();
        let count = rig.read(&mut buffer, TURN);
        let sent = buffer.get(..count).unwrap_or_default();
        for &byte in sent {
            if let Some(RigMessage::Frame(frame)) = decoder.push(byte) {
                newest = Some(frame.index);
            }
        }
        stream.write_all(sent)?;
        match stream.read(&mut buffer) {
            Ok(count) => rig.write(buffer.get(..count).unwrap_or_default()),
            Err(e) if e.kind() == std::io::ErrorKind::WouldBlock => {}
            Err(e) => return Err(e),
        }
        lateness = lateness.max(turn.elapsed().saturating_sub(TURN));
    }
    child.kill()?;
    let frame = Duration::from_micros(FRAME_US.into());
    let into_the_frame = Duration::from_nanos((rig.now().as_nanos() % frame.as_nanos()) as u64);
    Ok(Killed {
        newest,
        since_newest: into_the_frame,
        lateness,
    })
}

impl Killed {
    fn hold_against(&self, recording: &Recording) -> Result<Cost, String> {
        let rows = recording.rows.len();
        if !matches!(recording.completeness, Completeness::Partial(_)) {
            return Err("it is not partial".to_owned());
        }
        if !recording
            .rows
            .iter()
            .map(|row| row.sample)
            .eq(0..rows as u64)
        {
            return Err("its rows are not the first ones".to_owned());
        }
        let made = self.newest.map_or(0, |index| u32::from(index) + 1);
        let kept = (rows / SAMPLES_PER_FRAME) as u32;
        let frames = made.saturating_sub(kept);
        Ok(Cost {
            missing: Duration::from_micros(FRAME_US.into()) * frames + self.since_newest,
            lateness: self.lateness,
        })
    }
}
