//! A Gymnasium environment stepped in Python, as a learner's task.

use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::checkpoint::{Checkpoint, CheckpointError, Persist};
use qtab_core::features::MAX_TILINGS;
use qtab_core::numeric::Float;
use qtab_core::prediction::ObservableTask;
use qtab_core::tasks::{Next, RngSnapshot, Transition};
use qtab_core::{Features, StopFlag, Task};

use super::answers::{self, Answer};
use super::generic::boxed_run;
use super::prediction::observed_run;
use super::python_env::PythonEnv;
use super::{AnyRecordings, BuiltRun};
use crate::convert::{BoxReader, ObservationReader, Seed};
use crate::error::RunError;
use crate::spec::{BoxFeatures, DiscretizerSpec, FloatType, PolicyFeatures, PredictionSpec, RunSpec, match_capacity};

/// The number of Q-learning steps on a grid that one step in Python counts as. It may take a millisecond.
const STEP_WORK: u64 = 127;

/// The parts from which a run that steps a Python environment is built. Only this function needs the interpreter.
pub(crate) fn python_task<'a>(
    py: Python<'_>,
    mut env: PythonEnv,
    spec: &'a RunSpec,
    seed: &'a Seed,
) -> PyResult<PythonTaskBuilder<'a>> {
    env.keep_actions(py, spec.num_actions)?;
    Ok(PythonTaskBuilder { env, first_seed: seed.to_python(py)?.unbind(), spec, seed })
}

pub(crate) struct PythonTaskBuilder<'a> {
    env: PythonEnv,
    first_seed: Py<PyAny>,
    spec: &'a RunSpec,
    seed: &'a Seed,
}

