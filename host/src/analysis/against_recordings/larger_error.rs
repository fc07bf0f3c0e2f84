//! That a model does not hold for a recording as it does for its own, and the simplest cause that explains it.

use super::misfit::{Lag, Misfit, Scale};
use super::spikes::Spikes;
use crate::presentation::summary::{four_digits, with_unit};
use servoid_identification::results::{Advice, Check};

/// How the times of a model and of a recording are known to each other.
#[derive(Clone, Copy)]
pub(super) struct Times {
    /// Within this (s).
    pub(super) open_s: f64,
    /// Whether the recording is read as one whose commands were polled.
    pub(super) polled: bool,
    /// Whether commands are taken to wait for pulses, or known not to.
    pub(super) frame_is_stated: bool,
    /// What commands within a row of a pulse may make of the error (rms), where they are.
    pub(super) beside_pulses: f64,
}

/// A model whose error is so many times that of its own recording misses what it knew there: noise alone changes far less from one
/// recording of a sensor to the next.
const LARGER_ERROR: f64 = 2.0;

/// An offset, a scale or a shift in time is the cause where it leaves less than this share of the error, and hardly more than the model has on
/// its own recording: a servo that is slower in larger strokes is later, too, and a shift leaves the rest of that.
const OF_A_CAUSE: f64 = 0.5;

/// That a model does not hold for a recording, with an error of `rmse`, as it did for its own, beyond what commands beside pulses may make. `misfit` is asked for only then. The times of model and
/// recording are `known` to each other.
pub(super) fn larger_error(
    kind: &str,
    [rmse, own_rmse]: [f64; 2],
    misfit: impl FnOnce() -> Misfit,
    (unit, known): (&str, Times),
) -> Option<Advice> {
    let times = rmse / own_rmse;
    let of_model = (rmse.powi(2) - known.beside_pulses.powi(2)).max(0.0).sqrt();
    (of_model > LARGER_ERROR * own_rmse).then(|| {
        let in_unit = |error: f64| with_unit(four_digits(error), unit);
        Advice::new(
            Check::Prediction,
            format!(
                "The {kind} model does not hold here as it does for its own recording: its error is {} rms, {times:.1} times the {} there.",
                in_unit(rmse),
                in_unit(own_rmse)
            ),
            times,
            LARGER_ERROR,
            cause([rmse, own_rmse], &misfit(), known, in_unit),
        )
    })
}

