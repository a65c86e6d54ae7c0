//! The action mask of an observation, from a Python environment or a function.

use numpy::{PyArray1, PyArrayDescrMethods, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::answers::{named, shortened};
use crate::spec::{Fields, Variant};

/// The source of the masks.
pub(super) enum MaskSource {
    None,
    /// `info["action_mask"]`, Gymnasium's convention.
    Info,
    /// A function of the observation.
    Function(Py<PyAny>),
}

const MASK_SOURCES: &[Variant<MaskSource>] = &[
    ("none", |_| Ok(MaskSource::None)),
    ("info", |_| Ok(MaskSource::Info)),
    ("function", |fields| Ok(MaskSource::Function(fields.any("function")?.unbind()))),
];

impl MaskSource {
    pub(super) fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        fields.tagged(MASK_SOURCES)
    }

    pub(super) fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }

    /// Replaces `mask` by the mask of an observation, which `method` of the environment returned with `info`.
    pub(super) fn read(
        &self,
        (env, method): (&Bound<'_, PyAny>, &str),
        observation: &Bound<'_, PyAny>,
        info: &Bound<'_, PyAny>,
        mask: &mut [bool],
    ) -> PyResult<()> {
        let py = env.py();
        match self {
            Self::None => Ok(()),
            Self::Info => {
                let found = info.cast::<PyDict>()?.get_item(intern!(py, "action_mask"))?;
                let name = || format!("info['action_mask'] of {method} of {}", named(env));
                let Some(given) = found else {
                    return Err(PyValueError::new_err(format!(
                        "{} must be present for action_mask=True: return it in info, write a method \
                         action_masks(self), or give action_mask=f, a function of the observation",
                        name()
                    )));
                };
                parse(&given, mask, name)
            }
            Self::Function(function) => {
                let given = function.bind(py).call1((observation,))?;
                parse(&given, mask, || format!("action_mask({})", shortened(observation)))
            }
        }
    }
}

/// Reads a mask: an array of booleans, or of the integers 0 and 1, with an item for each action.
pub(super) fn parse(given: &Bound<'_, PyAny>, mask: &mut [bool], name: impl Fn() -> String) -> PyResult<()> {
    // Gymnasium's dtype and NumPy's for masks; others are converted.
    let read = if let Ok(array) = given.cast::<PyArray1<i8>>() {
        copy(array, mask, |item| bit(item.into()))
    } else if let Ok(array) = given.cast::<PyArray1<bool>>() {
        copy(array, mask, Some)
    } else {
        copy(&integers(given, mask.len(), &name)?, mask, bit)
    };
    match read {
        Err(Refused::Length) => Err(wrong_shape(given, mask.len(), &name)),
        Err(Refused::Value) => {
            Err(PyValueError::new_err(format!("{} must hold booleans, or 0 and 1, got {}", name(), shortened(given))))
        }
        Ok(()) if !mask.contains(&true) => {
            Err(PyValueError::new_err(format!("{} must leave at least one action, got {}", name(), shortened(given))))
        }
        Ok(()) => Ok(()),
    }
}

enum Refused {
    Length,
    Value,
}

fn copy<T: numpy::Element>(
    array: &Bound<'_, PyArray1<T>>,
    mask: &mut [bool],
    available: impl Fn(T) -> Option<bool>,
) -> Result<(), Refused> {
    if array.len() != mask.len() {
        return Err(Refused::Length);
    }
    for (index, action) in mask.iter_mut().enumerate() {
        *action = array.get_owned(index).and_then(&available).ok_or(Refused::Value)?;
    }
    Ok(())
}

fn bit(number: i64) -> Option<bool> {
    match number {
        0 => Some(false),
        1 => Some(true),
        _ => None,
    }
}

/// A mask of another type as integers.
fn integers<'py>(
    given: &Bound<'py, PyAny>,
    num_actions: usize,
    name: &impl Fn() -> String,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let py = given.py();
    let wrong_type = || {
        let got = given.get_type().name().map_or_else(|_| "another type".into(), |class| class.to_string());
        PyTypeError::new_err(format!(
            "{} must be an array of {num_actions} booleans, one for each action, got {got}: {}",
            name(),
            shortened(given)
        ))
    };
    let array = py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "asarray"), (given,));
    let array = array.map_err(|_| wrong_type())?.cast_into::<PyUntypedArray>()?;
    if !b"bui".contains(&array.dtype().kind()) {
        return Err(wrong_type());
    }
    if array.shape() != [num_actions] {
        return Err(wrong_shape(&array, num_actions, name));
    }
    Ok(array.call_method1(intern!(py, "astype"), (numpy::dtype::<i64>(py),))?.cast_into()?)
}

fn wrong_shape(given: &Bound<'_, PyAny>, num_actions: usize, name: &impl Fn() -> String) -> PyErr {
    match given.getattr(intern!(given.py(), "shape")) {
        Ok(shape) => PyValueError::new_err(format!(
            "{} must have shape ({num_actions},), with an item for each action, got {shape}",
            name()
        )),
        Err(error) => error,
    }
}
