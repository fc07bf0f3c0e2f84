//! The derivatives by hand against dual numbers, and speeds against their formula.

use super::*;
use crate::equation::place;
use crate::{AtRest, DriveLimit, Dual, Friction, Load, PARAMETERS, PulseEnd, SpeedLimit, Stops};

type Number = Dual<PARAMETERS>;

/// Every parameter of a servo as a variable, in the order of [`ServoParameters::in_order`].
fn variables(servo: &ServoParameters<f64>) -> ServoParameters<Number> {
    let number = |place: usize| Number::variable(servo.in_order()[place], place);
    ServoParameters {
        delay_s: number(0),
        pulse_end: servo.pulse_end,
        stiffness: number(1),
        damping: number(2),
        gain: number(3),
        offset: number(4),
        limit: servo.limit.map(|limit| DriveLimit {
            up: number(5),
            down_to_up: number(6),
            motor_damping: number(7),
            at_one_stiffness: limit.at_one_stiffness,
        }),
        speed_limit: servo.speed_limit.map(|_| SpeedLimit {
            up: number(place::SPEED_UP),
            down_to_up: number(place::SPEED_DOWN_TO_UP),
        }),
        dead_band: servo.dead_band.map(|_| number(8)),
        friction: servo.friction.map(|friction| Friction {
            coulomb: number(9),
            of_gears: number(10),
            at_rest: friction.at_rest.map(|_| AtRest {
                excess: number(11),
                speed: number(12),
            }),
        }),
        load: match servo.load {
            Load::None => Load::None,
            Load::Constant(_) => Load::Constant(number(13)),
            Load::Pendulum { .. } => Load::Pendulum {
                gravity: number(13),
                from: number(14),
                radians: number(15),
            },
            Load::Spring { .. } => Load::Spring {
                constant: number(13),
                rate: number(14),
            },
            Load::Air { .. } => Load::Air {
                constant: number(13),
                stiffening: number(14),
                from: number(15),
            },
        },
        play: servo.play.map(|_| number(16)),
        stops: servo.stops,
    }
}

/// Servos with every term absent and present.
fn servos() -> Vec<ServoParameters<f64>> {
    let limit = |at_one_stiffness: bool| DriveLimit {
        up: 9e3,
        down_to_up: 0.7,
        motor_damping: 30.0,
        at_one_stiffness,
    };
    let limits = [None, Some(limit(false)), Some(limit(true))];
    let frictions = [None, Some((0.0, None)), Some((0.2, Some((0.4, 11.0))))];
    let loads = [
        Load::None,
        Load::Constant(250.0),
        Load::Pendulum {
            gravity: 800.0,
            from: 20.0,
            radians: 0.03,
        },
        Load::Spring {
            constant: -90.0,
            rate: 70.0,
        },
        Load::Air {
            constant: 60.0,
            stiffening: 9.0,
            from: 1.0,
        },
        Load::Air {
            constant: 60.0,
            stiffening: -9.0,
            from: 2.0,
        },
    ];
    let speed_limit = SpeedLimit {
        up: 90.0,
        down_to_up: 0.8,
    };
    let mut servos = Vec::new();
    for (limit, speed_limit) in limits
        .into_iter()
        .flat_map(|limit| [(limit, None), (limit, Some(speed_limit))])
    {
        for dead_band in [None, Some(0.3)] {
            for friction in frictions {
                for (n, load) in loads.into_iter().enumerate() {
                    // A stop with every other load.
                    let lower = (n % 2 == 1).then_some(-3.0);
                    servos.push(ServoParameters {
                        delay_s: 0.0123,
                        gain: -0.9,
                        offset: 0.4,
                        limit,
                        speed_limit,
                        dead_band,
                        friction: friction.map(|(of_gears, at_rest)| Friction {
                            coulomb: 200.0,
                            of_gears,
                            at_rest: at_rest.map(|(excess, speed)| AtRest { excess, speed }),
                        }),
                        load,
                        // Play with every third.
                        play: (n % 3 == 1).then_some(0.4),
                        stops: Stops { lower, upper: None },
                        ..ServoParameters::linear(1600.0, 55.0)
                    });
                }
            }
        }
    }
    servos
}

