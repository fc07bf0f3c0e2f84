use super::*;
use crate::instrument::port;
use crate::instrument::rig::RigClient;
use servoid_simulator::sensor::SENSOR_SCALE;

/// A sensor of which everything is known.
fn exact(gain: f64) -> SensorSection {
    SensorSection {
        zero_counts: SENSOR_SCALE.zero_counts,
        degrees_per_count: SENSOR_SCALE.degrees_per_count / gain,
        zero_sd_deg: 0.0,
        scale_sd_percent: 0.0,
        ..SensorSection::default()
    }
}

fn measure(address: &str, sensor: &SensorSection) -> Result<Travel, TravelError> {
    let client = RigClient::connect(port::open(address).unwrap(), address).unwrap();
    let mut mover = Mover::new(client, RigFile::default(), &|| false);
    Travel::measure(&mut mover, sensor)
}

fn stop(end: &End) -> (Estimate, Estimate) {
    match end {
        End::Stops { at_us, angle_deg } => (*at_us, *angle_deg),
        other => panic!("{other:?}"),
    }
}

fn covers(interval: Estimate, truth: f64) -> bool {
    (interval.lower..=interval.upper).contains(&truth)
}

#[test]
fn neutral_scale_and_ends_of_the_simulated_servo_lie_within_their_intervals() {
    // At 1 % two misses of 2 happen once in 10 000.
    require_few_misses(2, 2);
}

#[test]
#[ignore = "half a minute: cargo test -p servoid --lib -- --ignored neutral_scale_and_ends"]
fn neutral_scale_and_ends_lie_within_their_intervals_with_many_seeds() {
    // Two misses or more of 4 happen once in 1700.
    require_few_misses(4, 2);
}

/// Stops at angles that no level of the staircase commands, 62.5 µs being 6.25 degrees.
fn require_few_misses(runs: u64, too_many: u64) {
    let mut missed = [0; 6];
    for seed in 0..runs {
        let gain = 0.98 + 0.001 * seed as f64;
        let (low, high) = (-33.3, 20.0 + 0.1 * seed as f64);
        let address = format!("sim:bench?seed={seed}&sensor-gain={gain}&stops-deg={low}:{high}");
        let travel = measure(&address, &exact(gain)).unwrap();
        let [short, long] = [&travel.short_end, &travel.long_end].map(stop);
        // The simulated servo's play is 0.04 degrees wide: at a stop the output is half of it short.
        let truths = [
            (travel.us_per_degree, 10.0),
            (travel.neutral_deg, 0.0),
            (short.0, 1500.0 + 10.0 * low),
            (long.0, 1500.0 + 10.0 * high),
            (short.1, low + 0.02),
            (long.1, high - 0.02),
        ];
        for (missed, (found, truth)) in missed.iter_mut().zip(truths) {
            *missed += u64::from(!covers(found, truth));
        }
    }
    assert!(
        missed.iter().all(|missed| *missed < too_many),
        "{missed:?} of {runs}"
    );
}

#[test]
fn a_servo_without_ends_has_none_and_its_gain_is_in_its_scale() {
    require_no_ends(0..1);
}

#[test]
#[ignore = "three seconds: cargo test -p servoid --lib -- --ignored without_ends"]
fn servos_without_ends_have_none_with_another_seed() {
    require_no_ends(1..2);
}

fn require_no_ends(seeds: std::ops::Range<u64>) {
    for (servo, us_per_degree) in [("bench", 10.0), ("linear?gain=0.9", 10.0 / 0.9)] {
        for seed in seeds.clone() {
            let sign = if servo.contains('?') { '&' } else { '?' };
            let travel = measure(&format!("sim:{servo}{sign}seed={seed}"), &exact(1.0)).unwrap();
            for end in [&travel.short_end, &travel.long_end] {
                assert!(
                    matches!(end, End::NotWithin { .. }),
                    "{servo} {seed}: {end:?}"
                );
            }
            // At 99 %: one of 4 outside happens in one of 25 such tests, half as far again in none.
            let Estimate {
                value,
                lower,
                upper,
            } = travel.us_per_degree;
            let half = (upper - lower) / 2.0;
            assert!(
                (value - us_per_degree).abs() < 1.5 * half,
                "{servo} {seed}: {value} ± {half}"
            );
            assert!(half / value < 0.01, "{half}");
        }
    }
}

