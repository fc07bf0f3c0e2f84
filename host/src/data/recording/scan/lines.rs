//! A file's lines.

/// A line, its line end included.
pub(super) struct Line<'a> {
    /// From 1.
    pub(super) number: usize,
    pub(super) bytes: &'a [u8],
}

/// The lines of a file that ends with a line end.
pub(super) struct Lines<'a> {
    body: &'a [u8],
    ends: memchr::Memchr<'a>,
    start: usize,
    number: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(body: &'a [u8]) -> Self {
        Self {
            body,
            ends: memchr::memchr_iter(b'\n', body),
            start: 0,
            number: 0,
        }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let end = self.ends.next()? + 1;
        let bytes = self.body.get(self.start..end)?;
        self.start = end;
        self.number += 1;
        Some(Line {
            number: self.number,
            bytes,
        })
    }
}
