//! Captures by the program itself while everything goes wrong at once: line, terminal, disk, signals, another host, and
//! a rig that lies.
//!
//! The program talks to a rig in this process through a man in the middle, who knows what the board really sampled. He
//! uses none of the host's code but its reader of files: what a file says is compared with the board's own log.

use super::judge::require_board_rows;
use crate::bad_line::{ChaosPort, Faults};
use rand::RngExt;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use servoid::data::recording::{Completeness, Recording};
use servoid::instrument::port::Port;
use servoid_protocol::message::{Activity, Command as Ask, EndReason, Ended, Request, Status};
use servoid_protocol::{Counts, Decoder, Frame, PulseWidth, RigMessage, framing};
use servoid_simulator::{InProcessRig, SimulatedFrame};
use std::cell::RefCell;
use std::io::{Read, Seek, SeekFrom, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::rc::Rc;
use std::time::{Duration, Instant};

/// Two steps of 0.3 s, and 0.8 s of rest before and after them.
const STEPS: &str = "angle_deg,hold_s\n5,0.3\n-5,0.3\n";
const RUN_FRAMES: usize = 110;

/// The loop of the man in the middle turns so often.
const TURN: Duration = Duration::from_millis(2);

/// A program that has not ended by itself then, is asked to.
const PATIENCE: Duration = Duration::from_secs(12);

/// From then on it may take so long.
const ENDS_WITHIN: Duration = Duration::from_secs(2);

/// Bytes that a pipe takes before whoever writes into it has to wait.
const PIPE: usize = 65_536;

/// What a lying rig says in one place of the run.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Lie {
    Pulse(u16),
    IndexBeyond,
    Counts,
    Short,
    OldStatus,
    FalseEnd,
}

/// What is done to the file under way.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Damage {
    Cut,
    Overwritten,
    Removed,
}

/// What is sent to the program under way.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Signals {
    Term,
    TwoAtOnce,
    StopAndGoOn(Duration),
}

/// One mix.
#[derive(Clone, Debug)]
struct Mix {
    line: Faults,
    terminal_is_blocked: bool,
    plain: bool,
    lie: Option<(Lie, u16)>,
    damage: Option<(Damage, Duration)>,
    signals: Option<(Signals, Duration)>,
    other_host: bool,
}

impl Mix {
    fn drawn(rng: &mut ChaCha8Rng) -> Self {
        let rates = [0.0, 0.0, 0.01, 0.05];
        let at = |rng: &mut ChaCha8Rng| Duration::from_millis(rng.random_range(300..3_500));
        let pulses = [1, 1_501, 2_500, 3_000, 65_535];
        let lies = [
            Lie::Pulse(pulses[rng.random_range(0..pulses.len())]),
            Lie::IndexBeyond,
            Lie::Counts,
            Lie::Short,
            Lie::OldStatus,
            Lie::FalseEnd,
        ];
        let damages = [Damage::Cut, Damage::Overwritten, Damage::Removed];
        let pause = Duration::from_millis(rng.random_range(100..3_000));
        let signals = [
            Signals::Term,
            Signals::TwoAtOnce,
            Signals::StopAndGoOn(pause),
        ];
        Self {
            line: Faults::of_rate(rates[rng.random_range(0..rates.len())]),
            terminal_is_blocked: rng.random_bool(0.4),
            plain: rng.random_bool(0.5),
            lie: rng.random_bool(0.4).then(|| {
                (
                    lies[rng.random_range(0..lies.len())],
                    rng.random_range(0..100),
                )
            }),
            damage: rng
                .random_bool(0.2)
                .then(|| (damages[rng.random_range(0..damages.len())], at(rng))),
            signals: rng
                .random_bool(0.3)
                .then(|| (signals[rng.random_range(0..signals.len())], at(rng))),
            other_host: rng.random_bool(0.3),
        }
    }
}

/// The outcome of a mix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The program reports a complete recording, and it is.
    Complete,
    /// A partial recording, or one that was saved elsewhere.
    Partial,
    /// No recording, with a sentence.
    Refused,
}

