//! A run from checked settings.

use super::checks::Shape;
use super::{AnyTrainer, InitialValues, TrainerBuilder};
use crate::checkpoint::RunIdentity;
use crate::envs::Env;
use crate::errors::BuildError;
use crate::features::{ActiveFeatures, Features};
use crate::learners::{Agent, AnyAlgorithm, AnyLearner};
use crate::memory::{filled, from_fn};
use crate::q_table::QTable;
use crate::random::{AgentRng, Pcg64, Rng, SeedSequence};
use crate::schedules::LearningRate;
use crate::stop_flag::StopFlag;
use crate::tasks::NativeTask;
use crate::trainer::Trainer;

impl<E, F> TrainerBuilder<E, F>
where
    E: Env<Action = usize>,
    F: Features<E::Observation>,
{
    /// Checks the settings and makes the run.
    ///
    /// # Errors
    /// - `Invalid` for a setting that is invalid or does not fit the others; the error names it. This includes features
    ///   without a row for the first observation.
    /// - `Allocation` if the tables do not fit into memory.
    pub fn build(self) -> Result<AnyTrainer<E, F>, BuildError> {
        let seed = SeedSequence::from(self.seed);
        let env_rng = Pcg64::new(&seed);
        let shape = self.shape(env_rng.clone())?;
        self.check(shape)?;
        let mut rng = AgentRng::pcg64(&seed);
        let stop = StopFlag::new();
        let episodes = self.episodes.unwrap_or(u64::MAX);
        let table_shape = (shape.rows, shape.actions);
        let agent = Agent {
            table: self.table(shape, &mut rng)?,
            policy: self.policy.build(episodes, table_shape, false, &stop)?,
            learning_rate: self.built_learning_rate(shape, &stop)?,
            discount: self.discount,
            terminal_update: self.terminal_update,
            masks: None,
        };
        let second_table = match self.algorithm.n_tables() {
            1 => None,
            _ if self.algorithm.value_learning_rate().is_some() => {
                Some(QTable::new(filled(&0.0, shape.rows * shape.actions, &stop)?, shape.actions))
            }
            _ => Some(self.table(shape, &mut rng)?),
        };
        let learner = AnyLearner::new(self.algorithm_with_limit(), agent, second_table, &stop)?;
        let Some(learner) = learner else {
            // Active rows that may be several, although they are one now.
            let expected = "[u32; 1], the active rows of a grid, for this algorithm";
            return Err(BuildError::invalid("the active rows of the features", expected, "a type for several rows"));
        };
        let identity = self.identity();
        let task = NativeTask::new(self.env, self.features, self.max_episode_steps, env_rng);
        let mut trainer = Trainer::try_new(task, learner, rng)?;
        trainer.identity = identity;
        Ok(trainer)
    }

    fn built_learning_rate(&self, shape: Shape, stop: &StopFlag<'_>) -> Result<LearningRate, BuildError> {
        let episodes = self.episodes.unwrap_or(u64::MAX);
        if F::Active::WEIGHTED {
            let rate = self.learning_rate.build_weighted(episodes, self.features.step_size_divisors());
            return rate.ok_or_else(|| {
                BuildError::invalid("learning_rate", "a schedule with weighted features", "one by visits")
            });
        }
        Ok(self.learning_rate.build(episodes, shape.rows * shape.actions, shape.n_active, stop)?)
    }

    /// The shape of the tables, from the features, the environment and its first observation.
    fn shape(&self, mut rng: Pcg64) -> Result<Shape, BuildError> {
        let (rows, actions) = (self.features.len(), self.env.num_actions());
        let fits = |count: usize| count > 0 && u32::try_from(count).is_ok();
        BuildError::check(fits(actions), "the number of actions", "at least 1 and less than 2**32", actions)?;
        self.features.check()?;
        BuildError::check(fits(rows), "the number of rows of the features", "from 1 to 2**32 - 1", rows)?;
        let observation = self.env.observe(&self.env.reset(&mut rng));
        match self.features.active_rows(&observation) {
            Ok(active) => Ok(Shape { rows, actions, n_active: active.as_ref().len(), weighted: F::Active::WEIGHTED }),
            Err(error) => Err(BuildError::invalid("features", "with a row for every observation", error)),
        }
    }

    /// The settings, by which a checkpoint of other settings is refused. The initial values are not among them, because
    /// a checkpoint replaces them.
    fn identity(&self) -> RunIdentity {
        let mut identity = RunIdentity::default();
        identity.add("algorithm", format_args!("{:?}", self.algorithm_with_limit()));
        identity.add("policy", format_args!("{:?}", self.policy));
        identity.add("learning_rate", format_args!("{:?}", self.learning_rate));
        identity.add("discount", self.discount);
        identity.add("terminal_update", format_args!("{:?}", self.terminal_update));
        identity.add("max_episode_steps", format_args!("{:?}", self.max_episode_steps));
        identity.add("episodes", format_args!("{:?}", self.episodes));
        identity.add("seed", self.seed);
        identity
    }

    /// A table with the initial values.
    fn table(&self, shape: Shape, rng: &mut impl Rng) -> Result<QTable, BuildError> {
        let (size, stop) = (shape.rows * shape.actions, StopFlag::new());
        let values = match &self.initial_values {
            InitialValues::Constant(value) => filled(value, size, &stop)?,
            &InitialValues::Uniform { low, high } => from_fn(size, &stop, || rng.uniform(low, high))?,
            InitialValues::Table(table) => {
                let mut values = table.values().iter().copied();
                from_fn(size, &stop, || values.next().unwrap_or_default())?
            }
        };
        Ok(QTable::new(values, shape.actions))
    }

    /// The algorithm with the time limit of the run.
    fn algorithm_with_limit(&self) -> AnyAlgorithm {
        self.algorithm.with_time_limit(self.max_episode_steps.unwrap_or(u64::MAX))
    }
}