/// After a turn the output stays where it is until the shaft has crossed the play, and rests half of it before the command, on the side from which it comes.
#[test]
fn play_is_crossed_after_each_turn() {
    let tight = ServoParameters {
        gain: 2.0,
        ..ServoParameters::linear(2500.0, 110.0)
    };
    let loose = ServoParameters {
        play: Some(0.6),
        ..tight
    };
    let input: Vec<f64> = [0.0, 5.0, 8.0, 7.9, 3.0, 4.0]
        .into_iter()
        .flat_map(|level| [level; 200])
        .collect();
    let outputs = |servo: &ServoParameters| {
        let mut outputs = Vec::new();
        let grid = Grid::new(0.002, 0.0, 1e-3);
        let start = Start::at_rest(0.0, Some(0.0));
        simulate(servo, &grid, &start, &input, |_, y| outputs.push(y));
        outputs
    };
    let mut shown = 0.0;
    for (angle, y) in outputs(&tight).into_iter().zip(outputs(&loose)) {
        shown = f64::clamp(shown, angle - 0.6, angle + 0.6);
        // What a shaft without overshoot turns beyond its samples is below the error of the integration.
        assert!((y - shown).abs() < 1e-6, "{y} {shown}");
    }
    let rests: Vec<f64> = outputs(&loose).into_iter().skip(199).step_by(200).collect();
    for (y, at) in rests.into_iter().zip([0.0, 9.4, 15.4, 15.4, 6.6, 7.4]) {
        assert!((y - at).abs() < 1e-3, "{y} {at}");
    }
}

/// A staircase, and then an input that changes with every sample.
fn input() -> Vec<f64> {
    let sample = |k: usize| match k {
        0..300 => [0.0, 8.0, -5.0, 1.0, 1.5, 20.0][k / 50],
        _ => 9.0 * (0.11 * k as f64).sin(),
    };
    (0..500).map(sample).collect()
}

/// Full drive lifts a load slowly and lets it down fast; the gears take their share of both.
#[test]
fn a_long_stroke_reaches_the_top_speed_under_its_load() {
    let load = 300.0;
    let servo = ServoParameters {
        limit: Some(DriveLimit {
            up: 4000.0,
            down_to_up: 0.8,
            motor_damping: 20.0,
            at_one_stiffness: false,
        }),
        friction: Some(Friction {
            coulomb: 100.0,
            of_gears: 0.1,
            at_rest: None,
        }),
        load: Load::Constant(load),
        ..ServoParameters::linear(2500.0, 70.0)
    };
    let grid = Grid::new(0.01, 0.0, 1e-3);
    let reached = |command: f64| {
        let mut output = Vec::new();
        let input = vec![command; 200];
        let start = Start::at_rest(0.0, Some(0.0));
        simulate(&servo, &grid, &start, &input, |_, y| output.push(y));
        (output[199] - output[198]).abs() / 0.01
    };
    let [up, down] = servo.top_speeds(load).unwrap();
    // (4000 - 300 - 100 - 0.1 4300)/20 and (3200 + 300 - 100 - 0.1 2900)/20.
    assert!(
        (up - 158.5).abs() < 1e-9 && (down - 155.5).abs() < 1e-9,
        "{up} {down}"
    );
    // After 40 time constants of the motor; what is left is rounding.
    assert!((reached(1e6) / up - 1.0).abs() < 1e-6, "{}", reached(1e6));
    assert!(
        (reached(-1e6) / down - 1.0).abs() < 1e-6,
        "{}",
        reached(-1e6)
    );
    assert_eq!(servo.top_speeds(1e4).map(|[up, _]| up), Some(0.0));
}

/// Computed by Euler's rule in steps of a microsecond, with a speed that is cut off in each: with and without a limit of the drive, up and down.
#[test]
fn a_speed_is_cut_off_as_in_tiny_steps() {
    const TINY_S: f64 = 1e-6;
    let (stiffness, damping, load, [up, down]) = (2500.0, 80.0, 300.0, [150.0, 120.0]);
    let input: Vec<f64> = [30.0, -30.0, -25.0, 20.0, 0.0]
        .into_iter()
        .flat_map(|level| [level; 200])
        .collect();
    for full in [None, Some(8000.0)] {
        let servo = ServoParameters {
            // What does not count beside a limit of the speed.
            limit: full.map(|up| DriveLimit {
                up,
                down_to_up: 0.5,
                motor_damping: 40.0,
                at_one_stiffness: false,
            }),
            speed_limit: Some(SpeedLimit {
                up,
                down_to_up: down / up,
            }),
            load: Load::Constant(load),
            ..ServoParameters::linear(stiffness, damping)
        };
        let grid = Grid::for_stiffness(0.002, 0.0, stiffness);
        let rest = -load / stiffness;
        let start = Start::at_rest(rest, Some(0.0));
        let (mut angle, mut speed) = (rest, 0.0_f64);
        let most = full.unwrap_or(f64::INFINITY);
        simulate(&servo, &grid, &start, &input, |k, y| {
            // A quarter of a thousandth of the largest stroke. A step of 1 ms that did not stay at the limit for its rest would be off by up to an
            // eighth of the acceleration times its square, of 150,000 at the most.
            assert!((y - angle).abs() < 0.015, "{full:?}, {k}: {y} {angle}");
            for _ in 0..(0.002 / TINY_S) as usize {
                let drive = (stiffness * (input[k] - angle) - damping * speed).clamp(-most, most);
                speed = (speed + TINY_S * (drive - load)).clamp(-down, up);
                angle += TINY_S * speed;
            }
        });
        assert_eq!(servo.top_speeds(load), Some([up, down]));
    }
}

