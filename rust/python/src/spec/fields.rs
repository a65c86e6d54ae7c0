//! Typed access to the dicts of a spec. Errors name the field by its path, such as `policy.epsilon.value`.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{invalid, required};

/// What a tag stands for: its word, and how the fields beside it are parsed.
pub(crate) type Variant<T> = (&'static str, fn(&Fields<'_>) -> PyResult<T>);

/// A dict of a spec, and where it is in the spec.
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

    /// What a message calls this dict.
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

    /// A field that holds one of these words: what the word stands for.
    pub(crate) fn word<T: Copy>(&self, name: &str, words: &[(&str, T)]) -> PyResult<T> {
        let given = self.any(name)?;
        let found = given.extract::<&str>().ok().and_then(|given| words.iter().find(|(word, _)| *word == given));
        match found {
            Some(&(_, value)) => Ok(value),
            None => Err(invalid(&self.path(name), one_of(words.iter().map(|(word, _)| *word)), given.repr()?)),
        }
    }

    /// Parses a tagged dict by the variant that its field `type` names.
    pub(crate) fn tagged<T>(&self, variants: &[Variant<T>]) -> PyResult<T> {
        self.word("type", variants)?(self)
    }
}

fn one_of<'a>(words: impl Iterator<Item = &'a str>) -> String {
    words.map(|word| format!("'{word}'")).collect::<Vec<_>>().join(" or ")
}
