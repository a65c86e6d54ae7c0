//! `VectorEnv`: the base of the Gymnasium-facing vector environments. One call steps all sub-environments.

use std::mem;

use pyo3::exceptions::{PyIndexError, PyRuntimeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyTuple};
use qtab_core::StopFlag;
use qtab_core::checkpoint::{Checkpoint, CheckpointError, Persist};
use qtab_core::memory::{collect, filled, with_capacity};
use qtab_core::vector::Autoreset;

use super::PyNativeEnv;
use super::gymnasium::reset_needed;
use crate::convert::Seed;
use crate::error::{CompiledCodeError, allocation, invalid, unusable_checkpoint};
use crate::vector::{DynVectorEnv, SubEnvRng, VectorOptions};

const ENTROPY_BYTES: usize = 16;
/// The owner of a checkpoint, as error messages name it.
const OWNER: &str = "vector environment";

const AUTORESET_MODES: [(&str, Autoreset); 3] =
    [("NextStep", Autoreset::NextStep), ("SameStep", Autoreset::SameStep), ("Disabled", Autoreset::Disabled)];

/// The sub-environments in Rust; None before `start`, and after `release`, when Python steps them.
#[pyclass(subclass, name = "VectorEnv", module = "qtab._core")]
pub(crate) struct PyVectorEnv {
    envs: Option<Box<dyn DynVectorEnv>>,
    rngs: Vec<SubEnvRng>,
    seeds: Vec<Seed>,
    /// Whether each sub-environment still needs its first reset; empty once all have been reset.
    not_reset: Vec<bool>,
}

