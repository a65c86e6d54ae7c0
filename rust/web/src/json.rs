//! What requests and responses hold beside the types of `serde_json`.

use serde::Serialize;
use serde_json::Value;

/// A response as JSON, in which numbers that are not finite are null.
pub(crate) fn written(response: &impl Serialize) -> String {
    serde_json::to_string(response).unwrap_or_default()
}

/// A number without a fraction, from 0 to `most`.
pub(crate) fn integer(value: &Value, most: u32) -> Option<u32> {
    value.as_u64().and_then(|integer| u32::try_from(integer).ok()).filter(|integer| *integer <= most)
}

/// Finite numbers; `None` if the value is anything else than an array of them.
pub(crate) fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(Value::as_f64).collect()
}

/// A value as a message shows it, shortened.
pub(crate) fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => format!("'{}'", text.chars().take(40).collect::<String>()),
        Value::Array(values) => format!("an array of {}", values.len()),
        Value::Object(_) => "an object".into(),
        simple => simple.to_string(),
    }
}
