//! Conversions of requests and responses, in addition to `serde_json`.

use serde::Serialize;
use serde_json::Value;

/// A response as JSON, with null for numbers that are not finite.
pub(crate) fn written(response: &impl Serialize) -> String {
    serde_json::to_string(response).unwrap_or_default()
}

/// A number without a fraction, from 0 to `most`.
pub(crate) fn integer(value: &Value, most: u32) -> Option<u32> {
    value.as_u64().and_then(|integer| u32::try_from(integer).ok()).filter(|integer| *integer <= most)
}

/// Finite numbers; `None` if the value is not an array of finite numbers.
pub(crate) fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(Value::as_f64).collect()
}

/// A value, shortened for messages.
pub(crate) fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => format!("'{}'", text.chars().take(40).collect::<String>()),
        Value::Array(values) => format!("an array of {}", values.len()),
        Value::Object(_) => "an object".into(),
        simple => simple.to_string(),
    }
}