#[pymethods]
impl PyVectorEnv {
    #[new]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(_args: &Bound<'_, PyTuple>, _kwargs: Option<&Bound<'_, PyDict>>) -> Self {
        Self { envs: None, rngs: vec![], seeds: vec![], not_reset: vec![] }
    }

    /// Makes `num_envs` copies of `env`, with seeds from the operating system. Returns False, and does nothing, if Rust
    /// has no vector environment of that kind.
    fn start(
        slf: &Bound<'_, Self>,
        env: &PyNativeEnv,
        num_envs: usize,
        max_episode_steps: Option<u64>,
        autoreset_mode: &str,
        copy: bool,
        threads: Option<usize>,
    ) -> PyResult<bool> {
        let (py, mut this) = (slf.py(), borrow_mut(slf)?);
        let found = AUTORESET_MODES.iter().find(|(mode, _)| *mode == autoreset_mode);
        let &(_, autoreset) = found.ok_or_else(|| {
            invalid("autoreset_mode", "'NextStep', 'SameStep' or 'Disabled'", format!("'{autoreset_mode}'"))
        })?;
        let options = VectorOptions { num_envs, max_episode_steps, autoreset, copy, threads };
        let Some(envs) = env.shared().vector_env(py, options)? else { return Ok(false) };
        let seeds = random_seeds(py, num_envs)?;
        this.rngs = collect(seeds.iter().map(SubEnvRng::new)).map_err(allocation)?;
        this.not_reset = filled(&true, num_envs, &StopFlag::new()).map_err(allocation)?;
        this.seeds = seeds;
        this.envs = Some(envs);
        Ok(true)
    }

    /// Whether Rust steps the sub-environments.
    #[getter]
    fn is_native(slf: &Bound<'_, Self>) -> PyResult<bool> {
        Ok(borrow(slf)?.envs.is_some())
    }

    /// One step of all sub-environments, with Gymnasium's return types. Python takes it, and all later ones, if it fails
    /// in compiled code only.
    fn step<'py>(slf: &Bound<'py, Self>, actions: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let mut this = borrow_mut(slf)?;
        let Self { envs: Some(envs), rngs, seeds, not_reset } = &mut *this else {
            drop(this);
            return slf.call_method1(intern!(py, "step_in_python"), (actions,));
        };
        if let Some(index) = not_reset.iter().position(|&not_reset| not_reset) {
            let message = format!("Cannot call env.step() before calling env.reset(): sub-environment {index}");
            return Err(reset_needed(py, message));
        }
        match envs.step(actions, rngs, seeds) {
            Err(error) if error.is_instance_of::<CompiledCodeError>(py) => {
                drop(this);
                slf.call_method1(intern!(py, "step_in_python"), (actions,))
            }
            stepped => Ok(stepped?.into_pyobject(py)?.into_any()),
        }
    }

    /// Starts an episode in each sub-environment of `indices`, with a seed for each; None leaves its generator
    /// unchanged. Returns all observations, and the infos of the sub-environments that were reset. Raises
    /// `CompiledCodeError` if a reset does not fail in Python.
    fn native_reset<'py>(
        slf: &Bound<'py, Self>,
        indices: Vec<usize>,
        seeds: Vec<Option<Seed>>,
        bounds: Option<[f64; 2]>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
        let mut this = borrow_mut(slf)?;
        let Self { envs: Some(envs), rngs, seeds: known_seeds, not_reset } = &mut *this else {
            return Err(PyValueError::new_err("Rust does not step these sub-environments"));
        };
        if let Some(&index) = indices.iter().find(|&&index| index >= rngs.len()) {
            return Err(no_such_env(index));
        }
        let mut replaced = with_capacity(indices.len()).map_err(allocation)?;
        for (&index, seed) in indices.iter().zip(seeds) {
            if let Some(seed) = seed {
                let rng = mem::replace(&mut rngs[index], SubEnvRng::new(&seed));
                replaced.push((index, rng, mem::replace(&mut known_seeds[index], seed)));
            }
        }
        if let Err(error) = envs.reset(slf.py(), &indices, bounds, rngs, known_seeds) {
            for (index, rng, seed) in replaced {
                (rngs[index], known_seeds[index]) = (rng, seed);
            }
            return Err(error);
        }
        if !not_reset.is_empty() {
            for &index in &indices {
                not_reset[index] = false;
            }
            if !not_reset.contains(&true) {
                not_reset.clear();
            }
        }
        envs.observe(slf.py(), &indices)
    }

    /// The indices of the sub-environments that have never been reset.
    fn not_reset(slf: &Bound<'_, Self>) -> PyResult<Vec<usize>> {
        let this = borrow(slf)?;
        Ok((0..this.not_reset.len()).filter(|&index| this.not_reset[index]).collect())
    }

    /// The reset options that bound initial states, and their defaults; None for environments without them.
    fn reset_bounds(slf: &Bound<'_, Self>) -> PyResult<Option<[(&'static str, f64); 2]>> {
        Ok(borrow(slf)?.envs.as_ref().and_then(|envs| envs.reset_bounds()))
    }

    /// The last seed of a sub-environment.
    fn seed_of<'py>(slf: &Bound<'py, Self>, index: usize) -> PyResult<Bound<'py, PyAny>> {
        borrow(slf)?.seeds.get(index).ok_or_else(|| no_such_env(index))?.to_python(slf.py())
    }

    /// The generator of a sub-environment: `NumPy`'s generator or, for one in Rust, the number of 64-bit words drawn
    /// since it was seeded, and its buffered half-word.
    fn rng<'py>(slf: &Bound<'py, Self>, index: usize) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        match borrow(slf)?.rngs.get(index).ok_or_else(|| no_such_env(index))? {
            SubEnvRng::Native(rng) => Ok((rng.words_drawn(), rng.buffered_u32()).into_pyobject(py)?.into_any()),
            SubEnvRng::Python(generator) => Ok(generator.bind(py).clone()),
        }
    }

    /// Makes a sub-environment draw from a `numpy.random.Generator`.
    fn set_rng(slf: &Bound<'_, Self>, index: usize, generator: Py<PyAny>) -> PyResult<()> {
        *borrow_mut(slf)?.rngs.get_mut(index).ok_or_else(|| no_such_env(index))? = SubEnvRng::Python(generator);
        Ok(())
    }

    /// The data for stepping each sub-environment in Python: its attributes, the steps of its episode so far, whether
    /// the episode is done, and the observation.
    fn snapshots<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyList>> {
        let (py, this) = (slf.py(), borrow(slf)?);
        let Some(envs) = &this.envs else { return Ok(PyList::empty(py)) };
        let snapshots = (0..this.rngs.len()).map(|index| envs.snapshot(py, index));
        PyList::new(py, snapshots.collect::<PyResult<Vec<_>>>()?)
    }

    /// The data that `restore` needs besides the seeds and the generators in Python: the episodes, the positions of the
    /// generators in Rust, and the sub-environments that were never reset.
    fn checkpoint<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyBytes>> {
        let mut bytes = Vec::new();
        borrow_mut(slf)?
            .persist(&mut Checkpoint::save(&mut bytes))
            .map_err(|error| unusable_checkpoint(error, OWNER))?;
        Ok(PyBytes::new(slf.py(), &bytes))
    }

    /// Restores a `checkpoint` in new sub-environments of the same kind and number.
    fn restore(slf: &Bound<'_, Self>, checkpoint: &[u8], seeds: Vec<Seed>) -> PyResult<()> {
        let mut this = borrow_mut(slf)?;
        if seeds.len() != this.rngs.len() {
            return Err(invalid("seeds", format!("{} of them", this.rngs.len()), seeds.len()));
        }
        this.rngs = collect(seeds.iter().map(SubEnvRng::new)).map_err(allocation)?;
        this.seeds = seeds;
        let mut checkpoint = Checkpoint::restore(checkpoint);
        this.persist(&mut checkpoint)
            .and_then(|()| checkpoint.finish())
            .map_err(|error| unusable_checkpoint(error, OWNER))
    }

    /// Drops the sub-environments in Rust.
    fn release(slf: &Bound<'_, Self>) -> PyResult<()> {
        borrow_mut(slf)?.envs = None;
        Ok(())
    }
}

