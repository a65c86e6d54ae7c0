//! The base of the Gymnasium-facing classes: the step in Rust, everything else Gymnasium's.

use numpy::PyArray1;
use pyo3::exceptions::PyAttributeError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};

use crate::blackjack::is_numpys;
use crate::model::{Habits, Model};
use crate::numbers::Values;
use crate::play::{Played, State};
use crate::toy_text::{generator, watch};
use crate::trigonometry::numpy_calls_the_platform;

/// Holds an environment's state, and steps it.
///
/// A Python class inherits from this and from Gymnasium's class, and names its `model`. The constants stay where
/// Gymnasium has them, in attributes of the instance or the class; they are read at the first step after a reset and
/// after any assignment. What Rust does not compute with (a float32 state where Gymnasium keeps float64, a constant
/// of another width) steps in Python, through Gymnasium's own code, and so does every step that overflows.
#[pyclass(subclass, module = "qtab._core")]
pub(crate) struct Physics {
    model: Model,
    constants: Constants,
    state: State,
}

/// What is known of the attributes.
#[derive(Clone, Copy)]
enum Constants {
    Unread,
    /// The model has them.
    Read {
        human: bool,
    },
    /// Rust does not stand for all of them.
    Foreign,
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
        Ok(Self { model, constants: Constants::Unread, state: State::Missing })
    }

    /// The first state, from the generator as it stands; what `reset` returns, or None, nothing drawn, where that is
    /// Gymnasium's to do.
    fn begin<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let py = slf.py();
        let (generator, model) = (generator(slf)?, slf.borrow().model);
        if !is_numpys(&generator) || (model.habits().trigonometry && !numpy_calls_the_platform(py)?) {
            return Ok(None);
        }
        let Some(begun) = model.begin(&generator)? else { return Ok(None) };
        // Straight to its place, since no constant changes.
        let attributes = slf.getattr(intern!(py, "__dict__"))?.cast_into::<PyDict>()?;
        match model {
            Model::CartPole(_) => attributes.set_item(intern!(py, "steps_beyond_terminated"), py.None())?,
            Model::Pendulum(_) => attributes.set_item(intern!(py, "last_u"), py.None())?,
            _ => (),
        }
        {
            let mut this = slf.borrow_mut();
            this.state = State::Python(begun.state.unbind());
            this.constants = Constants::Unread;
        }
        watch(slf)?;
        Ok(Some((begun.observation, PyDict::new(py)).into_pyobject(py)?.into_any()))
    }

    /// One step, with the types that Gymnasium returns.
    fn step<'py>(slf: &Bound<'py, Self>, action: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let Some((played, human)) = Self::step_in_rust(slf, action)? else {
            return slf.call_method1(intern!(py, "step_in_python"), (action,));
        };
        slf.borrow_mut().state = played.state;
        if human {
            slf.call_method0(intern!(py, "render"))?;
        }
        let answer = (played.observation, played.reward, played.terminated, false, PyDict::new(py));
        Ok(answer.into_pyobject(py)?.into_any())
    }

    /// To be called after any attribute was assigned.
    fn changed(&mut self) {
        self.constants = Constants::Unread;
    }

    /// The state as Gymnasium keeps it.
    #[getter]
    fn state<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let (numbers, Habits { state: count, tuple, .. }) = {
            let this = slf.borrow();
            let numbers = match &this.state {
                State::Python(state) => return Ok(state.bind(py).clone()),
                State::Rust(numbers) => Some(*numbers),
                State::Missing => None,
            };
            (numbers, this.model.habits())
        };
        let Some(numbers) = numbers else {
            let class = slf.get_type();
            return Err(PyAttributeError::new_err(format!("'{}' object has no attribute 'state'", class.name()?)));
        };
        let mut state = PyArray1::from_slice(py, &numbers[..count]).into_any();
        if tuple {
            state = PyTuple::new(py, state.try_iter()?.collect::<PyResult<Vec<_>>>()?)?.into_any();
        }
        slf.borrow_mut().state = State::Python(state.clone().unbind());
        Ok(state)
    }

    #[setter]
    fn set_state(&mut self, value: &Bound<'_, PyAny>) {
        self.state = State::Python(value.clone().unbind());
    }
}

impl Physics {
    /// The step, and whether a person watches; None where it is Gymnasium's to take.
    fn step_in_rust<'py>(slf: &Bound<'py, Self>, action: &Bound<'py, PyAny>) -> PyResult<Option<(Played<'py>, bool)>> {
        let py = slf.py();
        let constants = slf.borrow().constants;
        let human = match constants {
            Constants::Read { human } => human,
            Constants::Foreign => return Ok(None),
            Constants::Unread => match Self::read(slf)? {
                Some(human) => human,
                None => return Ok(None),
            },
        };
        let (model, values) = {
            let this = slf.borrow();
            let values = match &this.state {
                State::Rust(numbers) => Some(Values::new(*numbers)),
                State::Python(state) => Values::read(state.bind(py), this.model.habits().state),
                State::Missing => None,
            };
            (this.model, values)
        };
        let Some(values) = values else { return Ok(None) };
        Ok(model.play(slf, &values, action)?.map(|played| (played, human)))
    }

    /// The model with the constants of its attributes; None where Rust does not stand for one of them.
    pub(crate) fn model(slf: &Bound<'_, Self>) -> PyResult<Option<Model>> {
        Ok(Self::read(slf)?.map(|_| slf.borrow().model))
    }

    /// Reads the attributes into the model; None where Rust does not stand for one of them.
    fn read(slf: &Bound<'_, Self>) -> PyResult<Option<bool>> {
        let mut model = slf.borrow().model;
        let human = Self::read_into(slf, &mut model)?;
        let mut this = slf.borrow_mut();
        this.model = model;
        this.constants = human.map_or(Constants::Foreign, |human| Constants::Read { human });
        Ok(human)
    }

    fn read_into(slf: &Bound<'_, Self>, model: &mut Model) -> PyResult<Option<bool>> {
        let py = slf.py();
        let habits = model.habits();
        if habits.trigonometry && !numpy_calls_the_platform(py)? {
            return Ok(None);
        }
        if let Some(name) = habits.none
            && !slf.getattr_opt(name)?.is_some_and(|value| value.is_none())
        {
            return Ok(None);
        }
        if let Some(actions) = habits.actions {
            let Some(space) = slf.getattr_opt(intern!(py, "action_space"))? else { return Ok(None) };
            let [n, start] = [space.getattr_opt(intern!(py, "n"))?, space.getattr_opt(intern!(py, "start"))?];
            let (Some(n), Some(start)) = (n, start) else { return Ok(None) };
            if !n.eq(actions)? || !start.eq(0)? {
                return Ok(None);
            }
        }
        if model.read(slf)?.is_some() {
            return Ok(None);
        }
        let render_mode = slf.getattr_opt(intern!(py, "render_mode"))?;
        Ok(Some(render_mode.is_some_and(|mode| mode.eq(intern!(py, "human")).unwrap_or(false))))
    }
}
