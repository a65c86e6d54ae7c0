//! The sub-environments of one type, and their type-independent interface to Python.

use pyo3::exceptions::PyAssertionError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use qtab_core::checkpoint::{Checkpoint, CheckpointError, Persist};
use qtab_core::memory::with_capacity;
use qtab_core::vector::{Autoreset, States, StepBuffers};
use qtab_core::{Env, VectorEnv};

use super::infos::{EnvInfo, Infos, repeated};
use super::{BatchAction, BatchObservation, SubEnvRng};
use crate::convert::{Seed, array_from};
use crate::error::allocation;

/// Options for stepping sub-environments.
#[derive(Clone, Copy)]
pub(crate) struct VectorOptions {
    pub(crate) num_envs: usize,
    pub(crate) max_episode_steps: Option<u64>,
    pub(crate) autoreset: Autoreset,
    /// Whether each step returns its observations in new arrays.
    pub(crate) copy: bool,
    /// The maximum number of threads; None for one per core.
    pub(crate) threads: Option<usize>,
}

impl VectorOptions {
    /// The number of threads. They start at each step: with fewer sub-environments than `envs_per_thread` on each, every
    /// thread would make the step slower.
    pub(crate) fn threads(&self, envs_per_thread: usize) -> usize {
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        self.threads.unwrap_or_else(cores).min(self.num_envs / envs_per_thread).max(1)
    }
}

/// Refuses a step after the end of an episode without a reset, if nothing else resets the sub-environments.
pub(crate) fn check_not_over(autoreset: Autoreset, mut done: impl Iterator<Item = bool>) -> PyResult<()> {
    if autoreset == Autoreset::Disabled
        && let Some(index) = done.position(|done| done)
    {
        let text = "is over: reset it first, with options={'reset_mask': ...}";
        return Err(PyAssertionError::new_err(format!("the episode of sub-environment {index} {text}")));
    }
    Ok(())
}

/// Observations, rewards, terminations, truncations, infos.
pub(crate) type VectorStep<'py> =
    (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyDict>);

/// A sub-environment as Gymnasium's class would store it: its attributes, the steps of its episode so far, whether the
/// episode is done, and the observation.
pub(crate) type EnvSnapshot<'py> = (Bound<'py, PyDict>, u64, bool, Bound<'py, PyAny>);

/// Sub-environments of any type.
pub(crate) trait DynVectorEnv: Send + Sync {
    /// One step of all sub-environments, whose generators were seeded with `seeds`. An error changes nothing.
    fn step<'py>(
        &mut self,
        actions: &Bound<'py, PyAny>,
        rngs: &mut [SubEnvRng],
        seeds: &[Seed],
    ) -> PyResult<VectorStep<'py>>;

    /// Starts an episode in each of these sub-environments. `bounds` limits their initial states. An error changes
    /// nothing.
    fn reset(
        &mut self,
        py: Python<'_>,
        indices: &[usize],
        bounds: Option<[f64; 2]>,
        rngs: &mut [SubEnvRng],
        seeds: &[Seed],
    ) -> PyResult<()>;

    /// All observations, and the infos of a reset of these sub-environments.
    fn observe<'py>(&self, py: Python<'py>, indices: &[usize]) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)>;

    /// The two numbers that bound initial states, under the names of Gymnasium's reset options.
    fn reset_bounds(&self) -> Option<[(&'static str, f64); 2]>;

    fn snapshot<'py>(&self, py: Python<'py>, index: usize) -> PyResult<EnvSnapshot<'py>>;

    /// Saves the episodes, or restores the saved ones.
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError>;
}

/// Sub-environments that are copies of `env`, with their states stored as `S`.
pub(crate) fn native_vector_env<E, S>(
    py: Python<'_>,
    env: E,
    info: EnvInfo<E>,
    options: VectorOptions,
) -> PyResult<Box<dyn DynVectorEnv>>
where
    E: Env<State: Send + Sync, Action: BatchAction, Observation: BatchObservation + Sync> + Send + Sync + 'static,
    S: States<E> + Send + Sync + 'static,
{
    let VectorOptions { num_envs, max_episode_steps, autoreset, copy, .. } = options;
    let threads = options.threads(info.envs_per_thread);
    let envs = VectorEnv::<E, S>::new(env, num_envs, max_episode_steps, autoreset, threads).map_err(allocation)?;
    let mut observations = with_capacity(num_envs).map_err(allocation)?;
    observations.extend(envs.states().map(|state| envs.env().observe(&state)));
    let out = if copy { None } else { Some(E::Observation::batched(py, &observations)?.unbind()) };
    Ok(Box::new(NativeVectorEnv {
        envs,
        info,
        actions: [repeated(E::Action::NONE, num_envs)?, repeated(E::Action::NONE, num_envs)?],
        observations,
        rewards: repeated(0.0, num_envs)?,
        terminated: repeated(false, num_envs)?,
        truncated: repeated(false, num_envs)?,
        autoreset,
        out,
    }))
}