/// Computed by Euler's rule in steps of a microsecond, in each of which friction has one direction: with and without an excess at rest, in strokes
/// that are broken off, so that the shaft turns round and comes to rest within steps.
#[test]
fn friction_brakes_and_holds_as_in_tiny_steps() {
    const TINY_S: f64 = 1e-6;
    let (stiffness, damping, motor, most, coulomb) = (1200.0, 60.0, 30.0, 11e3, 700.0);
    let input: Vec<f64> = (0..60_u32)
        .flat_map(|k| [f64::from(k * 37 % 41) - 20.0; 40])
        .collect();
    for excess in [0.0, 0.6] {
        let at_rest = AtRest {
            excess,
            speed: 13.0,
        };
        let servo = ServoParameters {
            limit: Some(DriveLimit {
                up: most,
                down_to_up: 1.0,
                motor_damping: motor,
                at_one_stiffness: false,
            }),
            friction: Some(Friction {
                coulomb,
                of_gears: 0.0,
                at_rest: Some(at_rest),
            }),
            ..ServoParameters::linear(stiffness, damping)
        };
        let grid = Grid::new(0.002, 0.0, 1e-3);
        let (mut angle, mut speed) = (0.0, 0.0_f64);
        let start = Start::at_rest(angle, Some(0.0));
        simulate(&servo, &grid, &start, &input, |k, y| {
            // A twentieth of a thousandth of the largest stroke: a step of 1 ms in which friction has the direction or the excess of its beginning is off by
            // a fiftieth of a degree and more.
            assert!((y - angle).abs() < 0.002, "{excess}, {k}: {y} {angle}");
            for _ in 0..(0.002 / TINY_S) as usize {
                let drive = stiffness * (input[k] - angle) - (damping - motor) * speed;
                let force = drive.clamp(-most, most) - motor * speed;
                let friction = coulomb * at_rest.factor(speed);
                let direction = if speed == 0.0 { force } else { speed }.signum();
                let after = speed + TINY_S * (force - friction * direction);
                // It holds where it would turn the motion round by itself.
                speed = if after * direction < 0.0 { 0.0 } else { after };
                angle += TINY_S * speed;
            }
        });
    }
}

/// Both are the same sums in another order: apart by rounding, of which 500 samples of 3 steps in a stable servo gather
/// some thousand times 1e-16 of the largest derivative.
#[test]
fn slopes_are_those_of_dual_numbers() {
    let input = input();
    for servo in servos() {
        for (phase_s, before) in [(0.0, None), (0.0, Some(3.0)), (0.0141, Some(3.0))] {
            let grid = Grid::new(0.002, phase_s, 0.0008);
            let start = Start {
                output: 1.0,
                rate: 4.0,
                command_before: before,
                in_play: 0.7,
            };
            let (mut slow, mut fast) = (Vec::new(), Vec::new());
            simulate(
                &variables(&servo),
                &grid,
                &Start {
                    output: Number::constant(start.output),
                    rate: Number::constant(start.rate),
                    command_before: before.map(Number::constant),
                    in_play: start.in_play,
                },
                &input,
                |_, y| {
                    slow.push(y);
                },
            );
            simulate_with_slopes(&servo, &grid, &start, &input, |_, y, slopes, _| {
                fast.push((y, *slopes));
            });
            for place in 0..PARAMETERS {
                let sizes = slow.iter().map(|y| y.slope[place].abs());
                let largest = sizes.fold(0.0, f64::max);
                for (k, (slow, (output, slopes))) in slow.iter().zip(&fast).enumerate() {
                    assert!((slow.value - output).abs() < 1e-11, "{k} {servo:?}");
                    let apart = (slow.slope[place] - slopes[place]).abs();
                    assert!(
                        apart <= 1e-11 * largest,
                        "{servo:?}: sample {k}, parameter {place}: {} {}",
                        slow.slope[place],
                        slopes[place]
                    );
                }
            }
        }
    }
}

