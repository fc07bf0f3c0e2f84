//! Texts with gaps: `{{name}}` stands for what is put in.

/// Puts the values into the gaps of a text, each once and none into another. A gap without a value
/// stays empty.
///
/// ```
/// let text = servoid::template::fill("{{a}} and {{b}}", &[("a", "{{b}}"), ("b", "2")]);
/// assert_eq!(text, "{{b}} and 2");
/// ```
#[must_use]
pub fn fill<V: AsRef<str>>(text: &str, values: &[(&str, V)]) -> String {
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
