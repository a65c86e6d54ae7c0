//! Sub-environments of another library, which step together.

use std::sync::{Mutex, PoisonError};

use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use qtab_core::checkpoint::{Checkpoint, CheckpointError};
use qtab_core::memory::with_capacity;
use qtab_core::random::Pcg64;
use qtab_core::vector::Autoreset;
use qtab_env::{FLOAT32, FLOAT64, Number};

use super::external_env::SharedEnv;
use super::observations::observation_array;
use super::sub_env::SubEnv;
use crate::convert::{Seed, array_of};
use crate::error::{CompiledCodeError, allocation};
use crate::interrupt::on_threads;
use crate::vector::{
    DynVectorEnv, EnvSnapshot, Infos, SubEnvRng, VectorOptions, VectorStep, check_not_over, read_numbered, repeated,
};

/// The work of the steps for which starting a thread is worth its time, in units of `step_work`.
const WORK_OF_A_THREAD: u64 = 5_000;

/// The spaces of an environment: an object in Python, which turns the numbers of observations into observations.
pub(super) struct PySpaces {
    object: Py<PyAny>,
    /// The action that is number 0.
    first_action: i64,
    /// The dtype of the action masks in the infos; `None` if the infos have none.
    mask_dtype: Option<String>,
}

impl PySpaces {
    /// `object` has the attributes `first_action` and `mask_dtype`, and the methods `batch(rows)` and `single(row)`.
    pub(super) fn new(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        let first_action = object.getattr("first_action")?.extract()?;
        let mask_dtype = object.getattr("mask_dtype")?.extract()?;
        Ok(Self { object: object.clone().unbind(), first_action, mask_dtype })
    }

    fn clone_ref(&self, py: Python<'_>) -> Self {
        let Self { object, first_action, mask_dtype } = self;
        Self { object: object.clone_ref(py), first_action: *first_action, mask_dtype: mask_dtype.clone() }
    }
}

pub(super) struct ExternalVectorEnv {
    env: SharedEnv,
    spaces: PySpaces,
    sub_envs: Vec<SubEnv>,
    /// The numbers of the actions of a step.
    actions: Vec<usize>,
    max_episode_steps: u64,
    autoreset: Autoreset,
    threads: usize,
}

impl ExternalVectorEnv {
    pub(super) fn new(py: Python<'_>, env: SharedEnv, spaces: &PySpaces, options: VectorOptions) -> PyResult<Self> {
        let mut sub_envs = with_capacity(options.num_envs).map_err(allocation)?;
        for _ in 0..options.num_envs {
            sub_envs.push(SubEnv::new(&env).map_err(allocation)?);
        }
        let envs_per_thread = WORK_OF_A_THREAD / env.0.step_work.clamp(1, WORK_OF_A_THREAD);
        Ok(Self {
            spaces: spaces.clone_ref(py),
            sub_envs,
            actions: repeated(0, options.num_envs)?,
            max_episode_steps: options.max_episode_steps.unwrap_or(u64::MAX),
            autoreset: options.autoreset,
            threads: options.threads(envs_per_thread as usize),
            env,
        })
    }

