//! Gymnasium's classic control: physics with parameters that a user may assign. One environment per file.

mod acrobot;
mod cart_pole;
mod cart_pole_batch;
mod continuous_mountain_car;
mod dyn_env;
mod mountain_car;
mod pendulum;
mod reset;
mod step;
mod trigonometry;

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use qtab_core::Env;
use qtab_core::envs::Parameters;
use qtab_core::envs::wrappers::DiscreteActions;
use qtab_core::numeric::Scalar;
use qtab_core::vector::States;

pub(crate) use cart_pole_batch::step_cart_poles;
use reset::ResetOutcome;
use step::Stepped;
pub(super) use step::{StepResult, StoredState};
pub(crate) use trigonometry::numpy_uses_libm;

use super::native_env::NativeEnv;
use crate::convert::StateArray;
use crate::runs::{RunFactory, generic_box};
use crate::spec::RunSpec;
use crate::vector::{BatchAction, BatchObservation};

/// The attributes of a Gymnasium class, besides its parameters.
pub(crate) struct EnvLayout {
    /// The number of components of the state.
    pub(crate) state_len: usize,
    /// Whether a step leaves the state as a tuple instead of an array.
    pub(crate) state_is_tuple: bool,
    /// The number of actions, for environments whose `step` checks the action against the action space.
    pub(crate) num_actions: Option<usize>,
    /// Whether `step` calls `np.sin` or `np.cos`.
    pub(crate) calls_numpy_trigonometry: bool,
    /// The attribute that is None during an episode, and 0 once a terminal state is reached.
    pub(crate) terminal_counter: Option<&'static str>,
    /// The attribute that is None after a reset, and holds the last action after a step.
    pub(crate) last_action: Option<&'static str>,
}

impl EnvLayout {
    /// A state of this many numbers, stored in an array, and no other attributes.
    const fn new(state_len: usize) -> Self {
        Self {
            state_len,
            state_is_tuple: false,
            num_actions: None,
            calls_numpy_trigonometry: false,
            terminal_counter: None,
            last_action: None,
        }
    }
}

/// Resets and steps of Gymnasium's class. Either returns None, and neither draws nor changes anything, if Gymnasium's own
/// code must do it.
pub(super) trait GymnasiumClass {
    /// The reset, with numbers from `generator`.
    fn py_reset<'py>(&self, generator: &Bound<'py, PyAny>) -> ResetOutcome<'py>;

    /// One step.
    fn py_step<'py>(&self, env: &Bound<'py, PyAny>, state: &StateArray, action: &Bound<'py, PyAny>) -> Stepped<'py>;
}

/// A classic-control environment: the parts in which the environments differ. The rest is shared, or in the core.
pub(super) trait ClassicEnv:
    Env<State: Send + Sync, Action: BatchAction, Observation: BatchObservation + Sync>
    + GymnasiumClass
    + Parameters
    + Copy
    + Send
    + Sync
    + 'static
{
    const LAYOUT: EnvLayout;

    /// How vector environments store the states.
    type States: States<Self> + Send + Sync + 'static;

    /// The names of parameters that are neither numbers nor flags.
    const OTHER_PARAMETERS: &'static [&'static str] = &[];

    /// The number of sub-environments per thread from which a step of a vector environment takes about a quarter of a
    /// millisecond, long enough to be worth starting the thread.
    const ENVS_PER_THREAD: usize;

    /// Reads `OTHER_PARAMETERS`, and prepares the data that training and vector environments need.
    fn read_other_parameters(&mut self, _env: &Bound<'_, PyAny>) -> PyResult<()> {
        Ok(())
    }

    /// Whether steps and resets compute the same numbers as Gymnasium on this machine.
    fn matches_numpy(py: Python<'_>) -> PyResult<bool> {
        Ok(!Self::LAYOUT.calls_numpy_trigonometry || numpy_uses_libm(py)?)
    }

    /// Writes a state, and the action that led to it, into a dict of Gymnasium's attributes.
    fn snapshot(
        &self,
        attributes: &Bound<'_, PyDict>,
        state: &Self::State,
        last_action: Option<Self::Action>,
    ) -> PyResult<()>;

    /// Training runs. If the action space is continuous, the learner chooses from `actions`.
    fn runs(&self, actions: &[f32], spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>>;
}

/// A [`ClassicEnv`] whose type is known only at run time.
pub(super) trait DynClassicEnv: GymnasiumClass + Send + Sync {
    fn layout(&self) -> &'static EnvLayout;

    fn matches_numpy(&self, py: Python<'_>) -> PyResult<bool>;

    /// The names of all parameters, as Gymnasium spells its attributes.
    fn parameter_names(&self) -> Vec<&'static str>;

    /// This environment with the parameters of `env`, or the name of the first parameter that Rust does not support.
    fn with_parameters(&self, env: &Bound<'_, PyAny>) -> PyResult<Result<Arc<dyn DynClassicEnv>, &'static str>>;

    /// This environment for training and vector environments. A parameter that Rust does not support is an error.
    fn native_env(&self, env: &Bound<'_, PyAny>, actions: Vec<f32>) -> PyResult<Arc<dyn NativeEnv>>;
}

/// Runs that choose from a finite set of an environment's continuous actions.
fn runs_with_discrete_actions<E, const M: usize>(
    env: E,
    actions: &[f32],
    spec: &Arc<RunSpec>,
) -> PyResult<Box<dyn RunFactory>>
where
    E: Env<Action = Scalar, Observation = [f32; M], State: Send> + Clone + Send + Sync + 'static,
{
    let actions = actions.iter().copied().map(Scalar::Single).collect();
    generic_box(DiscreteActions { env, actions }, spec)
}
