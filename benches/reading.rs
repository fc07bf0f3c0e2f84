//! Reading files: at least 150 MB/s, so that a million rows are identified in well under half a
//! second.

use std::fmt::Write as _;
use std::hint::black_box;
use std::path::{Path, PathBuf};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use servoid::data::dataset::{self, DatasetOptions};
use servoid::data::recording::{Ending, Header, Recording, RecordingWriter};
use servoid_identification::{Options, identify};
use servoid_protocol::{Counts, Frame, PulseWidth};

/// The longest recording that the wire can number.
const FRAMES: u16 = u16::MAX;

/// Rows of the file of another program.
const ROWS: u32 = 1_000_000;

/// A recording of this program, of a servo that follows its reference with a lag.
fn own_recording(path: &Path) {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let header = Header {
        neutral_us: 1500,
        us_per_degree: 10.0,
        zero_counts: 8190.0,
        degrees_per_count: 0.009_157,
        ..Header::default()
    };
    let mut writer = RecordingWriter::create(path, true, &header).expect("a free place");
    let mut position = 8190.0;
    for index in 0..FRAMES {
        let pulse = if random.random::<bool>() { 1450 } else { 1550 };
        let samples = std::array::from_fn(|_| {
            position += 0.06 * (8190.0 + 10.92 * (f64::from(pulse) - 1500.0) - position);
            Counts((position + 4.0 * random.random::<f64>()) as u16)
        });
        let frame = Frame {
            run: 1,
            index,
            pulse: PulseWidth(pulse),
            samples,
        };
        writer.append(&frame).expect("room on the disk");
    }
    writer.finish(&Ending::Complete).expect("room on the disk");
}

/// How another program writes its cells.
#[derive(Clone, Copy)]
enum Style {
    /// 0.002,5.0
    Plain,
    /// "0.002","5.0"
    Quoted,
    /// 0,002;5,0
    DecimalComma,
}

impl Style {
    /// What is written with points and commas, in this style.
    fn of(self, row: &str) -> String {
        match self {
            Self::Plain => row.to_owned(),
            Self::Quoted => format!("\"{}\"", row.replace(',', "\",\"")),
            Self::DecimalComma => row.replace(',', ";").replace('.', ","),
        }
    }
}

/// A file of another program with a column of time and one that is not needed.
fn foreign_file(path: &Path, style: Style) {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let mut text = style.of("t,u,y,temperature") + "\n";
    let (mut u, mut y) = (0.0, 0.0);
    for k in 0..ROWS {
        if k % 10 == 0 {
            u = if random.random::<bool>() { 5.0 } else { -5.0 };
        }
        y += 0.06 * (u - y);
        let measured = y + 0.1 * (random.random::<f64>() - 0.5);
        let t = 0.002 * f64::from(k);
        let row = format!("{t:.3},{u:.1},{measured:.5},21.5");
        let _infallible = writeln!(text, "{}", style.of(&row));
    }
    std::fs::write(path, text).expect("room on the disk");
}

fn named() -> DatasetOptions {
    DatasetOptions {
        input: Some("u".to_owned()),
        output: Some("y".to_owned()),
        period_s: Some(0.002),
        ..DatasetOptions::default()
    }
}

fn benches(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder for files");
    let [own, foreign, quoted, commas] =
        ["own.csv", "u.csv", "quoted.csv", "commas.csv"].map(|name| folder.path().join(name));
    own_recording(&own);
    foreign_file(&foreign, Style::Plain);
    foreign_file(&quoted, Style::Quoted);
    foreign_file(&commas, Style::DecimalComma);
    let bytes = |path: &PathBuf| std::fs::metadata(path).expect("it was written").len();

    let mut group = criterion.benchmark_group("reading is at least 150 MB/s");
    group.sample_size(10);
    group.throughput(Throughput::Bytes(bytes(&own)));
    let text = std::fs::read(&own).expect("it was written");
    group.bench_function("recording of this program, 655 350 rows", |bencher| {
        bencher.iter(|| Recording::parse(black_box(&text), &own).expect("it is sound"));
    });
    for (name, path) in [
        ("columns of another program's file, 1e6 rows", &foreign),
        ("the same in quotes", &quoted),
        ("the same with decimal commas", &commas),
    ] {
        group.throughput(Throughput::Bytes(bytes(path)));
        group.bench_function(name, |bencher| {
            let paths = [path.clone()];
            bencher.iter(|| dataset::load(black_box(&paths), &named()).expect("it is sound"));
        });
    }
    group.finish();

    let mut group = criterion.benchmark_group("a file is identified in well under 0.5 s");
    group.sample_size(10);
    for (name, path, options) in [
        ("655 350 rows, its own", own, DatasetOptions::default()),
        ("1e6 rows, another's", foreign, named()),
    ] {
        let paths = [path];
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let data = dataset::load(black_box(&paths), &options).expect("it is sound");
                identify(&data.record, &Options::default()).expect("it is excited")
            });
        });
    }
    group.finish();
}

criterion_group!(reading, benches);
criterion_main!(reading);
