//! Texts with gaps: `{{name}}` stands for a value.

/// Puts the values into the gaps of a text, each once and none into another. A gap without a value
/// stays empty.
pub(crate) fn fill<V: AsRef<str>>(text: &str, values: &[(&str, V)]) -> String {
    let mut filled = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("{{") {
        let Some((name, after)) = after.split_once("}}") else {
            break;
        };
        filled.push_str(before);
        let value = values.iter().find(|(key, _)| *key == name);
        filled.push_str(value.map_or("", |(_, value)| value.as_ref()));
        rest = after;
    }
    filled + rest
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_value_is_not_filled_in_again() {
        let text = super::fill("{{a}} and {{b}}{{c}}", &[("a", "{{b}}"), ("b", "2")]);
        assert_eq!(text, "{{b}} and 2");
    }
}