/// What the error is, the simplest first, and what to do.
fn cause(
    [rmse, own_rmse]: [f64; 2],
    misfit: &Misfit,
    Times {
        open_s,
        polled,
        frame_is_stated,
        ..
    }: Times,
    in_unit: impl Fn(f64) -> String,
) -> String {
    // Spikes spoil every figure below, be they ever so few.
    let is_of_spikes = |spikes: &&Spikes| spikes.left < OF_A_CAUSE * rmse;
    if let Some(spikes) = misfit.spikes.as_ref().filter(is_of_spikes) {
        return of_spikes(spikes, in_unit);
    }
    let is_all = |left: f64| left < LARGER_ERROR * own_rmse;
    let is_most = |left: f64| is_all(left) && left < OF_A_CAUSE * misfit.left_of_offset;
    if is_all(misfit.left_of_offset) && misfit.left_of_offset < rmse {
        return format!(
            "It is an offset of {}, without which the error is {}: the zero of the sensor has moved, or that of the command, or a load.",
            in_unit(misfit.offset),
            in_unit(misfit.left_of_offset)
        );
    }
    let scale = misfit.scale.as_ref();
    let turned =
        |scale: &Scale| scale.factor < 0.0 && scale.left < OF_A_CAUSE * misfit.left_of_offset;
    if scale.is_some_and(turned) {
        return "This recording turns the other way: look at the sign of command and position, and at the direction that a transmitter or \
             controller is set to."
            .to_owned();
    }
    let both = |scale: &&Scale| {
        is_all(scale.left) && scale.left < OF_A_CAUSE * rmse && !is_all(scale.left_of_scale_alone)
    };
    if let Some(scale) = scale.filter(both) {
        return format!(
            "It is gain and offset together: this recording is {:.3} times the model and {}, which leaves an error of {}. If the servo is the same, \
             look at the calibration of the sensor, its scale and its zero, and at travel and centre that a transmitter or controller is set to.",
            scale.factor,
            in_unit(scale.offset),
            in_unit(scale.left)
        );
    }
    if let Some(scale) = scale.filter(|scale| is_most(scale.left)) {
        return format!(
            "It is the gain: this recording moves {:.3} times as far as the model, and scaled by that it leaves an error of {}. If the servo is \
             the same, look at the units of both columns, at the calibration of the sensor, at the travel that a transmitter or controller is set to, and for a load that grows with the angle.",
            scale.factor,
            in_unit(scale.left)
        );
    }
    match misfit.lag.as_ref().filter(|lag| is_most(lag.left)) {
        Some(lag) if lag.seconds.abs() <= open_s => format!(
            "It is a delay of {:.1} ms, and shifted by that{} this recording leaves an error of {}. The files leave up to {:.1} ms open, as in how a command \
             that moves on with every row was sent: the model is not shown to be wrong.",
            1e3 * lag.seconds.abs(),
            without_offset(lag, &in_unit),
            in_unit(lag.left),
            1e3 * open_s
        ),
        Some(lag) => {
            let (here, model) = match lag.seconds > 0.0 {
                true => ("later", "early"),
                false => ("earlier", "late"),
            };
            format!(
                "It is a delay: this recording is {:.1} ms {here} than the model, and shifted by that{} it leaves an error of {}. Where servo, command and \
                 logger are the same, it is the model that is {model} in motion of this kind: identify from this recording, or from both together. Else look at \
                 how the command is written (at the moment at which it is sent, by the clock of the position), at the logger, and for pulses on a clock of their own, for which commands wait{}.",
                1e3 * lag.seconds.abs(),
                without_offset(lag, &in_unit),
                in_unit(lag.left),
                state_a_frame(frame_is_stated)
            )
        }
        None => noise(misfit, is_most, &in_unit).unwrap_or_else(|| {
            let lag = misfit.lag.as_ref();
            let in_part = lag.filter(|lag| lag.left < OF_A_CAUSE * misfit.left_of_offset);
            match in_part {
                Some(lag) => {
                    let delay = in_part_a_delay(lag, frame_is_stated, in_unit);
                    format!("{delay} {ANOTHER_MOTION}")
                }
                None if misfit.left_of_offset < OF_A_CAUSE * rmse => format!(
                    "Much of it is an offset of {}, without which the error is {}: the zero of the sensor has moved, or that of the command, or a load. {ANOTHER_MOTION}",
                    in_unit(misfit.offset),
                    in_unit(misfit.left_of_offset)
                ),
                None if open_s > 0.0 && !polled && !frame_is_stated => {
                    format!("{BETWEEN_ROWS} {ANOTHER_MOTION}")
                }
                None if !frame_is_stated => format!("{ANOTHER_MOTION} {FOR_PULSES}"),
                None => ANOTHER_MOTION.to_owned(),
            }
        }),
    }
}

/// That a shift leaves less than half of the error, and what does that.
fn in_part_a_delay(lag: &Lag, frame_is_stated: bool, in_unit: impl Fn(f64) -> String) -> String {
    let here = if lag.seconds > 0.0 {
        "later"
    } else {
        "earlier"
    };
    format!(
        "Much of it is a delay: taken {:.1} ms {here} than the model{}, this recording leaves an error of {}. Pulses on a clock of their own, for which commands wait{}, do that, \
         a logger that polls the command, and a servo that is slower in this motion.",
        1e3 * lag.seconds.abs(),
        without_offset(lag, &in_unit),
        in_unit(lag.left),
        state_a_frame(frame_is_stated)
    )
}

/// The offset that is taken out beside a shift, where it is more than a part of what is left.
fn without_offset(lag: &Lag, in_unit: impl Fn(f64) -> String) -> String {
    match lag.offset.abs() > OF_A_CAUSE * lag.left {
        true => format!(", without an offset of {}", in_unit(lag.offset)),
        false => String::new(),
    }
}

