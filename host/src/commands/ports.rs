//! `servoid ports`

use super::Talk;
use crate::instrument::port;
use crate::instrument::rig::{ClientError, RigClient, TalkError};
use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;
use serialport::SerialPortType;

/// List the serial ports, those that answer as a rig first
#[derive(Debug, Args)]
#[command(after_help = "Example:
  servoid ports")]
pub(super) struct Ports {
    #[command(flatten)]
    talk: Talk,
}

/// A serial port, and what answers there.
#[derive(Serialize)]
pub(super) struct Found {
    pub(super) port: String,
    device: String,
    rig: Option<String>,
    error: Option<String>,
}

impl Found {
    /// One line of a table.
    fn in_words(&self) -> String {
        format!("{:24} {:32} {}", self.port, self.device, self.answer())
    }

    /// One line of a list to choose from.
    pub(super) fn in_few_words(&self) -> String {
        format!("{}: {}", self.port, self.answer())
    }

    /// Whether there is a rig.
    pub(super) fn answers(&self) -> bool {
        self.rig.is_some()
    }

    fn answer(&self) -> String {
        match (&self.rig, &self.error) {
            (Some(rig), _) => format!("servoid rig: {rig}"),
            (None, Some(error)) => error.clone(),
            (None, None) => "no rig answers".to_owned(),
        }
    }
}

/// Which of the ports have answered, in one sentence.
pub(super) fn summary(found: &[Found]) -> String {
    let answering: Vec<&str> = found
        .iter()
        .filter(|port| port.answers())
        .map(|port| port.port.as_str())
        .collect();
    match (&answering[..], found) {
        ([], []) => "there are no serial ports: is the board plugged in?".to_owned(),
        ([], [only]) => format!("no rig answers at {}, the only serial port", only.port),
        ([], several) => format!("no rig answers at any of {} serial ports", several.len()),
        (some, _) => format!("a rig answers at {}", some.join(", ")),
    }
}

/// The serial ports, those that answer as a rig first.
pub(super) fn find() -> Result<Vec<Found>> {
    let ports = serialport::available_ports().context("the serial ports cannot be listed")?;
    // Each silent port takes its whole time-out, so all are asked at once.
    let askers: Vec<_> = ports
        .into_iter()
        .map(|port| std::thread::spawn(move || ask(port)))
        .collect();
    let mut found: Vec<Found> = askers
        .into_iter()
        .filter_map(|asker| asker.join().ok())
        .collect();
    found.sort_by(|a, b| (!a.answers(), &a.port).cmp(&(!b.answers(), &b.port)));
    Ok(found)
}

impl Ports {
    pub(super) fn run(self) -> Result<String> {
        let found = find()?;
        let mut text: String = found.iter().map(|port| port.in_words() + "\n").collect();
        if found.is_empty() {
            text.push_str("no serial ports: is the board plugged in?\n");
        }
        text.push_str("without hardware: sim:bench, sim:aircraft, sim:linear\n");
        self.talk.result(text, &found)
    }
}

fn ask(info: serialport::SerialPortInfo) -> Found {
    let port = info.port_name;
    let device = match info.port_type {
        SerialPortType::UsbPort(usb) => {
            let product = usb.product.unwrap_or_default();
            format!("USB {:04x}:{:04x} {product}", usb.vid, usb.pid)
        }
        SerialPortType::PciPort => "built in".to_owned(),
        SerialPortType::BluetoothPort => "Bluetooth".to_owned(),
        SerialPortType::Unknown => String::new(),
    };
    let client = match port::open(&port) {
        Ok(stream) => RigClient::probe(stream, &port),
        Err(error) => {
            return Found {
                port,
                device,
                rig: None,
                error: Some(error.to_string()),
            };
        }
    };
    let rig = match client {
        Ok(client) => {
            let hello = client.hello();
            Some(format!(
                "{}, firmware {}",
                hello.board.as_str(),
                hello.build.as_str()
            ))
        }
        Err(TalkError::Rig(ClientError::RunOfAnother)) => Some("a run is under way".to_owned()),
        Err(_) => None,
    };
    Found {
        port,
        device,
        rig,
        error: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_answers_is_said() {
        let port = |port: &str, rig: bool| Found {
            port: port.into(),
            device: String::new(),
            rig: rig.then(|| "bench, firmware 1".into()),
            error: None,
        };
        let said = |found: &[Found]| summary(found);
        assert!(said(&[]).contains("plugged in"));
        assert!(said(&[port("/dev/ttyS0", false)]).contains("no rig answers at /dev/ttyS0"));
        let both = [port("/dev/ttyUSB0", true), port("/dev/ttyS0", false)];
        assert_eq!(said(&both), "a rig answers at /dev/ttyUSB0");
        let silent = [port("/dev/ttyS0", false), port("/dev/ttyS1", false)];
        assert!(said(&silent).contains("any of 2"));
    }
}
