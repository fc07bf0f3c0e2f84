//! `servoid ports`

use super::output::Talk;
use crate::instrument::port;
use crate::instrument::rig::{ClientError, RigClient, TalkError};
use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;
use serialport::SerialPortType;

/// List the serial ports, rigs first
#[derive(Debug, Args)]
#[command(after_help = "Example:
  servoid ports")]
pub(super) struct Ports {
    #[command(flatten)]
    talk: Talk,
}

/// A serial port, and the rig there, if one answers.
#[derive(Serialize)]
pub(super) struct PortProbe {
    pub(super) port: String,
    device: String,
    rig: Option<String>,
    error: Option<String>,
}

impl PortProbe {
    /// An item of a list to choose from.
    pub(super) fn item(&self) -> String {
        format!("{}: {}", self.port, self.answer())
    }

    /// Whether a rig answers.
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

/// The ports with a rig, in one sentence.
pub(super) fn summary(found: &[PortProbe]) -> String {
    let answering = found.iter().filter(|port| port.answers());
    let answering: Vec<&str> = answering.map(|port| port.port.as_str()).collect();
    match (&answering[..], found) {
        ([], []) => "no serial ports were found: plug in the board".to_owned(),
        ([], [only]) => format!("no rig answers at {}, the only serial port", only.port),
        ([], several) => format!("no rig answers at any of {} serial ports", several.len()),
        (some, _) => format!("a rig answers at {}", some.join(", ")),
    }
}

/// All serial ports, rigs first.
pub(super) fn find() -> Result<Vec<PortProbe>> {
    let ports = serialport::available_ports().context("the serial ports cannot be listed")?;
    // A silent port takes its whole time-out, so all are probed at once.
    let begin = |port| std::thread::spawn(move || probe(port));
    let threads: Vec<_> = ports.into_iter().map(begin).collect();
    let ended = threads.into_iter().filter_map(|thread| thread.join().ok());
    let mut found: Vec<PortProbe> = ended.collect();
    found.sort_by(|a, b| (!a.answers(), &a.port).cmp(&(!b.answers(), &b.port)));
    Ok(found)
}

impl Ports {
    pub(super) fn run(self) -> Result<String> {
        let found = find()?;
        let line = |p: &PortProbe| format!("{:24} {:32} {}\n", p.port, p.device, p.answer());
        let mut text: String = found.iter().map(line).collect();
        if found.is_empty() {
            text.push_str("no serial ports were found: plug in the board\n");
        }
        text.push_str("without hardware: sim:bench, sim:aircraft, sim:linear\n");
        self.talk.result(text, &found)
    }
}

fn probe(info: serialport::SerialPortInfo) -> PortProbe {
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
    let mut found = PortProbe {
        port,
        device,
        rig: None,
        error: None,
    };
    let stream = match port::open(&found.port) {
        Ok(stream) => stream,
        Err(error) => {
            found.error = Some(error.to_string());
            return found;
        }
    };
    found.rig = match RigClient::probe(stream, &found.port) {
        Ok(client) => {
            let (board, build) = (client.hello().board, client.hello().build);
            Some(format!("{}, firmware {}", board.as_str(), build.as_str()))
        }
        Err(TalkError::Rig(ClientError::RunOfAnother)) => Some("a run is under way".to_owned()),
        Err(_) => None,
    };
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ports_with_a_rig_are_named() {
        let port = |port: &str, rig: bool| PortProbe {
            port: port.into(),
            device: String::new(),
            rig: rig.then(|| "bench, firmware 1".into()),
            error: None,
        };
        let said = |found: &[PortProbe]| summary(found);
        assert!(said(&[]).contains("plug in"));
        assert!(said(&[port("/dev/ttyS0", false)]).contains("no rig answers at /dev/ttyS0"));
        let both = [port("/dev/ttyUSB0", true), port("/dev/ttyS0", false)];
        assert_eq!(said(&both), "a rig answers at /dev/ttyUSB0");
        let silent = [port("/dev/ttyS0", false), port("/dev/ttyS1", false)];
        assert!(said(&silent).contains("any of 2"));
    }
}
