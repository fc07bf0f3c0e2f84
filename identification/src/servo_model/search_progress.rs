//! The caller's view of a search while it goes on.

/// Sees how far a search is, and may end it.
pub trait Watch: Sync {
    /// A set of terms was tried: how many have been, and the best fit of parts that were not seen \[%\].
    fn tried(&self, sets_of_terms: usize, best_held_out_percent: f64);

    /// Whether the search has to end. It is asked every few milliseconds.
    fn ends(&self) -> bool;
}

/// Nobody watches.
impl Watch for () {
    fn tried(&self, _: usize, _: f64) {}

    fn ends(&self) -> bool {
        false
    }
}
