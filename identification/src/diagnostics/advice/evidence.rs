//! The evidence behind the findings on a model.

use crate::diagnostics::explanation::Explanation;
use crate::options::Options;
use crate::results::{Model, Reason};

/// What advice is drawn from.
pub(crate) struct Evidence<'a> {
    /// The model, with the bounds that it has as long as nothing speaks against them.
    pub(crate) model: &'a Model,
    /// Why these bounds do not hold, if they do not.
    pub(crate) withdrawn: Option<Reason>,
    pub(crate) explanation: &'a Explanation,
    pub(crate) options: &'a Options,
    /// Samples of the record, missing ones included.
    pub(crate) samples: usize,
}
