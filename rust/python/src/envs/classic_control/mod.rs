//! Gymnasium's classic control: physics with parameters that a user may assign. One environment a file.

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
pub(super) use reset::ResetResult;
pub(super) use step::{StepResult, StoredState};
pub(crate) use trigonometry::numpy_uses_libm;

use super::native_env::NativeEnv;
use crate::convert::StateArray;
use crate::runs::{RunFactory, generic_box};
use crate::spec::RunSpec;
use crate::vector::{BatchAction, BatchObservation};

/// The attributes of a Gymnasium class, besides its parameters.
pub(crate) struct EnvLayout {
    /// How many numbers the state has.
    pub(crate) state_len: usize,
    /// Whether a step leaves the state as a tuple, not as an array.
    pub(crate) state_is_tuple: bool,
    /// How many actions `step` accepts, where it asks the action space.
    pub(crate) num_actions: Option<usize>,
    /// Whether `step` calls `np.sin` or `np.cos`.
    pub(crate) calls_numpy_trigonometry: bool,
    /// The attribute that is None during an episode, and 0 once it reached a terminal state.
    pub(crate) terminal_counter: Option<&'static str>,
    /// The attribute that is None after a reset, and holds the last action after a step.
    pub(crate) last_action: Option<&'static str>,
}

impl EnvLayout {
    /// A state of so many numbers, kept in an array, and no attributes besides.
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

/// A classic-control environment: what differs from one to the next. All else follows from it and from the core.
pub(super) trait ClassicEnv:
    Env<State: Send + Sync, Action: BatchAction, Observation: BatchObservation + Sync>
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

    /// From this many sub-environments a thread on, a step of a vector environment is worth starting the thread: it then
    /// takes about a quarter of a millisecond.
    const ENVS_PER_THREAD: usize;

    /// Reads `OTHER_PARAMETERS`, and prepares what training and vector environments need.
    fn read_other_parameters(&mut self, _env: &Bound<'_, PyAny>) -> PyResult<()> {
        Ok(())
    }

    /// Whether the environment computes Gymnasium's numbers on this machine, its reset included.
    fn matches_numpy(py: Python<'_>) -> PyResult<bool> {
        Ok(!Self::LAYOUT.calls_numpy_trigonometry || numpy_uses_libm(py)?)
    }

    /// The reset of Gymnasium's class, drawing from `generator`; None, and nothing drawn, where Gymnasium's own code must
    /// do it.
    fn reset_python<'py>(&self, generator: &Bound<'py, PyAny>) -> PyResult<Option<ResetResult<'py>>>;

    /// One step of Gymnasium's class; None, and nothing changed, where Gymnasium's own code must take it.
    fn step_python<'py>(
        &self,
        env: &Bound<'py, PyAny>,
        state: &StateArray,
        action: &Bound<'py, PyAny>,
    ) -> PyResult<Option<StepResult<'py>>>;

    /// Writes a state, and the action that led to it, into a dict of Gymnasium's attributes.
    fn snapshot(
        attributes: &Bound<'_, PyDict>,
        env: &Self,
        state: &Self::State,
        last_action: Option<Self::Action>,
    ) -> PyResult<()>;

    /// Training runs; `actions` are what a learner chooses from where the action space is continuous.
    fn runs(&self, actions: &[f32], spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>>;
}

/// A [`ClassicEnv`] whose type is known at run time only.
pub(super) trait DynClassicEnv: Send + Sync {
    fn layout(&self) -> &'static EnvLayout;

    fn matches_numpy(&self, py: Python<'_>) -> PyResult<bool>;

    /// The names of all parameters, as Gymnasium spells its attributes.
    fn parameter_names(&self) -> Vec<&'static str>;

    /// The environment with the parameters of Gymnasium's, or the name of the first one that Rust cannot take over.
    fn with_parameters(&self, env: &Bound<'_, PyAny>) -> PyResult<Result<Arc<dyn DynClassicEnv>, &'static str>>;

    /// The same for training and vector environments. It is an error where Rust cannot take over a parameter.
    fn native_env(&self, env: &Bound<'_, PyAny>, actions: Vec<f32>) -> PyResult<Arc<dyn NativeEnv>>;

    fn reset_python<'py>(&self, generator: &Bound<'py, PyAny>) -> PyResult<Option<ResetResult<'py>>>;

    fn step_python<'py>(
        &self,
        env: &Bound<'py, PyAny>,
        state: &StateArray,
        action: &Bound<'py, PyAny>,
    ) -> PyResult<Option<StepResult<'py>>>;
}

/// Runs that choose from some of an environment's continuous actions.
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
