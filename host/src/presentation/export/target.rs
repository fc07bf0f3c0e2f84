//! The programs that models are written for.

/// The target program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Target {
    /// A script with tf and frd, which Octave runs too; of a servo model, a function
    Matlab,
    /// A module with numpy, and python-control where it is there; of a servo model, one without packages
    Python,
    /// A module without packages; objects of ControlSystems.jl
    Julia,
    /// A C99 header: impulse response and state space, or the steps of a servo model; no allocation
    C,
    /// A table: step and frequency response with bounds
    #[value(alias = "simulink-csv")]
    Csv,
    /// A system with the actuator: hold, delay and poles; of a servo model, also speeds and hysteresis
    Jsbsim,
    /// The parameters of the servos of ArduPilot's SITL, of a servo model
    Ardupilot,
    /// A joint with a position actuator in MuJoCo's MJCF, of a servo model
    Mujoco,
}

impl Target {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Matlab,
        Self::Python,
        Self::Julia,
        Self::C,
        Self::Csv,
        Self::Jsbsim,
        Self::Ardupilot,
        Self::Mujoco,
    ];

    /// Whether it takes nothing but a servo model.
    #[must_use]
    pub fn needs_servo_model(self) -> bool {
        matches!(self, Self::Ardupilot | Self::Mujoco)
    }
}

impl std::str::FromStr for Target {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, Self::Err> {
        <Self as clap::ValueEnum>::from_str(word, false).map_err(|_| {
            let names = Self::ALL.map(|target| format!("{target:?}").to_lowercase());
            format!("there is no target {word:?}: choose {}", names.join(", "))
        })
    }
}
