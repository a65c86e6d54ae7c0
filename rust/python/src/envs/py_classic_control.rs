//! `ClassicControl`: the base of the Gymnasium-facing classes of classic control. The step runs in Rust; everything
//! else is Gymnasium's.

use std::mem::replace;
use std::sync::{Arc, Mutex, MutexGuard};

use pyo3::exceptions::PyAttributeError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};

use super::classic_control::{DynClassicEnv, StepResult, StoredState, numpy_uses_libm};
use super::gymnasium::{generator, is_numpy_generator, render_if_human};
use super::registry::{Entry, classic_control, entry};
use crate::convert::{StateArray, array_from};
use crate::locks::lock;

/// The names of an environment's parameters, as Gymnasium spells its attributes.
#[pyfunction]
pub(crate) fn parameter_names(name: &str) -> PyResult<Vec<&'static str>> {
    Ok(classic_control(name)?.parameter_names())
}

/// Whether an environment in Rust, its reset included, computes the same numbers as Gymnasium on this machine.
#[pyfunction]
pub(crate) fn matches_numpy(py: Python<'_>, name: &str) -> PyResult<bool> {
    match entry(name)? {
        Entry::ClassicControl(new) => new().matches_numpy(py),
        Entry::FromGymnasium(_) => Ok(true),
    }
}

/// Holds an environment's state, and steps it.
///
/// A Python class inherits from this class and from Gymnasium's, and names its `model`. The parameters stay in
/// Gymnasium's attributes of the instance or the class. They are read at the first step after a reset and after any
/// assignment. Steps that Rust does not support (with a float32 state where Gymnasium's is float64, or a parameter of
/// another width) run in Gymnasium's own code, and so do steps that overflow.
///
/// Several threads may use an environment at once, with or without the GIL: steps then overwrite each other's state, as
/// in Gymnasium, but a thread that only reads changes nothing. While the mutex is locked, Python is never called and no
/// object is dropped.
#[pyclass(subclass, frozen, name = "ClassicControl", module = "qtab._core")]
pub(crate) struct PyClassicControl(Mutex<Contents>);

struct Contents {
    env: Arc<dyn DynClassicEnv>,
    parameters: Parameters,
    /// The number of attribute assignments so far. Parameters read before the last one are out of date.
    assignments: u64,
    state: StoredState,
}

/// The parameters as last read from the attributes.
#[derive(Clone, Copy)]
enum Parameters {
    /// Read before the last assignment, or never.
    Stale,
    /// Rust supports all of them.
    Loaded {
        /// Whether `render_mode` is "human".
        human: bool,
    },
    /// Rust does not support all of them.
    Unsupported,
}

#[pymethods]
impl PyClassicControl {
    #[new]
    #[classmethod]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(
        class: &Bound<'_, PyType>,
        _args: &Bound<'_, PyTuple>,
        _kwargs: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let model: String = class.getattr(intern!(class.py(), "model"))?.extract()?;
        let env = classic_control(&model)?;
        let (parameters, state) = (Parameters::Stale, StoredState::Unset);
        Ok(Self(Mutex::new(Contents { env, parameters, assignments: 0, state })))
    }

    /// Draws the initial state from the environment's generator. Returns the result of `reset`; or None, drawing
    /// nothing, if Gymnasium's own code must do it.
    fn native_reset<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let py = slf.py();
        let (generator, env) = (generator(slf)?, Arc::clone(&slf.get().lock().env));
        let layout = env.layout();
        if !is_numpy_generator(&generator) || (layout.calls_numpy_trigonometry && !numpy_uses_libm(py)?) {
            return Ok(None);
        }
        let Some(result) = env.py_reset(&generator)? else { return Ok(None) };
        // Bypasses `__setattr__`, since no parameter changes.
        let attributes = slf.getattr(intern!(py, "__dict__"))?.cast_into::<PyDict>()?;
        for name in layout.terminal_counter.iter().chain(&layout.last_action) {
            attributes.set_item(name, py.None())?;
        }
        slf.get().store(StoredState::Python(result.state.unbind()));
        slf.get().invalidate();
        render_if_human(slf)?;
        Ok(Some((result.observation, PyDict::new(py)).into_pyobject(py)?.into_any()))
    }

    /// One step, with Gymnasium's return types.
    fn step<'py>(slf: &Bound<'py, Self>, action: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let Some((result, human)) = Self::native_step(slf, action)? else {
            return slf.call_method1(intern!(py, "step_in_python"), (action,));
        };
        slf.get().store(result.state);
        if human {
            slf.call_method0(intern!(py, "render"))?;
        }
        let answer = (result.observation, result.reward, result.terminated, false, PyDict::new(py));
        Ok(answer.into_pyobject(py)?.into_any())
    }

    /// Must be called after any attribute was assigned.
    fn invalidate(&self) {
        let mut contents = self.lock();
        contents.parameters = Parameters::Stale;
        contents.assignments += 1;
    }

    /// The state, in Gymnasium's type.
    #[getter]
    fn state<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let (stored, layout) = {
            let contents = slf.get().lock();
            (contents.state.clone_ref(py), contents.env.layout())
        };
        let numbers = match stored {
            StoredState::Python(state) => return Ok(state.into_bound(py)),
            StoredState::Native(numbers) => numbers,
            StoredState::Unset => {
                let class = slf.get_type();
                return Err(PyAttributeError::new_err(format!("'{}' object has no attribute 'state'", class.name()?)));
            }
        };
        let mut state = array_from(py, &numbers[..layout.state_len])?.into_any();
        if layout.state_is_tuple {
            state = PyTuple::new(py, state.try_iter()?.collect::<PyResult<Vec<_>>>()?)?.into_any();
        }
        // Unless another thread has taken a step in the meantime, which must not be undone.
        let mut contents = slf.get().lock();
        if matches!(&contents.state, StoredState::Native(now) if now.map(f64::to_bits) == numbers.map(f64::to_bits)) {
            contents.state = StoredState::Python(state.clone().unbind());
        }
        Ok(state)
    }

    #[setter]
    fn set_state(&self, value: &Bound<'_, PyAny>) {
        self.store(StoredState::Python(value.clone().unbind()));
    }
}