struct NativeVectorEnv<E: Env, S> {
    envs: VectorEnv<E, S>,
    info: EnvInfo<E>,
    /// The last actions, and a buffer for the actions being read.
    actions: [Vec<E::Action>; 2],
    observations: Vec<E::Observation>,
    rewards: Vec<f64>,
    terminated: Vec<bool>,
    truncated: Vec<bool>,
    autoreset: Autoreset,
    /// The arrays that hold the observations if they are not copied.
    out: Option<Py<PyAny>>,
}

impl<E, S> NativeVectorEnv<E, S>
where
    E: Env<Action: BatchAction, Observation: BatchObservation>,
    S: States<E>,
{
    fn batched_observations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Some(out) = &self.out else { return E::Observation::batched(py, &self.observations) };
        let out = out.bind(py).clone();
        E::Observation::write(&self.observations, &out)?;
        Ok(out)
    }
}

impl<E, S> DynVectorEnv for NativeVectorEnv<E, S>
where
    E: Env<State: Send + Sync, Action: BatchAction, Observation: BatchObservation + Sync> + Send + Sync,
    S: States<E> + Send + Sync,
{
    fn step<'py>(
        &mut self,
        actions: &Bound<'py, PyAny>,
        rngs: &mut [SubEnvRng],
        _seeds: &[Seed],
    ) -> PyResult<VectorStep<'py>> {
        let py = actions.py();
        let Self { envs, info, autoreset, .. } = self;
        check_not_over(*autoreset, envs.done())?;
        let inactive = |index| *autoreset == Autoreset::NextStep && envs.is_done(index);
        E::Action::read(actions, envs.env().num_actions(), &inactive, &mut self.actions[1])?;
        self.actions.swap(0, 1);

        let buffers = StepBuffers {
            observations: &mut self.observations,
            rewards: &mut self.rewards,
            terminated: &mut self.terminated,
            truncated: &mut self.truncated,
        };
        let actions = &self.actions[0];
        if envs.threads() > 1 {
            // Detached, so that a thread that draws from a Python generator can attach itself.
            py.detach(|| envs.step(actions, rngs, buffers));
        } else {
            envs.step(actions, rngs, buffers);
        }

        let infos = Infos::new(py, self.rewards.len());
        if envs.final_states().next().is_some() {
            let last = PyDict::new(py);
            infos.add_step(&last, info, envs.final_states().map(|(index, &state)| (index, state)))?;
            let observed = |(index, state)| Ok((index, envs.env().observe(state).single(py)?));
            infos.add_final(envs.final_states().map(observed), &last)?;
        }
        infos.add_step(&infos.dict, info, envs.states().enumerate())?;
        Ok((
            self.batched_observations(py)?,
            array_from(py, &self.rewards)?.into_any(),
            array_from(py, &self.terminated)?.into_any(),
            array_from(py, &self.truncated)?.into_any(),
            infos.dict,
        ))
    }

    fn reset(
        &mut self,
        _py: Python<'_>,
        indices: &[usize],
        bounds: Option<[f64; 2]>,
        rngs: &mut [SubEnvRng],
        _seeds: &[Seed],
    ) -> PyResult<()> {
        for &index in indices {
            self.envs.reset(index, bounds, &mut rngs[index]);
        }
        self.envs.observe(&mut self.observations);
        Ok(())
    }

    fn observe<'py>(&self, py: Python<'py>, indices: &[usize]) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
        let infos = Infos::new(py, self.rewards.len());
        infos.add_reset(&self.envs, &self.info, indices)?;
        Ok((self.batched_observations(py)?, infos.dict))
    }

    fn reset_bounds(&self) -> Option<[(&'static str, f64); 2]> {
        E::RESET_BOUNDS
    }

    fn snapshot<'py>(&self, py: Python<'py>, index: usize) -> PyResult<EnvSnapshot<'py>> {
        let (state, elapsed) = (self.envs.state(index), self.envs.elapsed(index));
        let attributes = PyDict::new(py);
        let last_action = (elapsed > 0).then(|| self.actions[0][index]);
        (self.info.snapshot)(&attributes, self.envs.env(), &state, last_action)?;
        let done = self.envs.is_done(index);
        if done && self.terminated[index] {
            self.info.terminal_counter.map_or(Ok(()), |name| attributes.set_item(name, 0))?;
        }
        Ok((attributes, elapsed, done, self.observations[index].single(py)?))
    }

    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.envs.persist(checkpoint)?;
        let num_actions = self.envs.env().num_actions();
        self.actions[0].iter_mut().try_for_each(|action| action.persist(num_actions, checkpoint))?;
        self.terminated.as_mut_slice().persist(checkpoint)?;
        if checkpoint.is_restoring() {
            self.envs.observe(&mut self.observations);
        }
        Ok(())
    }
}
