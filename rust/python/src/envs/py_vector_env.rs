//! `VectorEnv`: the base of the Gymnasium-facing vector environments. One call steps all sub-environments.

use pyo3::exceptions::{PyIndexError, PyRuntimeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};
use qtab_core::vector::Autoreset;

use super::PyNativeEnv;
use super::gymnasium::reset_needed;
use crate::convert::Seed;
use crate::error::invalid;
use crate::vector::{DynVectorEnv, SubEnvRng, VectorOptions};

const AUTORESET_MODES: [(&str, Autoreset); 3] =
    [("NextStep", Autoreset::NextStep), ("SameStep", Autoreset::SameStep), ("Disabled", Autoreset::Disabled)];

/// The sub-environments in Rust; none before `start`, and after `release`, when Python steps them.
#[pyclass(subclass, name = "VectorEnv", module = "qtab._core")]
pub(crate) struct PyVectorEnv {
    envs: Option<Box<dyn DynVectorEnv>>,
    rngs: Vec<SubEnvRng>,
    seeds: Vec<Seed>,
    /// Whether each sub-environment still waits for its first reset; empty once all were reset.
    not_reset: Vec<bool>,
}

#[pymethods]
impl PyVectorEnv {
    #[new]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(_args: &Bound<'_, PyTuple>, _kwargs: Option<&Bound<'_, PyDict>>) -> Self {
        Self { envs: None, rngs: vec![], seeds: vec![], not_reset: vec![] }
    }

    /// Makes `num_envs` sub-environments that equal `env`, with seeds from the operating system. Returns False, and does
    /// nothing, where Rust has no vector environment of that kind.
    #[expect(clippy::too_many_arguments, reason = "there is one caller, which names them")]
    fn start(
        &mut self,
        py: Python<'_>,
        env: &PyNativeEnv,
        num_envs: usize,
        max_episode_steps: Option<u64>,
        autoreset_mode: &str,
        copy: bool,
        threads: Option<usize>,
    ) -> PyResult<bool> {
        let found = AUTORESET_MODES.iter().find(|(mode, _)| *mode == autoreset_mode);
        let &(_, autoreset) = found.ok_or_else(|| {
            invalid("autoreset_mode", "'NextStep', 'SameStep' or 'Disabled'", format!("'{autoreset_mode}'"))
        })?;
        let options = VectorOptions { num_envs, max_episode_steps, autoreset, copy, threads };
        let Some(envs) = env.shared().vector_env(py, options)? else { return Ok(false) };
        // As many bytes of entropy for each as NumPy takes.
        let entropy: Vec<u8> = py.import("os")?.call_method1("urandom", (16 * num_envs,))?.extract()?;
        let word = |bytes: &[u8; 4]| u32::from_le_bytes(*bytes);
        let seed = |bytes: &[u8]| Seed::from_words(bytes.as_chunks().0.iter().map(word).collect());
        self.seeds = entropy.chunks(16).map(seed).collect();
        self.rngs = self.seeds.iter().map(SubEnvRng::new).collect();
        self.not_reset = vec![true; num_envs];
        self.envs = Some(envs);
        Ok(true)
    }

    /// Whether Rust steps the sub-environments.
    #[getter]
    fn is_native(&self) -> bool {
        self.envs.is_some()
    }

    /// One step of all sub-environments, with the types that Gymnasium returns.
    fn step<'py>(slf: &Bound<'py, Self>, actions: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let busy = |_| PyRuntimeError::new_err("another thread is stepping these sub-environments");
        let mut this = slf.try_borrow_mut().map_err(busy)?;
        let Self { envs: Some(envs), rngs, not_reset, .. } = &mut *this else {
            drop(this);
            return slf.call_method1(intern!(py, "step_in_python"), (actions,));
        };
        if let Some(index) = not_reset.iter().position(|&not_reset| not_reset) {
            let message = format!("Cannot call env.step() before calling env.reset(): sub-environment {index}");
            return Err(reset_needed(py, message));
        }
        Ok(envs.step(actions, rngs)?.into_pyobject(py)?.into_any())
    }

    /// Starts an episode in each sub-environment of `indices`, with a seed for each; None leaves its generator as it is.
    /// Returns all observations, and the infos of those that were reset.
    fn native_reset<'py>(
        &mut self,
        py: Python<'py>,
        indices: Vec<usize>,
        seeds: Vec<Option<Seed>>,
        bounds: Option<[f64; 2]>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
        let Some(envs) = &mut self.envs else {
            return Err(PyValueError::new_err("Rust does not step these sub-environments"));
        };
        if let Some(&index) = indices.iter().find(|&&index| index >= self.rngs.len()) {
            return Err(no_such_env(index));
        }
        for (&index, seed) in indices.iter().zip(seeds) {
            if let Some(seed) = seed {
                self.rngs[index] = SubEnvRng::new(&seed);
                self.seeds[index] = seed;
            }
        }
        envs.reset(&indices, bounds, &mut self.rngs);
        if !self.not_reset.is_empty() {
            for &index in &indices {
                self.not_reset[index] = false;
            }
            if !self.not_reset.contains(&true) {
                self.not_reset.clear();
            }
        }
        envs.observe(py, &indices)
    }

    /// The indices of the sub-environments that were never reset.
    fn not_reset(&self) -> Vec<usize> {
        (0..self.not_reset.len()).filter(|&index| self.not_reset[index]).collect()
    }

    /// The reset options that bound initial states, and their defaults; None where there are none.
    fn reset_bounds(&self) -> Option<[(&'static str, f64); 2]> {
        self.envs.as_ref().and_then(|envs| envs.reset_bounds())
    }

    /// The last seed of a sub-environment.
    fn seed_of<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyAny>> {
        self.seeds.get(index).ok_or_else(|| no_such_env(index))?.to_python(py)
    }

    /// The generator of a sub-environment: `NumPy`'s, or of one in Rust how many 64-bit words it has drawn since it was
    /// seeded, and its buffered half-word.
    fn rng<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyAny>> {
        match self.rngs.get(index).ok_or_else(|| no_such_env(index))? {
            SubEnvRng::Native(rng) => Ok((rng.words_drawn(), rng.buffered_u32()).into_pyobject(py)?.into_any()),
            SubEnvRng::Python(generator) => Ok(generator.bind(py).clone()),
        }
    }

    /// Makes a sub-environment draw from a `numpy.random.Generator`.
    fn set_rng(&mut self, index: usize, generator: Py<PyAny>) -> PyResult<()> {
        *self.rngs.get_mut(index).ok_or_else(|| no_such_env(index))? = SubEnvRng::Python(generator);
        Ok(())
    }

    /// All that it takes to step each sub-environment in Python: its attributes, the steps of its episode so far, whether
    /// the episode is done, and the observation.
    fn snapshots<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let Some(envs) = &self.envs else { return Ok(PyList::empty(py)) };
        let snapshots = (0..self.rngs.len()).map(|index| envs.snapshot(py, index));
        PyList::new(py, snapshots.collect::<PyResult<Vec<_>>>()?)
    }

    /// Drops the sub-environments in Rust.
    fn release(&mut self) {
        self.envs = None;
    }
}

fn no_such_env(index: usize) -> PyErr {
    PyIndexError::new_err(format!("there is no sub-environment {index}"))
}
