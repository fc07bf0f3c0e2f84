//! The limits of a self-test, and what it means where one is not kept.

use super::measured::{MeasuredBoard, Unseen};
use crate::data::clock_error::internal_clock_error;
use serde::Serialize;
use servoid_protocol::hello::ClockSource;

/// One line of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// Its name.
    pub name: String,
    /// What was measured: the least and the largest value that it may be; `None` where it could not be.
    pub measured: Option<[f64; 2]>,
    /// Its unit.
    pub unit: &'static str,
    /// The least and the largest value of a good board.
    pub limits: [f64; 2],
    /// Digits behind the point that are worth showing.
    #[serde(skip)]
    pub digits: usize,
    /// Whether what was measured is within the limits.
    pub passed: bool,
}

/// What is wrong: the result, the reason, what to do.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// A word for programs.
    pub fault: &'static str,
    /// A sentence for people.
    pub says: String,
}

/// Frames (ms). A crystal is exact to 0.01 %, this computer's clock to about as much.
const FRAME_MS: [f64; 2] = [19.9, 20.1];
/// Half of an interval that is too wide to say anything (ms): answers came late.
const VAGUE_MS: f64 = 0.2;
/// Edges of a pulse are each known to half a microsecond.
const PULSE_REACH_US: f64 = 2.0;
/// Of the time that the board states for a probe (µs), which is known to half a microsecond.
const HOLD_REACH_US: [f64; 2] = [-1.0, 1.5];
/// Of the phase that the board states (µs): the processor sees it up to some microseconds later.
const PHASE_REACH_US: [f64; 2] = [-1.0, 8.0];
/// 10 kΩ of 15.1 kΩ, or of 15.43 kΩ behind the resistor of the pulse line, each to 1 %; 0.662 and 0.648.
const HIGH_SHARE: [f64; 2] = [0.64, 0.69];
const LOW_SHARE: [f64; 2] = [0.0, 0.01];
/// A tenth of a degree of the usual sensor is 11 counts.
const NOISE_COUNTS: [f64; 2] = [0.0, 11.0];
/// A regulator of 3.3 V to 2 %, by a reference voltage to 3.3 %.
const SUPPLY_VOLTS: [f64; 2] = [3.1, 3.5];
const LOAD_PERCENT: [f64; 2] = [0.0, 20.0];
/// Never used of the stack (bytes).
const STACK_UNUSED: [f64; 2] = [1_024.0, 65_536.0];
const REPEATED_PERCENT: [f64; 2] = [0.0, 0.5];
const NONE: [f64; 2] = [0.0, 0.0];

