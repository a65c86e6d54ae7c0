//! What a vector step takes: an action for each sub-environment, all of them looked at before any is taken.

use numpy::{PyArray1, PyArray2, PyArrayDescrMethods, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyAssertionError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;
use qtab_core::numeric::Scalar;

use crate::numbers::{LARGEST_FORCE, double, first, index, numpy_scalar};

/// So few are sooner asked for one by one than borrowed.
const FEW: usize = 8;

/// An action as a type of the core's.
pub(super) trait Acts: Copy + Send + Sync + 'static {
    /// For whom no action is needed.
    const NONE: Self;

    /// Reads an action for each place; the `idle` ones may be anything.
    fn read(actions: &Bound<'_, PyAny>, count: usize, idle: &dyn Fn(usize) -> bool, into: &mut [Self]) -> PyResult<()>;

    /// As a sub-environment of Gymnasium's remembers it.
    fn remembered(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>>;
}

/// For what is no array.
fn sized(actions: &Bound<'_, PyAny>, shape: &str, places: usize) -> PyResult<()> {
    match actions.len() {
        Ok(length) if length == places => Ok(()),
        Ok(length) => Err(PyValueError::new_err(format!("actions must have shape {shape}, got {length} of them"))),
        Err(_) => {
            Err(PyTypeError::new_err(format!("actions must be an array of shape {shape}, got {}", actions.repr()?)))
        }
    }
}

impl Acts for usize {
    const NONE: Self = 0;

    fn read(actions: &Bound<'_, PyAny>, count: usize, idle: &dyn Fn(usize) -> bool, into: &mut [Self]) -> PyResult<()> {
        if let Ok(array) = actions.cast::<PyArray1<i64>>()
            && whole(array, count, into)?
        {
            return Ok(());
        }
        if let Ok(array) = actions.cast::<PyUntypedArray>() {
            if array.shape() != [into.len()] {
                return Err(wrong_shape(array, &format!("({},)", into.len())));
            }
            if matches!(array.dtype().kind(), b'i' | b'u')
                && whole(actions.call_method1("astype", ("int64",))?.cast()?, count, into)?
            {
                return Ok(());
            }
        }
        sized(actions, &format!("({},)", into.len()), into.len())?;
        for (lane, place) in into.iter_mut().enumerate() {
            let action = actions.get_item(lane)?;
            *place =
                if idle(lane) { Self::NONE } else { index(&action, count).ok_or_else(|| invalid(lane, &action))? };
        }
        Ok(())
    }

    fn remembered(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        PyArray1::from_slice(py, &[self.cast_signed() as i64]).get_item(0)
    }
}

/// Whether there are as many as places, and all of them are actions; if so, they are read.
fn whole(actions: &Bound<'_, PyArray1<i64>>, count: usize, into: &mut [usize]) -> PyResult<bool> {
    if actions.len() != into.len() {
        return Ok(false);
    }
    // Negative ones become the largest.
    let mut fit = true;
    let mut put = |place: &mut usize, action: i64| {
        *place = action as usize;
        fit &= *place < count;
    };
    if into.len() <= FEW {
        for (lane, place) in into.iter_mut().enumerate() {
            put(place, actions.get_owned(lane).unwrap_or(-1));
        }
    } else {
        let view = actions.try_readonly()?;
        into.iter_mut().zip(view.as_array()).for_each(|(place, &action)| put(place, action));
    }
    Ok(fit)
}

/// Gymnasium's own words, and whose action it is.
fn invalid(lane: usize, action: &Bound<'_, PyAny>) -> PyErr {
    let text = |part: PyResult<Bound<'_, PyString>>| part.map_or_else(|_| "?".into(), |part| part.to_string());
    let (value, class) = (text(action.repr()), text(action.get_type().repr()));
    PyAssertionError::new_err(format!("sub-environment {lane}: {value} ({class}) invalid"))
}

fn wrong_shape(array: &Bound<'_, PyUntypedArray>, shape: &str) -> PyErr {
    let found = array.getattr("shape").and_then(|found| Ok(found.repr()?.to_string())).unwrap_or_default();
    PyValueError::new_err(format!("actions must have shape {shape}, got {found}"))
}

impl Acts for Scalar {
    const NONE: Self = Self::Single(0.0);

    fn read(
        actions: &Bound<'_, PyAny>,
        _count: usize,
        idle: &dyn Fn(usize) -> bool,
        into: &mut [Self],
    ) -> PyResult<()> {
        let shape = format!("({}, 1)", into.len());
        if let Ok(array) = actions.cast::<PyUntypedArray>() {
            if array.shape() != [into.len(), 1] {
                return Err(wrong_shape(array, &shape));
            }
            if let Ok(single) = actions.cast::<PyArray2<f32>>() {
                let view = single.try_readonly()?;
                into.iter_mut().zip(view.as_array()).for_each(|(place, &force)| *place = Self::Single(force));
            } else {
                let kind = array.dtype().kind();
                if kind != b'i' && kind != b'u' && actions.cast::<PyArray2<f64>>().is_err() {
                    let found = array.dtype();
                    return Err(PyTypeError::new_err(format!(
                        "actions must have dtype float32 or float64, got {found}"
                    )));
                }
                // Integers meet floats alone, so they compute as doubles.
                let double = actions.call_method1("astype", ("float64",))?.cast_into::<PyArray2<f64>>()?;
                let view = double.try_readonly()?;
                into.iter_mut().zip(view.as_array()).for_each(|(place, &force)| *place = Self::Double(force));
            }
        } else {
            sized(actions, &shape, into.len())?;
            for (lane, place) in into.iter_mut().enumerate().filter(|(lane, _)| !idle(*lane)) {
                let row = actions.get_item(lane)?;
                let plain = || double(&row.get_item(0).ok()?).map(Self::Python);
                let force = if row.len().is_ok_and(|length| length == 1) { first(&row).or_else(plain) } else { None };
                *place = force
                    .ok_or_else(|| PyTypeError::new_err(format!("actions[{lane}] must hold one number, got {row}")))?;
            }
        }
        for (lane, place) in into.iter_mut().enumerate() {
            let force = f64::from(*place);
            if force.is_nan() || force.abs() > LARGEST_FORCE {
                if !idle(lane) {
                    return Err(PyValueError::new_err(format!("actions[{lane}] must be a finite number, got {force}")));
                }
                *place = Self::NONE;
            }
        }
        Ok(())
    }

    fn remembered(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        numpy_scalar(py, self)
    }
}
