//! Which quantity of a servo a number is.

use super::quantities::Quantity;

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
    /// What friction leaves of an error.
    RestingError,
    /// Relative to that in motion.
    FrictionAtRest,
    /// Relative to drive and load.
    FrictionOfGears,
    /// At the middle of the commands.
    LoadAtMiddle,
    /// Of an arm with a weight.
    LoadOfLevelArm,
}

/// The names that documents have.
const NAMES: [(QuantityKind, &str); 16] = [
    (QuantityKind::Delay, "delay"),
    (QuantityKind::Gain, "gain"),
    (QuantityKind::Offset, "offset"),
    (QuantityKind::Bandwidth, "bandwidth at small signals"),
    (QuantityKind::DampingRatio, "damping ratio"),
    (QuantityKind::TopSpeedUpwards, "top speed upwards"),
    (QuantityKind::TopSpeedDownwards, "top speed downwards"),
    (QuantityKind::AccelerationUpwards, "acceleration upwards"),
    (
        QuantityKind::AccelerationDownwards,
        "acceleration downwards",
    ),
    (QuantityKind::ErrorOfFullDrive, "error of full drive"),
    (QuantityKind::DeadBand, "dead band, to each side"),
    (QuantityKind::RestingError, "resting error by friction"),
    (
        QuantityKind::FrictionAtRest,
        "friction at rest to that in motion",
    ),
    (QuantityKind::FrictionOfGears, "friction of the gears"),
    (QuantityKind::LoadAtMiddle, "load at the middle"),
    (QuantityKind::LoadOfLevelArm, "load of a level arm"),
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

    /// What holds the servo off its command, whichever side it comes from.
    pub const OF_FRICTION: &[Self] = &[
        Self::DeadBand,
        Self::RestingError,
        Self::FrictionAtRest,
        Self::FrictionOfGears,
    ];

    /// What pulls to one side.
    pub const OF_LOAD: &[Self] = &[Self::LoadAtMiddle, Self::LoadOfLevelArm];

    /// The quantity of this name; `None` of one that this version does not know.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let known = NAMES.iter().find(|(_, known)| *known == name);
        known.map(|(kind, _)| *kind)
    }
}

impl Quantity {
    /// Which quantity it is; `None` of one that this version does not know.
    #[must_use]
    pub fn kind(&self) -> Option<QuantityKind> {
        QuantityKind::named(&self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::super::quantities::names;
    use super::*;

    #[test]
    fn every_quantity_has_a_kind_of_its_own() {
        let kinds: Vec<QuantityKind> = names().filter_map(QuantityKind::named).collect();
        assert_eq!((kinds.len(), names().count()), (NAMES.len(), NAMES.len()));
        for (place, kind) in kinds.iter().enumerate() {
            assert!(!kinds[..place].contains(kind), "{kind:?}");
        }
    }
}
