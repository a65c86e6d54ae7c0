//! An environment with its features, behind one type: it makes the runs and evaluates their values.

use std::sync::{Arc, Mutex, PoisonError};

use qtab_core::checkpoint::{Checkpoint, CheckpointError};
use qtab_core::features::{Features, Identity, OutOfBounds};
use qtab_core::learners::TransformedSteps;
use qtab_core::random::{Pcg64, SeedSequence};
use qtab_core::tasks::{BoxedTask, NativeTask, TimedState, Transition, VisitCounter};
use qtab_core::{Env, StopFlag, Task, Trainer};

use crate::environment::{Environment, NumberedBlackjack};
use crate::failure::Failure;
use crate::learners::AnyLearner;
use crate::learners::greedy::{Episode, greedy_action};
use crate::runs::run::Run;
use crate::settings::{Discretizer, Settings};
use crate::updates::Watch;
use crate::updates::recorder::UpdateRecorder;

/// Observations as numbers.
pub(crate) trait Numbers: Sized {
    fn numbers(&self) -> Vec<f64>;

    /// The observation with these numbers; `None` if their number is wrong.
    fn of(numbers: &[f64]) -> Option<Self>;
}

impl<const M: usize> Numbers for [f32; M] {
    fn numbers(&self) -> Vec<f64> {
        self.iter().map(|&number| number.into()).collect()
    }

    fn of(numbers: &[f64]) -> Option<Self> {
        let numbers: Self = numbers.iter().map(|&number| number as f32).collect::<Vec<_>>().try_into().ok()?;
        Some(numbers)
    }
}

impl Numbers for u32 {
    fn numbers(&self) -> Vec<f64> {
        vec![f64::from(*self)]
    }

    fn of(numbers: &[f64]) -> Option<Self> {
        numbers.first().map(|&number| number as u32)
    }
}

/// A run that has not started, and the state of its environment.
pub(crate) struct StartedRun {
    pub(crate) run: Box<dyn Run>,
    pub(crate) observation: Box<dyn Fn() -> Option<Vec<f64>>>,
}

/// An environment with its features, of any types.
pub(crate) trait Subject {
    fn num_actions(&self) -> usize;

    fn n_rows(&self) -> usize;

    /// A run with a seed. With `shown`, its visits are counted, and `watch` receives its updates.
    fn run(&self, settings: &Settings, seed: u32, shown: bool, watch: Option<Watch>) -> Result<StartedRun, Failure>;

    /// The observation of the first state of a run with a seed.
    fn first_observation(&self, seed: u32) -> Vec<f64>;

    /// The active rows of an observation; `None` if it is outside the table.
    fn active_rows(&self, observation: &[f64]) -> Option<Vec<u32>>;

    /// An episode of the greedy policy for the sum of the tables, from the first state of the seed's first episode.
    fn greedy_episode(&self, tables: &[&[f64]], seed: u32, max_steps: u64) -> Option<Episode>;
}

struct EnvWithFeatures<E, F> {
    env: E,
    features: F,
    n_active: usize,
}

/// The subject of an environment and its discretizer; `None` if they do not fit.
pub(crate) fn subject(environment: &Environment, discretizer: &Discretizer) -> Option<Box<dyn Subject>> {
    let n_active = discretizer.n_active();
    Some(match (environment, discretizer) {
        (Environment::Table(mdp, _) | Environment::Taxi(mdp), Discretizer::Identity) => {
            let features = Identity(u32::try_from(mdp.num_states()).ok()?);
            Box::new(EnvWithFeatures { env: mdp.clone(), features, n_active })
        }
        (&Environment::Blackjack(env), Discretizer::Identity) => {
            Box::new(EnvWithFeatures { env, features: Identity(NumberedBlackjack::NUM_STATES), n_active })
        }
        (&Environment::MountainCar(env), Discretizer::Grid(grid)) => {
            Box::new(EnvWithFeatures { env, features: grid.features.clone(), n_active })
        }
        (&Environment::MountainCar(env), Discretizer::Tiles { features, .. }) => {
            Box::new(EnvWithFeatures { env, features: (**features).clone(), n_active })
        }
        (&Environment::CartPole(env), Discretizer::Grid(grid)) => {
            Box::new(EnvWithFeatures { env, features: grid.features.clone(), n_active })
        }
        (&Environment::CartPole(env), Discretizer::Tiles { features, .. }) => {
            Box::new(EnvWithFeatures { env, features: (**features).clone(), n_active })
        }
        (&Environment::Acrobot(env), Discretizer::Grid(grid)) => {
            Box::new(EnvWithFeatures { env, features: grid.features.clone(), n_active })
        }
        (&Environment::Acrobot(env), Discretizer::Tiles { features, .. }) => {
            Box::new(EnvWithFeatures { env, features: (**features).clone(), n_active })
        }
        _ => return None,
    })
}

