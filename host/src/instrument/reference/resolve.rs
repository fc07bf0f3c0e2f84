//! From degrees, seconds and Hertz to a reference of whole frames and microseconds.

use super::error::ReferenceError;
use super::kind::{FrequencyBand, Kind};
use super::steps_file;
use super::whole_frames::{
    LARGEST_AMPLITUDE_US, LONGEST_S, frame_ratio, frames, repetitions, seconds,
};
use servoid_protocol::PulseTrain;
use servoid_protocol::reference::{
    MAX_LEVELS, MAX_TONES, Multisine, Prbs, Reference, Staircase, Stairs, Sweep,
};

/// A reference in degrees, seconds and Hertz. `None` takes the default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReferenceSpec {
    /// Which.
    pub kind: Kind,
    /// How far it goes to each side (degrees); not for a table.
    pub amplitude_deg: Option<f64>,
    /// How long a level of `stairs` or a chip of `prbs` is held (s).
    pub hold_s: Option<f64>,
    /// How long it takes (s): as near to it as whole cycles and periods come; not for the staircase.
    pub length_s: Option<f64>,
    /// Number of levels of `stairs`.
    pub levels: Option<u16>,
    /// Where `prbs` begins in its sequence.
    pub seed: Option<u16>,
    /// Lowest and highest frequency of `sweep` and `multisine` (Hz).
    pub frequencies_hz: Option<FrequencyBand>,
    /// The pulses that the servo takes, whose frames it is made of.
    pub train: PulseTrain,
}

/// A reference, and remarks on how it differs from the specification.
#[derive(Clone, Debug, PartialEq)]
pub struct ResolvedReference {
    /// The reference.
    pub reference: Reference,
    /// Roundings, and amplitudes that friction may swallow.
    pub remarks: Vec<String>,
}

/// Degrees of the paper's staircase to each side.
pub const AMPLITUDE_DEG: f64 = 5.0;

/// Five levels: four sizes of strokes in each direction, three levels reached from both sides, and four
/// gains from level to level, as many as the ends of the travel are judged by.
const LEVELS: u16 = 5;
/// Longer than the 599 samples that a settling time may have. Where strokes of different size differ in shape,
/// identification with shorter holds takes the differences for a slow tail: on the simulated bench servo it
/// chooses N = 599 for holds of 0.2 to 1.1 s, with a band of 6 to 3 % and no limits found, and
/// N = 85 from 1.2 s on, with 1.4 % and all of them (aircraft: N = 121, 2.3 %).
const STAIRS_HOLD_S: f64 = 1.2;
/// A third longer than the paper's servo takes to settle (0.12 s). A servo that is not linear does not answer
/// chips that end before it rests as it answers longer ones: on the simulated bench servo the band is 14 to 29 % at
/// 0.02 s, 13 % at 0.06 s, 1.3 % at 0.08 s, and 0.42 % from 0.12 to 0.16 s; on the aircraft 22, 15, 4.8 and 3 %.
/// On the linear one it is 0.45 to 0.65 % at all of them.
const CHIP_S: f64 = 0.16;
/// Each level has to be reached from each side twice, or there is no scatter to judge by.
const CYCLES: u32 = 2;
/// The default length of the other references: 63 chips of 8 frames of 20 ms, a whole sequence of 6 bits, fit just so.
const LENGTH_S: f64 = 10.24;
/// The paper's staircase has holds of 1 to 8 tenths of a second.
const PAPER_STEP_S: f64 = 0.1;
/// From a stroke a second or so up to where frames still make a good sine (three a turn).
const FREQUENCIES_HZ: FrequencyBand = FrequencyBand {
    first: 0.2,
    last: 15.0,
};
/// Periods of a multisine: the second one shows what the servo repeats.
const PERIODS: u16 = 2;

/// Below this, rounding to whole microseconds alone is more than 5 % of the step (µs).
const SMALL_AMPLITUDE_US: f64 = 10.0;