/// Runs the mix of this seed with the program `servoid`, in a folder that is empty.
///
/// # Errors
/// What was hung, silently wrong, or reported complete and is not; with the mix.
pub fn trial(servoid: &Path, folder: &Path, seed: u64) -> Result<Outcome, String> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mix = Mix::drawn(&mut rng);
    run(servoid, folder, seed, &mix, &mut rng).map_err(|how| format!("{how}: {mix:?}"))
}

fn run(
    servoid: &Path,
    folder: &Path,
    seed: u64,
    mix: &Mix,
    rng: &mut ChaCha8Rng,
) -> Result<Outcome, String> {
    let text = |error: std::io::Error| error.to_string();
    let (steps, file) = (folder.join("steps.csv"), folder.join("x.csv"));
    std::fs::write(&steps, STEPS).map_err(text)?;
    let listener = TcpListener::bind("127.0.0.1:0").map_err(text)?;
    let address = listener.local_addr().map_err(text)?;
    // A pipe that is full is a terminal that takes nothing; this end of it is never read.
    let (_unread, mut terminal) = std::io::pipe().map_err(text)?;
    if mix.terminal_is_blocked {
        terminal.write_all(&vec![b'.'; PIPE]).map_err(text)?;
    }
    let mut command = Command::new(servoid);
    command.args([
        "capture",
        "--port",
        &format!("tcp:{address}"),
        "--reference",
    ]);
    command.arg(&steps).arg("-o").arg(&file);
    if mix.plain {
        command.arg("--plain");
    }
    let stdout = terminal.try_clone().map_err(text)?;
    let child = command
        .env("TERM", "dumb")
        .stdin(Stdio::null())
        .stdout(stdout)
        .stderr(terminal)
        .spawn();
    let mut child = child.map_err(text)?;
    let log = Rc::new(RefCell::new(Vec::new()));
    let mut middle = Middle::new(seed, mix, rng, Rc::clone(&log))?;
    let served = middle.serve(&listener, &mut child, &file, mix);
    let status = match served {
        Ok(status) => status,
        Err(how) => {
            let _it_may_have_ended = child.kill();
            let _reaped = child.wait();
            return Err(how);
        }
    };
    judge(folder, &file, status, mix, &log.borrow())
}

/// The man in the middle.
struct Middle {
    port: ChaosPort<InProcessRig>,
    lie: Option<(Lie, u16)>,
    from_rig: Decoder,
    from_host: Decoder,
    old_status: Option<Status>,
    replayed: Vec<Request>,
    other_host: bool,
    visits: u16,
}

impl Middle {
    fn new(
        seed: u64,
        mix: &Mix,
        rng: &mut ChaCha8Rng,
        log: Rc<RefCell<Vec<SimulatedFrame>>>,
    ) -> Result<Self, String> {
        let options = format!("linear?realtime&noise=white&seed={}", rng.random::<u16>());
        let options = options.parse().map_err(|e| format!("{e}"))?;
        let rig = InProcessRig::observed(&options, move |frame| log.borrow_mut().push(*frame));
        let rig = rig.map_err(|e| e.to_string())?;
        Ok(Self {
            port: ChaosPort::new(rig, seed, mix.line, mix.line),
            lie: mix.lie,
            from_rig: Decoder::new(),
            from_host: Decoder::new(),
            old_status: None,
            replayed: Vec::new(),
            other_host: mix.other_host,
            visits: 0,
        })
    }