impl PyClassicControl {
    fn lock(&self) -> MutexGuard<'_, Contents> {
        lock(&self.0)
    }

    fn store(&self, state: StoredState) {
        let before = replace(&mut self.lock().state, state);
        // Dropping an array of a subclass may run Python code.
        drop(before);
    }

    /// The step, and whether `render_mode` is "human"; None if Gymnasium's own code must take the step.
    fn native_step<'py>(
        slf: &Bound<'py, Self>,
        action: &Bound<'py, PyAny>,
    ) -> PyResult<Option<(StepResult<'py>, bool)>> {
        let py = slf.py();
        let (mut env, parameters, stored) = {
            let contents = slf.get().lock();
            (Arc::clone(&contents.env), contents.parameters, contents.state.clone_ref(py))
        };
        let human = match parameters {
            Parameters::Loaded { human } => human,
            Parameters::Unsupported => return Ok(None),
            Parameters::Stale => {
                let Some(loaded) = Self::load_parameters(slf)? else { return Ok(None) };
                env = loaded.0;
                loaded.1
            }
        };
        let state = match stored {
            StoredState::Native(numbers) => Some(StateArray::new(numbers)),
            StoredState::Python(state) => StateArray::read(state.bind(py), env.layout().state_len),
            StoredState::Unset => None,
        };
        let Some(state) = state else { return Ok(None) };
        Ok(env.py_step(slf, &state, action)?.map(|result| (result, human)))
    }

    /// Reads the attributes. Returns the environment with these parameters, and whether `render_mode` is "human"; None
    /// if Rust does not support all of them.
    fn load_parameters(slf: &Bound<'_, Self>) -> PyResult<Option<(Arc<dyn DynClassicEnv>, bool)>> {
        let (env, assignments) = {
            let contents = slf.get().lock();
            (Arc::clone(&contents.env), contents.assignments)
        };
        let loaded = Self::supported(slf, &*env)?;
        let mut contents = slf.get().lock();
        // Otherwise an attribute changed during the reading, and the next step reads them again.
        if contents.assignments == assignments {
            contents.parameters = Parameters::Unsupported;
            if let Some((env, human)) = &loaded {
                contents.env = Arc::clone(env);
                contents.parameters = Parameters::Loaded { human: *human };
            }
        }
        Ok(loaded)
    }

    /// The environment with its parameters, and whether `render_mode` is "human"; None if Rust cannot step it.
    fn supported(slf: &Bound<'_, Self>, env: &dyn DynClassicEnv) -> PyResult<Option<(Arc<dyn DynClassicEnv>, bool)>> {
        let py = slf.py();
        let layout = env.layout();
        if layout.calls_numpy_trigonometry && !numpy_uses_libm(py)? {
            return Ok(None);
        }
        if let Some(name) = layout.terminal_counter
            && !slf.getattr_opt(name)?.is_some_and(|value| value.is_none())
        {
            return Ok(None);
        }
        if let Some(num_actions) = layout.num_actions {
            let Some(space) = slf.getattr_opt(intern!(py, "action_space"))? else { return Ok(None) };
            let [n, start] = [space.getattr_opt(intern!(py, "n"))?, space.getattr_opt(intern!(py, "start"))?];
            let (Some(n), Some(start)) = (n, start) else { return Ok(None) };
            if !n.eq(num_actions)? || !start.eq(0)? {
                return Ok(None);
            }
        }
        let Ok(env) = env.with_parameters(slf)? else { return Ok(None) };
        let render_mode = slf.getattr_opt(intern!(py, "render_mode"))?;
        let human = render_mode.is_some_and(|mode| mode.eq(intern!(py, "human")).unwrap_or(false));
        Ok(Some((env, human)))
    }
}