impl MeasuredBoard {
    /// The table.
    pub fn checks(&self) -> Vec<Check> {
        let hello = &self.hello;
        let exactly = |value: f64| [value, value];
        let half = |value: f64| [value - 0.5, value + 0.5];
        let mut frames = check("frame period", self.frame_ms, "ms", FRAME_MS, 3);
        frames.passed &= !self.frames_are_vague();
        let mut checks = vec![frames];
        for pulse in &self.pulses {
            let asked = f64::from(pulse.asked_us);
            let limits = [asked - PULSE_REACH_US, asked + PULSE_REACH_US];
            let width = pulse.width_us.map(|width| [width - 1.0, width + 1.0]);
            let name = format!("pulse of {} µs", pulse.asked_us);
            checks.push(check(name, width, "µs", limits, 0));
        }
        let phase = PHASE_REACH_US.map(|reach| f64::from(hello.first_sample_us) + reach);
        let holds = HOLD_REACH_US.map(|reach| self.stated_hold_us() + reach);
        let noise = |level: Option<super::measured::Level>| level.map(|l| exactly(l.sd_counts));
        let repeated = 100.0 * f64::from(self.requests_repeated) / f64::from(self.requests.max(1));
        let lost = self.status_after.frames_lost_on_board - self.status_before.frames_lost_on_board;
        let unreadable = self.unreadable + (self.status_after.rejects - self.status_before.rejects);
        let stack = self.vitals_at_end;
        let unused = (stack.stack_bytes > 0).then(|| exactly(f64::from(stack.stack_unused)));
        let share = |level: Option<super::measured::Level>| level.map(|l| exactly(l.share));
        let rest = [
            (
                "probe holds after",
                self.probe_holds_us.map(half),
                "µs",
                holds,
                1,
            ),
            (
                "first sample",
                self.first_sample_us().map(exactly),
                "µs",
                phase,
                0,
            ),
            (
                "pin, line high",
                share(self.high),
                "of supply",
                HIGH_SHARE,
                3,
            ),
            ("pin, line low", share(self.low), "of supply", LOW_SHARE, 3),
            (
                "noise, line high",
                noise(self.high),
                "counts",
                NOISE_COUNTS,
                1,
            ),
            (
                "noise, line low",
                noise(self.low),
                "counts",
                NOISE_COUNTS,
                1,
            ),
            (
                "board's supply",
                self.supply_volts().map(exactly),
                "V",
                SUPPLY_VOLTS,
                2,
            ),
            (
                "processor awake",
                self.load_percent().map(exactly),
                "%",
                LOAD_PERCENT,
                1,
            ),
            ("stack never used", unused, "bytes", STACK_UNUSED, 0),
            ("frames lost", Some(exactly(f64::from(lost))), "", NONE, 0),
            (
                "requests repeated",
                Some(exactly(repeated)),
                "%",
                REPEATED_PERCENT,
                2,
            ),
            (
                "messages unreadable",
                Some(exactly(f64::from(unreadable))),
                "",
                NONE,
                0,
            ),
        ];
        checks.extend(rest.map(|(name, measured, unit, limits, digits)| {
            check(name, measured, unit, limits, digits)
        }));
        checks
    }

    /// What is wrong with the board or its wires; empty where nothing is.
    pub fn findings(&self) -> Vec<Finding> {
        let failed: Vec<_> = self.checks().into_iter().filter(|c| !c.passed).collect();
        let fails = |name: &str| failed.iter().any(|check| check.name == name);
        let mut findings = Vec::new();
        let mut find = |fault, says: String| findings.push(Finding { fault, says });
        if self.hello.clock == ClockSource::InternalRc {
            find(
                "internal_oscillator",
                format!(
                    "the board runs from its internal oscillator, because its crystal did not start: all times and pulses are off by {}; check or replace the crystal",
                    internal_clock_error()
                ),
            );
        }
        if fails("frame period") {
            find("frame_period", self.about_frames());
        }
        match self.unseen {
            Some(unseen) => find(unseen.fault(), unseen.says(self.pin_before)),
            None => self.about_pulses(&fails, &mut find),
        }
        if fails("board's supply") {
            let volts = self.supply_volts().unwrap_or_default();
            find(
                "supply",
                format!(
                    "the chip's supply is {volts:.2} V by its own reference voltage, where 3.3 V are expected: measure the 3.3 V pin; if it is right, the reference of this chip is wrong, and so is every reading of its supply"
                ),
            );
        }
        if fails("processor awake") {
            find("processor_load", "the processor is busier than the program makes it: an interrupt may come without end; send the file of this test".to_owned());
        }
        if fails("stack never used") {
            find("stack", "the stack is nearly full, or the board does not measure it: send the file of this test".to_owned());
        }
        if fails("frames lost") {
            find(
                "frames_lost",
                "the board lost frames, because its processor was late: send the file of this test"
                    .to_owned(),
            );
        }
        if fails("requests repeated") || fails("messages unreadable") {
            find(
                "line",
                format!(
                    "the line to the board is disturbed: {} of {} requests were repeated; check the adapter's wires and ground, and that it runs at 115200 baud",
                    self.requests_repeated, self.requests
                ),
            );
        }
        findings
    }

    fn frames_are_vague(&self) -> bool {
        let width = |[least, most]: [f64; 2]| most - least;
        self.frame_ms.is_some_and(|ms| width(ms) > 2.0 * VAGUE_MS)
    }

