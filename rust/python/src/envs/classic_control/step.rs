//! Steps of Gymnasium's classes: the core's step, with Gymnasium's return types and state types.

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat};
use qtab_core::Env;
use qtab_core::envs::Step;

use qtab_core::random::NoRng;

use crate::convert::{StateArray, array_from, discrete_action, small_array};

/// The state of a Gymnasium class. After a step in Rust it stays in Rust until Python reads it.
pub(crate) enum StoredState {
    /// Never assigned.
    Unset,
    /// Left by a step in Rust, padded with zeros. In Gymnasium it is an array of float64, or a tuple.
    Native([f64; 4]),
    /// Assigned from Python, or returned to Python. Python may write to an array, so each step reads it again.
    Python(Py<PyAny>),
}

impl StoredState {
    /// The same state; an array is shared, not copied.
    pub(crate) fn clone_ref(&self, py: Python<'_>) -> Self {
        match self {
            Self::Unset => Self::Unset,
            Self::Native(numbers) => Self::Native(*numbers),
            Self::Python(state) => Self::Python(state.clone_ref(py)),
        }
    }
}

/// The return values of a step, and the state after it.
pub(crate) struct StepResult<'py> {
    pub(crate) state: StoredState,
    pub(crate) observation: Bound<'py, PyAny>,
    pub(crate) reward: Bound<'py, PyAny>,
    pub(crate) terminated: bool,
    /// False if a number overflowed.
    finite: bool,
}

pub(super) type Stepped<'py> = PyResult<Option<StepResult<'py>>>;

impl<'py> StepResult<'py> {
    /// The result of a step, for an environment with a float64 state in Gymnasium and a Python float as the reward.
    pub(super) fn new<E, const N: usize, const M: usize>(py: Python<'py>, env: &E, step: Step<E::State>) -> Self
    where
        E: Env<Observation = [f32; M], State: Into<[f64; N]>>,
    {
        let mut state = [0.0; 4];
        state[..N].copy_from_slice(&step.state.into());
        let observation = env.observe(&step.state);
        Self {
            state: StoredState::Native(state),
            observation: small_array(py, &observation).into_any(),
            reward: PyFloat::new(py, step.reward).into_any(),
            terminated: step.terminated,
            finite: step.reward.is_finite() && observation.iter().all(|number| number.is_finite()),
        }
    }

    /// None if a number overflowed: Python and `NumPy` then warn or raise, so Gymnasium's own code must take the step.
    pub(super) fn if_finite(self) -> Option<Self> {
        self.finite.then_some(self)
    }
}

/// A step in which Gymnasium computes with float64 and checks the action; None for another state or action.
pub(super) fn discrete_step<E, const N: usize>(
    env: &E,
    state: &StateArray,
    action: &Bound<'_, PyAny>,
) -> Option<Step<E::State>>
where
    E: Env<Action = usize, State: From<[f64; N]>>,
{
    let (state, action) = state.doubles().zip(discrete_action(action, env.num_actions()))?;
    Some(env.step(state.into(), action, &mut NoRng))
}

/// Writes the attribute `state`, an array of float64.
pub(super) fn set_state<const N: usize>(attributes: &Bound<'_, PyDict>, state: impl Into<[f64; N]>) -> PyResult<()> {
    let py = attributes.py();
    attributes.set_item(intern!(py, "state"), small_array(py, &state.into()))
}

/// Writes the attribute `state`, an array of float32.
pub(super) fn set_f32_state(attributes: &Bound<'_, PyDict>, state: &[f32]) -> PyResult<()> {
    let py = attributes.py();
    attributes.set_item(intern!(py, "state"), array_from(py, state)?)
}