/// A command of one value has no range beside which a motion is none, so each of its steps is computed.
#[test]
fn a_servo_is_at_rest_where_each_further_step_would_leave_it() {
    // Of which the stroke is a hundredth: what is still beside that range moves it most.
    const RANGE: f64 = 900.0;
    let start = Start::at_rest(-3.0, Some(-4.0));
    // Where samples are near each other, a servo hardly moves from one to the next where it turns round.
    for (servo, period_s) in (servos().into_iter()).flat_map(|servo| [(servo, 2e-3), (servo, 1e-4)])
    {
        let grid = Grid::new(period_s, 0.0, 0.0008);
        let held = vec![6.0; (3.0 / period_s) as usize];
        let followed = [held.clone(), vec![6.0 - RANGE]].concat();
        let motion = |input: &[f64]| {
            let mut motion = Vec::new();
            simulate_with_slopes(&servo, &grid, &start, input, |_, y, slopes, _| {
                motion.push((y, *slopes));
            });
            motion
        };
        let [every, until_rest] = [&held, &followed].map(|input| motion(input));
        for place in 0..PARAMETERS {
            let sizes = every.iter().map(|(_, slopes)| slopes[place].abs());
            let largest = sizes.fold(0.0, f64::max);
            for ((y, slopes), (same, as_steep)) in every.iter().zip(&until_rest) {
                // A slow end is ten times as far away. Derivatives end later, and only steer a fit.
                let holds = (y - same).abs() < 10.0 * STILL * RANGE
                    && (slopes[place] - as_steep[place]).abs() <= 0.1 * largest;
                assert!(
                    holds,
                    "{place}: {y} {same} {slopes:?} {as_steep:?} {servo:?}"
                );
            }
        }
    }
}

/// A servo that runs into both stops and leaves them: where the zero of the sensor moves, the output at a stop moves with it; where the offset is
/// estimated, the output there stays. Before and between, both are the derivative by the offset.
#[test]
fn at_a_stop_the_output_follows_the_zero_of_the_sensor_and_not_the_offset() {
    let stops = Stops {
        lower: Some(-3.0),
        upper: Some(6.0),
    };
    let input = input();
    let grid = Grid::new(0.002, 0.0, 0.0008);
    let start = Start::at_rest(1.0, None);
    let mut checked = 0;
    for free in servos() {
        let servo = ServoParameters { stops, ..free };
        let outputs = |servo: ServoParameters| {
            let mut outputs = Vec::new();
            simulate(&servo, &grid, &start, &input, |_, y| outputs.push(y));
            outputs
        };
        let difference = |moved: &dyn Fn(f64) -> ServoParameters| {
            const STEP: f64 = 1e-6;
            let [more, less] = [STEP, -STEP].map(|step| outputs(moved(step)));
            let slopes = more.iter().zip(less).map(|(a, b)| (a - b) / (2.0 * STEP));
            slopes.collect::<Vec<f64>>()
        };
        let by_zero = difference(&|change| servo.seen_from(change));
        let by_offset = difference(&|change| ServoParameters {
            offset: servo.offset + change,
            ..servo
        });
        simulate_with_slopes(&servo, &grid, &start, &input, |k, y, slopes, zero| {
            let is_at_stop = y == 6.0 || y == -3.0;
            if is_at_stop {
                assert_eq!((zero, slopes[place::OFFSET]), (1.0, 0.0), "{k} {servo:?}");
                checked += 1;
            }
            // The derivative jumps where a step of the integration meets a stop, or friction stops the shaft, a step earlier or later.
            let smooth = free.friction.is_none();
            for (exact, found) in [(by_zero[k], zero), (by_offset[k], slopes[place::OFFSET])] {
                let holds = (exact - found).abs() < 1e-3;
                assert!(holds || !smooth, "{k}: {exact} {found} {servo:?}");
            }
        });
    }
    assert!(checked > 1000, "{checked}");
}

/// Steps of a millionth of a second, in which every change of a command falls on a step.
const FINE_S: f64 = 1e-6;

/// Sample period and samples of a level, in the tests of commands that change at moments of their own.
const ROW_S: f64 = 2e-3;
const HELD: usize = 30;

/// Levels with the time by which each acts later than its first sample \[s\].
type Late = [(f64, f64); 5];