    fn about_frames(&self) -> String {
        match self.frame_ms {
            None => {
                "this computer's clock jumped during the test, or the board was reset: start again"
                    .to_owned()
            }
            Some([least, most]) if self.frames_are_vague() => format!(
                "a frame lasts between {least:.2} and {most:.2} ms by this computer's clock, which says nothing: answers of the board come too late; connect the adapter to the computer itself, close other programs, and start again"
            ),
            Some([least, most]) => {
                let percent = |ms: f64| 100.0 * (ms / 20.0 - 1.0);
                let doubled = match most < 15.0 {
                    true => "; a virtual board needs --realtime",
                    false => "",
                };
                format!(
                    "a frame lasts {least:.3} to {most:.3} ms, {:+.2} to {:+.2} % from 20 ms by this computer's clock: the crystal is not one of 8 MHz, or the line delays answers by much; all times and pulses are off by as much{doubled}",
                    percent(least),
                    percent(most)
                )
            }
        }
    }

    fn about_pulses(
        &self,
        fails: &impl Fn(&str) -> bool,
        find: &mut impl FnMut(&'static str, String),
    ) {
        let high = self.high.map_or(0.0, |level| level.share);
        if fails("pin, line high") {
            find("divider", match high > 0.9 {
                true => "PA4 reads the whole supply while the line is high: the wire goes to it without the divider, which would put 5 V of a sensor onto a pin that takes 3.3; put 5.1 kΩ before PA4 and 10 kΩ from PA4 to ground".to_owned(),
                false => format!("PA4 reads {high:.3} of the supply while the line is high, where the divider gives 0.66: its resistors are others, or something else is connected to PA4"),
            });
        }
        if fails("pin, line low") {
            find("pin_low", "PA4 does not return to zero: take off whatever else is connected to it, and check the ground of the divider".to_owned());
        }
        if fails("noise, line high") || fails("noise, line low") {
            find("noise", "the readings of PA4 scatter: keep the wire short and away from supplies, and check the ground of the divider and the adapter".to_owned());
        }
        if self.probe_holds_us.is_none() {
            find("slow_edge", "the pulse's rising edge was not found at PA4 within 20 µs: a capacitor is connected there, or the divider's resistors are too large; take the capacitor off, it would delay every measured angle".to_owned());
        } else if fails("probe holds after") {
            find("converter_clock", "a conversion samples its input for another time than what the board states: the edges are slow, as with a capacitor at PA4, or the converter's clock is wrong".to_owned());
        } else if self
            .pulses
            .iter()
            .any(|pulse| fails(&format!("pulse of {} µs", pulse.asked_us)))
        {
            find("pulse_width", "a pulse is longer or shorter than what was asked for, by the board's own clock: its falling edges come at another time than its rising ones; look at PA1 with an oscilloscope, and send the file of this test".to_owned());
        }
        if fails("first sample") {
            let us = self.first_sample_us().unwrap_or_default();
            let stated = self.hello.first_sample_us;
            find(
                "sample_phase",
                format!(
                    "the first sample is taken {us:.0} µs after the pulse's rising edge and not after {stated} µs: every delay that is measured would be wrong by the difference; send the file of this test"
                ),
            );
        }
    }
}

impl Unseen {
    fn fault(self) -> &'static str {
        match self {
            Self::NotLowBefore => "pin_driven",
            Self::StayedLow => "wire_missing",
            Self::Lost => "wire_loose",
        }
    }

    fn says(self, before: f64) -> String {
        match self {
            Self::NotLowBefore => format!(
                "PA4 reads {before:.3} of the supply before there is any pulse, where PA1 would give 0: the wire comes from another pin than PA1, or a sensor is still connected; there were no pulses"
            ),
            Self::StayedLow => "PA4 stays at zero while PA1 has pulses: the wire from PA1 to the divider before PA4 is missing or goes to another pin, or the divider's upper resistor is open; the pulses were ended after three frames".to_owned(),
            Self::Lost => "the board saw its pulses for a while and then no more, so it ended them: the wire from PA1 to the divider before PA4 is loose".to_owned(),
        }
    }
}