/// How to try whether commands waited for pulses.
fn state_a_frame(is_stated: bool) -> &'static str {
    match is_stated {
        true => "",
        false => " (--frame-ms states how often they come)",
    }
}

/// That the error is that of single rows.
fn of_spikes(spikes: &Spikes, in_unit: impl Fn(f64) -> String) -> String {
    let rows = match spikes.count {
        1 => "one row that stands".to_owned(),
        count => format!("{count} rows that stand"),
    };
    format!(
        "It is {rows} apart from what is before and behind, as spikes of a sensor or of its line do (the first at {:.3} s of its run): without that the \
         error is {}. Identification weights such rows down; leave their cells empty to validate without them.",
        spikes.first_s,
        in_unit(spikes.left)
    )
}

/// Said before it where times are open.
const BETWEEN_ROWS: &str = "Where the servo followed the command between the rows, and was not held at each, say --polled first: a fast motion is another one then.";

/// Said behind it where commands may have waited for pulses, and nobody says that they did not.
const FOR_PULSES: &str = "Where commands of this recording waited for pulses on a clock of their own, --frame-ms 20 looks for these, and the error is less with them.";

/// Said where nothing simpler is the cause.
pub(super) const ANOTHER_MOTION: &str = "Where servo and noise are the same, the motion is not: identify from recordings of both kinds of motion together, all with rows of one period (strokes as \
    large, as small and as quick as these), and take the servo model where the servo is not linear. Where the servo may be another, as under a load or another \
    supply, identify this recording by itself and compare the two.";

