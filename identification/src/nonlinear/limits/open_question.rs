//! A question that a recording leaves open.

/// What a recording does not determine, and what to record instead.
pub(super) struct OpenQuestion {
    /// What is not determined, without a full stop.
    pub(super) finding: String,
    /// What to record, as a sentence.
    pub(super) remedy: String,
}

impl OpenQuestion {
    /// Both in one sentence, as all findings are.
    pub(super) fn statement(&self) -> String {
        let mut letters = self.remedy.chars();
        let first = letters.next().into_iter().flat_map(char::to_lowercase);
        let remedy: String = first.chain(letters).collect();
        format!("{}: {remedy}", self.finding)
    }
}
