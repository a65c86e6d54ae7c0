//! The base of the Gymnasium-facing classes: state and constants in Rust, everything else Gymnasium's.

use numpy::PyArray1;
use pyo3::exceptions::PyAttributeError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyInt, PyTuple, PyType};
use qtab_core::env::{Env, Step};
use qtab_core::random::Draw;

use crate::model::Model;

/// Holds an environment's state and constants, and steps it.
///
/// A Python class inherits from this and from Gymnasium's class, names its `model`, and gives every constant a
/// property that reads and writes here. Constants that f64 cannot stand for with Gymnasium's meaning (a float32 one
/// promotes differently) are kept as they are, and such an environment steps in Python, through Gymnasium's own code.
#[pyclass(subclass, module = "qtab._core")]
pub(crate) struct Physics {
    model: Model,
    state: State,
    /// The constants that Rust does not compute with, under their names; None until there are any.
    foreign: Option<Py<PyDict>>,
}

/// Where the environment stands.
enum State {
    /// Before the first reset.
    Nowhere,
    /// What Python assigned, the array of a reset too: the object itself, whose types and later changes count.
    Assigned(Py<PyAny>),
    /// After a step in Rust.
    Stepped([f64; 2]),
}

impl State {
    /// What Rust can step from; None leaves the step to Python.
    fn doubles(&self, py: Python<'_>) -> PyResult<Option<[f64; 2]>> {
        let assigned = match self {
            Self::Nowhere => return Ok(None),
            Self::Stepped(state) => return Ok(Some(*state)),
            Self::Assigned(assigned) => assigned.bind(py),
        };
        let Ok(numbers) = assigned.try_iter() else { return Ok(None) };
        let numbers = numbers.map(|number| double(&number?)).collect::<PyResult<Option<Vec<f64>>>>()?;
        Ok(numbers.and_then(|numbers| numbers.try_into().ok()))
    }
}

/// For steps that draw nothing.
struct NoDraw;

impl Draw for NoDraw {
    fn random(&mut self) -> f64 {
        0.0
    }
    fn integers(&mut self, _below: u32) -> u32 {
        0
    }
}

#[pymethods]
impl Physics {
    #[new]
    #[classmethod]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(
        class: &Bound<'_, PyType>,
        _args: &Bound<'_, PyTuple>,
        _kwargs: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let model = Model::new(class.getattr(intern!(class.py(), "model"))?.extract()?)?;
        Ok(Self { model, state: State::Nowhere, foreign: None })
    }

    /// One step, with the types that Gymnasium returns.
    fn step<'py>(slf: &Bound<'py, Self>, action: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let (model, state) = {
            let this = slf.borrow();
            (this.model, if this.foreign.is_none() { this.state.doubles(py)? } else { None })
        };
        let Some(state) = state else {
            return slf.call_method1(intern!(py, "step_in_python"), (action,));
        };
        let Model::MountainCar(env) = model;
        let action = index(slf, action, env.actions())?;
        let Step { state, reward, terminated } = env.step(state.into(), action, &mut NoDraw);
        slf.borrow_mut().state = State::Stepped(state.into());
        let render_mode = slf.getattr(intern!(py, "render_mode"))?;
        if !render_mode.is_none() && render_mode.eq(intern!(py, "human"))? {
            slf.call_method0(intern!(py, "render"))?;
        }
        let observation = PyArray1::from_slice(py, &env.observe(&state));
        Ok((observation, reward, terminated, false, PyDict::new(py)).into_pyobject(py)?.into_any())
    }

    /// The state as Gymnasium keeps it, a tuple of `np.float64` after a step; None before the first reset.
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.state {
            State::Nowhere => Ok(py.None().into_bound(py)),
            State::Assigned(state) => Ok(state.bind(py).clone()),
            State::Stepped(state) => py.get_type::<PyTuple>().call1((PyArray1::from_slice(py, state),)),
        }
    }

    #[setter]
    fn set_state(&mut self, value: &Bound<'_, PyAny>) {
        self.state = if value.is_none() { State::Nowhere } else { State::Assigned(value.clone().unbind()) };
    }

    /// One of the model's constants.
    fn parameter<'py>(&mut self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        match self.foreign_value(py, name)? {
            Some(value) => Ok(value),
            None => Ok(PyFloat::new(py, *self.model.parameter(name)?).into_any()),
        }
    }

    fn set_parameter(&mut self, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let parameter = self.model.parameter(name)?;
        let number = double(value)?;
        if let Some(number) = number {
            *parameter = number;
        }
        self.keep(name, value, number.is_none())
    }
}

impl Physics {
    fn foreign_value<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.foreign.as_ref().map_or(Ok(None), |foreign| foreign.bind(py).get_item(name))
    }

    /// Keeps a foreign value, or forgets the one of that name.
    fn keep(&mut self, name: &str, value: &Bound<'_, PyAny>, foreign: bool) -> PyResult<()> {
        let py = value.py();
        if foreign {
            return self.foreign.get_or_insert_with(|| PyDict::new(py).unbind()).bind(py).set_item(name, value);
        }
        if let Some(kept) = &self.foreign {
            let kept = kept.bind(py);
            if kept.contains(name)? {
                kept.del_item(name)?;
            }
            if kept.is_empty() {
                self.foreign = None;
            }
        }
        Ok(())
    }
}

/// The f64 that Python computes with. None for a number of another width, whose arithmetic rounds differently, and for
/// one that is not finite, of which Python's functions make errors and `NumPy`'s comparisons something of their own.
fn double(number: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    if number.is_instance_of::<PyFloat>() || number.is_instance_of::<PyInt>() {
        return Ok(Some(number.extract()?).filter(|number: &f64| number.is_finite()));
    }
    Ok(None)
}

/// The action as an index; what is no plain integer in range is left to Gymnasium's judgement.
fn index(slf: &Bound<'_, Physics>, action: &Bound<'_, PyAny>, actions: usize) -> PyResult<usize> {
    if action.is_instance_of::<PyInt>()
        && let Ok(index) = action.extract::<usize>()
        && index < actions
    {
        return Ok(index);
    }
    slf.call_method1(intern!(slf.py(), "checked_action"), (action,))?
        .extract()
        .map_err(|_| PyAttributeError::new_err("action"))
}
