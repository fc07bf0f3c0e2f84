//! What files say of themselves.

use crate::data::units::Units;
use servoid_identification::results::{Advice, Check};

/// What files say of themselves.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// Whether all files are recordings of servoid, whose command changes with the pulse frame only.
    pub by_servoid: bool,
    /// The unit of what was commanded, where the files say it and agree.
    pub input_unit: Option<String>,
    /// The unit of what was measured, where the files say it and agree.
    pub output_unit: Option<String>,
    /// Under what condition it was recorded, where the files say it and agree.
    pub condition: Option<String>,
    /// Where the data come from, file by file: name and value of each thing that is known.
    pub provenance: Vec<Vec<(String, String)>>,
    /// What a user should know about the files: partial recordings, guessed periods.
    pub remarks: Vec<String>,
    /// What every result from these files has to carry: that a recording is partial, or values of
    /// its header unproved.
    pub advice: Vec<Advice>,
}

impl About {
    /// The unit of the input of both, empty where they do not have one in common.
    #[must_use]
    pub fn input_unit_with(&self, other: &Self) -> String {
        in_common(self.input_unit.as_ref(), other.input_unit.as_ref())
    }

    /// The unit of the output of both, empty where they do not have one in common.
    #[must_use]
    pub fn output_unit_with(&self, other: &Self) -> String {
        in_common(self.output_unit.as_ref(), other.output_unit.as_ref())
    }

    /// The units of the two columns.
    #[must_use]
    pub fn units(&self) -> Units<'_> {
        Units {
            input: self.input_unit.as_deref(),
            output: self.output_unit.as_deref(),
        }
    }

    pub(super) fn merge(&mut self, other: Self) {
        let agree = |mine: &mut Option<String>, theirs: Option<String>| {
            if *mine != theirs {
                *mine = None;
            }
        };
        self.by_servoid &= other.by_servoid;
        agree(&mut self.input_unit, other.input_unit);
        agree(&mut self.output_unit, other.output_unit);
        agree(&mut self.condition, other.condition);
        self.provenance.extend(other.provenance);
        self.remarks.extend(other.remarks);
        self.advice.extend(other.advice);
    }

    /// Adds a remark that every result carries too, as advice that `value` is there where `threshold` was meant.
    pub(super) fn add(
        &mut self,
        check: Check,
        remark: String,
        [value, threshold]: [f64; 2],
        remedy: &str,
    ) {
        let finding = format!("{remark}.");
        self.advice
            .push(Advice::new(check, finding, value, threshold, remedy));
        self.remarks.push(remark);
    }
}

fn in_common(a: Option<&String>, b: Option<&String>) -> String {
    a.filter(|unit| b == Some(unit))
        .cloned()
        .unwrap_or_default()
}
