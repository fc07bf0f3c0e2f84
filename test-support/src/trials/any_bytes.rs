//! Any bytes as a recording, for the tests and for the fuzz target alike: they are read as a recording or
//! refused, and `recover` makes a recording of them.

use servoid::data::DegreeScale;
use servoid::data::recording::{Recording, RecordingTarget, RecordingWriter, recover};
use std::io::{Result, Write};
use std::path::Path;
use std::sync::{Arc, Mutex};

/// A target that keeps all bytes.
#[derive(Clone, Default)]
struct Memory(Arc<Mutex<Vec<u8>>>);

impl Write for Memory {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.0.lock().unwrap().extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

impl RecordingTarget for Memory {
    fn cut_to(&mut self, length: u64) -> Result<()> {
        self.0.lock().unwrap().truncate(length as usize);
        Ok(())
    }

    fn settle(&mut self) -> Result<()> {
        Ok(())
    }
}

/// Reads and recovers `bytes`, and checks the properties of every recording.
pub fn read_as_a_recording(bytes: &[u8]) {
    let path = Path::new("x.csv");
    if let Ok(recording) = Recording::parse(bytes, path) {
        assert!(recording.rows.is_sorted_by(|a, b| a.sample < b.sample));
        let rows = recording.rows_of(recording.reference_samples());
        let (input, output) = DegreeScale::of_recording(&recording.header).columns(rows);
        assert_eq!(input.len(), output.len());
    }
    let Ok(saved) = recover(bytes, path) else {
        return;
    };
    assert!(saved.frames.is_sorted_by(|a, b| a.index < b.index));
    assert!(saved.rows() > 0);
    let memory = Memory::default();
    // A scale from the file may have no form that reads back; then nothing is written.
    let target = Box::new(memory.clone());
    let Ok(writer) = RecordingWriter::on(target, path, &saved.header) else {
        return;
    };
    saved.write(writer).expect("memory takes all");
    let bytes = memory.0.lock().unwrap();
    let again = Recording::parse(&bytes, path).expect("what is saved reads well");
    assert_eq!(again.rows.len(), saved.rows());
}