impl PythonTaskBuilder<'_> {
    /// Builds the run. Slow construction stops when `stop` is set.
    pub(crate) fn build(self, stop: &StopFlag<'_>) -> PyResult<BuiltRun> {
        let spec = self.spec;
        if let DiscretizerSpec::Identity(reader) = &spec.discretizer {
            return self.run(reader.clone(), reader.n_rows(), stop);
        }
        if let DiscretizerSpec::Product(product) = &spec.discretizer {
            let reader = BoxReader::<f64, _>::new(product.features.clone(), product.dimensions);
            return self.run(reader, product.n_rows(), stop);
        }
        match spec.discretizer.box_space()? {
            (FloatType::F32, dimensions) => self.box_run(|bound| bound as f32, dimensions, stop),
            (FloatType::F64, dimensions) => self.box_run(|bound| bound, dimensions, stop),
        }
    }

    /// A run with the observations of a Box of dtype `T`.
    fn box_run<T>(self, to_dtype: impl Fn(f64) -> T, dimensions: usize, stop: &StopFlag<'_>) -> PyResult<BuiltRun>
    where
        T: Float + Default + numpy::Element + 'static,
    {
        if let Some(prediction) = self.spec.prediction_by_observation() {
            return self.observed_run(prediction, to_dtype, dimensions, stop);
        }
        if let DiscretizerSpec::Tiles(tiles) = &self.spec.discretizer {
            let tiles = tiles.tile_coding::<T, MAX_TILINGS>();
            let n_rows = Features::<[T]>::len(&tiles);
            return self.run(BoxReader::new(tiles, dimensions), n_rows, stop);
        }
        if let DiscretizerSpec::Weighted(features) = &self.spec.discretizer {
            let n_rows = features.n_features();
            return match_capacity!(
                n_rows,
                ROOM => self.run(BoxReader::new(features.basis::<T, ROOM>()?, dimensions), n_rows, stop)
            );
        }
        let grid = self.spec.discretizer.grid(to_dtype)?;
        let n_rows = Features::<[T]>::len(&grid);
        self.run(BoxReader::new(grid, dimensions), n_rows, stop)
    }

    /// A run that estimates the values of a policy that reads the observations.
    fn observed_run<T>(
        self,
        prediction: &PredictionSpec,
        to_dtype: impl Fn(f64) -> T,
        dimensions: usize,
        stop: &StopFlag<'_>,
    ) -> PyResult<BuiltRun>
    where
        T: Float + Default + numpy::Element + 'static,
    {
        let (spec, seed) = (self.spec, self.seed);
        let policies = prediction
            .policies(spec, |own| PyResult::Ok(BoxReader::new(PolicyFeatures::new(own, &to_dtype)?, dimensions)))?;
        let run = if let DiscretizerSpec::Weighted(weighted) = &spec.discretizer {
            match_capacity!(weighted.n_features(), ROOM => {
                let task = self.observed_task(BoxReader::new(weighted.basis::<T, ROOM>()?, dimensions));
                observed_run(task, policies, seed, spec, prediction, stop)?
            })
        } else {
            let features = BoxFeatures::new(&spec.discretizer, &to_dtype)?;
            let task = self.observed_task(BoxReader::new(features, dimensions));
            observed_run(task, policies, seed, spec, prediction, stop)?
        };
        Ok(BuiltRun { run, recordings: AnyRecordings::None, steps_python: true })
    }

    /// A task that keeps its last observation for a policy.
    fn observed_task<R>(self, reader: R) -> PythonTask<R> {
        PythonTask { keeps_observation: true, ..self.task(reader) }
    }

    fn task<R>(self, reader: R) -> PythonTask<R> {
        let (max_episode_steps, mask) = (self.spec.max_episode_steps, vec![true; self.spec.num_actions]);
        let Self { env, first_seed, .. } = self;
        PythonTask {
            env,
            first_seed,
            seeded: false,
            max_episode_steps,
            reader,
            mask,
            keeps_observation: false,
            last_observation: None,
        }
    }

    fn run<R>(self, reader: R, n_rows: usize, stop: &StopFlag<'_>) -> PyResult<BuiltRun>
    where
        R: ObservationReader<Active: Send> + Send + 'static,
    {
        let Self { spec, seed, .. } = self;
        let shape = (n_rows, spec.discretizer.n_active());
        let task = self.task(reader);
        let (run, recordings) = boxed_run(task, shape, seed, spec, stop, AnyRecordings::Python)?;
        Ok(BuiltRun { run, recordings, steps_python: true })
    }
}

struct PythonTask<R> {
    env: PythonEnv,
    /// The seed of the first reset, a Python integer.
    first_seed: Py<PyAny>,
    seeded: bool,
    max_episode_steps: u64,
    reader: R,
    /// The actions available in the last state, if the environment has action masks.
    mask: Vec<bool>,
    /// Whether a policy reads the observations, so that the last one is stored.
    keeps_observation: bool,
    last_observation: Option<Py<PyAny>>,
}

impl<R: ObservationReader> ObservableTask for PythonTask<R> {
    type Observation = Py<PyAny>;

    fn observation(&self, _elapsed: &u64) -> Py<PyAny> {
        Python::attach(|py| self.last_observation.as_ref().map_or_else(|| py.None(), |last| last.clone_ref(py)))
    }
}

impl<R: ObservationReader> Task for PythonTask<R> {
    /// The steps taken since the reset.
    type State = u64;
    type Active = R::Active;
    type Error = RunError;

    fn reset(&mut self) -> Result<(u64, R::Active), RunError> {
        Python::attach(|py| {
            let answer = self.env.reset(py, (!self.seeded).then_some(&self.first_seed))?;
            self.seeded = true;
            let env = self.env.bind(py);
            let (observation, info) = answers::of_reset(env, &answer)?;
            let rows = self.reader.active_rows(&observation)?;
            if self.keeps_observation {
                self.last_observation = Some(observation.clone().unbind());
            }
            self.env.masks.read((env, "reset"), &observation, &info, &mut self.mask)?;
            Ok((0, rows))
        })
    }

    fn step(&mut self, elapsed: &mut u64, action: usize) -> Result<Transition<R::Active>, RunError> {
        Python::attach(|py| {
            let answer = self.env.step(py, action)?;
            let env = self.env.bind(py);
            let Answer { observation, reward, terminated, truncated, info } = Answer::of_step(env, &answer)?;
            *elapsed += 1;
            let rows = self.reader.active_rows(&observation)?;
            if self.keeps_observation {
                self.last_observation = Some(observation.to_owned().unbind());
            }
            if terminated {
                // No action is chosen in a terminal state, whose mask may have none left.
                return Ok(Transition { reward, next: Next::Terminal });
            }
            if !self.env.masks.is_none() {
                self.env.masks.read((env, "step"), &observation, &info, &mut self.mask)?;
            }
            let next = if truncated || *elapsed >= self.max_episode_steps {
                Next::Truncated(rows)
            } else {
                Next::NonTerminal(rows)
            };
            Ok(Transition { reward, next })
        })
    }

    fn action_mask(&self) -> Option<&[bool]> {
        (!self.env.masks.is_none()).then_some(&self.mask)
    }

    fn step_work(&self) -> u64 {
        STEP_WORK
    }

    fn active_rows(&self, _elapsed: &u64) -> Result<R::Active, RunError> {
        unreachable!("a checkpoint within an episode of a Python environment is refused before this")
    }

    fn resumes_episodes(&self) -> bool {
        false
    }

    /// Whether the environment was seeded. The caller must restore its generator.
    fn persist(&mut self, _state: Option<&mut u64>, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.seeded.persist(checkpoint)
    }
}

/// The state of the environment's bit generator, a dict; before the first reset, the seed.
impl<R: ObservationReader> RngSnapshot for PythonTask<R> {
    type Snapshot = Py<PyAny>;

    fn rng_snapshot(&self) -> Result<Py<PyAny>, RunError> {
        Python::attach(|py| {
            if !self.seeded {
                return Ok(self.first_seed.clone_ref(py));
            }
            let env = self.env.bind(py);
            let generator = env.getattr(intern!(py, "unwrapped"))?.getattr(intern!(py, "np_random"))?;
            Ok(generator.getattr(intern!(py, "bit_generator"))?.getattr(intern!(py, "state"))?.unbind())
        })
    }
}
