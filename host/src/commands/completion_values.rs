//! Values that shells suggest for options that take other values too.

use crate::instrument::reference::Kind;
use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use clap::error::Error;
use clap::{Arg, Command};
use std::ffi::OsStr;

/// A parser with words that completions offer. Options that use it hide their possible values, because other
/// values are allowed.
#[derive(Clone)]
pub(super) struct Suggesting<P> {
    parser: P,
    words: &'static [&'static str],
}

impl<P: TypedValueParser> TypedValueParser for Suggesting<P> {
    type Value = P::Value;

    fn parse_ref(
        &self,
        command: &Command,
        option: Option<&Arg>,
        value: &OsStr,
    ) -> Result<Self::Value, Error> {
        self.parser.parse_ref(command, option, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.words.iter().map(PossibleValue::new)))
    }
}

fn suggesting<P: TypedValueParser>(parser: P, words: &'static [&'static str]) -> Suggesting<P> {
    Suggesting { parser, words }
}

/// Ports of rigs.
pub(super) fn port() -> impl TypedValueParser<Value = String> {
    let words = &[
        "sim:bench",
        "sim:aircraft",
        "sim:linear",
        "tcp:",
        "/dev/ttyUSB0",
        "/dev/ttyACM0",
    ];
    suggesting(StringValueParser::new(), words)
}

/// Simulated servos.
pub(super) fn simulated_servo() -> impl TypedValueParser<Value = String> {
    suggesting(StringValueParser::new(), &["bench", "aircraft", "linear"])
}

/// Kinds of references.
pub(super) fn reference() -> impl TypedValueParser<Value = Kind> {
    let parser = StringValueParser::new().try_map(|text| text.parse::<Kind>());
    suggesting(
        parser,
        &["staircase", "stairs", "prbs", "sweep", "multisine"],
    )
}

/// Conditions of a measurement.
pub(super) fn condition() -> impl TypedValueParser<Value = String> {
    suggesting(StringValueParser::new(), &["bench", "aircraft"])
}
