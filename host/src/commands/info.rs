//! `servoid info`

use super::completion_values;
use super::output::Talk;
use super::rig_args::RigFileArgs;
use crate::data::clock_error::internal_clock_error;
use crate::instrument::flash::embedded_image;
use crate::instrument::port;
use crate::instrument::rig::{ClientError, Mismatch, RigClient, TalkError, mismatches};
use anyhow::Result;
use clap::Args;
use servoid_protocol::health::{FaultKind, LastFault};
use servoid_protocol::hello::{ClockSource, ResetCause};
use servoid_protocol::message::{Activity, Status};
use servoid_protocol::schema::{PROTOCOL_VERSION, SCHEMA_HASH};
use servoid_protocol::{Health, Hello, Rejects};

/// Show the rig at a port: its board, firmware, timing and state
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid info                       the port of rig.toml
  servoid info --port /dev/ttyUSB0
  servoid info --port sim:bench")]
pub(super) struct Info {
    /// Port of the rig: a serial device, tcp:HOST:PORT, or sim:bench, sim:aircraft, sim:linear; without it, that of the rig file
    #[arg(long, short, value_parser = completion_values::port(), hide_possible_values = true)]
    port: Option<String>,
    #[command(flatten)]
    rig: RigFileArgs,
    #[command(flatten)]
    talk: Talk,
}

#[derive(serde::Serialize)]
struct Identity<'a> {
    hello: &'a Hello,
    schema_equal: bool,
    mismatches: &'a [Mismatch],
    status: Option<Status>,
    health: Option<Health>,
    /// Of the image inside this program; `None` where it was built without one.
    image_sha256: Option<String>,
}

impl Info {
    pub(super) fn run(self) -> Result<String> {
        let address = self.rig.address(self.port.as_deref(), self.talk)?;
        let port = port::open(&address)?;
        let mut client = match RigClient::connect_beside(port, &address) {
            Err(busy @ TalkError::Rig(ClientError::RunOfAnother)) => {
                let result = serde_json::json!({ "running": true });
                let text = format!("{address}: {busy}\n");
                return self.talk.result(text, &result);
            }
            other => other?,
        };
        let hello = *client.hello();
        let schema_equal = client.has_equal_schema();
        // Only the hello of a rig with another schema can be trusted.
        let status = schema_equal.then(|| client.status()).transpose()?;
        let health = schema_equal.then(|| client.health()).transpose()?;
        let mismatches = mismatches(&hello);
        let image_sha256 = embedded_image().map(|image| image.sha256());
        let text = describe(&hello, status.as_ref(), client.rejects())
            + &health.as_ref().map_or_else(String::new, describe_health)
            + &describe_image(image_sha256.as_deref())
            + &explain(&mismatches);
        let answer = Identity {
            hello: &hello,
            schema_equal,
            mismatches: &mismatches,
            status,
            health,
            image_sha256,
        };
        self.talk.result(text, &answer)
    }
}

/// The image that `servoid flash` would write; a board does not say which bytes it holds.
fn describe_image(sha256: Option<&str>) -> String {
    sha256.map_or_else(String::new, |sha256| {
        format!(
            "{:16} SHA-256 {sha256}, which 'servoid flash' writes\n",
            "image inside"
        )
    })
}

fn describe(hello: &Hello, status: Option<&Status>, rejects: Rejects) -> String {
    let id: String = hello
        .unique_id
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect();
    let equal = if hello.schema_hash == SCHEMA_HASH {
        "equal"
    } else {
        "differs"
    };
    let aperture = match hello.aperture_us {
        0 => "at one moment".to_owned(),
        us => format!("within {us} µs"),
    };
    let Hello {
        protocol_version,
        schema_hash,
        frame_us,
        sample_us,
        first_sample_us,
        oversampling,
        full_scale_counts,
        shortest_pulse_us,
        longest_pulse_us,
        history_frames,
        ..
    } = hello;
    let history_s = f64::from(*history_frames) * f64::from(*frame_us) * 1e-6;
    let mut rows = vec![
        ("board", format!("{} ({id})", hello.board.as_str())),
        ("firmware", hello.build.as_str().to_owned()),
        (
            "protocol",
            format!("{protocol_version} (this servoid: {PROTOCOL_VERSION})"),
        ),
        ("schema", format!("{schema_hash:016x} ({equal})")),
        ("clock", clock(hello.clock)),
        ("last start", reset(hello.reset_cause).to_owned()),
        ("frame", format!("{frame_us} µs")),
        (
            "samples",
            format!(
                "every {sample_us} µs, the first {first_sample_us} µs after the pulse's rising edge"
            ),
        ),
        (
            "one sample",
            format!("{oversampling} conversions {aperture}, 0 to {full_scale_counts} counts"),
        ),
        (
            "pulses",
            format!("{shortest_pulse_us} to {longest_pulse_us} µs, never beyond"),
        ),
        (
            "memory",
            format!("{history_frames} frames ({history_s} s) can be sent again"),
        ),
    ];
    if let Some(status) = status {
        let (frames, lost) = (status.frames_since_start, status.frames_lost_on_board);
        let (waited, to_rig) = (status.backlog_high_water, status.rejects);
        let from_rig = rejects.total();
        rows.extend([
            ("state", activity(&status.activity)),
            ("sensor", format!("{} counts", status.sensor.0)),
            (
                "frames",
                format!(
                    "{frames} since start, {lost} lost on the board, at most {waited} in the queue"
                ),
            ),
            (
                "link",
                format!("unreadable messages: {to_rig} to the rig, {from_rig} from it"),
            ),
        ]);
    }
    lines(&rows)
}

