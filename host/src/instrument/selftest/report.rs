//! The file of a self-test, and its table.

use super::checks::{Check, Finding};
use super::measured::MeasuredBoard;
use serde::Serialize;
use std::fmt::Write;

/// Everything that somebody needs who was not there.
#[derive(Clone, Debug, Serialize)]
pub struct SelfTestReport {
    /// The layout of this file.
    pub selftest: u32,
    /// `passed` or `failed`.
    pub verdict: &'static str,
    /// The version of this program.
    pub servoid: &'static str,
    /// The system that it runs on.
    pub system: &'static str,
    /// What is behind the port: `serial`, or `network`.
    pub port: &'static str,
    /// The board's number, in hexadecimal digits.
    pub board: String,
    /// SHA-256 of the image inside this program. A board does not say which bytes it holds: only its version and its schema are
    /// known to be equal.
    pub image_inside_sha256: Option<String>,
    /// What is wrong.
    pub findings: Vec<Finding>,
    /// The table.
    pub checks: Vec<Check>,
    /// What the table was made of.
    pub measured: MeasuredBoard,
}

/// The layout of the file.
const LAYOUT: u32 = 1;

impl SelfTestReport {
    /// The report of what was measured at the port `address`.
    pub fn new(
        measured: MeasuredBoard,
        address: &str,
        image_inside_sha256: Option<String>,
    ) -> Self {
        let (checks, findings) = (measured.checks(), measured.findings());
        let passed = findings.is_empty() && checks.iter().all(|check| check.passed);
        let number = &measured.hello.unique_id;
        Self {
            selftest: LAYOUT,
            verdict: if passed { "passed" } else { "failed" },
            servoid: env!("CARGO_PKG_VERSION"),
            system: std::env::consts::OS,
            port: if address.starts_with("tcp:") {
                "network"
            } else {
                "serial"
            },
            board: number.iter().map(|byte| format!("{byte:02x}")).collect(),
            image_inside_sha256,
            findings,
            checks,
            measured,
        }
    }

    /// Whether nothing is wrong.
    pub fn passed(&self) -> bool {
        self.verdict == "passed"
    }

    /// The table, with what is wrong below it.
    pub fn text(&self) -> String {
        let hello = &self.measured.hello;
        let mut text = format!(
            "{} ({}), firmware {}\n\n",
            hello.board.as_str(),
            self.board,
            hello.build.as_str()
        );
        for check in &self.checks {
            let verdict = match (check.passed, check.measured) {
                (true, _) => "ok",
                (false, Some(_)) => "FAILED",
                (false, None) => "not measured",
            };
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{:22} {:>20} {:10} {:>20}  {verdict}",
                check.name,
                shown(check.measured, check.digits),
                check.unit,
                limits(check),
            );
        }
        let _ = writeln!(text, "\nself-test {}", self.verdict);
        for finding in &self.findings {
            let _ = writeln!(text, "  ! {}", finding.says);
        }
        text
    }
}

/// An interval as its middle, and how far its ends are from it.
fn shown(measured: Option<[f64; 2]>, digits: usize) -> String {
    let Some([least, most]) = measured else {
        return "-".to_owned();
    };
    let (middle, reach) = ((least + most) / 2.0, (most - least) / 2.0);
    match reach > 0.0 {
        true => format!("{middle:.digits$} ± {reach:.digits$}"),
        false => format!("{middle:.digits$}"),
    }
}

fn limits(check: &Check) -> String {
    let [low, high] = check.limits;
    let digits = check.digits;
    match low == high {
        true => format!("{low:.digits$}"),
        false => format!("{low:.digits$} to {high:.digits$}"),
    }
}
