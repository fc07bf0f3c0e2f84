//! Why a conversation with a rig failed, and the remedy.

use crate::commanded::Contradiction;
use servoid_protocol::message::Refusal;

/// Why a conversation with a rig failed. The text names the remedy.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ClientError {
    /// No rig has answered.
    #[error("no rig answers: {bytes} bytes have come, and no answer in them")]
    NobodyThere {
        /// How many bytes came.
        bytes: u64,
    },
    /// It answered once and no longer does.
    #[error("the rig does not answer to {request}: check the cable and its power")]
    NoAnswer {
        /// The request.
        request: &'static str,
    },
    /// Nothing readable has come for a long time.
    #[error(
        "nothing readable has come from the rig for {seconds} s: check the cable and its power"
    )]
    FellSilent {
        /// How long (s).
        seconds: u64,
    },
    /// It says that the run goes on, and no frame of it comes.
    #[error(
        "the rig answers, but no frame of the run has come for {seconds} s: its clock stands still, or the line is too slow"
    )]
    NoFrames {
        /// How long (s).
        seconds: u64,
    },
    /// It knows nothing of the run that it had begun.
    #[error(
        "the rig knows nothing of the run any more: it has been reset, or another program has taken it over"
    )]
    RunForgotten,
    /// The rig was built for other messages.
    #[error(
        "the rig speaks another protocol (its schema is {rig:016x}, this servoid's is {host:016x}): flash the firmware of this version with 'servoid flash'"
    )]
    SchemaDiffers {
        /// The rig's schema hash.
        rig: u64,
        /// This program's schema hash.
        host: u64,
    },
    /// The rig's clock is not the one that times in a recording are made of.
    #[error(
        "the rig's {field} is {rig}, this servoid's {host}: {meaning}; flash the firmware of this version with 'servoid flash'"
    )]
    TimingDiffers {
        /// Its name in [`servoid_protocol::Hello`].
        field: &'static str,
        /// The rig's.
        rig: String,
        /// This program's.
        host: String,
        /// Its consequence.
        meaning: &'static str,
    },
    /// Frames come that nobody here has asked for, or another session holds the rig.
    #[error(
        "a run of another program is under way on this rig, or ended a moment ago, so nothing was asked of it: wait for its end, or stop it there"
    )]
    RunOfAnother,
    /// It says what cannot be true of the run that it was asked for.
    #[error(
        "the rig contradicts the command: {0}; neither its program nor what came can be trusted: flash the firmware of this version with 'servoid flash'"
    )]
    Contradiction(Contradiction),
    /// The rig says no.
    #[error("the rig refuses to {request}: {}", refusal_text(*.refusal))]
    Refused {
        /// The request.
        request: &'static str,
        /// Why not.
        refusal: Refusal,
    },
}

fn refusal_text(refusal: Refusal) -> &'static str {
    match refusal {
        Refusal::UnknownSession => "another program has taken over the rig; start again",
        Refusal::Outdated => "a newer request has overtaken this one; start again",
        Refusal::SchemaDiffers => {
            "it was built for another protocol; flash this version's firmware"
        }
        Refusal::NotArmed => "it is not armed, or has been reset since it was; start again",
        Refusal::Running => "a run is under way; wait for its end",
        Refusal::BadLimits => {
            "the limits or the healthy readings of the sensor are outside what the board allows, or neutral is outside the limits; mend 'limits', 'servo.neutral_us' and 'sensor.healthy_counts' in the rig file"
        }
        Refusal::BeyondLimits => {
            "the reference leaves the limits; choose a smaller amplitude or wider 'limits' in the rig file"
        }
        Refusal::BadReference => "the reference is empty or too long for one run; make it shorter",
        Refusal::UnknownRun => "it knows nothing of that run; it may have been reset",
        Refusal::RunRepeated => "its number is that of the run before; start again",
        Refusal::SensorOutOfRange => {
            "the sensor reads outside its healthy range; check its wiring and supply, or 'sensor.healthy_counts' in the rig file"
        }
        Refusal::LeaseLapsed => {
            "it had heard nothing from this program for too long, as the line held the request back; start again"
        }
        Refusal::NoSuchTrain => {
            "no board makes pulses of that type at that rate; mend 'servo.pulse_type' and 'servo.pulse_rate_hz' in the rig file"
        }
        Refusal::OtherPulseType => {
            "it has made pulses of the other type since its last start, and a servo of that type may still be on its line; put the right servo on it, or mend 'servo.pulse_type' in the rig file, and press the board's reset button"
        }
        Refusal::SupplyLow => {
            "its own 3.3 V are too low, so its readings would be wrong; feed its 5V pin with 4.75 to 5.25 V"
        }
    }
}
