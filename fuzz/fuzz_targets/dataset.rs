//! Any bytes as a file of data, of any kind: they are refused, or give a valid record.
#![no_main]

use libfuzzer_sys::fuzz_target;
use servoid::data::dataset::{self, DatasetOptions, TimeUnit};
use std::path::PathBuf;
use std::sync::LazyLock;

/// One file for each process: reading begins with a name.
static FILE: LazyLock<PathBuf> =
    LazyLock::new(|| std::env::temp_dir().join(format!("servoid-fuzz-{}.csv", std::process::id())));

/// Options of a user; the first byte of the input chooses.
fn options(choice: u8) -> DatasetOptions {
    let has = |bit: u8| choice >> bit & 1 == 1;
    DatasetOptions {
        input: has(0).then(|| "u".into()),
        output: has(0).then(|| "y".into()),
        period_s: has(1).then_some(0.02),
        time: has(7).then(|| "t".into()),
        time_unit: has(6).then_some(TimeUnit::Milliseconds),
        run: has(2).then(|| "run".into()),
        at_rest: has(3).then_some(0.0),
        with_rest: has(4),
        // Both are options of times: the bits are enough for one. So it is with the two of what is taken as it stands.
        polled: has(7),
        exact_command: has(4),
        controller: None,
    }
}

fuzz_target!(|bytes: &[u8]| {
    let Some((choice, bytes)) = bytes.split_first() else { return };
    std::fs::write(&*FILE, bytes).expect("there is room");
    let mut files = vec![FILE.clone()];
    if choice >> 5 & 1 == 1 {
        let second = FILE.with_extension("again.csv");
        std::fs::write(&second, bytes).expect("there is room");
        files.push(second);
    }
    let Ok(data) = dataset::load(&files, &options(*choice)) else { return };
    let record = &data.record;
    assert!(record.sample_period_s().is_finite() && record.sample_period_s() > 0.0);
    let runs = record.runs();
    assert_eq!(runs.iter().map(|run| run.len()).sum::<usize>(), record.samples());
    for run in runs {
        assert_eq!(run.input().len(), run.output().len());
        let both = run.input().iter().chain(run.output());
        assert!(both.clone().all(|x| x.is_finite() || x.is_nan()));
    }
    // Gaps are filled with missing rows, never with more than the file can contain.
    assert!(record.samples() - record.missing() <= bytes.len() * files.len());
});
