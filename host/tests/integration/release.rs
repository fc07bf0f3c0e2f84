//! The end of the pulses after a capture.

use super::support::{arg, servoid};
use servoid::data::recording::{Completeness, Recording};
use servoid::instrument::port::Port;
use servoid_protocol::framing::Decoder;
use servoid_protocol::message::{Command, Request};
use servoid_simulator::InProcessRig;
use std::io::{Read, Write};
use std::net::TcpListener;
use std::time::Duration;

/// A bridge to a simulated rig, up to the end of the connection. Returns whether it was asked to end the pulses; where it
/// does not `pass_release` on, the connection ends then.
fn bridge(listener: &TcpListener, pass_release: bool) -> bool {
    let mut rig = InProcessRig::new(&"linear".parse().unwrap()).unwrap();
    let (mut stream, _) = listener.accept().unwrap();
    stream.set_nonblocking(true).unwrap();
    let (mut heard, mut released) = (Decoder::new(), false);
    let mut buffer = [0; 512];
    loop {
        match stream.read(&mut buffer) {
            Ok(0) => return released,
            Ok(count) => {
                for &byte in &buffer[..count] {
                    let request = heard.push::<Request>(byte);
                    released |= request.is_some_and(|r| matches!(r.command, Command::Disarm));
                }
                if released && !pass_release {
                    return true;
                }
                rig.write_all(&buffer[..count]).unwrap();
            }
            Err(_nothing_came) => {}
        }
        let count = Port::read(&mut rig, &mut buffer, Duration::from_millis(2)).unwrap();
        std::thread::sleep(Duration::from_millis(1));
        if stream.write_all(&buffer[..count]).is_err() {
            return released;
        }
    }
}

#[test]
fn pulses_end_after_the_last_run_where_that_was_asked_for_and_what_fails_is_said() {
    for (release, pass_release, code) in [(false, true, 0), (true, true, 0), (true, false, 1)] {
        let dir = tempfile::tempdir().unwrap();
        let (steps, file) = (dir.path().join("steps.csv"), dir.path().join("x.csv"));
        std::fs::write(&steps, "angle_deg,hold_s\n5,0.3\n-5,0.3\n").unwrap();
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = format!("tcp:{}", listener.local_addr().unwrap());
        let bridge = std::thread::spawn(move || bridge(&listener, pass_release));
        let capture = ["capture", "--port", &port, "--reference", arg(&steps)];
        let asked: &[&str] = if release { &["--release"] } else { &[] };
        let output = servoid(&[&capture[..], asked, &["-o", arg(&file)]].concat())
            .output()
            .unwrap();
        assert_eq!(bridge.join().unwrap(), release);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{said}");
        assert_eq!(
            said.contains("the servo still gets pulses"),
            code == 1,
            "{said}"
        );
        let recording = Recording::read(&file).unwrap();
        assert_eq!(recording.completeness, Completeness::Complete);
    }
}
