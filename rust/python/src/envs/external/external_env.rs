//! Runs in an environment of another library.

use std::borrow::BorrowMut;
use std::ops::Deref;
use std::sync::Arc;

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use qtab_core::features::MAX_TILINGS;
use qtab_core::numeric::Float;
use qtab_core::random::Pcg64;
use qtab_core::{Features, StopFlag};
use qtab_env::host::{BitGenerator, CallError, Environment};
use qtab_env::{FLOAT32, FLOAT64, Number};

use super::super::native_env::NativeEnv;
use super::external_task::{ExternalTask, TaskOptions};
use super::external_vector_env::{ExternalVectorEnv, PySpaces};
use super::observations::{ConvertTo, Converted};
use crate::convert::Seed;
use crate::error::{CompiledCodeError, invalid};
use crate::runs::{AnyRecordings, BoxedFactory, RunFactory, boxed_run, check_actions, observed_run, one_step_runs};

use crate::spec::{
    ActionMasksSpec, BoxFeatures, DiscretizerSpec, FloatType, PolicyFeatures, PredictionSpec, ReadValues, RunSpec,
    match_capacity,
};
use crate::vector::{DynVectorEnv, VectorOptions};

/// An environment of another library, shared by all runs.
pub(crate) struct ExternalEnv {
    pub(super) environment: Environment,
    /// The work of a step, as counted by a training budget.
    pub(super) step_work: u64,
    /// Keeps the environment alive.
    pub(super) _capsule: Py<PyAny>,
    /// Called where a function of the environment fails, to raise the error or to give the result of the call.
    pub(super) on_failure: Option<Py<PyAny>>,
    /// Whether `on_failure` repeats the whole episode, so that its actions are kept.
    pub(super) repeats_episodes: bool,
}

/// A shared environment and its capsule.
#[derive(Clone)]
pub(super) struct SharedEnv(pub(super) Arc<ExternalEnv>);

impl Deref for SharedEnv {
    type Target = Environment;

    #[inline]
    fn deref(&self) -> &Environment {
        &self.0.environment
    }
}

/// The environment's generator, or a reference to it, from which its functions draw bits.
#[derive(Clone)]
pub(super) struct EnvironmentBits<R>(pub(super) R);

impl<R: BorrowMut<Pcg64>> BitGenerator for EnvironmentBits<R> {
    #[inline]
    fn next_u64(&mut self) -> u64 {
        self.0.borrow_mut().next_u64()
    }

    #[inline]
    fn next_u32(&mut self) -> u32 {
        self.0.borrow_mut().next_u32()
    }
}

/// The number of words that a generator has drawn, and its buffered half-word.
pub(super) type Position = (u64, Option<u32>);

/// A call that failed: what is needed to repeat it.
pub(super) struct FailedCall<'a> {
    /// The state before the step; `None` for a reset.
    pub(super) state: Option<&'a [u8]>,
    /// The position of the generator before the call.
    pub(super) before: Position,
    pub(super) action: Option<usize>,
    pub(super) seed: &'a Seed,
    /// The position of the generator before the reset of the episode, and the actions before the call; `None` if they
    /// are not known.
    pub(super) played: Option<(Position, &'a [u32])>,
}

/// The result of a call that Python repeated: the observation and the action mask as bytes, the reward, the code as of
/// `step`, and the position of the generator.
pub(super) type Repeated = (Vec<u8>, Vec<u8>, f64, i32, Position);

impl ExternalEnv {
    /// Repeats a call in Python by `on_failure`, which raises the error, or returns the result and a function of an
    /// action that takes the next step.
    pub(super) fn repeat(
        &self,
        py: Python<'_>,
        error: CallError,
        failed: &FailedCall<'_>,
    ) -> PyResult<(Repeated, Py<PyAny>)> {
        match self.repeated(py, error, failed)? {
            Some(repeated) => repeated.extract(py),
            None => Err(returned_failed(failed.action)),
        }
    }

    /// The error of a call in a vector environment: that of Python, or `CompiledCodeError` if it does not fail there.
    pub(super) fn error(&self, py: Python<'_>, error: CallError, failed: &FailedCall<'_>) -> PyErr {
        match self.repeated(py, error, failed) {
            Err(raised) => raised,
            Ok(_) if self.repeats_episodes => CompiledCodeError::new_err("a call failed in compiled code only"),
            Ok(_) => returned_failed(failed.action),
        }
    }

