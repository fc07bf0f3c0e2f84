use super::*;

fn even(count: u32) -> Vec<f64> {
    (0..count).map(|k| 0.02 * f64::from(k)).collect()
}

/// Whole milliseconds of rows that come up to a few milliseconds late: of the same logger, other runs are of other lengths.
#[test]
fn the_step_has_no_digits_that_the_stamps_do_not_have() {
    let stamps = |rows: u32, step: f64, seed: u32| -> Vec<f64> {
        let late = |k: u32| 2.5 * f64::from((k * 7919 + seed) % 101) / 101.0;
        let stamp = |k: u32| (step * f64::from(k) + late(k)).floor();
        (0..rows).map(stamp).collect()
    };
    for (rows, seed) in [(6000, 3), (4511, 20), (1207, 57)] {
        let column = TimeColumn::new(stamps(rows, 10.0, seed)).unwrap();
        assert_eq!(column.step(), 10.0, "{rows}");
    }
    // A clock that is off by more than the stamps leave open keeps its step, to what they show.
    let off = TimeColumn::new(stamps(60_000, 10.013, 3)).unwrap().step();
    assert!((off - 10.013).abs() < 3e-4, "{off}");
}

#[test]
fn a_gap_keeps_its_place_and_a_jump_back_is_another_run() {
    let mut times = even(100);
    times.drain(50..70);
    times.extend(even(40));
    let column = TimeColumn::new(times.clone()).unwrap();
    assert_eq!(column.step(), 0.02);
    let found = stretches(times.len(), Some(&column), None);
    assert_eq!(found.len(), 2);
    assert_eq!((found[0].rows.clone(), found[0].missing()), (0..80, 20));
    assert_eq!((found[1].rows.clone(), found[1].missing()), (80..120, 0));
    let placed = found[0].place(&times);
    assert_eq!(placed.len(), 100);
    assert!(placed[49] == times[49] && placed[55].is_nan() && placed[70] == times[50]);
}

/// A logger that writes one stamp twice and the next one right has lost nothing; one that writes a row
/// twice has another row than it says.
#[test]
fn a_stamp_that_is_repeated_and_made_up_for_is_a_late_one() {
    let mut times = even(200);
    for row in [20, 40, 199] {
        times[row] = times[row - 1];
    }
    let column = TimeColumn::new(times.clone()).unwrap();
    let found = stretches(times.len(), Some(&column), None);
    // The last row has none behind it that would make up for it.
    let rows: Vec<_> = found.iter().map(|stretch| stretch.rows.clone()).collect();
    assert_eq!(rows, [0..199, 199..200]);
    assert_eq!(found[0].missing(), 0);
    assert!(found[0].samples.iter().copied().eq(0..199));

    let mut twice = even(100);
    twice.insert(50, twice[49]);
    let column = TimeColumn::new(twice.clone()).unwrap();
    assert_eq!(stretches(twice.len(), Some(&column), None).len(), 2);
}

#[test]
fn a_year_of_gap_takes_no_memory() {
    let mut times = even(100);
    times.push(3e7);
    let column = TimeColumn::new(times.clone()).unwrap();
    let found = stretches(times.len(), Some(&column), None);
    assert_eq!(found.len(), 2);
    assert!(!found[0].continues && found[1].continues);
}

#[test]
fn uneven_steps_are_no_time() {
    assert_eq!(TimeColumn::new(vec![]), Err(TimeFault::Constant));
    assert_eq!(
        TimeColumn::new(vec![1.0, 1.0, 1.0]),
        Err(TimeFault::Constant)
    );
    let squares = TimeColumn::new((0..50).map(|k| f64::from(k * k)).collect());
    assert!(matches!(squares, Err(TimeFault::Uneven { .. })));
}

/// From -0.5 to 0.5, without order: a hash of the number.
fn scattered(k: u32) -> f64 {
    let mut mixed = k.wrapping_add(1).wrapping_mul(0x9E37_79B1);
    mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x85EB_CA6B);
    mixed = (mixed ^ (mixed >> 13)).wrapping_mul(0xC2B2_AE35);
    f64::from(mixed ^ (mixed >> 16)) / f64::from(u32::MAX) - 0.5
}

#[test]
fn stamps_that_scatter_keep_every_row_at_its_place() {
    let times: Vec<f64> = (0..2000)
        .filter(|k| k % 97 != 50)
        .map(|k| 2.0 * f64::from(k) + 0.8 * scattered(k))
        .collect();
    let column = TimeColumn::new(times.clone()).unwrap();
    // Uniform over 0.4 steps: 0.115 steps rms.
    assert!(
        (column.scatter() - 0.115).abs() < 0.02,
        "{}",
        column.scatter()
    );
    assert!((column.step() - 2.0).abs() < 0.002, "{}", column.step());
    let found = stretches(times.len(), Some(&column), None);
    let kept: Vec<usize> = (0..2000).filter(|k| k % 97 != 50).collect();
    assert_eq!((found.len(), &found[0].samples), (1, &kept));
    let wild: Vec<f64> = (0..2000)
        .map(|k| f64::from(k) + 0.9 * scattered(k))
        .collect();
    assert!(matches!(
        TimeColumn::new(wild),
        Err(TimeFault::Uneven { .. })
    ));
}

#[test]
fn many_gaps_are_distinguished_from_stamps_too_coarse() {
    let kept: Vec<usize> = (0..3000)
        .filter(|&k| k == 0 || scattered(k as u32) > -0.4)
        .collect();
    let times: Vec<f64> = kept.iter().map(|&k| 0.002 * k as f64).collect();
    let column = TimeColumn::new(times.clone()).unwrap();
    assert_eq!(column.step(), 0.002);
    assert_eq!(stretches(times.len(), Some(&column), None)[0].samples, kept);
    // Every 2.4 and 1.2 ms, written in whole milliseconds.
    let fine = TimeColumn::new((0..500).map(|k| (2.4 * f64::from(k)).floor()).collect()).unwrap();
    assert!((fine.step() - 2.4).abs() < 0.01);
    let coarse = TimeColumn::new((0..500).map(|k| (1.2 * f64::from(k)).floor()).collect());
    assert!(matches!(coarse, Err(TimeFault::Uneven { .. })));
    // Every ninth row missing looks the same, until the step is known.
    let kept: Vec<usize> = (0..900).filter(|k| k % 9 != 4).collect();
    let times: Vec<f64> = kept.iter().map(|&k| 2.0 * k as f64).collect();
    assert!(matches!(
        TimeColumn::new(times.clone()),
        Err(TimeFault::Uneven { .. })
    ));
    let column = TimeColumn::with_step(&times, 2.0).unwrap();
    assert_eq!(stretches(times.len(), Some(&column), None)[0].samples, kept);
    assert_eq!(TimeColumn::with_step(&times, 1.0), None);
    assert_eq!(TimeColumn::with_step(&times, 20.0), None);
}

#[test]
fn labels_part_runs_even_where_time_goes_on() {
    let column = TimeColumn::new(even(6)).unwrap();
    let labels = [1.0, 1.0, 2.0, 2.0, f64::NAN, f64::NAN];
    let rows: Vec<_> = stretches(6, Some(&column), Some(&labels))
        .into_iter()
        .map(|s| s.rows)
        .collect();
    assert_eq!(rows, [0..2, 2..4, 4..6]);
}