impl PyVectorEnv {
    /// Saves or restores the episodes, the generators in Rust, and `not_reset`.
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let Some(envs) = &mut self.envs else { return Ok(()) };
        envs.persist(checkpoint)?;
        for (index, rng) in self.rngs.iter_mut().enumerate() {
            let mut not_reset = self.not_reset.get(index).is_some_and(|&not_reset| not_reset);
            (rng, &mut not_reset).persist(checkpoint)?;
            if let Some(ours) = self.not_reset.get_mut(index) {
                *ours = not_reset;
            }
        }
        if !self.not_reset.contains(&true) {
            self.not_reset.clear();
        }
        Ok(())
    }
}

/// Read access, unless a step is under way.
fn borrow<'py>(slf: &Bound<'py, PyVectorEnv>) -> PyResult<PyRef<'py, PyVectorEnv>> {
    slf.try_borrow().map_err(|_| busy())
}

/// Write access, unless a step is under way.
fn borrow_mut<'py>(slf: &Bound<'py, PyVectorEnv>) -> PyResult<PyRefMut<'py, PyVectorEnv>> {
    slf.try_borrow_mut().map_err(|_| busy())
}

fn busy() -> PyErr {
    PyRuntimeError::new_err(
        "this vector environment is busy: another thread is stepping its sub-environments, or one of their generators \
         calls it",
    )
}

/// Seeds from the operating system, each with as many bytes of entropy as `NumPy` uses.
fn random_seeds(py: Python<'_>, count: usize) -> PyResult<Vec<Seed>> {
    let entropy = py.import("os")?.call_method1("urandom", (count.saturating_mul(ENTROPY_BYTES),))?;
    let entropy = entropy.cast_into::<PyBytes>()?;
    let word = |bytes: &[u8; 4]| u32::from_le_bytes(*bytes);
    let seed = |bytes: &[u8]| Seed::from_words(bytes.as_chunks().0.iter().map(word).collect());
    collect(entropy.as_bytes().chunks_exact(ENTROPY_BYTES).map(seed)).map_err(allocation)
}

fn no_such_env(index: usize) -> PyErr {
    PyIndexError::new_err(format!("there is no sub-environment {index}"))
}
