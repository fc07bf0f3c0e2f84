//! The range of pulses that a servo may get, and the range of a healthy sensor.

use servoid_protocol::lease::LONGEST_LEASE_S;
use servoid_protocol::message::{Arm, Refusal, Start};
use servoid_protocol::{Counts, PulseTrain, PulseWidth};

/// Consecutive samples outside the sensor's range that end a run: 10 ms. A single one may be a disturbance; a broken
/// wire or a sensor without its magnet stays outside.
pub const UNHEALTHY_SAMPLES: u8 = 5;

/// Parts of full scale that the rails take at either end: 1/256 is 13 mV of 3.3 V. A wire that is off or shorted
/// reads there, so a reading there is healthy for no sensor.
const RAIL_PARTS: u16 = 256;

/// The limits of an armed rig, checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    pub(crate) neutral: PulseWidth,
    shortest: PulseWidth,
    longest: PulseWidth,
    sensor_low: Counts,
    sensor_high: Counts,
    /// Length of the lease: a run goes on for this time after the last request of the host.
    pub(crate) lease_frames: u16,
}

impl Limits {
    /// The limits in `arm`, if they are consistent and within those that the board has for this train of pulses.
    ///
    /// # Errors
    /// [`Refusal::NoSuchTrain`] where the board cannot make the train. [`Refusal::BadLimits`] unless shortest ≤ neutral ≤
    /// longest, all within [`board_limits`](servoid_protocol::pulse_train::PulseType::board_limits), sensor_low <
    /// sensor_high ≤ `full_scale`, and the lease is between one frame and [`LONGEST_LEASE_S`].
    pub fn new(arm: &Arm, train: &PulseTrain, full_scale: Counts) -> Result<Self, Refusal> {
        if !train.is_sound() {
            return Err(Refusal::NoSuchTrain);
        }
        let [board_shortest, board_longest] = train.pulses.board_limits();
        let pulses = [
            board_shortest,
            arm.shortest,
            arm.neutral,
            arm.longest,
            board_longest,
        ];
        let sane = pulses.is_sorted()
            && arm.sensor_low < arm.sensor_high
            && arm.sensor_high <= full_scale
            && (1..=train.frames_in(LONGEST_LEASE_S)).contains(&arm.lease_frames);
        if !sane {
            return Err(Refusal::BadLimits);
        }
        // Rounded up: the first reading that is off the rail.
        let rail = full_scale.0.div_ceil(RAIL_PARTS);
        Ok(Self {
            neutral: arm.neutral,
            shortest: arm.shortest,
            longest: arm.longest,
            sensor_low: arm.sensor_low.max(Counts(rail)),
            sensor_high: arm
                .sensor_high
                .min(Counts(full_scale.0.saturating_sub(rail))),
            lease_frames: arm.lease_frames,
        })
    }

    /// Whether `counts` is within the range of a healthy sensor, and not at a rail of the converter.
    pub fn is_healthy(&self, counts: Counts) -> bool {
        (self.sensor_low..=self.sensor_high).contains(&counts)
    }

    /// The length of a run (frames), if it is allowed.
    ///
    /// # Errors
    /// [`Refusal::BadReference`] where the reference is not well formed or the run does not fit the
    /// 16-bit frame index; [`Refusal::BeyondLimits`] where it leaves the travel limits anywhere.
    pub fn admit(&self, start: &Start) -> Result<u16, Refusal> {
        let frames = u16::try_from(start.frames()).map_err(|_| Refusal::BadReference)?;
        if !start.reference.is_well_formed() || frames == 0 {
            return Err(Refusal::BadReference);
        }
        let (low, high) = start.reference.extremes_us();
        let within = |offset_us| {
            self.neutral
                .offset_by(offset_us)
                .is_some_and(|pulse| (self.shortest..=self.longest).contains(&pulse))
        };
        if within(low) && within(high) {
            Ok(frames)
        } else {
            Err(Refusal::BeyondLimits)
        }
    }