/// The output of a servo in samples of [`ROW_S`], computed in fine steps.
fn moved_finely(servo: &ServoParameters<f64>, levels: Late) -> Vec<f64> {
    let period = (ROW_S / FINE_S).round() as usize;
    let mut fine = vec![levels[0].0; levels.len() * HELD * period];
    for (n, (level, late_s)) in levels.into_iter().enumerate().skip(1) {
        let late = (late_s / FINE_S).round() as isize;
        let from = (n * HELD * period).saturating_add_signed(late);
        fine[from..].fill(level);
    }
    let start = Start::at_rest(servo.resting_output(levels[0].0), Some(levels[0].0));
    let mut output = Vec::new();
    simulate(
        servo,
        &Grid::new(FINE_S, 0.0, FINE_S),
        &start,
        &fine,
        |k, y| {
            if k % period == 0 {
                output.push(y);
            }
        },
    );
    output
}

/// That a servo moves as in fine steps.
fn require_same(servo: &ServoParameters<f64>, commands: Commands<'_>, expected: &[f64]) {
    let start = Start::at_rest(servo.resting_output(0.0), Some(0.0));
    let mut found = Vec::new();
    let grid = Grid::new(ROW_S, 0.0, 0.1e-3);
    simulate(servo, &grid, &start, commands, |_, y| found.push(y));
    for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
        // The error of the scheme, the square of 0.1 ms times its bandwidth, of 550 units: 0.01. A command that acts 0.25 ms later makes it 4.
        assert!((found - expected).abs() < 0.02, "{k}: {found} {expected}");
    }
}

/// As a servo with one delay for all commands moves, whose commands are given as much later as their pulses are longer.
#[test]
fn a_pulse_that_is_longer_acts_later() {
    let pulse_end = PulseEnd {
        s_per_command: 1e-6,
        neutral: 50.0,
    };
    let servo = ServoParameters {
        delay_s: 7e-3,
        pulse_end: Some(pulse_end),
        ..servos()[0]
    };
    let constant = ServoParameters {
        pulse_end: None,
        ..servo
    };
    let levels = [0.0, 300.0, -250.0, -240.0, 100.0];
    let expected = moved_finely(
        &constant,
        levels.map(|level| (level, pulse_end.later_s(level))),
    );
    let input: Vec<f64> = levels.into_iter().flat_map(|level| [level; HELD]).collect();
    require_same(&servo, (&input).into(), &expected);
}

#[test]
fn a_command_that_comes_into_force_behind_its_sample_acts_later() {
    let servo = ServoParameters {
        delay_s: 7.3e-3,
        ..servos()[0]
    };
    let levels = [
        (0.0, 0.0),
        (300.0, 0.4e-3),
        (-250.0, 1.9e-3),
        (-240.0, 0.0),
        (100.0, 1.1e-3),
    ];
    let expected = moved_finely(&servo, levels);
    let held = |of: fn((f64, f64)) -> f64| -> Vec<f64> {
        levels
            .into_iter()
            .flat_map(|level| [of(level); HELD])
            .collect()
    };
    let (input, late_s) = (held(|level| level.0), held(|level| level.1));
    let commands = Commands {
        levels: &input,
        late_s: Some(&late_s),
    };
    require_same(&servo, commands, &expected);
}

/// Both are the same sums in another order, as without pulses.
#[test]
fn slopes_are_those_of_dual_numbers_where_pulses_end_later() {
    let input = input();
    for servo in servos() {
        let servo = ServoParameters {
            pulse_end: Some(PulseEnd {
                s_per_command: -0.2e-3,
                neutral: 1.0,
            }),
            ..servo
        };
        let grid = Grid::new(0.002, 0.0, 0.0008);
        let at = |x: f64| Number::constant(x);
        let (mut slow, mut fast) = (Vec::new(), Vec::new());
        let start = Start {
            output: at(1.0),
            rate: at(4.0),
            command_before: Some(at(3.0)),
            in_play: 0.7,
        };
        simulate(&variables(&servo), &grid, &start, &input, |_, y| {
            slow.push(y.slope[0])
        });
        let start = Start {
            output: 1.0,
            rate: 4.0,
            command_before: Some(3.0),
            in_play: 0.7,
        };
        simulate_with_slopes(&servo, &grid, &start, &input, |_, _, slopes, _| {
            fast.push(slopes[0])
        });
        let largest = slow
            .iter()
            .fold(0.0_f64, |most, slope| most.max(slope.abs()));
        for (k, (slow, fast)) in slow.iter().zip(&fast).enumerate() {
            assert!(
                (slow - fast).abs() <= 1e-11 * largest,
                "{servo:?}: {k} {slow} {fast}"
            );
        }
    }
}
