//! Names of runs that are texts: they get numbers in their order.

/// Texts that a remark names.
const MOST_NAMED: usize = 6;

/// The number of the run that each row is in, from 1, and a remark on which is which.
pub(super) fn of_texts(column: &str, texts: &[String]) -> (Vec<f64>, String) {
    let mut names: Vec<&String> = Vec::new();
    let mut place = |text| {
        let known = names.iter().rposition(|name| *name == text);
        let place = known.unwrap_or(names.len());
        if known.is_none() {
            names.push(text);
        }
        (place + 1) as f64
    };
    let labels = texts.iter().map(&mut place).collect();
    let mut named: Vec<String> = (1..)
        .zip(&names)
        .take(MOST_NAMED)
        .map(|(number, name)| format!("{number} is {name:?}"))
        .collect();
    if names.len() > MOST_NAMED {
        named.push(format!("and so on up to {}", names.len()));
    }
    let remark = format!(
        "column {column:?} names runs by texts, which get numbers in their order: {}",
        named.join(", ")
    );
    (labels, remark)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_get_numbers_in_their_order() {
        let texts = ["T0", "T0", "T1", "T0"].map(str::to_owned);
        let (labels, remark) = of_texts("trial", &texts);
        assert_eq!(labels, [1.0, 1.0, 2.0, 1.0]);
        assert!(
            remark.ends_with("in their order: 1 is \"T0\", 2 is \"T1\""),
            "{remark}"
        );
    }
}
