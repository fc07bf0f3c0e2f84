//! The measurement with the samples that were left out as outlying.

use super::figure::{Figure, Ink, Mark, Marks, Panel, with_unit};
use super::signals::{MOST_RUNS, over_time, signal};
use servoid_identification::Record;
use servoid_identification::diagnostics::TakenOut;

/// The runs in which `taken_out` has samples, the first of many; `unit` is that of the output. No panels where nothing was left out.
#[must_use]
pub fn left_out(
    name: &str,
    title: &str,
    record: &Record,
    taken_out: &[TakenOut],
    unit: Option<&str>,
) -> Figure {
    let period = record.sample_period_s();
    let panel = |(run, samples): (usize, &[f64])| {
        let of_run = taken_out.iter().filter(|found| found.run == run);
        let points: Vec<Mark> = of_run
            .flat_map(|found| found.sample..found.sample + found.samples)
            .filter_map(|k| {
                Some(Mark {
                    x: k as f64 * period,
                    y: *samples.get(k)?,
                    line: None,
                })
            })
            .collect();
        (!points.is_empty()).then(|| Panel {
            marks: vec![Marks {
                name: "left out".to_owned(),
                ink: Ink::SecondModel,
                points,
            }],
            ..over_time(
                with_unit("position", unit),
                vec![signal("measured", Ink::Measured, period, samples)],
            )
        })
    };
    let runs = (1..)
        .zip(record.runs())
        .map(|(place, run)| (place, run.output()));
    Figure::new(
        name,
        title,
        runs.filter_map(panel).take(MOST_RUNS).collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_identification::Run;

    #[test]
    fn what_was_left_out_is_drawn_at_its_place() {
        let run = |y: [f64; 4]| Run::new(vec![0.0, 1.0, 0.0, 1.0], y.to_vec()).unwrap();
        let runs = vec![run([0.0; 4]), run([0.0, 1.0, 5.0, 6.0])];
        let record = Record::new(0.5, runs).unwrap();
        let taken_out = TakenOut {
            run: 2,
            sample: 2,
            samples: 2,
            spike: false,
            other_stroke: false,
        };
        let drawn = left_out("left-out", "Left out", &record, &[taken_out], Some("deg"));
        let [panel] = &drawn.panels[..] else {
            panic!("one run has samples that were left out");
        };
        let places: Vec<(f64, f64)> = panel.marks[0].points.iter().map(|m| (m.x, m.y)).collect();
        assert_eq!(places, [(1.0, 5.0), (1.5, 6.0)]);
        assert!(left_out("a", "b", &record, &[], None).panels.is_empty());
    }
}
