//! Units of a record's two columns.

/// The units of a record's two columns, where they are known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Units<'a> {
    /// Of the command.
    pub input: Option<&'a str>,
    /// Of the measured position.
    pub output: Option<&'a str>,
}

/// Radians for each of a unit; `None` where that is no angle.
pub(crate) fn radians_of(unit: Option<&str>) -> Option<f64> {
    match unit? {
        "deg" => Some(1f64.to_radians()),
        "rad" => Some(1.0),
        _ => None,
    }
}

impl<'a> Units<'a> {
    /// One unit for both.
    pub fn common(self) -> Option<&'a str> {
        self.output.filter(|_| self.input == self.output)
    }

    /// "deg/us", the unit of a gain; `None` where it is 1, or not known.
    ///
    /// ```
    /// use servoid::data::Units;
    /// let units = |input, output| Units { input: Some(input), output: Some(output) };
    /// assert_eq!(units("us", "deg").gain().as_deref(), Some("deg/us"));
    /// assert_eq!(units("deg", "deg").gain(), None);
    /// ```
    pub fn gain(self) -> Option<String> {
        let (input, output) = (self.input?, self.output?);
        (input != output).then(|| format!("{output}/{input}"))
    }
}