    /// What `on_failure` returns for a call that failed; `None` if it returns None, or there is no such function.
    fn repeated(&self, py: Python<'_>, error: CallError, failed: &FailedCall<'_>) -> PyResult<Option<Py<PyAny>>> {
        let FailedCall { state, before, action, seed, played } = failed;
        let is_repeated = self.repeats_episodes && matches!(error, CallError::Reward(_));
        if error != CallError::Failed && !is_repeated {
            return Err(PyValueError::new_err(error.to_string()));
        }
        let Some(on_failure) = &self.on_failure else { return Ok(None) };
        let state = state.map(|bytes| PyBytes::new(py, bytes));
        let repeated = on_failure.call1(py, (state, *before, *action, seed.to_python(py)?, *played))?;
        Ok((!repeated.is_none(py)).then_some(repeated))
    }

    /// Runs with the features of the spec's discretizer, for observations of type `T`.
    fn runs_with<T, F>(self: &Arc<Self>, features: F, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>>
    where
        T: Number,
        F: Features<[T], Active: Send> + Clone + Send + Sync + 'static,
    {
        let (env, spec, options) = (Arc::clone(self), Arc::clone(spec), self.options(spec)?);
        let shape = (features.len(), spec.discretizer.n_active());
        let build = move |seed: &Seed, stop: &StopFlag<'_>| {
            let task = ExternalTask::new(&env, features.clone(), options, seed)?;
            boxed_run(task, shape, seed, &spec, stop, AnyRecordings::Native)
        };
        Ok(Box::new(BoxedFactory(build)))
    }

    fn options(&self, spec: &RunSpec) -> PyResult<TaskOptions> {
        check_actions(self.environment.num_actions(), spec)?;
        let has_masks = matches!(spec.action_masks, ActionMasksSpec::Observed);
        if has_masks && !self.environment.has_action_mask() {
            return Err(invalid("action_mask", "False for an environment without action masks", "True"));
        }
        Ok(TaskOptions { max_episode_steps: spec.max_episode_steps, has_masks })
    }

