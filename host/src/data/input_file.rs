//! Files that come in, whole.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Most bytes that are read: hours of rows. Without an end to it, a device such as `/dev/zero` would take all of the
/// memory, and so would a file that is mostly a hole.
const MOST: u64 = 1 << 28;

/// Reads all of a file, or of a pipe; fails with [`ErrorKind::FileTooLarge`] for what is longer than 256 MiB, or does
/// not end.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    read_at_most(File::open(path)?, MOST)
}

fn read_at_most(stream: impl Read, most: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    stream.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(Error::new(
            ErrorKind::FileTooLarge,
            "it is longer than 256 MiB, or does not end; give a long recording as several files",
        ));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_is_read_up_to_its_end_and_refused_without_one() {
        assert_eq!(read_at_most(&[7; 1000][..], 1000).unwrap(), [7; 1000]);
        let error = read_at_most(std::io::repeat(0), 1000).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::FileTooLarge);
    }
}