/// That the error is noise, where what the recording scatters by at rest is most of it.
fn noise(
    misfit: &Misfit,
    is_most: impl Fn(f64) -> bool,
    in_unit: impl Fn(f64) -> String,
) -> Option<String> {
    let noise = misfit.noise?;
    let left = (misfit.left_of_offset.powi(2) - noise.powi(2))
        .max(0.0)
        .sqrt();
    let of_offset = match misfit.offset.abs() > left.max(OF_A_CAUSE * noise) {
        true => format!("an offset of {} and ", in_unit(misfit.offset)),
        false => String::new(),
    };
    let rest = match left > 0.0 {
        true => format!("without that the error is {}", in_unit(left)),
        false => "that is all of the error".to_owned(),
    };
    is_most(left).then(|| {
        format!(
            "It is {of_offset}noise: at rest this recording scatters by {} rms, and {rest}. The response of the model is not shown to be wrong: look for \
             what shakes the servo or disturbs the sensor, or validate with a recording that has less noise.",
            in_unit(noise),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn misfit() -> Misfit {
        Misfit {
            offset: 0.0,
            left_of_offset: 0.8,
            scale: None,
            lag: None,
            noise: None,
            spikes: None,
        }
    }

    fn remedy(misfit: Misfit) -> String {
        remedy_within(misfit, 0.0)
    }

    /// The same where the times of model and recording are known to each other within `open_s`.
    fn remedy_within(misfit: Misfit, open_s: f64) -> String {
        let known = Times {
            open_s,
            polled: false,
            frame_is_stated: false,
            beside_pulses: 0.0,
        };
        larger_error("linear", [0.8, 0.05], || misfit, ("deg", known))
            .unwrap()
            .remedy
    }

    #[test]
    fn a_delay_is_named_where_it_is_most_of_the_error() {
        let shifted = |left: f64, offset: f64| {
            let lag = Lag {
                seconds: -0.02,
                left,
                offset,
            };
            remedy(Misfit {
                lag: Some(lag),
                ..misfit()
            })
        };
        let delayed = |left: f64| shifted(left, 0.0);
        let delay = delayed(0.06);
        assert!(
            delay.starts_with(
                "It is a delay: this recording is 20.0 ms earlier than the model, and shifted by that it leaves an error of 0.06000 deg."
            ),
            "{delay}"
        );
        let lag = Some(Lag {
            seconds: 0.0099,
            left: 0.06,
            offset: 0.0,
        });
        let open = remedy_within(Misfit { lag, ..misfit() }, 0.012);
        assert!(open.contains("leave up to 12.0 ms open"), "{open}");
        let another = remedy_within(misfit(), 0.012);
        assert!(another.contains("say --polled first") && another.ends_with(ANOTHER_MOTION));
        let polled = Times {
            open_s: 0.012,
            polled: true,
            frame_is_stated: false,
            beside_pulses: 0.0,
        };
        let found = larger_error("linear", [0.8, 0.05], misfit, ("deg", polled)).unwrap();
        assert_eq!(found.remedy, format!("{ANOTHER_MOTION} {FOR_PULSES}"));
        let stated = Times {
            frame_is_stated: true,
            ..polled
        };
        let found = larger_error("linear", [0.8, 0.05], misfit, ("deg", stated)).unwrap();
        assert_eq!(found.remedy, ANOTHER_MOTION);
        // A shift that leaves six times the error of the model's own recording is not all, and half of this one is no more than a slower servo has.
        let in_part = delayed(0.3);
        assert!(
            in_part.starts_with("Much of it is a delay: taken 20.0 ms earlier than the model")
                && in_part.ends_with(ANOTHER_MOTION),
            "{in_part}"
        );
        let beside = shifted(0.3, -0.4);
        assert!(
            beside.contains(
                "than the model, without an offset of -0.4000 deg, this recording leaves"
            ),
            "{beside}"
        );
        let motion = delayed(0.6);
        assert!(motion.starts_with("Where servo and noise"), "{motion}");
    }

    #[test]
    fn an_offset_a_gain_and_the_other_direction_are_named() {
        let offset = remedy(Misfit {
            offset: 0.79,
            left_of_offset: 0.06,
            // A shift leaves no less where there is no shift.
            lag: Some(Lag {
                seconds: 0.0,
                left: 0.06,
                offset: 0.0,
            }),
            ..misfit()
        });
        assert!(
            offset.starts_with("It is an offset of 0.7900 deg"),
            "{offset}"
        );
        let in_part = remedy(Misfit {
            offset: 0.77,
            left_of_offset: 0.2,
            ..misfit()
        });
        assert!(
            in_part.starts_with("Much of it is an offset of 0.7700 deg"),
            "{in_part}"
        );
        let scaled = |factor: f64| {
            let left = 0.06;
            remedy(Misfit {
                scale: Some(Scale {
                    factor,
                    offset: 0.0,
                    left,
                    left_of_scale_alone: left,
                }),
                ..misfit()
            })
        };
        assert!(scaled(0.9).starts_with("It is the gain: this recording moves 0.900 times"));
        assert!(scaled(-1.0).starts_with("This recording turns the other way"));
    }

    #[test]
    fn gain_and_offset_that_differ_together_are_named_together() {
        let both = remedy(Misfit {
            scale: Some(Scale {
                factor: 0.9,
                offset: -1.5,
                left: 0.06,
                left_of_scale_alone: 0.7,
            }),
            ..misfit()
        });
        assert!(
            both.starts_with(
                "It is gain and offset together: this recording is 0.900 times the model and -1.500 deg,"
            ),
            "{both}"
        );
    }

    #[test]
    fn noise_is_named_where_it_is_most_of_the_error() {
        let noisy = |noise: f64| {
            let noise = Some(noise);
            remedy(Misfit { noise, ..misfit() })
        };
        // sqrt(0.8² - 0.797²) = 0.069 is less than twice the error of the model's own recording, and sqrt(0.8² - 0.7²) is not.
        let named = noisy(0.797);
        assert!(
            named.starts_with("It is noise: at rest this recording scatters by 0.7970 deg rms"),
            "{named}"
        );
        assert!(noisy(0.7).starts_with("Where servo and noise"));
        let moved = remedy(Misfit {
            offset: 2.0,
            noise: Some(0.81),
            ..misfit()
        });
        assert!(
            moved.starts_with("It is an offset of 2.000 deg and noise")
                && moved.contains("that is all of the error"),
            "{moved}"
        );
    }
}