impl<E, F> Subject for EnvWithFeatures<E, F>
where
    E: Env<Action = usize, Observation: Numbers, State: Send> + Clone + Send + 'static,
    F: Features<E::Observation, Active: Send + 'static> + Clone + Send + 'static,
{
    fn num_actions(&self) -> usize {
        self.env.num_actions()
    }

    fn n_rows(&self) -> usize {
        self.features.len()
    }

    fn run(&self, settings: &Settings, seed: u32, shown: bool, watch: Option<Watch>) -> Result<StartedRun, Failure> {
        let (stop, shape) = (StopFlag::new(), (self.n_rows(), self.num_actions()));
        let env_rng = Pcg64::new(&SeedSequence::new(&[seed]));
        let limit = Some(settings.max_episode_steps);
        let task = NativeTask::new(self.env.clone(), self.features.clone(), limit, env_rng);
        let last_state = Arc::new(Mutex::new(None));
        let task: BoxedTask<F::Active, Failure> = if shown {
            let task = ShownTask { task, last_state: Arc::clone(&last_state) };
            BoxedTask::new(VisitCounter::new(task, shape.0, shape.1, &stop)?)
        } else {
            BoxedTask::new(task)
        };
        let mut rng = settings.rng(seed);
        let (agent, second_table) = settings.agent(shape, self.n_active, &mut rng)?;
        let algorithm = settings.algorithm;
        let learner = AnyLearner::<F::Active>::new(algorithm, shape, agent, second_table, &stop)?;
        let learner = TransformedSteps { learner, terminate: settings.terminate_on_truncation, bonus: None };
        let run = Box::new(Trainer::new(task, UpdateRecorder::new(learner, watch), rng));
        let env = self.env.clone();
        let observation = move || {
            let state = *last_state.lock().unwrap_or_else(PoisonError::into_inner);
            state.map(|state| env.observe(&state).numbers())
        };
        Ok(StartedRun { run, observation: Box::new(observation) })
    }

    fn first_observation(&self, seed: u32) -> Vec<f64> {
        let state = self.env.reset(&mut Pcg64::new(&SeedSequence::new(&[seed])));
        self.env.observe(&state).numbers()
    }

    fn active_rows(&self, observation: &[f64]) -> Option<Vec<u32>> {
        let observation = E::Observation::of(observation)?;
        self.features.active_rows(&observation).ok().map(|rows| rows.as_ref().to_vec())
    }

    fn greedy_episode(&self, tables: &[&[f64]], seed: u32, max_steps: u64) -> Option<Episode> {
        let mut rng = Pcg64::new(&SeedSequence::new(&[seed]));
        let mut state = self.env.reset(&mut rng);
        let mut episode = Episode::default();
        for _ in 0..max_steps {
            let observation = self.env.observe(&state);
            let rows = self.features.active_rows(&observation).ok()?;
            let action = greedy_action(tables, rows.as_ref(), self.num_actions())?;
            let step = self.env.step(state, action, &mut rng);
            episode.push(observation.numbers(), action, step.reward);
            state = step.state;
            if step.terminated {
                episode.terminated = true;
                break;
            }
        }
        episode.end(self.env.observe(&state).numbers());
        Some(episode)
    }
}

/// A task that exposes the state of its environment after each step.
struct ShownTask<E: Env, F> {
    task: NativeTask<E, F>,
    last_state: Arc<Mutex<Option<E::State>>>,
}

impl<E: Env, F> ShownTask<E, F> {
    fn show(&self, state: E::State) {
        *self.last_state.lock().unwrap_or_else(PoisonError::into_inner) = Some(state);
    }
}

impl<E: Env<Action = usize>, F: Features<E::Observation>> Task for ShownTask<E, F> {
    type State = TimedState<E::State>;
    type Active = F::Active;
    type Error = OutOfBounds;

    fn reset(&mut self) -> Result<(Self::State, F::Active), OutOfBounds> {
        let (state, active) = self.task.reset()?;
        self.show(state.state);
        Ok((state, active))
    }

    #[inline]
    fn step(&mut self, state: &mut Self::State, action: usize) -> Result<Transition<F::Active>, OutOfBounds> {
        let transition = self.task.step(state, action)?;
        self.show(state.state);
        Ok(transition)
    }

    fn active_rows(&self, state: &Self::State) -> Result<F::Active, OutOfBounds> {
        self.task.active_rows(state)
    }

    fn persist(
        &mut self,
        state: Option<&mut Self::State>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        self.task.persist(state, checkpoint)
    }
}
