//! The live scope on a real terminal: a pseudo-terminal that `setsid` makes the controlling one.

use super::support::arg;
use rustix::process::{Pid, Signal, kill_process};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Termios, Winsize, tcgetattr, tcsetwinsize};
use servoid::recording::{Completeness, Recording};
use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

const ENTER: &str = "\x1b[?1049h";
const LEAVE: &str = "\x1b[?1049l";

/// The run itself takes 8.8 s; the rest is for a loaded machine.
const LIMIT: Duration = Duration::from_secs(60);

/// A capture in a terminal of 80 x 24. Dropping it ends the program if it still runs.
struct Session {
    child: Child,
    keyboard: File,
    terminal: File,
    before: Termios,
    screen: Arc<Mutex<Vec<u8>>>,
}

impl Session {
    fn begin(file: &Path, more: &[&str]) -> Self {
        let controller = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        grantpt(&controller).unwrap();
        unlockpt(&controller).unwrap();
        let name = ptsname(&controller, Vec::new()).unwrap();
        let mut output = File::from(controller);
        let keyboard = output.try_clone().unwrap();
        resize(&keyboard, 80, 24);
        let open = || {
            use rustix::fs::{Mode, OFlags};
            let flags = OFlags::RDWR | OFlags::NOCTTY;
            File::from(rustix::fs::open(name.as_c_str(), flags, Mode::empty()).unwrap())
        };
        let terminal = open();
        let before = tcgetattr(&terminal).unwrap();
        let child = Command::new("setsid")
            .arg("--ctty")
            .arg(env!("CARGO_BIN_EXE_servoid"))
            .args(["capture", "--port", "sim:bench?realtime", "-o", arg(file)])
            .args(more)
            .env("TERM", "xterm-256color")
            .stdin(open())
            .stdout(open())
            .stderr(open())
            .spawn()
            .expect("setsid, of util-linux, is installed");
        let screen = Arc::new(Mutex::new(Vec::new()));
        let theirs = Arc::clone(&screen);
        std::thread::spawn(move || {
            let mut bytes = [0; 4096];
            while let Ok(count @ 1..) = output.read(&mut bytes) {
                theirs.lock().unwrap().extend(&bytes[..count]);
            }
        });
        Self {
            child,
            keyboard,
            terminal,
            before,
            screen,
        }
    }

    fn pid(&self) -> Pid {
        Pid::from_child(&self.child)
    }

    fn seen(&self) -> String {
        String::from_utf8_lossy(&self.screen.lock().unwrap()).into_owned()
    }

    fn wait_for(&self, what: &str, there: impl Fn(&str) -> bool) {
        let started = Instant::now();
        while !there(&self.seen()) {
            assert!(started.elapsed() < LIMIT, "{what}: {}", self.seen());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    fn wait_for_rows(&self, file: &Path) {
        self.wait_for("no rows came", |_| {
            std::fs::metadata(file).is_ok_and(|m| m.len() > 4000)
        });
    }

    fn end(&mut self) -> ExitStatus {
        let started = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status;
            }
            assert!(started.elapsed() < LIMIT, "it does not end");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// The program has ended well, the terminal is as it was, and the data is kept.
    fn require_stopped_safely(&mut self, file: &Path) {
        let status = self.end();
        self.wait_for("the screen is not given back", |seen| seen.contains(LEAVE));
        let seen = self.seen();
        assert!(status.success(), "{status}: {seen}");
        assert!(!seen.contains("panicked"), "{seen}");
        assert_eq!(seen.matches(ENTER).count(), 1);
        let after = tcgetattr(&self.terminal).unwrap();
        assert_eq!(modes(&after), modes(&self.before));
        let recording = Recording::read(file).unwrap();
        let Completeness::Partial(reason) = &recording.completeness else {
            panic!("it is partial")
        };
        // The recording says so only where the rig itself has confirmed that it stopped.
        assert_eq!(reason, "stopped by the user");
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // A child that has ended cannot be killed, which is as well.
        let _ended = self.child.kill();
        let _status = self.child.wait();
    }
}

fn resize(terminal: &File, columns: u16, rows: u16) {
    let size = Winsize {
        ws_col: columns,
        ws_row: rows,
        ws_xpixel: 0,
        ws_ypixel: 0,
    };
    tcsetwinsize(terminal, size).unwrap();
}

fn modes(termios: &Termios) -> [u64; 4] {
    [
        u64::from(termios.input_modes.bits()),
        u64::from(termios.output_modes.bits()),
        u64::from(termios.control_modes.bits()),
        u64::from(termios.local_modes.bits()),
    ]
}

/// On the way the terminal becomes tiny and large; q held down is one wish to stop, not two.
#[test]
fn q_stops_the_run_and_gives_the_terminal_back() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let mut session = Session::begin(&file, &[]);
    session.wait_for("no scope", |seen| {
        seen.contains(ENTER) && seen.contains("servoid capture")
    });
    assert_ne!(
        modes(&tcgetattr(&session.terminal).unwrap()),
        modes(&session.before)
    );
    session.wait_for_rows(&file);
    for (columns, rows) in [(1, 1), (40, 12), (200, 60), (80, 24)] {
        resize(&session.keyboard, columns, rows);
        // Some pictures of that size.
        std::thread::sleep(Duration::from_millis(200));
    }
    session.keyboard.write_all(b"q").unwrap();
    session.keyboard.write_all(b"q").unwrap();
    session.require_stopped_safely(&file);
}

#[test]
fn a_signal_stops_the_run_and_gives_the_terminal_back() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("x.csv");
    let mut session = Session::begin(&file, &[]);
    session.wait_for("no scope", |seen| seen.contains(ENTER));
    session.wait_for_rows(&file);
    kill_process(session.pid(), Signal::TERM).unwrap();
    session.require_stopped_safely(&file);
}

#[test]
fn scripts_get_no_scope_even_on_a_terminal() {
    for word in ["--quiet", "--plain"] {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("x.csv");
        let mut session = Session::begin(&file, &[word]);
        session.wait_for_rows(&file);
        kill_process(session.pid(), Signal::TERM).unwrap();
        assert!(session.end().success());
        assert!(!session.seen().contains(ENTER), "{word}");
    }
}
