//! Small readers for untyped JSON.

use serde_json::Value;

/// A non-negative integer. Accepts `12.0` and `1.2e1`, which some exporters write.
pub(crate) fn index(value: &Value) -> Option<usize> {
    if let Some(integer) = value.as_u64() {
        return usize::try_from(integer).ok();
    }
    // Above 2^53 not every integer is a double: such a number was not meant as an index.
    let number = value.as_f64()?;
    (number.fract() == 0.0 && (0.0..9.0e15).contains(&number)).then_some(number as usize)
}

/// A property that is an array; empty if it is absent or something else.
pub(crate) fn array<'a>(object: &'a Value, key: &str) -> &'a [Value] {
    object.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

/// An array of numbers; `None` if it is anything else.
pub(crate) fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(Value::as_f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn indices_are_whole_numbers_only() {
        assert_eq!(index(&json!(7)), Some(7));
        assert_eq!(index(&serde_json::from_str("7.0").unwrap()), Some(7));
        for text in ["-1", "0.5", "1e300", "1e999", "\"1\"", "null", "18446744073709551616"] {
            assert_eq!(index(&serde_json::from_str(text).unwrap()), None, "{text}");
        }
    }
}
