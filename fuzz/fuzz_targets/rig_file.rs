//! Any text as a rig file: an accepted one gives valid scales and limits.
#![no_main]

use libfuzzer_sys::fuzz_target;
use servoid::data::rig_file::RigFile;
use servoid_protocol::{Counts, Degrees};
use std::path::Path;

fuzz_target!(|text: &str| {
    if let Ok(rig) = RigFile::parse(text, Path::new("rig.toml")) {
        let _ = rig.servo_scale().pulse(Degrees(5.0));
        assert!(rig.sensor_scale().degrees(Counts(8_000)).0.is_finite());
        let [lowest, highest] = rig.sensor.healthy_counts;
        assert!(lowest < highest);
    }
});