impl ReferenceSpec {
    /// The reference for a servo of `us_per_degree`.
    ///
    /// ```
    /// use servoid::instrument::reference::{Kind, ReferenceSpec};
    /// let spec = ReferenceSpec { kind: Kind::Stairs, ..ReferenceSpec::default() };
    /// let resolved = spec.resolve(10.0)?;
    /// assert_eq!(resolved.reference.frames(), 2400); // 5 levels, 20 strokes of 1.2 s, twice
    /// # Ok::<(), servoid::instrument::reference::ReferenceError>(())
    /// ```
    pub fn resolve(&self, us_per_degree: f64) -> Result<ResolvedReference, ReferenceError> {
        self.refuse_inapplicable_options()?;
        let mut remarks = Vec::new();
        let mut amplitude = || self.amplitude_us(us_per_degree, &mut remarks);
        let reference = match &self.kind {
            Kind::Staircase => Reference::Staircase(self.staircase(amplitude()?)?),
            Kind::Stairs => Reference::Stairs(self.stairs(amplitude()?)?),
            Kind::Prbs => Reference::Prbs(self.prbs(amplitude()?)?),
            Kind::Sweep => Reference::Sweep(self.sweep(amplitude()?)?),
            Kind::Multisine => Reference::Multisine(self.multisine(amplitude()?)?),
            Kind::Steps(file) => Reference::Steps(steps_file::read(
                file,
                us_per_degree,
                self.length_s,
                self.train,
                &mut remarks,
            )?),
        };
        let seconds = seconds(reference.frames(), self.train);
        if !reference.is_well_formed() || seconds > LONGEST_S {
            return Err(ReferenceError::OutOfRange(format!(
                "that makes a reference of {seconds} s that moves too little or lasts too long: it has to move, and to end within {LONGEST_S} s"
            )));
        }
        Ok(ResolvedReference { reference, remarks })
    }

    fn refuse_inapplicable_options(&self) -> Result<(), ReferenceError> {
        use Kind::{Multisine, Prbs, Staircase, Stairs, Steps, Sweep};
        let kind = &self.kind;
        let options = [
            (
                "--amplitude",
                self.amplitude_deg.is_some() && matches!(kind, Steps(_)),
                "every other reference; a table has its angles",
            ),
            (
                "--hold",
                self.hold_s.is_some() && !matches!(kind, Stairs | Prbs),
                "stairs and prbs",
            ),
            (
                "--length",
                self.length_s.is_some() && matches!(kind, Staircase),
                "every other reference; the paper's staircase takes 7.2 s",
            ),
            (
                "--levels",
                self.levels.is_some() && !matches!(kind, Stairs),
                "stairs",
            ),
            (
                "--prbs-seed",
                self.seed.is_some() && !matches!(kind, Prbs),
                "prbs",
            ),
            (
                "--frequencies",
                self.frequencies_hz.is_some() && !matches!(kind, Sweep | Multisine),
                "sweep and multisine",
            ),
        ];
        match options
            .into_iter()
            .find(|(_, does_not_apply, _)| *does_not_apply)
        {
            Some((option, _, instead)) => Err(ReferenceError::NotFor {
                option,
                kind: kind.clone(),
                instead,
            }),
            None => Ok(()),
        }
    }

    fn amplitude_us(
        &self,
        us_per_degree: f64,
        remarks: &mut Vec<String>,
    ) -> Result<u16, ReferenceError> {
        let degrees = self.amplitude_deg.unwrap_or(AMPLITUDE_DEG);
        if degrees.is_sign_negative() {
            return Err(ReferenceError::OutOfRange(format!(
                "an amplitude of {degrees} degrees is none: a reference goes to both sides of neutral, so state {}",
                -degrees
            )));
        }
        let microseconds = (degrees * us_per_degree).abs().round();
        if !(1.0..=LARGEST_AMPLITUDE_US).contains(&microseconds) {
            return Err(ReferenceError::OutOfRange(format!(
                "an amplitude of {degrees} degrees is {microseconds} µs of pulse: choose one between 1 and {LARGEST_AMPLITUDE_US} µs"
            )));
        }
        if microseconds < SMALL_AMPLITUDE_US {
            remarks.push(format!(
                "an amplitude of {degrees} degrees is only {microseconds} µs of pulse: it is sent in whole microseconds, and friction and dead band may swallow much of it"
            ));
        }
        Ok(microseconds as u16)
    }

    fn hold_frames(&self, otherwise_s: f64) -> Result<u16, ReferenceError> {
        frames("hold", self.hold_s.unwrap_or(otherwise_s), self.train)
    }

    fn length_frames(&self) -> Result<u16, ReferenceError> {
        frames("length", self.length_s.unwrap_or(LENGTH_S), self.train)
    }

    /// Its holds are the paper's, as near as whole frames come.
    fn staircase(&self, amplitude_us: u16) -> Result<Staircase, ReferenceError> {
        let hold_step_frames = frames("hold", PAPER_STEP_S, self.train)?;
        Ok(Staircase {
            amplitude_us,
            longest_hold_frames: 8 * hold_step_frames,
            shortest_hold_frames: hold_step_frames,
            hold_step_frames,
        })
    }

