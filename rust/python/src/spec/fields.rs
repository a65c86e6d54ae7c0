//! Typed access to the dicts of a spec. Errors name the field by its path, such as `policy.epsilon.value`.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use qtab_core::settings::SettingSource;

use crate::error::{invalid, required};

/// A tag of a tagged dict, and the parser for the fields beside it.
pub(crate) type Variant<T> = (&'static str, fn(&Fields<'_>) -> PyResult<T>);

/// A dict of a spec, and its path in the spec.
pub(crate) struct Fields<'py> {
    dict: Bound<'py, PyDict>,
    path: String,
}

impl<'py> Fields<'py> {
    /// The outermost dict.
    pub(crate) fn new(spec: &Bound<'py, PyAny>) -> PyResult<Self> {
        Self::at(spec, String::new())
    }

    fn at(value: &Bound<'py, PyAny>, path: String) -> PyResult<Self> {
        if let Ok(dict) = value.cast::<PyDict>() {
            return Ok(Self { dict: dict.clone(), path });
        }
        let name = if path.is_empty() { "spec" } else { &path };
        Err(PyTypeError::new_err(format!("{name} must be a dict, got {}", value.repr()?)))
    }

    /// The name of this dict in messages.
    pub(crate) fn name(&self) -> &str {
        if self.path.is_empty() { "spec" } else { &self.path }
    }

    /// The path of a field.
    pub(crate) fn path(&self, name: &str) -> String {
        if self.path.is_empty() { name.into() } else { format!("{}.{name}", self.path) }
    }

    /// A field, whatever its type.
    pub(crate) fn any(&self, name: &str) -> PyResult<Bound<'py, PyAny>> {
        self.dict.get_item(name)?.ok_or_else(|| required(&self.path(name)))
    }

    /// A field that is not None.
    fn given(&self, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let value = self.any(name)?;
        if value.is_none() { Err(required(&self.path(name))) } else { Ok(value) }
    }

    /// A field of type `T`.
    pub(crate) fn get<T>(&self, name: &str) -> PyResult<T>
    where
        T: for<'a> FromPyObject<'a, 'py, Error: Into<PyErr>>,
    {
        let value = self.any(name)?;
        value.extract::<T>().map_err(|error| {
            let (py, error): (_, PyErr) = (value.py(), error.into());
            PyErr::from_type(error.get_type(py), format!("{}: {}", self.path(name), error.value(py)))
        })
    }

    /// A field that is a dict itself.
    pub(crate) fn nested(&self, name: &str) -> PyResult<Self> {
        Self::at(&self.any(name)?, self.path(name))
    }

    /// Parses a tagged dict by the variant that its field `type` names.
    pub(crate) fn tagged<T>(&self, variants: &[Variant<T>]) -> PyResult<T> {
        self.word("type", variants)?(self)
    }
}

impl SettingSource for Fields<'_> {
    type Error = PyErr;

    fn has(&self, name: &str) -> bool {
        self.dict.contains(name).unwrap_or(false)
    }

    fn any_number(&self, name: &'static str) -> PyResult<Option<f64>> {
        self.given(name).map(|value| value.extract().ok())
    }

    fn any_integer(&self, name: &'static str) -> PyResult<Option<u64>> {
        self.given(name).map(|value| value.extract().ok())
    }

    fn any_flag(&self, name: &'static str) -> PyResult<Option<bool>> {
        self.given(name).map(|value| value.extract().ok())
    }

    fn any_text(&self, name: &'static str) -> PyResult<Option<String>> {
        self.given(name).map(|value| value.extract().ok())
    }

    fn invalid(&self, name: &'static str, expected: &str) -> PyErr {
        let got =
            self.any(name).and_then(|value| value.repr()).map_or_else(|_| "nothing".into(), |got| got.to_string());
        invalid(&self.path(name), expected, got)
    }
}