    /// Stands between the program and the rig until the program has ended, or has not when it had to.
    fn serve(
        &mut self,
        listener: &TcpListener,
        child: &mut Child,
        file: &Path,
        mix: &Mix,
    ) -> Result<ExitStatus, String> {
        let text = |error: std::io::Error| error.to_string();
        listener.set_nonblocking(true).map_err(text)?;
        let begun = Instant::now();
        let (mut stream, mut asked) = (None::<TcpStream>, None::<Instant>);
        let (mut damage, mut signals) = (mix.damage, mix.signals);
        let mut goes_on_at = None::<Instant>;
        // What a machine that is overloaded does to this loop, it does to the program.
        let (mut turned, mut longest_turn) = (Instant::now(), Duration::ZERO);
        loop {
            longest_turn = match asked {
                Some(_) => longest_turn.max(turned.elapsed()),
                None => Duration::ZERO,
            };
            turned = Instant::now();
            if let Some(status) = child.try_wait().map_err(text)? {
                return Ok(status);
            }
            if asked.is_some_and(|at| at.elapsed() > ENDS_WITHIN) {
                let stands = where_it_stands(child);
                return Err(format!(
                    "it hangs, {stands}, and the longest turn of the trial itself took {longest_turn:?}"
                ));
            }
            if stream.is_none()
                && let Ok((accepted, _)) = listener.accept()
            {
                accepted.set_nonblocking(true).map_err(text)?;
                stream = Some(accepted);
            }
            self.pass_on(stream.as_mut());
            let age = begun.elapsed();
            if let Some((what, _)) = damage.take_if(|(_, at)| age > *at) {
                spoil(file, what);
            }
            if let Some((which, _)) = signals.take_if(|(_, at)| age > *at) {
                match which {
                    Signals::Term => {
                        signal(child, "-TERM");
                        asked = Some(Instant::now());
                    }
                    Signals::TwoAtOnce => {
                        signal(child, "-INT");
                        signal(child, "-TERM");
                        asked = Some(Instant::now());
                    }
                    Signals::StopAndGoOn(pause) => {
                        signal(child, "-STOP");
                        goes_on_at = Some(Instant::now() + pause);
                    }
                }
            }
            if goes_on_at.take_if(|at| Instant::now() > *at).is_some() {
                signal(child, "-CONT");
            }
            if asked.is_none() && goes_on_at.is_none() && age > PATIENCE {
                signal(child, "-TERM");
                asked = Some(Instant::now());
            }
        }
    }

    /// One turn of bytes in both directions. A program that is gone is noticed by its end.
    fn pass_on(&mut self, stream: Option<&mut TcpStream>) {
        let mut buffer = [0; 512];
        let count = self.port.read(&mut buffer, TURN).unwrap_or(0);
        let from_rig = buffer.get(..count).unwrap_or_default().to_vec();
        let Some(stream) = stream else { return };
        let to_host = match self.lie {
            Some(_) => self.with_lies(&from_rig),
            None => from_rig,
        };
        let _gone = stream.write_all(&to_host);
        if let Ok(count) = stream.read(&mut buffer) {
            let from_host = buffer.get(..count).unwrap_or_default();
            for &byte in from_host {
                if let Some(request) = self.from_host.push::<Request>(byte) {
                    self.replayed.push(request);
                }
            }
            let _simulated = self.port.write_all(from_host);
            if self.other_host && count > 0 {
                self.visit();
            }
        }
    }

    /// What another host says, and old requests of the first one.
    fn visit(&mut self) {
        self.visits += 1;
        let own = Request {
            session: 0x7777,
            id: self.visits,
            command: [Ask::Hello, Ask::Disarm, Ask::KeepAlive][usize::from(self.visits % 3)],
        };
        let old = self.replayed.len().checked_sub(3);
        let old = old.and_then(|place| self.replayed.get(place)).copied();
        for request in [Some(own), old].into_iter().flatten() {
            if let Ok(wire) = framing::encode(&request, &mut [0; framing::MAX_WIRE]) {
                let _simulated = self.port.write_all(wire);
            }
        }
    }

    /// The rig's messages with the lie among them; what cannot be read stays away.
    fn with_lies(&mut self, from_rig: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        for &byte in from_rig {
            if let Some(message) = self.from_rig.push::<RigMessage>(byte) {
                for said in self.says(message) {
                    if let Ok(wire) = framing::encode(&said, &mut [0; framing::MAX_WIRE]) {
                        bytes.extend_from_slice(wire);
                    }
                }
            }
        }
        bytes
    }

