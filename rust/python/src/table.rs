//! From Gymnasium's `P` to the table in Rust, checked on the way.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use qtab_core::Env;
use qtab_core::envs::tabular::{Outcome, TabularMdp};

use crate::numbers::double;

/// `P[state][action]` lists (probability, state, reward, terminated); `start` is `initial_state_distrib`.
fn compile(table: &Bound<'_, PyAny>, start: &[f64], exact: bool) -> PyResult<TabularMdp> {
    let shape = |_| PyTypeError::new_err("P must hold for each state and action a list of outcomes");
    let states = table.len().map_err(shape)?;
    if states != start.len() {
        let message =
            format!("initial_state_distrib must hold {states} numbers, one for each state, got {}", start.len());
        return Err(PyValueError::new_err(message));
    }
    let mut rows = Vec::new();
    let mut actions = 0;
    for state in 0..states {
        let missing =
            |_| PyValueError::new_err(format!("P must have the states 0 to {}, it lacks {state}", states - 1));
        let row = table.get_item(state).map_err(missing)?;
        let count = row.len().map_err(shape)?;
        if state == 0 {
            actions = count;
        }
        if count != actions {
            let message = format!("P[{state}] must have {actions} actions as P[0] has, got {count}");
            return Err(PyValueError::new_err(message));
        }
        for action in 0..actions {
            let place = || format!("P[{state}][{action}]");
            let lacks = |_| {
                PyValueError::new_err(format!(
                    "P[{state}] must have the actions 0 to {}, it lacks {action}",
                    actions - 1
                ))
            };
            let listed = row.get_item(action).map_err(lacks)?;
            // What has no length may be gone once it was looked at.
            let listed = listed.len().and_then(|_| listed.try_iter());
            let listed = listed.map_err(|_| PyTypeError::new_err(format!("{} must be a list of outcomes", place())))?;
            rows.push(
                listed
                    .enumerate()
                    .map(|(index, entry)| outcome(place, index, &entry?, exact))
                    .collect::<PyResult<_>>()?,
            );
        }
    }
    TabularMdp::new(actions, start, &rows).map_err(|bad| PyValueError::new_err(bad.to_string()))
}

fn outcome(place: impl Fn() -> String, index: usize, entry: &Bound<'_, PyAny>, exact: bool) -> PyResult<Outcome> {
    if exact && entry.get_item(0).is_ok_and(|probability| double(&probability).is_none()) {
        return Err(PyTypeError::new_err(format!("{}[{index}] must have a float for a probability", place())));
    }
    match entry.extract() {
        Ok((probability, state, reward, terminated)) => Ok(Outcome { probability, state, reward, terminated }),
        Err(_) => Err(PyTypeError::new_err(format!(
            "{}[{index}] must be (probability, state, reward, terminated), got {}",
            place(),
            entry.repr()?
        ))),
    }
}

/// A table in Rust, checked.
#[pyclass(frozen, module = "qtab._core")]
pub(crate) struct Transitions(pub(crate) TabularMdp);

#[pymethods]
impl Transitions {
    /// With `exact` it refuses probabilities that `NumPy` would not add as Python's floats.
    #[new]
    fn new(table: &Bound<'_, PyAny>, start: Vec<f64>, exact: bool) -> PyResult<Self> {
        compile(table, &start, exact).map(Self)
    }

    #[getter]
    fn states(&self) -> usize {
        self.0.states()
    }

    #[getter]
    fn actions(&self) -> usize {
        self.0.num_actions()
    }
}
