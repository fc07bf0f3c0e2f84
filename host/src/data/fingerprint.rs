//! Fingerprints of runs: a CRC-32 of the samples, whatever file they are in and however that is written.

use servoid_identification::results::{Advice, Check};
use servoid_identification::{Record, Run};
use std::collections::{HashMap, HashSet};

/// Samples whose bytes are gathered for one step of the CRC, so that those of a long run are not in memory twice.
const GATHERED: usize = 512;

/// The fingerprint of a run: the CRC-32 of its inputs and outputs, eight bytes each, the lowest first.
fn of_run(run: &Run) -> String {
    let mut digest = crc32fast::Hasher::new();
    let mut bytes = Vec::new();
    for values in [run.input(), run.output()]
        .into_iter()
        .flat_map(|column| column.chunks(GATHERED))
    {
        bytes.clear();
        for value in values {
            // One NaN is as missing as another, and 0 is -0.
            let value = if value.is_nan() {
                f64::NAN
            } else {
                value + 0.0
            };
            bytes.extend_from_slice(&value.to_le_bytes());
        }
        digest.update(&bytes);
    }
    format!("{:08x}", digest.finalize())
}

/// The fingerprints of all runs of a record.
pub fn of(record: &Record) -> Vec<String> {
    record.runs().iter().map(of_run).collect()
}

/// How many of `these` are among `those`.
fn shared(these: &[String], those: &[String]) -> usize {
    these.iter().filter(|one| those.contains(one)).count()
}

/// Advice that `count` runs are there twice, if any are.
fn advice(count: usize, finding: String, remedy: &str) -> Option<Advice> {
    (count > 0).then(|| Advice::new(Check::SameData, finding, count as f64, 0.0, remedy))
}

/// Advice where the two sides of a comparison share runs.
pub fn advice_on_sides(a: &[String], b: &[String]) -> Option<Advice> {
    let count = shared(b, a);
    let part = match b.len() - count {
        0 => String::new(),
        _ => format!(" in {count} of the second's {}", runs(b.len())),
    };
    let finding = format!(
        "Both sides have the same samples{part}, so the comparison shows nothing about the servo."
    );
    let remedy = "Record the second condition by itself, and name that file.";
    advice(count, finding, remedy)
}

/// Samples in a row that no two recordings have in common by chance, if their output has so many values: noise and clock differ.
const IN_A_ROW: usize = 128;
const VALUES: usize = 32;

/// Advice where a part of one side is in the other.
pub fn advice_on_overlap(a: &Record, b: &Record) -> Option<Advice> {
    let mut parts: HashMap<u64, Vec<&[f64]>> = HashMap::new();
    let all = (a.runs().iter()).flat_map(|run| run.output().chunks_exact(IN_A_ROW));
    for part in all.filter(|part| is_distinct(part)) {
        parts.entry(first_bits(part)).or_default().push(part);
    }
    let is_shared = |part: &&[f64]| {
        let alike = parts.get(&first_bits(part));
        alike.is_some_and(|alike| alike.contains(part))
    };
    let of_run = |run: &Run| run.output().windows(IN_A_ROW).filter(is_shared).count() * IN_A_ROW;
    let count: usize = b.runs().iter().map(of_run).sum();
    let finding = format!(
        "Both sides have at least {count} of the second's {} samples in common, so as far as these go the comparison shows nothing about \
         the servo.",
        b.samples()
    );
    let remedy = "Record the second condition by itself, and name that file.";
    advice(count, finding, remedy)
}

/// Whether outputs are all there and of many values.
fn is_distinct(part: &[f64]) -> bool {
    let values: HashSet<u64> = part.iter().map(|value| bits(*value)).collect();
    values.len() >= VALUES && part.iter().all(|value| value.is_finite())
}

fn first_bits(part: &[f64]) -> u64 {
    part.first().map_or(0, |value| bits(*value))
}

/// Both zeros are one.
fn bits(value: f64) -> u64 {
    (value + 0.0).to_bits()
}

/// Advice where a model is validated on runs that it was identified from.
pub fn advice_on_validation(model: &[String], record: &[String]) -> Option<Advice> {
    let count = shared(record, model);
    let part = match record.len() - count {
        0 => String::new(),
        _ => format!(" ({count} of {})", runs(record.len())),
    };
    let finding = format!(
        "The model was identified from these very samples{part}: it fits what it has seen, and how well it predicts anything else is not known."
    );
    let remedy = "Validate with a recording that the model has not seen.";
    advice(count, finding, remedy)
}

/// Advice where a record has a run twice.
pub fn advice_on_repeats(record: &Record) -> Option<Advice> {
    if record.runs().len() < 2 {
        return None; // Nothing to repeat, and no reason to read all samples again.
    }
    let all = of(record);
    let different: HashSet<&String> = all.iter().collect();
    let count = all.len() - different.len();
    let finding = format!(
        "{} of {} repeat the samples of another one: a run that counts twice makes bounds narrower than they are.",
        runs(count),
        runs(all.len())
    );
    let remedy = "Name each run once, under whatever name it is kept.";
    advice(count, finding, remedy)
}

fn runs(count: usize) -> String {
    match count {
        1 => "1 run".to_owned(),
        many => format!("{many} runs"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(runs: &[[f64; 3]]) -> Record<'static> {
        let run = |output: &[f64; 3]| Run::new(vec![1.0, 2.0, 3.0], output.to_vec()).unwrap();
        Record::new(0.002, runs.iter().map(run).collect()).unwrap()
    }

    #[test]
    fn the_same_samples_are_known_again_and_others_are_not() {
        let (one, other) = ([1.0, f64::NAN, 0.0], [1.0, f64::NAN, 1e-9]);
        let a = of(&record(&[one]));
        let b = of(&record(&[other, [1.0, -f64::NAN, -0.0]]));
        assert_eq!(b[1], a[0]);
        assert_ne!(b[0], a[0]);
        let advice = advice_on_sides(&a, &b).unwrap();
        assert!(advice.finding.contains("in 1 of the second's 2 runs"));
        assert_eq!(advice_on_sides(&a, &b[..1]), None);
        assert!(advice_on_validation(&a, &b).is_some());
        assert!(advice_on_repeats(&record(&[one, other])).is_none());
        assert!(advice_on_repeats(&record(&[one, other, one])).is_some());
    }

    #[test]
    fn a_part_that_both_sides_have_is_known_and_a_likeness_is_not() {
        let whole: Vec<f64> = (0..600).map(|k| (f64::from(k) * 0.7).sin()).collect();
        let record = |output: &[f64]| {
            let input: Vec<f64> = (0..output.len()).map(|k| (k % 7) as f64).collect();
            Record::of_run(0.01, input, output.to_vec()).unwrap()
        };
        let found = advice_on_overlap(&record(&whole), &record(&whole[250..])).unwrap();
        assert_eq!(found.value, 256.0);
        let near: Vec<f64> = whole.iter().map(|y| y + 1e-12).collect();
        assert_eq!(advice_on_overlap(&record(&whole), &record(&near)), None);
        // Few steps of a sensor repeat themselves.
        let coarse: Vec<f64> = whole.iter().map(|y| (5.0 * y).round()).collect();
        assert_eq!(
            advice_on_overlap(&record(&coarse), &record(&coarse[9..])),
            None
        );
    }
}