    fn says(&mut self, message: RigMessage) -> Vec<RigMessage> {
        let Some((lie, place)) = self.lie else {
            return vec![message];
        };
        match (lie, message) {
            (Lie::Pulse(pulse), RigMessage::Frame(frame)) if frame.index == place => {
                vec![RigMessage::Frame(Frame {
                    pulse: PulseWidth(pulse),
                    ..frame
                })]
            }
            (Lie::IndexBeyond, RigMessage::Frame(frame)) if frame.index == place => {
                vec![RigMessage::Frame(Frame {
                    index: frame.index + 1_000,
                    ..frame
                })]
            }
            (Lie::Counts, RigMessage::Frame(mut frame)) if frame.index == place => {
                frame.samples[3] = Counts(frame.samples[3].0 ^ 1);
                vec![RigMessage::Frame(frame)]
            }
            (Lie::Short, RigMessage::Ended(ended)) => vec![RigMessage::Ended(Ended {
                frames: ended.frames.min(place),
                ..ended
            })],
            (Lie::OldStatus, RigMessage::Status(status)) => {
                let old = *self.old_status.get_or_insert(Status {
                    activity: Activity::Armed,
                    ..status
                });
                vec![RigMessage::Status(old), message]
            }
            (Lie::FalseEnd, RigMessage::Frame(frame)) if frame.index == place => {
                let end = Ended {
                    run: frame.run,
                    reason: EndReason::Complete,
                    frames: place,
                    frames_lost_on_board: 0,
                    check: 0,
                };
                vec![message, RigMessage::Ended(end)]
            }
            _ => vec![message],
        }
    }
}

/// What each thread of the program waits for, as the system has it: a file system that stalls and a machine that is
/// overloaded look alike from outside.
fn where_it_stands(child: &Child) -> String {
    let tasks = format!("/proc/{}/task", child.id());
    let threads = std::fs::read_dir(tasks).into_iter().flatten().flatten();
    let of_thread = |folder: PathBuf| {
        let text = |name| std::fs::read_to_string(folder.join(name)).unwrap_or_default();
        let status = text("status");
        let state = status.lines().find(|line| line.starts_with("State:"));
        let state = state.unwrap_or_default().replace('\t', " ");
        format!("{state} in {}", text("wchan"))
    };
    let threads: Vec<_> = threads.map(|thread| of_thread(thread.path())).collect();
    format!("threads: {}", threads.join("; "))
}

fn signal(child: &Child, signal: &str) {
    let pid = child.id().to_string();
    let _it_may_have_ended = Command::new("kill").args([signal, &pid]).status();
}

/// Another program does something to the file, if it is there.
fn spoil(file: &Path, damage: Damage) {
    let opened = std::fs::OpenOptions::new().write(true).open(file);
    let Ok(mut open) = opened else { return };
    let _best_effort = match damage {
        Damage::Cut => open.set_len(2_000),
        Damage::Overwritten => open
            .seek(SeekFrom::Start(1_500))
            .and_then(|_| open.write_all(b"0123456789")),
        Damage::Removed => std::fs::remove_file(file),
    };
}

fn judge(
    folder: &Path,
    file: &Path,
    status: ExitStatus,
    mix: &Mix,
    log: &[SimulatedFrame],
) -> Result<Outcome, String> {
    let mut outcome = Outcome::Refused;
    for path in recordings(folder) {
        let Ok(recording) = Recording::read(&path) else {
            outcome = Outcome::Partial;
            continue;
        };
        let complete = recording.completeness == Completeness::Complete;
        // The rows of a rig that lies are its own, unless the file calls them complete.
        if complete || mix.lie.is_none() {
            require_board_rows(&recording, log)?;
        }
        let frames = recording.rows.len() / servoid_protocol::timing::SAMPLES_PER_FRAME;
        if complete && frames != RUN_FRAMES {
            return Err(format!("{frames} frames are complete"));
        }
        if !complete || outcome == Outcome::Refused {
            outcome = if complete {
                Outcome::Complete
            } else {
                Outcome::Partial
            };
        }
    }
    let reads_back =
        Recording::read(file).is_ok_and(|file| file.completeness == Completeness::Complete);
    // An error is said to have left nothing, and 3 to have left something that is not whole.
    let left = recordings(folder).len();
    if (status.code() == Some(1)) != (left == 0) && matches!(status.code(), Some(1 | 3)) {
        return Err(format!("{status} beside {left} recordings"));
    }
    if status.success() && !reads_back {
        return Err("it reports a complete recording, and the file is none".to_owned());
    }
    Ok(outcome)
}

/// Every recording that the program has left.
fn recordings(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let paths = entries.map(|entry| entry.path());
    paths
        .filter(|path| path.file_name().is_some_and(|name| name != "steps.csv"))
        .filter(|path| path.metadata().is_ok_and(|there| there.len() > 0))
        .collect()
}