fn lines(rows: &[(&str, String)]) -> String {
    rows.iter()
        .map(|(name, value)| format!("{name:16} {value}\n"))
        .collect()
}

/// What is known of the chip, its supply and its last fault; nothing of a simulated board.
fn describe_health(health: &Health) -> String {
    let mut rows = Vec::new();
    match (health.flash_kib, health.device) {
        (0, 0) => {}
        (flash, 0) => rows.push(("chip", format!("{flash} KiB of flash; hides its type"))),
        (flash, device) => {
            rows.push(("chip", format!("{flash} KiB of flash, type {device:#010x}")))
        }
    }
    if let Some(ratio) = health.supply_ratio() {
        let change = 100.0 * (ratio - 1.0);
        let low = match health.low_supply_frames {
            0 => String::new(),
            frames => format!(", too low in {frames} frames"),
        };
        rows.push(("supply", format!("{change:+.2} % since its start{low}")));
    }
    if let Some(fault) = &health.last_fault {
        rows.push(("last fault", describe_fault(fault)));
    }
    lines(&rows)
}

fn describe_fault(fault: &LastFault) -> String {
    let LastFault {
        kind,
        detail,
        place,
    } = fault;
    match kind {
        FaultKind::Panic => format!("a panic of the firmware at {}:{detail}", place.as_str()),
        FaultKind::HardFault => format!("a hard fault of the processor at {detail:#010x}"),
        FaultKind::CrystalStopped => "the crystal stopped".to_owned(),
        FaultKind::StrayInterrupt => format!("an interrupt that nothing handles, number {detail}"),
    }
}

/// The mismatches, field by field.
/// Why a rig does not go with this program; empty where it does.
pub(super) fn explain(mismatches: &[Mismatch]) -> String {
    if mismatches.is_empty() {
        return String::new();
    }
    let line = |m: &Mismatch| {
        let Mismatch {
            field,
            rig,
            servoid,
            meaning,
        } = m;
        format!("  {field:16} {rig} (this servoid: {servoid}): {meaning}\n")
    };
    let lines: String = mismatches.iter().map(line).collect();
    format!("\nThis rig cannot be used with this servoid:\n{lines}")
}

fn clock(source: ClockSource) -> String {
    match source {
        ClockSource::Crystal => "crystal (tens of ppm)".to_owned(),
        ClockSource::InternalRc => format!(
            "internal oscillator (all times and pulses off by {}), because the crystal did not start",
            internal_clock_error()
        ),
        ClockSource::Simulated => "simulated (exact)".to_owned(),
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
        Activity::Loopback => "testing itself".to_owned(),
        Activity::Running { run, frames } => format!("run {run}, {frames} frames so far"),
        Activity::Ended(ended) => {
            let (run, reason, frames) = (ended.run, ended.reason, ended.frames);
            format!("at neutral; run {run} ended ({reason:?}) after {frames} frames")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_protocol::hello::Text16;

    #[test]
    fn health_is_said_as_far_as_it_is_known() {
        assert_eq!(describe_health(&Health::default()), "");
        let fault = LastFault {
            kind: FaultKind::Panic,
            detail: 42,
            place: Text16::new("src/pulse.rs"),
        };
        let health = Health {
            flash_kib: 64,
            device: 0x2003_6410,
            bandgap_at_start: 24_000,
            bandgap: 25_000,
            low_supply_frames: 3,
            last_fault: Some(fault),
        };
        let expected = "\
chip             64 KiB of flash, type 0x20036410
supply           -4.00 % since its start, too low in 3 frames
last fault       a panic of the firmware at src/pulse.rs:42
";
        assert_eq!(describe_health(&health), expected);
        let hidden = Health {
            flash_kib: 64,
            ..Health::default()
        };
        let expected = "chip             64 KiB of flash; hides its type\n";
        assert_eq!(describe_health(&hidden), expected);
    }
}
