//! `servoid info`

use super::completion_values;
use super::output_args::Talk;
use crate::instrument::port;
use crate::instrument::rig::ClientError;
use crate::instrument::rig::{Mismatch, mismatches};
use crate::instrument::rig::{RigClient, TalkError};
use anyhow::Result;
use clap::Args;
use servoid_protocol::hello::{ClockSource, ResetCause};
use servoid_protocol::message::{Activity, Status};
use servoid_protocol::schema::{PROTOCOL_VERSION, SCHEMA_HASH};
use servoid_protocol::{Hello, Rejects};
use std::fmt::Write;

/// Show the rig at a port: its board, firmware, timing and state
#[derive(Debug, Args)]
#[command(after_help = "Example:
  servoid info --port /dev/ttyUSB0
  servoid info --port sim:bench")]
pub(super) struct Info {
    /// Port of the rig: a serial device, tcp:HOST:PORT, or sim:bench, sim:aircraft, sim:linear
    #[arg(long, short, value_parser = completion_values::port(), hide_possible_values = true)]
    port: String,
    #[command(flatten)]
    talk: Talk,
}

#[derive(serde::Serialize)]
struct Answer<'a> {
    hello: &'a Hello,
    schema_equal: bool,
    mismatches: &'a [Mismatch],
    status: Option<Status>,
}

impl Info {
    pub(super) fn run(self) -> Result<String> {
        let port = port::open(&self.port)?;
        let mut client = match RigClient::connect_beside(port, &self.port) {
            Err(busy @ TalkError::Rig(ClientError::RunOfAnother)) => {
                let result = serde_json::json!({ "running": true });
                return self
                    .talk
                    .result(format!("{}: {busy}\n", self.port), &result);
            }
            other => other?,
        };
        let hello = *client.hello();
        let schema_equal = client.has_equal_schema();
        // Only the hello of a rig with another schema can be trusted.
        let status = if schema_equal {
            Some(client.status()?)
        } else {
            None
        };
        let mismatches = mismatches(&hello);
        let mut text = describe(&hello, status.as_ref(), client.rejects())?;
        text.push_str(&explain(&mismatches)?);
        self.talk.result(
            text,
            &Answer {
                hello: &hello,
                schema_equal,
                mismatches: &mismatches,
                status,
            },
        )
    }
}

fn describe(hello: &Hello, status: Option<&Status>, rejects: Rejects) -> Result<String> {
    let mut text = String::new();
    let id: String = hello
        .unique_id
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect();
    writeln!(text, "board            {} ({id})", hello.board.as_str())?;
    writeln!(text, "firmware         {}", hello.build.as_str())?;
    writeln!(
        text,
        "protocol         {} (this servoid: {PROTOCOL_VERSION})",
        hello.protocol_version
    )?;
    writeln!(
        text,
        "schema           {:016x} ({})",
        hello.schema_hash,
        if hello.schema_hash == SCHEMA_HASH {
            "equal"
        } else {
            "differs"
        }
    )?;
    writeln!(text, "clock            {}", clock(hello.clock))?;
    writeln!(text, "last start       {}", reset(hello.reset_cause))?;
    writeln!(text, "PWM frame        {} µs", hello.frame_us)?;
    writeln!(
        text,
        "samples          every {} µs, the first {} µs after the pulse's rising edge",
        hello.sample_us, hello.first_sample_us
    )?;
    writeln!(
        text,
        "one sample       {} conversions {}, 0 to {} counts",
        hello.oversampling,
        match hello.aperture_us {
            0 => "at one moment".to_owned(),
            us => format!("within {us} µs"),
        },
        hello.full_scale_counts
    )?;
    writeln!(
        text,
        "pulses           {} to {} µs, never beyond",
        hello.shortest_pulse_us, hello.longest_pulse_us
    )?;
    writeln!(
        text,
        "memory           {} frames ({} s) can be sent again",
        hello.history_frames,
        f64::from(hello.history_frames) * f64::from(hello.frame_us) * 1e-6
    )?;
    if let Some(status) = status {
        write_status(&mut text, status, rejects)?;
    }
    Ok(text)
}

fn write_status(text: &mut String, status: &Status, rejects: Rejects) -> std::fmt::Result {
    writeln!(text, "state            {}", activity(&status.activity))?;
    writeln!(text, "sensor           {} counts", status.sensor.0)?;
    writeln!(
        text,
        "frames           {} since start, {} lost on the board, at most {} in the queue",
        status.frames_since_start, status.frames_lost_on_board, status.backlog_high_water
    )?;
    writeln!(
        text,
        "link             unreadable messages: {} to the rig, {} from it",
        status.rejects,
        rejects.total()
    )
}

/// The mismatches, field by field.
fn explain(mismatches: &[Mismatch]) -> Result<String> {
    let mut text = String::new();
    if mismatches.is_empty() {
        return Ok(text);
    }
    writeln!(text, "\nThis rig cannot be used with this servoid:")?;
    for m in mismatches {
        writeln!(
            text,
            "  {:16} {} (this servoid: {}): {}",
            m.field, m.rig, m.servoid, m.meaning
        )?;
    }
    Ok(text)
}

fn clock(source: ClockSource) -> &'static str {
    match source {
        ClockSource::Crystal => "crystal (tens of ppm)",
        ClockSource::InternalRc => {
            "internal oscillator (all times uncertain by about 1 %), because the crystal did not start"
        }
        ClockSource::Simulated => "simulated (exact)",
    }
}

fn reset(cause: ResetCause) -> &'static str {
    match cause {
        ResetCause::PowerOn => "power on, or a drop of the supply",
        ResetCause::Pin => "the reset pin",
        ResetCause::Watchdog => "the watchdog: frames had stopped",
        ResetCause::Software => "a reset by the program",
        ResetCause::LowPower => "a low-power reset",
        ResetCause::Unknown => "unknown",
    }
}

fn activity(activity: &Activity) -> String {
    match activity {
        Activity::Idle => "idle, no pulses".to_owned(),
        Activity::Armed => "armed, at neutral".to_owned(),
        Activity::Running { run, frames } => format!("run {run}, {frames} frames so far"),
        Activity::Ended(ended) => {
            format!(
                "at neutral; run {} ended ({:?}) after {} frames",
                ended.run, ended.reason, ended.frames
            )
        }
    }
}
