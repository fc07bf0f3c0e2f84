//! Which quantity of a servo a number is.

/// A quantity of a servo as a machine. Documents have its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuantityKind {
    /// From the edge of a command to the beginning of the motion.
    Delay,
    /// Output for each unit of the command at rest.
    Gain,
    /// Output at rest under command 0.
    Offset,
    /// Of small signals.
    Bandwidth,
    /// Of small signals.
    DampingRatio,
    /// Towards larger outputs.
    TopSpeedUpwards,
    /// Towards smaller outputs.
    TopSpeedDownwards,
    /// Of full drive, towards larger outputs.
    AccelerationUpwards,
    /// Of full drive, towards smaller outputs.
    AccelerationDownwards,
    /// From which on the drive is full.
    ErrorOfFullDrive,
    /// To each side.
    DeadBand,
    /// Of the gears, the whole width.
    Play,
    /// What friction leaves of an error.
    RestingError,
    /// Relative to that in motion.
    FrictionAtRest,
    /// Relative to drive and load.
    FrictionOfGears,
    /// At the middle of the commands.
    LoadAtMiddle,
    /// Growth of the load with the angle, over the stiffness of the loop.
    SpringOfLoad,
    /// Of an arm with a weight.
    LoadOfLevelArm,
}

/// All of them.
const ALL: [QuantityKind; 18] = [
    QuantityKind::Delay,
    QuantityKind::Gain,
    QuantityKind::Offset,
    QuantityKind::Bandwidth,
    QuantityKind::DampingRatio,
    QuantityKind::TopSpeedUpwards,
    QuantityKind::TopSpeedDownwards,
    QuantityKind::AccelerationUpwards,
    QuantityKind::AccelerationDownwards,
    QuantityKind::ErrorOfFullDrive,
    QuantityKind::DeadBand,
    QuantityKind::Play,
    QuantityKind::RestingError,
    QuantityKind::FrictionAtRest,
    QuantityKind::FrictionOfGears,
    QuantityKind::LoadAtMiddle,
    QuantityKind::SpringOfLoad,
    QuantityKind::LoadOfLevelArm,
];

impl QuantityKind {
    /// What a limit of the drive brings about: large strokes show it.
    pub const OF_LIMIT: &[Self] = &[
        Self::TopSpeedUpwards,
        Self::TopSpeedDownwards,
        Self::AccelerationUpwards,
        Self::AccelerationDownwards,
        Self::ErrorOfFullDrive,
    ];

    /// What small quick strokes show.
    pub const OF_SMALL_SIGNALS: &[Self] = &[Self::Bandwidth, Self::DampingRatio];

    /// What shows where the servo rests. The friction at rest is no such quantity: how soon it is gone in motion no recording shows.
    pub const OF_REST: &[Self] = &[
        Self::DeadBand,
        Self::Play,
        Self::RestingError,
        Self::FrictionOfGears,
        Self::LoadAtMiddle,
        Self::SpringOfLoad,
        Self::LoadOfLevelArm,
        Self::Gain,
        Self::Offset,
    ];

    /// What holds the servo off its command, whichever side it comes from, as far as a recording shows it.
    pub const OF_FRICTION: &[Self] = &[
        Self::DeadBand,
        Self::Play,
        Self::RestingError,
        Self::FrictionOfGears,
    ];

    /// What pulls to one side.
    pub const OF_LOAD: &[Self] = &[Self::LoadAtMiddle, Self::SpringOfLoad, Self::LoadOfLevelArm];

    /// The name that documents have.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Delay => "delay",
            Self::Gain => "gain",
            Self::Offset => "offset",
            Self::Bandwidth => "bandwidth at small signals",
            Self::DampingRatio => "damping ratio",
            Self::TopSpeedUpwards => "top speed upwards",
            Self::TopSpeedDownwards => "top speed downwards",
            Self::AccelerationUpwards => "acceleration upwards",
            Self::AccelerationDownwards => "acceleration downwards",
            Self::ErrorOfFullDrive => "error of full drive",
            Self::DeadBand => "dead band, to each side",
            Self::Play => "play, whole width",
            Self::RestingError => "resting error by friction",
            Self::FrictionAtRest => "friction at rest to that in motion",
            Self::FrictionOfGears => "friction of the gears",
            Self::LoadAtMiddle => "load at the middle",
            Self::SpringOfLoad => "spring of the load to that of the loop",
            Self::LoadOfLevelArm => "load of a level arm",
        }
    }

    /// The quantity of this name; `None` of one that this version does not know.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        ALL.into_iter().find(|kind| kind.name() == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo_model::quantities::names;

    #[test]
    fn every_quantity_has_a_kind_of_its_own() {
        let kinds: Vec<QuantityKind> = names().filter_map(QuantityKind::named).collect();
        assert_eq!((kinds.len(), names().count()), (ALL.len(), ALL.len()));
        for (place, kind) in kinds.iter().enumerate() {
            assert!(!kinds[..place].contains(kind), "{kind:?}");
        }
    }
}