    /// Runs with cells, compiled for the usual learners.
    fn cell_runs<T, F>(self: &Arc<Self>, features: F, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>>
    where
        T: Number,
        F: Features<[T], Active = [u32; 1]> + Clone + Send + Sync + 'static,
    {
        let (env, options, n_rows) = (Arc::clone(self), self.options(spec)?, features.len());
        let own = features.clone();
        let new_task = move |seed: &Seed| ExternalTask::<T, F>::new(&env, own.clone(), options, seed);
        one_step_runs(new_task, n_rows, spec).map_or_else(|| self.runs_with::<T, F>(features, spec), Ok)
    }

    /// Runs with a discretizer of a Box of dtype `D`, for observations of type `T`.
    fn box_runs<T, D>(self: &Arc<Self>, to_dtype: fn(f64) -> D, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>>
    where
        T: ConvertTo<D>,
        D: Float + Default + Send + Sync + 'static,
    {
        if let DiscretizerSpec::Tiles(tiles) = &spec.discretizer {
            return self.runs_with::<T, _>(Converted::new(tiles.tile_coding::<D, MAX_TILINGS>(), Vec::new()), spec);
        }
        self.runs_with::<T, _>(Converted::new(spec.discretizer.grid(to_dtype)?, Vec::new()), spec)
    }

    /// Runs with a discretizer of the type of the observations, which may estimate the values of a policy that reads
    /// them.
    fn same_box_runs<T>(self: &Arc<Self>, to_dtype: fn(f64) -> T, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>>
    where
        T: Number + Float + numpy::Element + Send + Sync + 'static,
        PolicyFeatures<T>: ReadValues<Vec<T>>,
    {
        let prediction = spec.prediction_by_observation();
        if let DiscretizerSpec::Weighted(weighted) = &spec.discretizer {
            return match_capacity!(weighted.n_features(), ROOM => {
                let features = weighted.basis::<T, ROOM>()?;
                match prediction {
                    Some(prediction) => self.observed_runs(features, to_dtype, spec, prediction),
                    None => self.runs_with::<T, _>(features, spec),
                }
            });
        }
        if let Some(prediction) = prediction {
            return self.observed_runs(BoxFeatures::new(&spec.discretizer, to_dtype)?, to_dtype, spec, prediction);
        }
        if let DiscretizerSpec::Tiles(tiles) = &spec.discretizer {
            return self.runs_with::<T, _>(tiles.tile_coding::<T, MAX_TILINGS>(), spec);
        }
        self.cell_runs::<T, _>(spec.discretizer.grid(to_dtype)?, spec)
    }

    /// Runs that estimate the values of a policy that reads the observations.
    fn observed_runs<T, F>(
        self: &Arc<Self>,
        features: F,
        to_dtype: fn(f64) -> T,
        spec: &Arc<RunSpec>,
        prediction: &Arc<PredictionSpec>,
    ) -> PyResult<Box<dyn RunFactory>>
    where
        T: Number + Float + numpy::Element + Send + Sync + 'static,
        F: Features<[T], Active: Send> + Clone + Send + Sync + 'static,
        PolicyFeatures<T>: ReadValues<Vec<T>>,
    {
        let (env, spec, prediction) = (Arc::clone(self), Arc::clone(spec), Arc::clone(prediction));
        let options = self.options(&spec)?;
        let build = move |seed: &Seed, stop: &StopFlag<'_>| {
            let task = ExternalTask::<T, _>::new(&env, features.clone(), options, seed)?;
            let policies = prediction.policies(&spec, |own| PolicyFeatures::new(own, to_dtype))?;
            Ok((observed_run(task, policies, seed, &spec, &prediction, stop)?, AnyRecordings::None))
        };
        Ok(Box::new(BoxedFactory(build)))
    }

    /// Checks that an observation has as many numbers as the discretizer reads.
    fn check_dimensions(&self, dimensions: usize) -> PyResult<()> {
        let size = self.environment.observation_size();
        if dimensions == size {
            return Ok(());
        }
        Err(invalid("discretizer", format!("one for observations of {size} numbers"), dimensions))
    }

    /// Runs as the spec describes them. `first` are the numbers to subtract from those of an observation; empty for zeros.
    fn build_runs(self: &Arc<Self>, first: &[i64], spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        let observation_type = self.environment.observation_type();
        let is_float = [FLOAT32, FLOAT64].contains(&observation_type);
        if let DiscretizerSpec::Identity(reader) = &spec.discretizer {
            self.check_dimensions(reader.dimensions())?;
            return match first {
                _ if is_float => Err(invalid("discretizer", "one for a Box of observations", "'identity'")),
                [] => self.cell_runs::<i64, _>(reader.clone(), spec),
                first => self.cell_runs::<i64, _>(Converted::new(reader.clone(), first.to_vec()), spec),
            };
        }
        let (dtype, dimensions) = spec.discretizer.box_space()?;
        self.check_dimensions(dimensions)?;
        if let DiscretizerSpec::Product(product) = &spec.discretizer {
            let first = first.iter().map(|&first| first as f64).collect();
            let features = Converted::new(product.features.clone(), first);
            return match observation_type {
                FLOAT32 => self.runs_with::<f32, _>(features, spec),
                FLOAT64 => self.runs_with::<f64, _>(features, spec),
                _ => self.runs_with::<i64, _>(features, spec),
            };
        }
        let to_f32 = |bound: f64| bound as f32;
        match (observation_type, dtype) {
            (FLOAT32, FloatType::F32) => self.same_box_runs::<f32>(to_f32, spec),
            (FLOAT64, FloatType::F64) => self.same_box_runs::<f64>(|bound| bound, spec),
            _ if spec.prediction_by_observation().is_some() || spec.discretizer.weighted().is_some() => {
                Err(invalid("env", "one with observations of the dtype of its space", "another dtype"))
            }
            (FLOAT32, FloatType::F64) => self.box_runs::<f32, f64>(|bound| bound, spec),
            (FLOAT64, FloatType::F32) => self.box_runs::<f64, f32>(to_f32, spec),
            (_, FloatType::F32) => self.box_runs::<i64, f32>(to_f32, spec),
            (_, FloatType::F64) => self.box_runs::<i64, f64>(|bound| bound, spec),
        }
    }
}

fn returned_failed(action: Option<usize>) -> PyErr {
    PyRuntimeError::new_err(match action {
        Some(action) => format!("step of the environment failed: it returned QTAB_FAILED for action {action}"),
        None => "reset of the environment failed: it returned QTAB_FAILED".into(),
    })
}

/// An environment of another library, as training takes it, with the numbers to subtract from those of an observation.
pub(super) struct SharedExternalEnv {
    pub(super) env: Arc<ExternalEnv>,
    pub(super) first: Vec<i64>,
    /// The spaces, for a vector environment.
    pub(super) spaces: Option<PySpaces>,
}

impl NativeEnv for SharedExternalEnv {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        self.env.build_runs(&self.first, spec)
    }

    fn vector_env(&self, py: Python<'_>, options: VectorOptions) -> PyResult<Option<Box<dyn DynVectorEnv>>> {
        let Some(spaces) = &self.spaces else { return Ok(None) };
        let envs = ExternalVectorEnv::new(py, SharedEnv(Arc::clone(&self.env)), spaces, options)?;
        Ok(Some(Box::new(envs)))
    }
}
