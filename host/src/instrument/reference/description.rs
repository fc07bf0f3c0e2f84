//! A reference in one line, for people.

use super::whole_frames::{frame_ratio, seconds};
use servoid_protocol::PulseTrain;
use servoid_protocol::reference::{MAX_STEPS, Reference};

/// A reference in one line, for people: its name, its numbers, how long it takes.
pub fn describe(reference: &Reference, us_per_degree: f64, train: PulseTrain) -> String {
    let seconds = |frames: u32| seconds(frames, train);
    let degrees = |us: u16| (1e3 * f64::from(us) / us_per_degree.abs()).round() / 1e3;
    // On the wire in cycles per 50 000 frames. Rounded: what a user states comes out as it was.
    let hertz = |wire: u16| (f64::from(wire) / frame_ratio(train)).round() * 1e-3;
    let numbers = match reference {
        Reference::Staircase(s) => format!(
            "±{} deg, holds of {} to {} s",
            degrees(s.amplitude_us),
            seconds(s.longest_hold_frames.into()),
            seconds(s.shortest_hold_frames.into())
        ),
        Reference::Stairs(s) => format!(
            "{} levels within ±{} deg, holds of {} s, every stroke {} times",
            s.levels,
            degrees(s.amplitude_us),
            seconds(s.hold_frames.into()),
            s.cycles
        ),
        Reference::Prbs(p) => format!(
            "±{} deg, {} chips of {} s from a register of {} bits, seed {}",
            degrees(p.amplitude_us),
            p.chips,
            seconds(p.chip_frames.into()),
            p.register,
            p.seed
        ),
        Reference::Sweep(s) => format!(
            "±{} deg, {} to {} Hz",
            degrees(s.amplitude_us),
            hertz(s.first_millihertz),
            hertz(s.last_millihertz)
        ),
        Reference::Multisine(m) => {
            let period_s = seconds(m.period_frames.into());
            let highest = m.harmonics().last().unwrap_or(0);
            format!(
                "within ±{} deg, {} tones from {:.3} to {:.3} Hz, {} periods of {period_s} s",
                degrees(m.amplitude_us),
                m.tones,
                f64::from(m.first) / period_s,
                f64::from(highest) / period_s,
                m.periods
            )
        }
        Reference::Steps(s) => format!(
            "{} of at most {MAX_STEPS} steps, {} times over",
            s.held().count(),
            s.repeats
        ),
    };
    let name = reference.name();
    format!("{name}: {numbers}; {} s", seconds(reference.frames()))
}
