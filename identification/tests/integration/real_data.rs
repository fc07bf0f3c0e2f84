//! A recording of a real motor: the first half predicts the second.

use servoid_identification::{Options, Record, Settling, identify};

/// Columns u and y of the file beside this test.
fn motor() -> (Vec<f64>, Vec<f64>) {
    let text = include_str!("../data/dcmotor_speed_prbs.csv");
    let rows = text.lines().skip(1).map(|line| {
        let mut cells = line.split(',').map(|cell| cell.parse::<f64>().unwrap());
        cells.next();
        (cells.next().unwrap(), cells.next().unwrap())
    });
    rows.unzip()
}

#[test]
fn the_first_half_of_a_motor_recording_predicts_the_second() {
    let (u, y) = motor();
    let half = u.len() / 2;
    let seen = Record::of_run(0.02, &u[..half], &y[..half]).unwrap();
    let unseen = Record::of_run(0.02, &u[half..], &y[half..]).unwrap();
    // Plain FIR least squares of 50 lags reaches 96.4 %.
    for (settling, wanted) in [("50", 95.0), ("auto", 95.9)] {
        let options = Options {
            settling: settling.parse::<Settling>().unwrap(),
            ..Options::default()
        };
        let model = identify(&seen, &options).unwrap();
        let validation = model.validate(&unseen).unwrap();
        println!(
            "settling {settling}: {:?} fit {:.2} %",
            model.structure, validation.fit_percent
        );
        assert!(
            validation.fit_percent >= wanted,
            "{settling}: {validation:?}"
        );
    }
}