    /// The pulse `offset_us` from neutral, clamped to the limits: a last defence, should a reference ever exceed the
    /// extremes that were checked.
    pub fn pulse(&self, offset_us: i16) -> PulseWidth {
        self.neutral
            .offset_by(offset_us)
            .unwrap_or(self.neutral)
            .max(self.shortest)
            .min(self.longest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_protocol::lease::LONGEST_LEASE_S;
    use servoid_protocol::pulse_train::PulseType;
    use servoid_protocol::reference::{Reference, Staircase};
    use servoid_protocol::schema::SCHEMA_HASH;

    const FULL_SCALE: Counts = Counts(16_380);
    const USUAL: PulseTrain = PulseTrain::USUAL;
    const LONGEST_LEASE: u16 = USUAL.frames_in(LONGEST_LEASE_S);

    fn arm() -> Arm {
        Arm {
            schema_hash: SCHEMA_HASH,
            neutral: PulseWidth(1_500),
            shortest: PulseWidth(1_000),
            longest: PulseWidth(2_000),
            sensor_low: Counts(1_000),
            sensor_high: Counts(15_000),
            lease_frames: 50,
        }
    }

    fn staircase(amplitude_us: u16) -> Start {
        Start {
            run: 1,
            pre_roll_frames: 10,
            reference: Reference::Staircase(Staircase {
                amplitude_us,
                ..Staircase::PAPER
            }),
            post_roll_frames: 10,
        }
    }

    #[test]
    fn limits_that_touch_the_boards_own_are_good_and_one_microsecond_more_is_not() {
        let widest = Arm {
            shortest: PulseWidth(800),
            longest: PulseWidth(2_200),
            sensor_high: FULL_SCALE,
            lease_frames: LONGEST_LEASE,
            ..arm()
        };
        assert!(Limits::new(&widest, &USUAL, FULL_SCALE).is_ok());
        type Change = fn(&mut Arm);
        let bad: [(&str, Change); 8] = [
            ("too short", |a| a.shortest = PulseWidth(799)),
            ("too long", |a| a.longest = PulseWidth(2_201)),
            ("neutral below", |a| a.neutral = PulseWidth(799)),
            ("neutral above", |a| a.neutral = PulseWidth(2_201)),
            ("no sensor range", |a| a.sensor_low = a.sensor_high),
            ("beyond full scale", |a| a.sensor_high = Counts(16_381)),
            ("no lease", |a| a.lease_frames = 0),
            ("a lease of hours", |a| {
                a.lease_frames = LONGEST_LEASE + 1;
            }),
        ];
        for (name, change) in bad {
            let mut arm = widest;
            change(&mut arm);
            assert_eq!(
                Limits::new(&arm, &USUAL, FULL_SCALE),
                Err(Refusal::BadLimits),
                "{name}"
            );
        }
    }

    /// A wide pulse never reaches a narrow-pulse servo, nor a narrow one the other, whatever the host asks for.
    #[test]
    fn each_type_has_limits_and_rates_of_its_own() {
        let train = |pulses, period_us| PulseTrain { pulses, period_us };
        let (wide, narrow) = (
            train(PulseType::Wide, 3_004),
            train(PulseType::Narrow, 1_786),
        );
        let narrow_arm = Arm {
            neutral: PulseWidth(760),
            shortest: PulseWidth(400),
            longest: PulseWidth(1_100),
            ..arm()
        };
        assert!(Limits::new(&narrow_arm, &narrow, FULL_SCALE).is_ok());
        assert!(Limits::new(&arm(), &wide, FULL_SCALE).is_ok());
        let refused = |arm: Arm, train| Limits::new(&arm, &train, FULL_SCALE).err();
        let bad = Some(Refusal::BadLimits);
        assert_eq!(refused(narrow_arm, wide), bad);
        assert_eq!(refused(arm(), narrow), bad);
        for (shortest, longest) in [(400, 1_101), (399, 1_100)] {
            let beyond = Arm {
                shortest: PulseWidth(shortest),
                longest: PulseWidth(longest),
                ..narrow_arm
            };
            assert_eq!(refused(beyond, narrow), bad);
        }
        // Five seconds of frames of 15.02 ms.
        for (lease_frames, expected) in [(332, None), (333, bad)] {
            let leased = Arm {
                lease_frames,
                ..arm()
            };
            assert_eq!(refused(leased, wide), expected);
        }
        for train in [
            train(PulseType::Wide, 1_786),
            train(PulseType::Wide, 3_003),
            train(PulseType::Wide, 20_010),
            train(PulseType::Narrow, 1_784),
            train(PulseType::Narrow, 0),
        ] {
            assert_eq!(
                refused(arm(), train),
                Some(Refusal::NoSuchTrain),
                "{train:?}"
            );
        }
    }

    /// Every combination of values at and beside every limit, against the rule in plain words.
    #[test]
    fn every_combination_around_the_limits_is_judged_by_the_rule() {
        let pulses = [0, 799, 800, 801, 1_500, 2_199, 2_200, 2_201, u16::MAX].map(PulseWidth);
        let counts = [0, 1, 8_190, 16_379, 16_380, 16_381, u16::MAX].map(Counts);
        let leases = [0, 1, 249, 250, 251, u16::MAX];
        let mut accepted = 0;
        for shortest in pulses {
            for neutral in pulses {
                for longest in pulses {
                    for (low, high) in counts.iter().flat_map(|&l| counts.map(|h| (l, h))) {
                        for lease_frames in leases {
                            let arm = Arm {
                                neutral,
                                shortest,
                                longest,
                                sensor_low: low,
                                sensor_high: high,
                                lease_frames,
                                ..arm()
                            };
                            let pulses_are_good = shortest.0 >= 800
                                && shortest <= neutral
                                && neutral <= longest
                                && longest.0 <= 2_200;
                            let good = pulses_are_good
                                && low < high
                                && high <= FULL_SCALE
                                && (1..=250).contains(&lease_frames);
                            let found = Limits::new(&arm, &USUAL, FULL_SCALE);
                            assert_eq!(found.is_ok(), good, "{arm:?}");
                            accepted += u32::from(good);
                            let Ok(limits) = found else { continue };
                            // Whatever it was armed with, a rail is healthy for nobody.
                            assert!(!limits.is_healthy(Counts(0)));
                            assert!(!limits.is_healthy(FULL_SCALE));
                        }
                    }
                }
            }
        }
        assert!(accepted > 0);
    }

    #[test]
    fn a_reference_may_touch_the_limits_and_not_leave_them() {
        let limits = Limits::new(&arm(), &USUAL, FULL_SCALE).unwrap();
        assert_eq!(limits.admit(&staircase(500)), Ok(380));
        assert_eq!(limits.admit(&staircase(501)), Err(Refusal::BeyondLimits));
        // Beyond what a 16-bit pulse can be, on the low side.
        assert_eq!(limits.admit(&staircase(1_501)), Err(Refusal::BeyondLimits));
    }

    #[test]
    fn a_run_must_make_sense_and_fit_the_frame_index() {
        let limits = Limits::new(&arm(), &USUAL, FULL_SCALE).unwrap();
        assert_eq!(limits.admit(&staircase(0)), Err(Refusal::BadReference));
        let longest = Start {
            pre_roll_frames: u16::MAX - 370,
            ..staircase(50)
        };
        assert_eq!(limits.admit(&longest), Ok(u16::MAX));
        let too_long = Start {
            post_roll_frames: 11,
            ..longest
        };
        assert_eq!(limits.admit(&too_long), Err(Refusal::BadReference));
    }

    #[test]
    fn no_offset_makes_a_pulse_outside_the_limits() {
        let limits = Limits::new(&arm(), &USUAL, FULL_SCALE).unwrap();
        for offset in i16::MIN..=i16::MAX {
            let pulse = limits.pulse(offset);
            assert!((PulseWidth(1_000)..=PulseWidth(2_000)).contains(&pulse));
            if (-500..=500).contains(&offset) {
                assert_eq!(Some(pulse), PulseWidth(1_500).offset_by(offset));
            }
        }
    }
}
