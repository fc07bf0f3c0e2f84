//! Angles that somebody reads on a protractor while the servo holds a position.

use crate::commands::output::print_remark;
use crate::commands::prompts;
use crate::data::DegreeScale;
use crate::instrument::calibration::{MoveError, Mover, Reading, Rest};
use anyhow::Result;
use servoid_protocol::PulseWidth;
use std::cell::{Cell, RefCell};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// The answer where an angle cannot be read.
const LEAVE_OUT: &str = "skip";

/// Time between two checks whether the program is to end, while a simulated rig waits for an answer.
const PATIENCE: Duration = Duration::from_millis(100);

/// Goes to each position and asks for the angle there. [`LEAVE_OUT`] leaves the position out; Enter alone does not, because
/// it may have been typed at an earlier question. Of a servo that `is_simulated` nobody can read it, and the question says what the pulse asks for.
pub(super) fn read(
    mover: &mut Mover<'_>,
    pulses: &[u16],
    is_simulated: bool,
) -> Result<(Vec<Reading>, Vec<Rest>)> {
    let (mut readings, mut rests) = (Vec::new(), Vec::new());
    let scale = DegreeScale::of_rig(mover.rig());
    for (number, &pulse_us) in pulses.iter().enumerate() {
        let position = format!("position {} of {}", number + 1, pulses.len());
        let commanded = is_simulated.then(|| scale.reference(PulseWidth(pulse_us)));
        let read = read_one(mover, pulse_us, &position, commanded);
        // On a line of its own, where it can be copied.
        let (rest, angle) = read.inspect_err(|_| print_remark(so_far(&readings)))?;
        if let Some(angle_deg) = angle {
            let counts = rest.counts;
            readings.push(Reading { angle_deg, counts });
            rests.push(rest);
        } else {
            print_remark(format_args!("{position}, {pulse_us} µs: left out"));
        }
    }
    Ok((readings, rests))
}

/// The readings so far, for a calibration that fails: they can be used again.
pub(super) fn so_far(readings: &[Reading]) -> String {
    let pair = |r: &Reading| format!("{}={:.1}", r.angle_deg, r.counts);
    let pairs: Vec<String> = readings.iter().map(pair).collect();
    match pairs.join(",").as_str() {
        "" => "no position was read".to_owned(),
        pairs => format!("the readings so far are kept here: --pairs={pairs}"),
    }
}

fn read_one(
    mover: &mut Mover<'_>,
    pulse_us: u16,
    position: &str,
    commanded: Option<f64>,
) -> Result<(Rest, Option<f64>), MoveError> {
    let waits = mover.is_paced_by_reader();
    let asked: RefCell<Option<Receiver<Option<f64>>>> = RefCell::new(None);
    let answer: Cell<Option<Option<f64>>> = Cell::new(None);
    let done = |rest: &Rest| {
        if answer.get().is_some() {
            return true;
        }
        let mut asked = asked.borrow_mut();
        let receiver = asked.get_or_insert_with(|| ask_beside(question(rest, position, commanded)));
        let patience = if waits { PATIENCE } else { Duration::ZERO };
        match receiver.recv_timeout(patience) {
            Ok(angle) => answer.set(Some(angle)),
            // The input has ended.
            Err(RecvTimeoutError::Disconnected) => answer.set(Some(None)),
            Err(RecvTimeoutError::Timeout) => {}
        }
        answer.get().is_some()
    };
    let rest = mover.hold(pulse_us, &done)?;
    Ok((rest, answer.get().flatten()))
}

fn question(rest: &Rest, position: &str, commanded: Option<f64>) -> String {
    let commanded = commanded.map_or_else(String::new, |angle| {
        format!("; the pulse asks for {angle:.1}")
    });
    format!(
        "{position}, {} µs: {:.1} counts (standard deviation {:.1}). Angle on the protractor (degrees; {LEAVE_OUT:?} leaves the position out{commanded})?",
        rest.pulse_us, rest.counts, rest.sd_counts
    )
}

/// Asks in a thread of its own, so that the run goes on during the question.
fn ask_beside(words: String) -> Receiver<Option<f64>> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        if let Some(angle) = prompts::line(&words, angle) {
            // The run may have ended meanwhile.
            let _gone = sender.send(angle);
        }
    });
    receiver
}

fn angle(text: &str) -> Result<Option<f64>, String> {
    if text == LEAVE_OUT {
        return Ok(None);
    }
    let number = text.to_lowercase();
    let units = ["degrees", "degree", "deg", "°"];
    let number = units
        .iter()
        .find_map(|unit| number.strip_suffix(unit))
        .unwrap_or(&number);
    let number = number.trim_end().replace(',', ".").parse::<f64>().ok();
    number
        .filter(|angle| (-360.0..=360.0).contains(angle))
        .map(Some)
        .ok_or_else(|| {
            format!(
                "a number of degrees from -360 to 360 is needed, such as -20.5, or {LEAVE_OUT:?}"
            )
        })
}

#[cfg(test)]
mod tests {
    use super::angle;

    #[test]
    fn an_angle_may_have_its_unit() {
        for (text, expected) in [
            ("-10", -10.0),
            ("-10°", -10.0),
            ("-22 deg", -22.0),
            ("20,5 °", 20.5),
            ("3 Degrees", 3.0),
        ] {
            assert_eq!(angle(text), Ok(Some(expected)), "{text}");
        }
        assert_eq!(angle("skip"), Ok(None));
        for wrong in ["", "deg", "10 rad", "400", "10 deg deg"] {
            assert!(angle(wrong).is_err(), "{wrong}");
        }
    }
}