fn check(
    name: impl Into<String>,
    measured: Option<[f64; 2]>,
    unit: &'static str,
    limits: [f64; 2],
    digits: usize,
) -> Check {
    let [low, high] = limits;
    // What is known to a microsecond is compared by its middle; so is what is known exactly.
    let middle = measured.map(|[least, most]| (least + most) / 2.0);
    let passed = middle.is_some_and(|value| (low..=high).contains(&value));
    Check {
        name: name.into(),
        measured,
        unit,
        limits,
        digits,
        passed,
    }
}

#[cfg(test)]
mod tests {
    use super::super::measured::{Level, MeasuredPulse};
    use super::*;
    use servoid_protocol::loopback::Vitals;
    use servoid_protocol::message::{Activity, Status};
    use servoid_protocol::{Counts, Health};
    use servoid_test_support::hello::hello;

    /// As on a good board.
    fn good() -> MeasuredBoard {
        let hello = hello();
        let status = Status {
            activity: Activity::Idle,
            sensor: Counts(0),
            frames_since_start: 100,
            frames_lost_on_board: 2,
            rejects: 3,
            backlog_high_water: 0,
        };
        let vitals = Vitals {
            frames: 100,
            awake_us: u32::MAX - 5_000,
            stack_bytes: 10_240,
            stack_unused: 3_600,
        };
        // 7 % of a hundred frames, across the end of the count.
        let later = Vitals {
            frames: 200,
            awake_us: vitals.awake_us.wrapping_add(140_000),
            ..vitals
        };
        let level = |share| Level {
            share,
            sd_counts: 2.0,
        };
        MeasuredBoard {
            hello,
            status_before: status,
            status_after: status,
            health: Health {
                bandgap: 23_800,
                ..Health::default()
            },
            vitals_before: vitals,
            vitals_after: later,
            vitals_at_end: later,
            frame_ms: Some([19.99, 20.01]),
            pin_before: 0.0,
            unseen: None,
            pulses: vec![MeasuredPulse {
                asked_us: 1_500,
                width_us: Some(1_500.5),
            }],
            probe_holds_us: Some(20.5),
            sampled_us: Some(18_586),
            high: Some(level(0.662)),
            low: Some(level(0.0)),
            requests: 500,
            requests_repeated: 0,
            unreadable: 0,
        }
    }

    fn faults(measured: &MeasuredBoard) -> Vec<&'static str> {
        measured.findings().iter().map(|f| f.fault).collect()
    }

    /// What the models of the chip cannot have: the others are found on the virtual board.
    #[test]
    fn each_fault_is_named_alone() {
        assert_eq!(faults(&good()), [""; 0]);
        assert!((good().load_percent().unwrap() - 7.0).abs() < 1e-9);
        type Change = fn(&mut MeasuredBoard);
        let cases: [(&str, Change); 8] = [
            ("stack", |m| m.vitals_at_end.stack_unused = 1_000),
            ("stack", |m| m.vitals_at_end.stack_bytes = 0),
            ("processor_load", |m| m.vitals_after.awake_us += 400_000),
            ("frames_lost", |m| m.status_after.frames_lost_on_board += 1),
            ("line", |m| m.status_after.rejects += 1),
            ("frame_period", |m| m.frame_ms = None),
            ("frame_period", |m| m.frame_ms = Some([19.7, 20.3])),
            ("wire_loose", |m| m.unseen = Some(Unseen::Lost)),
        ];
        for (fault, change) in cases {
            let mut measured = good();
            change(&mut measured);
            assert_eq!(faults(&measured), [fault]);
        }
    }

    /// A virtual board that runs twice as fast is no bad crystal.
    #[test]
    fn frames_of_half_the_length_have_a_remark() {
        let mut measured = good();
        measured.frame_ms = Some([9.99, 10.01]);
        let says = &measured.findings()[0].says;
        assert!(says.contains("--realtime"), "{says}");
    }
}
