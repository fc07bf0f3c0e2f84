//! Runs that are put together and are not of one kind: other strokes, another condition, another servo or rig.

use servoid_identification::results::{Advice, Check};
use servoid_identification::thresholds::EQUALLY_LARGE;
use servoid_identification::{Record, only_stroke};

/// What the header of a recording calls that which has to be the same in all runs.
const THE_SAME: [&str; 3] = ["condition", "servo", "rig"];

/// That runs differ in what they are of. `facts` are those of the files, in the order of the runs.
pub(super) fn advice(
    record: &Record,
    facts: &[Vec<(String, String)>],
    unit: Option<&str>,
) -> Option<Advice> {
    let strokes = strokes(record, &names(record, facts), unit);
    let stated = THE_SAME.iter().filter_map(|key| stated(key, facts));
    let differ: Vec<String> = strokes.into_iter().chain(stated).collect();
    (!differ.is_empty()).then(|| {
        Advice::new(
            Check::UnlikeRuns,
            format!(
                "The runs are not of one kind: {}. One model of all of them holds only if the servo answers them alike.",
                differ.join("; ")
            ),
            differ.len() as f64,
            0.0,
            "Identify each kind alone, and compare them ('servoid compare'); strokes of several sizes serve a servo model ('--servo-model').",
        )
    })
}

/// What the runs are called: their files, where each file is one run.
fn names(record: &Record, facts: &[Vec<(String, String)>]) -> Vec<String> {
    let runs = record.runs().len();
    let file = |number: usize| {
        let facts = facts.get(number).filter(|_| facts.len() == runs)?;
        value(facts, "file").map(str::to_owned)
    };
    let name = |number: usize| file(number).unwrap_or_else(|| format!("run {}", number + 1));
    (0..runs).map(name).collect()
}

fn value<'f>(facts: &'f [(String, String)], key: &str) -> Option<&'f str> {
    let mut found = facts.iter().filter(|(name, _)| name == key);
    found.next().map(|(_, value)| value.as_str())
}

/// "strokes of 10 deg (a.csv) and 4 deg (b.csv)", where each run has strokes of one size, and these differ.
fn strokes(record: &Record, names: &[String], unit: Option<&str>) -> Option<String> {
    let alone = |run: &servoid_identification::Run| {
        let record = Record::new(record.sample_period_s(), vec![run.clone()]).ok()?;
        only_stroke(&record)
    };
    let sizes: Option<Vec<f64>> = record.runs().iter().map(alone).collect();
    let sizes = sizes?;
    let first = *sizes.first()?;
    let other = |size: &f64| (size - first).abs() > EQUALLY_LARGE * size.max(first);
    let at = sizes.iter().position(other)?;
    let unit = unit.map(|unit| format!(" {unit}")).unwrap_or_default();
    let shown = |number: usize| {
        let size = (1e3 * sizes.get(number)?).round() / 1e3;
        Some(format!("{size}{unit} ({})", names.get(number)?))
    };
    Some(format!("strokes of {} and {}", shown(0)?, shown(at)?))
}

/// "condition bench (a.csv) and aircraft (b.csv)", where two files state different ones.
fn stated(key: &str, facts: &[Vec<(String, String)>]) -> Option<String> {
    let mut all = facts
        .iter()
        .filter_map(|facts| Some((value(facts, key)?, value(facts, "file")?)));
    let (first, of_first) = all.next()?;
    let (other, of_other) = all.find(|(other, _)| *other != first)?;
    Some(format!(
        "{key} {first} ({of_first}) and {other} ({of_other})"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_identification::Run;

    fn facts(file: &str, condition: &str) -> Vec<(String, String)> {
        [("file", file), ("condition", condition)]
            .map(|(key, value)| (key.to_owned(), value.to_owned()))
            .to_vec()
    }

    fn record(sizes: [f64; 2]) -> Record<'static> {
        let run = |size: f64| {
            let input: Vec<f64> = (0..80).map(|k| size * f64::from(k / 20 % 2)).collect();
            Run::new(input.clone(), input).unwrap()
        };
        Record::new(0.01, sizes.map(run).to_vec()).unwrap()
    }

    #[test]
    fn what_differs_is_named() {
        let files = [facts("a.csv", "bench"), facts("b.csv", "aircraft")];
        let found = advice(&record([10.0, 4.0]), &files, Some("deg"))
            .unwrap()
            .finding;
        let differ = "strokes of 10 deg (a.csv) and 4 deg (b.csv); condition bench (a.csv) and aircraft (b.csv).";
        assert!(
            found.starts_with(&format!("The runs are not of one kind: {differ}")),
            "{found}"
        );
        let alike = [facts("a.csv", "bench"), facts("b.csv", "bench")];
        assert_eq!(advice(&record([10.0, 10.1]), &alike, None), None);
        let found = advice(&record([10.0, 4.0]), &[], None).unwrap().finding;
        assert!(found.contains("10 (run 1) and 4 (run 2)"), "{found}");
    }
}
