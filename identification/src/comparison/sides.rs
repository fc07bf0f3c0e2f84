//! What there is of each of the two sides.

use crate::results::Reason;
use serde::{Deserialize, Serialize};

/// One item for each side.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Sides<T> {
    /// The first side.
    pub a: T,
    /// The second side.
    pub b: T,
}

impl<T> Sides<T> {
    pub(super) fn of<S: Copy>([a, b]: [S; 2], of: impl Fn(S) -> T) -> Self {
        Self { a: of(a), b: of(b) }
    }
}

impl<T> Sides<Option<T>> {
    /// Whether neither side has it.
    pub(super) fn have_none(&self) -> bool {
        self.a.is_none() && self.b.is_none()
    }
}

impl Sides<Option<Reason>> {
    /// "for A the errors are not noise", of the sides by their `names`; `None` where neither has a reason.
    #[must_use]
    pub fn in_words(&self, [a, b]: [&str; 2]) -> Option<String> {
        let of = |name: &str, reason: Reason| format!("for {name} {}", reason.because());
        match (self.a, self.b) {
            (Some(of_a), Some(of_b)) if of_a == of_b => Some(of("both", of_a)),
            (of_a, of_b) => {
                let all = [of_a.map(|of_a| of(a, of_a)), of_b.map(|of_b| of(b, of_b))];
                let all: Vec<String> = all.into_iter().flatten().collect();
                (!all.is_empty()).then(|| all.join(", and "))
            }
        }
    }
}