    fn stairs(&self, amplitude_us: u16) -> Result<Stairs, ReferenceError> {
        let levels = self.levels.unwrap_or(LEVELS);
        if !(2..=MAX_LEVELS).contains(&levels) {
            return Err(ReferenceError::OutOfRange(format!(
                "{levels} levels cannot be: choose 2 to {MAX_LEVELS}"
            )));
        }
        let once = Stairs {
            amplitude_us,
            levels,
            hold_frames: self.hold_frames(STAIRS_HOLD_S)?,
            cycles: 1,
        };
        let cycles = match self.length_s {
            Some(_) => repetitions(self.length_frames()?.into(), once.frames()),
            None => CYCLES,
        };
        Ok(Stairs {
            cycles: u16::try_from(cycles).unwrap_or(u16::MAX),
            ..once
        })
    }

    /// As many chips as fit; without a length, the longest whole sequence that does.
    fn prbs(&self, amplitude_us: u16) -> Result<Prbs, ReferenceError> {
        let chip_frames = self.hold_frames(CHIP_S)?;
        let chips = (self.length_frames()? / chip_frames).max(1);
        let bits = |value: u16| (u16::BITS - value.leading_zeros()) as u16;
        let (register, chips) = match self.length_s {
            // The shortest register whose sequence is not over before the end.
            Some(_) => (bits(chips).clamp(2, 15), chips),
            None => {
                // Chips of other frames are a little longer or shorter: a sequence that takes 6 % more fits as well.
                let register = (bits(chips + chips / 16 + 1) - 1).clamp(2, 15);
                (register, (1 << register) - 1)
            }
        };
        let largest_seed = (1u16 << register) - 1;
        let seed = self.seed.unwrap_or(largest_seed);
        if !(1..=largest_seed).contains(&seed) {
            return Err(ReferenceError::OutOfRange(format!(
                "a sequence from a register of {register} bits begins at a seed from 1 to {largest_seed}, not {seed}"
            )));
        }
        Ok(Prbs {
            amplitude_us,
            register,
            seed,
            chip_frames,
            chips,
        })
    }

    fn sweep(&self, amplitude_us: u16) -> Result<Sweep, ReferenceError> {
        let FrequencyBand { first, last } = self.frequencies_hz.unwrap_or(FREQUENCIES_HZ);
        let highest_hz = 0.5 / self.train.frame_s();
        if first.max(last) > highest_hz {
            return Err(ReferenceError::OutOfRange(format!(
                "the command changes every {} ms, so no frequency can be above {highest_hz:.1} Hz: make --frequencies lower",
                1e3 * self.train.frame_s()
            )));
        }
        // The wire counts cycles in frames: see `Sweep`.
        let millihertz = |hz: f64| (hz * 1e3 * frame_ratio(self.train)).round() as u16;
        Ok(Sweep {
            amplitude_us,
            first_millihertz: millihertz(first),
            last_millihertz: millihertz(last),
            frames: self.length_frames()?,
        })
    }

    fn multisine(&self, amplitude_us: u16) -> Result<Multisine, ReferenceError> {
        let FrequencyBand { first, last } = self.frequencies_hz.unwrap_or(FREQUENCIES_HZ);
        let (low, high) = (first.min(last), first.max(last));
        let period_frames = self.length_frames()? / PERIODS;
        let period_s = seconds(period_frames.into(), self.train);
        let lowest = (low * period_s).ceil().max(1.0) as u16;
        // A tone at half the frame rate may be sampled at its zeros.
        let below_half = period_frames.saturating_sub(1) / 2;
        let highest = ((high * period_s).floor() as u16).min(below_half);
        let Some(beyond) = highest.checked_sub(lowest) else {
            return Err(ReferenceError::OutOfRange(format!(
                "in a period of {period_s} s no tone fits between {low} and {high} Hz: they are {:.3} Hz apart; make --length longer or --frequencies wider",
                1.0 / period_s
            )));
        };
        let spacing = (beyond + 1).div_ceil(MAX_TONES);
        Ok(Multisine {
            amplitude_us,
            tone_64ths_us: 0,
            period_frames,
            first: lowest,
            spacing,
            tones: beyond / spacing + 1,
            periods: PERIODS,
        }
        .with_largest_tones())
    }
}
