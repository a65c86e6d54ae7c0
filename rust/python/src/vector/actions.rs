//! The actions of a vector step, one for each sub-environment. All are checked before any is taken.

use numpy::{PyArray1, PyArray2, PyArrayDescrMethods, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyAssertionError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;
use qtab_core::checkpoint::{Checkpoint, CheckpointError, Persist};
use qtab_core::numeric::Scalar;

use crate::convert::{LARGEST_FORCE, double, first_item, numbered_action, numpy_scalar, small_array};
use crate::error::invalid;

/// Up to this many items, reading one by one is faster than borrowing the array.
const READ_ONE_BY_ONE: usize = 8;

/// A type of actions that Python passes in batches.
pub(crate) trait BatchAction: Copy + Send + Sync + 'static {
    /// Placeholder for a sub-environment that takes no action.
    const NONE: Self;

    /// Reads one action for each item of `into`. The actions of `inactive` sub-environments may have any value.
    fn read(
        actions: &Bound<'_, PyAny>,
        num_actions: usize,
        inactive: &dyn Fn(usize) -> bool,
        into: &mut [Self],
    ) -> PyResult<()>;

    /// The action as Gymnasium's environments store it.
    fn to_python(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>>;

    /// Saves the action, or replaces it by the saved one.
    fn persist(&mut self, num_actions: usize, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError>;
}

/// Checks the length of a sequence that is not an array.
fn check_length(actions: &Bound<'_, PyAny>, shape: &str, expected: usize) -> PyResult<()> {
    match actions.len() {
        Ok(length) if length == expected => Ok(()),
        Ok(length) => Err(PyValueError::new_err(format!("actions must have shape {shape}, got {length} of them"))),
        Err(_) => {
            Err(PyTypeError::new_err(format!("actions must be an array of shape {shape}, got {}", actions.repr()?)))
        }
    }
}

impl BatchAction for usize {
    const NONE: Self = 0;

    fn read(
        actions: &Bound<'_, PyAny>,
        num_actions: usize,
        inactive: &dyn Fn(usize) -> bool,
        into: &mut [Self],
    ) -> PyResult<()> {
        read_numbered(actions, 0, num_actions, inactive, into)
    }

    fn to_python(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        small_array(py, &[self.cast_signed() as i64]).get_item(0)
    }

    fn persist(&mut self, num_actions: usize, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        checkpoint.index(self, num_actions, "action")
    }
}

/// Reads the number, from 0, of each discrete action. The actions begin at `first`.
pub(crate) fn read_numbered(
    actions: &Bound<'_, PyAny>,
    first: i64,
    num_actions: usize,
    inactive: &dyn Fn(usize) -> bool,
    into: &mut [usize],
) -> PyResult<()> {
    if let Ok(array) = actions.cast::<PyArray1<i64>>()
        && read_integers(array, first, num_actions, into)?
    {
        return Ok(());
    }
    if let Ok(array) = actions.cast::<PyUntypedArray>() {
        if array.shape() != [into.len()] {
            return Err(wrong_shape(array, &format!("({},)", into.len())));
        }
        if matches!(array.dtype().kind(), b'i' | b'u')
            && read_integers(actions.call_method1("astype", ("int64",))?.cast()?, first, num_actions, into)?
        {
            return Ok(());
        }
    }
    check_length(actions, &format!("({},)", into.len()), into.len())?;
    for (index, item) in into.iter_mut().enumerate() {
        let action = actions.get_item(index)?;
        *item = if inactive(index) {
            usize::NONE
        } else {
            numbered_action(&action, first, num_actions).ok_or_else(|| invalid_action(index, &action))?
        };
    }
    Ok(())
}

/// Reads the array, and returns whether its length fits and all its items are valid actions.
fn read_integers(
    actions: &Bound<'_, PyArray1<i64>>,
    first: i64,
    num_actions: usize,
    into: &mut [usize],
) -> PyResult<bool> {
    if actions.len() != into.len() {
        return Ok(false);
    }
    let last = num_actions.cast_signed() as i64 - 1;
    // Becomes negative if any number is below 0 or above the last one.
    let mut signs = 0;
    let mut put = |item: &mut usize, action: i64| {
        let number = action.wrapping_sub(first);
        *item = number as usize;
        signs |= number | last.wrapping_sub(number);
    };
    if into.len() <= READ_ONE_BY_ONE {
        for (index, item) in into.iter_mut().enumerate() {
            put(item, actions.get_owned(index).unwrap_or(i64::MIN));
        }
    } else {
        let view = actions.try_readonly()?;
        match view.as_slice() {
            // The usual case, which the compiler turns into SIMD code.
            Ok(items) => into.iter_mut().zip(items).for_each(|(item, &action)| put(item, action)),
            Err(_) => into.iter_mut().zip(view.as_array()).for_each(|(item, &action)| put(item, action)),
        }
    }
    Ok(signs >= 0)
}

/// Gymnasium's error for an invalid action, with the index of the sub-environment.
fn invalid_action(index: usize, action: &Bound<'_, PyAny>) -> PyErr {
    let text = |part: PyResult<Bound<'_, PyString>>| part.map_or_else(|_| "?".into(), |part| part.to_string());
    let (value, class) = (text(action.repr()), text(action.get_type().repr()));
    PyAssertionError::new_err(format!("sub-environment {index}: {value} ({class}) invalid"))
}

fn wrong_shape(array: &Bound<'_, PyUntypedArray>, shape: &str) -> PyErr {
    let found = array.getattr("shape").and_then(|found| Ok(found.repr()?.to_string())).unwrap_or_default();
    PyValueError::new_err(format!("actions must have shape {shape}, got {found}"))
}

impl BatchAction for Scalar {
    const NONE: Self = Self::Single(0.0);

    fn read(
        actions: &Bound<'_, PyAny>,
        _num_actions: usize,
        inactive: &dyn Fn(usize) -> bool,
        into: &mut [Self],
    ) -> PyResult<()> {
        let shape = format!("({}, 1)", into.len());
        if let Ok(array) = actions.cast::<PyUntypedArray>() {
            if array.shape() != [into.len(), 1] {
                return Err(wrong_shape(array, &shape));
            }
            read_array(array, into)?;
        } else {
            check_length(actions, &shape, into.len())?;
            for (index, item) in into.iter_mut().enumerate().filter(|(index, _)| !inactive(*index)) {
                *item = read_item(&actions.get_item(index)?, index)?;
            }
        }
        for (index, item) in into.iter_mut().enumerate() {
            let force = f64::from(*item);
            if force.is_nan() || force.abs() > LARGEST_FORCE {
                if !inactive(index) {
                    return Err(invalid(&format!("actions[{index}]"), "a finite number", force));
                }
                *item = Self::NONE;
            }
        }
        Ok(())
    }

    fn to_python(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        numpy_scalar(py, self)
    }

    fn persist(&mut self, _num_actions: usize, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        Persist::persist(self, checkpoint)
    }
}

/// Reads an array with as many rows as `into` has items, in the array's dtype.
fn read_array(actions: &Bound<'_, PyUntypedArray>, into: &mut [Scalar]) -> PyResult<()> {
    if let Ok(single) = actions.cast::<PyArray2<f32>>() {
        let view = single.try_readonly()?;
        into.iter_mut().zip(view.as_array()).for_each(|(item, &force)| *item = Scalar::Single(force));
        return Ok(());
    }
    let dtype = actions.dtype();
    if !matches!(dtype.kind(), b'i' | b'u') && actions.cast::<PyArray2<f64>>().is_err() {
        return Err(PyTypeError::new_err(format!("actions must have dtype float32 or float64, got {dtype}")));
    }
    // Integers are combined only with Python floats, so they are computed as doubles.
    let double = actions.call_method1("astype", ("float64",))?.cast_into::<PyArray2<f64>>()?;
    let view = double.try_readonly()?;
    into.iter_mut().zip(view.as_array()).for_each(|(item, &force)| *item = Scalar::Double(force));
    Ok(())
}

/// Reads an array of one number, or a sequence of one plain number.
fn read_item(row: &Bound<'_, PyAny>, index: usize) -> PyResult<Scalar> {
    let plain = || double(&row.get_item(0).ok()?).map(Scalar::Python);
    let force = if row.len().is_ok_and(|length| length == 1) { first_item(row).or_else(plain) } else { None };
    force.ok_or_else(|| PyTypeError::new_err(format!("actions[{index}] must hold one number, got {row}")))
}
