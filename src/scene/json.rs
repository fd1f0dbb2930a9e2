//! Typed access to the document's JSON: indices, numbers and arrays, each failure with its pointer.

use super::SceneError;
use serde_json::Value;

/// The array under `key`; a missing one is empty.
pub(crate) fn array<'a>(parent: &'a Value, key: &str, pointer: &str) -> Result<&'a [Value], SceneError> {
    match parent.get(key) {
        None => Ok(&[]),
        Some(Value::Array(values)) => Ok(values),
        Some(_) => Err(malformed(format!("{pointer}/{key}"), "an array")),
    }
}

/// A number that is a non-negative integer. Integral floats (`3.0`) count: exporters write them.
pub(crate) fn index(value: &Value, pointer: impl FnOnce() -> String) -> Result<usize, SceneError> {
    if let Some(index) = value.as_u64() {
        return usize::try_from(index).map_err(|_| malformed(pointer(), "an index"));
    }
    match value.as_f64() {
        // 2^53: up to here every integer has its own f64.
        Some(float) if float.fract() == 0.0 && (0.0..9.0e15).contains(&float) => Ok(float as usize),
        _ => Err(malformed(pointer(), "a non-negative integer")),
    }
}

/// The index under `key`, checked against the `count` entries of top-level `array`; `None` if missing.
pub(crate) fn optional_index(
    parent: &Value,
    key: &str,
    array: &'static str,
    count: usize,
    pointer: &str,
) -> Result<Option<usize>, SceneError> {
    let Some(value) = parent.get(key) else { return Ok(None) };
    let place = || format!("{pointer}/{key}");
    let index = index(value, place)?;
    if index >= count {
        return Err(SceneError::IndexOutOfRange { pointer: place(), index, array, count });
    }
    Ok(Some(index))
}

/// `N` numbers under `key`; `None` if missing. A number beyond the range of f64 is read as NaN, which the
/// callers treat as they treat any other non-finite transform.
pub(crate) fn numbers<const N: usize>(
    parent: &Value,
    key: &str,
    pointer: &str,
    expected: &'static str,
) -> Result<Option<[f64; N]>, SceneError> {
    let Some(value) = parent.get(key) else { return Ok(None) };
    let error = || malformed(format!("{pointer}/{key}"), expected);
    let values = value.as_array().filter(|values| values.len() == N).ok_or_else(error)?;
    let mut numbers = [0.0; N];
    for (number, value) in numbers.iter_mut().zip(values) {
        if !value.is_number() {
            return Err(error());
        }
        *number = value.as_f64().unwrap_or(f64::NAN);
    }
    Ok(Some(numbers))
}

/// The number under `key`, or `default` where it is missing or not a finite number.
pub(crate) fn number_or(parent: &Value, key: &str, default: f64) -> f64 {
    parent.get(key).and_then(Value::as_f64).filter(|number| number.is_finite()).unwrap_or(default)
}

/// `extensions.<name>` of a glTF object.
pub(crate) fn extension<'a>(parent: &'a Value, name: &str) -> Option<&'a Value> {
    parent.get("extensions")?.get(name)
}

pub(crate) fn malformed(pointer: String, expected: &'static str) -> SceneError {
    SceneError::Malformed { pointer, expected }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn integral_floats_are_indices_and_others_are_not() {
        let place = || "/x".to_owned();
        assert_eq!(index(&json!(3), place).unwrap(), 3);
        assert_eq!(index(&json!(3.0), place).unwrap(), 3);
        for bad in [json!(-1), json!(0.5), json!("1"), json!(null), json!(1e300), json!([1])] {
            assert!(matches!(index(&bad, place), Err(SceneError::Malformed { .. })), "{bad}");
        }
    }

    #[test]
    fn numbers_outside_f64_become_nan() {
        let value: Value = serde_json::from_str(r#"{"a": [1, 1e999, -2.5]}"#).unwrap();
        let [a, b, c] = numbers::<3>(&value, "a", "", "three numbers").unwrap().unwrap();
        assert_eq!((a, c), (1.0, -2.5));
        assert!(!b.is_finite());
        assert!(numbers::<2>(&value, "a", "", "two numbers").is_err());
    }
}