    /// Calls a function with each sub-environment of `indices` and its generator, on several threads. If one fails, all
    /// return to their states before the call that has begun last.
    fn for_each(
        &mut self,
        py: Python<'_>,
        indices: &[usize],
        rngs: &mut [SubEnvRng],
        seeds: &[Seed],
        call: impl Fn(usize, &mut SubEnv, &mut Pcg64) + Sync,
    ) -> PyResult<()> {
        let mut selected = repeated(false, self.sub_envs.len())?;
        for &index in indices {
            selected[index] = true;
        }
        let mut generators = with_capacity(rngs.len()).map_err(allocation)?;
        for rng in rngs {
            let SubEnvRng::Native(rng) = rng else {
                return Err(PyRuntimeError::new_err("the functions of a library draw from a generator in Rust"));
            };
            generators.push(rng);
        }
        let shard_len = selected.len().div_ceil(self.threads).max(1);
        let shards = self.sub_envs.chunks_mut(shard_len).zip(generators.chunks_mut(shard_len));
        let shards = Mutex::new(shards.zip(selected.chunks(shard_len)).enumerate());
        let work = || {
            loop {
                let shard = shards.lock().unwrap_or_else(PoisonError::into_inner).next();
                let Some((shard, ((sub_envs, generators), selected))) = shard else { break };
                let members = sub_envs.iter_mut().zip(generators).zip(selected).enumerate();
                for (position, ((sub_env, rng), _)) in members.filter(|(_, (_, selected))| **selected) {
                    call(shard * shard_len + position, sub_env, rng);
                }
            }
        };
        py.detach(|| on_threads(self.threads, work));
        // An error of Python comes before one of compiled code only, after which Python would take the call.
        let mut failed = None;
        for error in self.sub_envs.iter().zip(seeds).filter_map(|(sub_env, seed)| sub_env.error(py, seed)) {
            let is_of_python = !error.is_instance_of::<CompiledCodeError>(py);
            failed = if is_of_python { Some(error) } else { failed.or(Some(error)) };
            if is_of_python {
                break;
            }
        }
        let Some(error) = failed else { return Ok(()) };
        for (index, sub_env) in self.sub_envs.iter_mut().enumerate() {
            sub_env.undo(generators[index]);
        }
        Err(error)
    }

    /// The observations of all sub-environments, as Gymnasium batches them.
    fn observations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let rows = match self.env.observation_type() {
            FLOAT32 => self.rows::<f32>(py)?,
            FLOAT64 => self.rows::<f64>(py)?,
            _ => self.rows::<i64>(py)?,
        };
        self.spaces.object.bind(py).call_method1(intern!(py, "batch"), (rows,))
    }

    /// (sub-environments, numbers): the numbers of the observations.
    fn rows<'py, T: Number + numpy::Element>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let (count, size) = (self.sub_envs.len(), self.env.observation_size());
        let mut numbers = with_capacity(count.saturating_mul(size)).map_err(allocation)?;
        self.sub_envs.iter().for_each(|sub_env| numbers.extend_from_slice(sub_env.episode.observation::<T>()));
        Ok(PyArray1::from_vec(py, numbers).reshape([count, size])?.into_any())
    }

    /// The observation of a sub-environment, as it returns it itself.
    fn observation<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyAny>> {
        let row = observation_array(py, &self.sub_envs[index].episode)?;
        self.spaces.object.bind(py).call_method1(intern!(py, "single"), (row,))
    }

    /// Adds the action masks of these sub-environments to a dict, if the environment has masks.
    fn add_masks<'py>(&self, infos: &Infos<'py>, dict: &Bound<'py, PyDict>, indices: &[usize]) -> PyResult<()> {
        let Some(dtype) = self.spaces.mask_dtype.as_ref().filter(|_| self.env.has_action_mask()) else {
            return Ok(());
        };
        let (py, count, width) = (dict.py(), self.sub_envs.len(), self.env.num_actions());
        let mut masks = repeated(0_i8, count.saturating_mul(width))?;
        for &index in indices {
            let row = masks[index * width..].iter_mut();
            row.zip(self.sub_envs[index].episode.action_mask()).for_each(|(to, &byte)| *to = byte.cast_signed());
        }
        let mut masks = PyArray1::from_vec(py, masks).reshape([count, width])?.into_any();
        if dtype != "int8" {
            masks = masks.call_method1(intern!(py, "astype"), (dtype,))?;
        }
        dict.set_item(intern!(py, "action_mask"), masks)?;
        dict.set_item(intern!(py, "_action_mask"), infos.mask(indices.iter().copied())?)
    }

    /// The indices of the sub-environments of which `select` holds.
    fn indices(&self, select: impl Fn(&SubEnv) -> bool) -> PyResult<Vec<usize>> {
        let mut indices = with_capacity(self.sub_envs.len()).map_err(allocation)?;
        indices.extend((0..self.sub_envs.len()).filter(|&index| select(&self.sub_envs[index])));
        Ok(indices)
    }
}