#[test]
fn a_servo_that_stands_still_is_distinguished_from_one_that_ends() {
    let error = measure("sim:linear?gain=0", &exact(1.0)).unwrap_err();
    assert!(error.to_string().contains("does not follow"), "{error}");
}

/// A staircase over a plant that is given: counts at each pulse, out and back on both sides.
fn of(counts: impl Fn(f64) -> f64) -> Travel {
    let rest = |(k, pulse_us): (usize, &u16)| Rest {
        pulse_us: *pulse_us,
        // Alternating by two counts: scatter.
        counts: counts(f64::from(*pulse_us)) + if k % 2 == 0 { 2.0 } else { -2.0 },
        sd_counts: 5.0,
        samples: 250,
    };
    let visit = |pulses: &[u16]| -> Vec<Rest> { pulses.iter().enumerate().map(rest).collect() };
    let mut rests = Vec::new();
    for limit in [2000, 1000] {
        let seen = visit(&staircase(1500, limit));
        let finer = finer_back(&seen[..=8], 10.923);
        rests.extend(seen);
        rests.extend(visit(&finer.unwrap_or_default()));
    }
    Travel::of(rests, 1500, [1000, 2000], &exact(1.0)).unwrap()
}

#[test]
fn an_end_that_only_softens_is_no_stop() {
    let line = |us: f64| 8192.0 + 10.923 * (us - 1500.0);
    let softened = of(|us| {
        if us > 1800.0 {
            line(1800.0) + 0.5 * (line(us) - line(1800.0))
        } else {
            line(us)
        }
    });
    let End::Softens {
        gain_percent,
        from_us,
    } = softened.long_end
    else {
        panic!("{:?}", softened.long_end)
    };
    assert!((gain_percent.value - 50.0).abs() < 5.0, "{gain_percent:?}");
    assert!(
        from_us.value > 1750.0 && from_us.value < 1950.0,
        "{from_us:?}"
    );
    assert!(matches!(softened.short_end, End::NotWithin { .. }));
    let steeper = of(|us| {
        if us < 1300.0 {
            line(1300.0) + 1.15 * (line(us) - line(1300.0))
        } else {
            line(us)
        }
    });
    let End::AnswersMore { gain_percent, .. } = steeper.short_end else {
        panic!("{:?}", steeper.short_end)
    };
    assert!(gain_percent.lower > 100.0, "{gain_percent:?}");
    assert!((gain_percent.value - 115.0).abs() < 5.0, "{gain_percent:?}");
    // One level beyond the knee: it may be either.
    let late = of(|us| line(us.min(1960.0)));
    assert!(
        matches!(late.long_end, End::Unclear { .. }),
        "{:?}",
        late.long_end
    );
    let stopped = of(|us| line(us.max(1234.0)));
    let (at, angle) = stop(&stopped.short_end);
    assert!(covers(at, 1234.0) && at.upper - at.lower < 10.0, "{at:?}");
    assert!((angle.value + 26.6).abs() < 0.1, "{angle:?}");
}

/// The simulated aircraft's servo answers less and less to 3.9 degrees, where its load stalls it: from 1549 µs on readings are all the same.
#[test]
fn a_servo_that_its_load_stalls_stops_within_the_interval() {
    for seed in 1..4 {
        let travel = measure(&format!("sim:aircraft?seed={seed}"), &exact(1.0)).unwrap();
        let (at, angle) = stop(&travel.long_end);
        assert!(covers(at, 1549.0) && at.upper - at.lower < 20.0, "{at:?}");
        assert!(covers(angle, 3.93), "{angle:?}");
    }
}

/// 60 degrees to each side are all that the sensor follows: at 1.2 times the gain that is where the pulses end, and beyond neither stop nor servo is seen.
#[test]
fn the_end_of_the_sensor_is_no_stop_of_the_servo() {
    for (gain, seen_us) in [(1.2, 1938), (1.5, 1875)] {
        let travel = measure(&format!("sim:linear?gain={gain}"), &exact(1.0)).unwrap();
        let End::SensorEnds {
            before_us,
            angle_deg,
            ..
        } = travel.long_end
        else {
            panic!("{:?}", travel.long_end)
        };
        assert!(before_us.abs_diff(seen_us) < 30, "{before_us}");
        assert!((angle_deg - 60.0).abs() < 0.1, "{angle_deg}");
        assert!(matches!(travel.short_end, End::SensorEnds { .. }));
    }
}
