//! The time that the library takes to identify a recording, for `identify.py` beside it: milliseconds, one a line.

use servoid::data::dataset::{DatasetOptions, load};
use servoid_identification::{Options, identify};
use std::hint::black_box;
use std::time::Instant;

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().unwrap_or_default();
    let times: usize = arguments.next().unwrap_or_default().parse()?;
    let data = load(&[file.into()], &DatasetOptions::default())?;
    for _ in 0..times {
        let began = Instant::now();
        black_box(identify(&data.record, &Options::default())?);
        println!("{}", 1e3 * began.elapsed().as_secs_f64());
    }
    Ok(())
}
