//! The program on a real terminal: a pseudo-terminal that `setsid` makes the controlling one.

use rustix::process::Pid;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Termios, Winsize, tcgetattr, tcsetwinsize};
use std::fs::File;
use std::io::{Read, Write};
use std::process::{Child, Command, ExitStatus};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// A run takes some ten seconds; the rest is for a loaded machine.
const LIMIT: Duration = Duration::from_secs(60);

/// `servoid` in a terminal of 80 x 24. Dropping it ends the program if it still runs.
pub struct Session {
    child: Child,
    keyboard: File,
    terminal: File,
    before: [u64; 4],
    screen: Arc<Mutex<Vec<u8>>>,
    held: Arc<AtomicBool>,
}

impl Session {
    /// Starts `servoid` with these arguments.
    pub fn begin(args: &[&str]) -> Self {
        Self::begin_on("xterm-256color", args)
    }

    /// The same on a terminal of this kind.
    pub fn begin_on(kind: &str, args: &[&str]) -> Self {
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
        let before = modes(&tcgetattr(&terminal).unwrap());
        let child = Command::new("setsid")
            .arg("--ctty")
            .arg(env!("CARGO_BIN_EXE_servoid"))
            .args(args)
            .env("TERM", kind)
            .stdin(open())
            .stdout(open())
            .stderr(open())
            .spawn()
            .expect("setsid, of util-linux, is installed");
        let screen = Arc::new(Mutex::new(Vec::new()));
        let held = Arc::new(AtomicBool::new(false));
        let theirs = (Arc::clone(&screen), Arc::clone(&held));
        std::thread::spawn(move || {
            let (screen, held) = theirs;
            let mut bytes = [0; 4096];
            while let Ok(count @ 1..) = output.read(&mut bytes) {
                screen.lock().unwrap().extend(&bytes[..count]);
                while held.load(Ordering::SeqCst) {
                    std::thread::sleep(Duration::from_millis(20));
                }
            }
        });
        Self {
            child,
            keyboard,
            terminal,
            before,
            screen,
            held,
        }
    }

    /// The program.
    pub fn pid(&self) -> Pid {
        Pid::from_child(&self.child)
    }

    /// All that has been put on the screen so far.
    pub fn seen(&self) -> String {
        String::from_utf8_lossy(&self.screen.lock().unwrap()).into_owned()
    }

    /// Waits until what is on the screen is as it has to be; `what` says what is missing otherwise.
    pub fn wait_for(&self, what: &str, there: impl Fn(&str) -> bool) {
        let started = Instant::now();
        while !there(&self.seen()) {
            assert!(started.elapsed() < LIMIT, "{what}: {}", self.seen());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Presses keys.
    pub fn press(&mut self, keys: &str) {
        self.keyboard.write_all(keys.as_bytes()).unwrap();
    }

    /// Waits for a question, and answers it.
    pub fn answer(&mut self, question: &str, keys: &str) {
        self.wait_for(question, |seen| seen.contains(question));
        self.press(keys);
        self.press("\r");
    }

    /// Another size of the terminal.
    pub fn resize(&self, columns: u16, rows: u16) {
        resize(&self.keyboard, columns, rows);
    }

    /// Lets the terminal take nothing any more, once its buffer is full, as a connection that hangs.
    pub fn hold(&self) {
        self.held.store(true, Ordering::SeqCst);
    }

    /// Fills the terminal's buffer, so that the next byte of the program has to wait.
    pub fn fill(&self) {
        use rustix::fs::OFlags;
        let name = rustix::termios::ttyname(&self.terminal, Vec::new()).unwrap();
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK;
        // A file of its own: the program's must go on waiting.
        let own = rustix::fs::open(name.as_c_str(), flags, rustix::fs::Mode::empty()).unwrap();
        // The reader takes what is there before it holds.
        for _ in 0..20 {
            while rustix::io::write(&own, &[b'.'; 64]).is_ok() {}
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Whether the terminal is as it was before the program began.
    pub fn is_as_before(&self) -> bool {
        modes(&tcgetattr(&self.terminal).unwrap()) == self.before
    }

    /// Waits for the program's end.
    pub fn end(&mut self) -> ExitStatus {
        let started = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status;
            }
            assert!(started.elapsed() < LIMIT, "it does not end");
            std::thread::sleep(Duration::from_millis(20));
        }
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
