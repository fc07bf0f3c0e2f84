//! Fingerprints of runs: a CRC-32 of the samples, whatever file they are in and however that is written.

use servoid_identification::results::{Advice, Check};
use servoid_identification::{Record, Run};
use std::collections::HashSet;

/// Samples whose bytes are gathered at a time: the table of the CRC takes sixteen bytes at once, and one
/// sample has eight.
const GATHERED: usize = 512;

/// The fingerprint of a run: the CRC-32 of its inputs and outputs, eight bytes each, the lowest first.
fn of_run(run: &Run) -> String {
    let mut digest = crc32fast::Hasher::new();
    let mut bytes = [[0; 8]; GATHERED];
    for column in [run.input(), run.output()] {
        for values in column.chunks(GATHERED) {
            for (bytes, value) in bytes.iter_mut().zip(values) {
                // One NaN is as missing as another, and 0 is -0.
                let value = if value.is_nan() {
                    f64::NAN
                } else {
                    value + 0.0
                };
                *bytes = value.to_le_bytes();
            }
            let filled = bytes.get(..values.len()).unwrap_or_default();
            digest.update(filled.as_flattened());
        }
    }
    format!("{:08x}", digest.finalize())
}

/// The fingerprints of all runs of a record.
///
/// ```
/// use servoid::fingerprint;
/// use servoid_identification::Record;
/// let record = Record::from_slices(0.002, &[1.0, 2.0], &[3.0, 4.0])?;
/// assert_eq!(fingerprint::of(&record), fingerprint::of(&record.clone()));
/// # Ok::<(), servoid_identification::Error>(())
/// ```
#[must_use]
pub fn of(record: &Record) -> Vec<String> {
    record.runs().iter().map(of_run).collect()
}

/// How many of `these` are among `those`.
fn shared(these: &[String], those: &[String]) -> usize {
    these.iter().filter(|one| those.contains(one)).count()
}

/// Advice where the two sides of a comparison share runs.
#[must_use]
pub fn advice_on_sides(a: &[String], b: &[String]) -> Option<Advice> {
    let count = shared(b, a);
    (count > 0).then(|| {
        Advice::new(
            Check::SameData,
            format!(
                "Both sides have the same samples{}, so the comparison shows nothing about the servo.",
                match b.len() - count {
                    0 => String::new(),
                    _ => format!(" in {count} of the second's {}", runs(b.len())),
                }
            ),
            count as f64,
            0.0,
            "Record the second condition by itself, and name that file.",
        )
    })
}

/// Advice where a model is validated on runs that it was identified from.
#[must_use]
pub fn advice_on_validation(model: &[String], record: &[String]) -> Option<Advice> {
    let count = shared(record, model);
    (count > 0).then(|| {
        Advice::new(
            Check::SameData,
            format!(
                "The model was identified from these very samples{}: it fits what it has seen, and how well it \
                 predicts anything else is not known.",
                match record.len() - count {
                    0 => String::new(),
                    _ => format!(" ({count} of {})", runs(record.len())),
                }
            ),
            count as f64,
            0.0,
            "Validate with a recording that the model has not seen.",
        )
    })
}

/// Advice where a record has a run twice.
#[must_use]
pub fn advice_on_repeats(record: &Record) -> Option<Advice> {
    if record.runs().len() < 2 {
        return None; // Nothing to repeat, and no reason to read all samples again.
    }
    let all = of(record);
    let different: HashSet<&String> = all.iter().collect();
    let count = all.len() - different.len();
    (count > 0).then(|| {
        Advice::new(
            Check::SameData,
            format!(
                "{} of {} repeat the samples of another one: a run that counts twice makes bounds narrower than they are.",
                runs(count),
                runs(all.len())
            ),
            count as f64,
            0.0,
            "Name each run once, under whatever name it is kept.",
        )
    })
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

    fn record(runs: &[[f64; 3]]) -> Record {
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
}
