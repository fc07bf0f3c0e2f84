//! From frames to the two columns that are identified.

use crate::data::degrees::DegreeScale;
use crate::data::rig_file::RigFile;
use servoid_protocol::message::Start;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_protocol::{Frame, Reference};
use std::ops::Range;

/// Makes input and output of a run's frames, in order: the same as of its recording later. Only the
/// reference counts, not the rest around it. Samples of a frame that was lost and readings beyond the
/// sensor's healthy range are NaN.
#[derive(Clone, Debug)]
pub struct RunSamples {
    scale: DegreeScale,
    reference: Range<u32>,
    /// The frame that would follow without a gap.
    next: Option<u32>,
}

impl RunSamples {
    /// For a run of `rig`.
    pub fn new(rig: &RigFile, start: &Start) -> Self {
        let first = u32::from(start.pre_roll_frames);
        Self {
            scale: DegreeScale::of_rig(rig),
            reference: first..first + start.reference.frames(),
            next: None,
        }
    }

    /// Reference and position \[deg\] of the next frame and of the gap before it; nothing for a
    /// frame of the rest.
    pub fn take(&mut self, frame: &Frame) -> (Vec<f64>, Vec<f64>) {
        let index = u32::from(frame.index);
        if !self.reference.contains(&index) {
            return (Vec::new(), Vec::new());
        }
        let missing = index.saturating_sub(self.next.unwrap_or(index)) as usize;
        self.next = Some(index + 1);
        let mut input = vec![f64::NAN; missing * SAMPLES_PER_FRAME];
        let mut output = input.clone();
        input.extend([self.scale.reference(frame.pulse); SAMPLES_PER_FRAME]);
        output.extend(frame.samples.map(|counts| self.scale.position(counts)));
        (input, output)
    }
}

/// The frame of a reference with which it begins a second time: where it first comes back to the
/// offset that it began with. `None` where it never does.
///
/// ```
/// use servoid::instrument::live::second_cycle;
/// use servoid_protocol::reference::{Reference, Staircase};
/// // Two holds of 40 frames, then the next cycle.
/// assert_eq!(second_cycle(&Reference::Staircase(Staircase::PAPER)), Some(80));
/// ```
pub fn second_cycle(reference: &Reference) -> Option<u32> {
    let first = reference.offset_us(0)?;
    let away = (0..reference.frames()).find(|f| reference.offset_us(*f) != Some(first))?;
    (away..reference.frames()).find(|f| reference.offset_us(*f) == Some(first))
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_protocol::reference::Staircase;
    use servoid_protocol::{Counts, PulseWidth};

    fn frame(index: u16, counts: u16) -> Frame {
        Frame {
            run: 1,
            index,
            pulse: PulseWidth(1550),
            samples: [Counts(counts); SAMPLES_PER_FRAME],
        }
    }

    #[test]
    fn rest_is_left_out_and_gaps_and_broken_readings_are_missing() {
        let start = Start {
            run: 1,
            pre_roll_frames: 2,
            reference: Reference::Staircase(Staircase::PAPER),
            post_roll_frames: 2,
        };
        let mut samples = RunSamples::new(&RigFile::default(), &start);
        assert_eq!(samples.take(&frame(1, 8192)), (vec![], vec![]));
        assert_eq!(
            samples.take(&frame(2, 8192)),
            (vec![5.0; 10], vec![0.0; 10])
        );
        // Frame 3 never comes; the wire is off in frame 4.
        let (input, output) = samples.take(&frame(4, 0));
        assert!(input[..10].iter().all(|u| u.is_nan()) && input[10..] == [5.0; 10]);
        assert!(output.len() == 20 && output.iter().all(|y| y.is_nan()));
        assert_eq!(samples.take(&frame(362, 8192)), (vec![], vec![]));
    }
}
