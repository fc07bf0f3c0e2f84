//! Any bytes as a CSV file: columns of one length, of finite numbers or missing ones.
#![no_main]

use libfuzzer_sys::fuzz_target;
use servoid::data::table::Table;

fuzz_target!(|bytes: &[u8]| {
    let Ok(table) = Table::parse(bytes.to_vec()) else { return };
    let names = table.columns().to_vec();
    if let [first, .., last] = names.as_slice()
        && let Ok(columns) = table.numbers(&[first, last])
        && let [a, b] = columns.as_slice()
    {
        assert_eq!(a.len(), b.len());
        assert!(a.iter().chain(b).all(|x| x.is_finite() || x.is_nan()));
    }
});