impl DynVectorEnv for ExternalVectorEnv {
    fn step<'py>(
        &mut self,
        actions: &Bound<'py, PyAny>,
        rngs: &mut [SubEnvRng],
        seeds: &[Seed],
    ) -> PyResult<VectorStep<'py>> {
        let (py, autoreset, limit) = (actions.py(), self.autoreset, self.max_episode_steps);
        check_not_over(autoreset, self.sub_envs.iter().map(|sub_env| sub_env.progress.done))?;
        let resets_done = autoreset == Autoreset::NextStep;
        let sub_envs = &self.sub_envs;
        let inactive = |index: usize| resets_done && sub_envs[index].progress.done;
        let num_actions = self.env.num_actions();
        read_numbered(actions, self.spaces.first_action, num_actions, &inactive, &mut self.actions)?;

        self.sub_envs.iter_mut().try_for_each(SubEnv::reserve_action).map_err(allocation)?;
        let numbers = std::mem::take(&mut self.actions);
        let all = self.indices(|_| true)?;
        let stepped = self.for_each(py, &all, rngs, seeds, |index, sub_env, rng| {
            sub_env.begin_call(rng);
            if resets_done && sub_env.progress.done {
                (sub_env.reward, sub_env.terminated, sub_env.truncated) = (0.0, false, false);
                sub_env.reset(rng);
            } else {
                sub_env.step(numbers[index], limit, rng);
            }
        });
        self.actions = numbers;
        stepped?;

        let infos = Infos::new(py, all.len());
        if autoreset == Autoreset::SameStep {
            let ended = self.indices(|sub_env| sub_env.progress.done)?;
            if !ended.is_empty() {
                let last = PyDict::new(py);
                self.add_masks(&infos, &last, &ended)?;
                infos.add_final(ended.iter().map(|&index| Ok((index, self.observation(py, index)?))), &last)?;
                self.for_each(py, &ended, rngs, seeds, |_, sub_env, rng| sub_env.reset(rng))?;
            }
        }
        self.add_masks(&infos, &infos.dict, &all)?;
        let sub_envs = self.sub_envs.iter();
        Ok((
            self.observations(py)?,
            array_of(py, sub_envs.clone().map(|sub_env| sub_env.reward))?.into_any(),
            array_of(py, sub_envs.clone().map(|sub_env| sub_env.terminated))?.into_any(),
            array_of(py, sub_envs.map(|sub_env| sub_env.truncated))?.into_any(),
            infos.dict,
        ))
    }

    /// These environments have no bounds of first states.
    fn reset(
        &mut self,
        py: Python<'_>,
        indices: &[usize],
        _bounds: Option<[f64; 2]>,
        rngs: &mut [SubEnvRng],
        seeds: &[Seed],
    ) -> PyResult<()> {
        for (sub_env, rng) in self.sub_envs.iter_mut().zip(rngs.iter()) {
            if let SubEnvRng::Native(rng) = rng {
                sub_env.begin_call(rng);
            }
        }
        self.for_each(py, indices, rngs, seeds, |_, sub_env, rng| sub_env.reset(rng))
    }

    fn observe<'py>(&self, py: Python<'py>, indices: &[usize]) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
        let infos = Infos::new(py, self.sub_envs.len());
        self.add_masks(&infos, &infos.dict, indices)?;
        Ok((self.observations(py)?, infos.dict))
    }

    fn reset_bounds(&self) -> Option<[(&'static str, f64); 2]> {
        None
    }

    /// The attribute `state` are the bytes of the state; `played`, of an environment that repeats episodes, the position
    /// before the reset and the actions since then.
    fn snapshot<'py>(&self, py: Python<'py>, index: usize) -> PyResult<EnvSnapshot<'py>> {
        let SubEnv { episode, progress, played, .. } = &self.sub_envs[index];
        let attributes = PyDict::new(py);
        attributes.set_item(intern!(py, "state"), PyBytes::new(py, episode.state()))?;
        if let Some(played) = played {
            attributes.set_item(intern!(py, "played"), (played.now.start, &played.now.actions))?;
        }
        Ok((attributes, progress.elapsed, progress.done, self.observation(py, index)?))
    }

    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.sub_envs.iter_mut().try_for_each(|sub_env| sub_env.persist(checkpoint))
    }
}
