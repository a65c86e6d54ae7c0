//! An environment with its features, behind one type: it makes the runs and evaluates their values.

use std::sync::{Arc, PoisonError};

use qtab_core::features::{ActiveFeatures, ActiveRows, FeatureVector, Features, FourierBasis, Identity, OutOfBounds};
use qtab_core::learners::TransformedSteps;
use qtab_core::random::{Pcg64, SeedSequence};
use qtab_core::tasks::{BoxedTask, NativeTask, VisitCounter};
use qtab_core::{Env, StopFlag, Trainer};

use crate::environment::{Environment, NumberedBlackjack};
use crate::failure::Failure;
use crate::learners::AnyLearner;
use crate::learners::greedy::{Episode, StateFeatures, greedy_action};
use crate::map::Cells;
use crate::runs::run::Run;
use crate::runs::shown_task::{CellVisits, ShownTask};
use crate::runs::unsaved::Unsaved;
use crate::settings::{Discretizer, MAX_FEATURES, Settings};
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

/// What the page shows of a run besides its results: the visits to the cells of its map, and the updates of a state.
pub(crate) struct Shown<'a> {
    pub(crate) cells: &'a Arc<Cells>,
    pub(crate) watch: Option<Watch>,
}

/// An environment with its features, of any types.
pub(crate) trait Subject {
    fn num_actions(&self) -> usize;

    fn n_rows(&self) -> usize;

    /// A run with a seed. If it is shown, its visits are counted, and a watch receives its updates.
    fn run(&self, settings: &Settings, seed: u32, shown: Option<Shown<'_>>) -> Result<StartedRun, Failure>;

    /// The observation of the first state of a run with a seed.
    fn first_observation(&self, seed: u32) -> Vec<f64>;

    /// The features of an observation; `None` if it is outside the table.
    fn features(&self, observation: &[f64]) -> Option<StateFeatures>;

    /// An episode of the greedy policy for the sum of the tables, from the first state of the seed's first episode.
    fn greedy_episode(&self, tables: &[&[f64]], seed: u32, max_steps: u64) -> Option<Episode>;
}

struct EnvWithFeatures<E, F> {
    env: E,
    features: F,
}

/// The subject of an environment and its discretizer; `None` if they do not fit.
pub(crate) fn subject(environment: &Environment, discretizer: &Discretizer) -> Option<Box<dyn Subject>> {
    Some(match (environment, discretizer) {
        (Environment::Table(mdp, _) | Environment::Taxi(mdp), Discretizer::Identity) => {
            let features = Identity(u32::try_from(mdp.num_states()).ok()?);
            Box::new(EnvWithFeatures { env: mdp.clone(), features })
        }
        (&Environment::Blackjack(env), Discretizer::Identity) => {
            Box::new(EnvWithFeatures { env, features: Identity(NumberedBlackjack::NUM_STATES) })
        }
        (&Environment::MountainCar(env), _) => of_floats(env, discretizer)?,
        (&Environment::CartPole(env), _) => of_floats(env, discretizer)?,
        (&Environment::Acrobot(env), _) => of_floats(env, discretizer)?,
        _ => return None,
    })
}

/// A Fourier basis whose features are computed by one function for all environments: inlined in their steps, it would make
/// the module larger.
#[derive(Clone)]
struct CompactFourier(FourierBasis<f32, MAX_FEATURES>);

impl CompactFourier {
    #[inline(never)]
    fn write(&self, observation: &[f32], active: &mut FeatureVector<MAX_FEATURES>) -> Result<(), OutOfBounds> {
        self.0.write_active_rows(observation, active)
    }
}

impl<const D: usize> Features<[f32; D]> for CompactFourier {
    type Active = FeatureVector<MAX_FEATURES>;

    fn active_rows(&self, observation: &[f32; D]) -> Result<Self::Active, OutOfBounds> {
        let Some(mut active) = FeatureVector::zeros(self.0.n_features()) else {
            unreachable!("the constructor has checked the capacity")
        };
        self.write(observation, &mut active)?;
        Ok(active)
    }

    #[inline]
    fn write_active_rows(&self, observation: &[f32; D], active: &mut Self::Active) -> Result<(), OutOfBounds> {
        self.write(observation, active)
    }

    fn len(&self) -> usize {
        self.0.n_features()
    }
}

/// The subject of an environment whose observations are numbers.
fn of_floats<E, const M: usize>(env: E, discretizer: &Discretizer) -> Option<Box<dyn Subject>>
where
    E: Env<Action = usize, Observation = [f32; M], State: Send> + Clone + Send + 'static,
{
    Some(match discretizer {
        Discretizer::Identity => return None,
        Discretizer::Grid(grid) => Box::new(EnvWithFeatures { env, features: grid.features.clone() }),
        Discretizer::Tiles { features, .. } => Box::new(EnvWithFeatures { env, features: (**features).clone() }),
        Discretizer::Fourier { features, .. } => {
            Box::new(EnvWithFeatures { env, features: CompactFourier(features.clone()) })
        }
    })
}

/// A run of a task. It depends on the features alone, so that the module has it once for all environments.
#[inline(never)]
fn run_of<R: ActiveRows + Send + 'static>(
    task: BoxedTask<R, Failure>,
    settings: &Settings,
    seed: u32,
    shape: (usize, usize),
    watch: Option<Watch>,
) -> Result<Box<dyn Run>, Failure> {
    let mut rng = settings.rng(seed);
    let (agent, second_table) = settings.agent(shape, &mut rng)?;
    let learner = AnyLearner::<R>::new(settings.algorithm, shape, agent, second_table, &StopFlag::new())?;
    let learner = TransformedSteps { learner, terminate: settings.terminate_on_truncation, bonus: None };
    Ok(Box::new(Trainer::new(task, UpdateRecorder::new(learner, watch), rng)))
}

#[inline(never)]
fn features_of<O, F: Features<O>>(features: &F, observation: &O) -> Option<StateFeatures> {
    features.active_rows(observation).ok().map(|features| StateFeatures::of(&features))
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

    fn run(&self, settings: &Settings, seed: u32, shown: Option<Shown<'_>>) -> Result<StartedRun, Failure> {
        let (stop, shape) = (StopFlag::new(), (self.n_rows(), self.num_actions()));
        let env_rng = Pcg64::new(&SeedSequence::new(&[seed]));
        let limit = Some(settings.max_episode_steps);
        let task = NativeTask::new(self.env.clone(), self.features.clone(), limit, env_rng);
        let mut last_state = Arc::default();
        let mut watch = None;
        let task: BoxedTask<F::Active, Failure> = if let Some(shown) = shown {
            watch = shown.watch;
            let mut task = ShownTask::new(self.env.clone(), task);
            last_state = task.last_state();
            if F::Active::WEIGHTED {
                // All rows are active in every state, so the cells of the map are counted.
                let left = watch.as_ref().and_then(Watch::cell_left);
                task.visits = Some(CellVisits::new(shown.cells, shape.1, left, &stop)?);
                BoxedTask::new(Unsaved(task))
            } else {
                BoxedTask::new(Unsaved(VisitCounter::new(task, shape.0, shape.1, &stop)?))
            }
        } else {
            BoxedTask::new(Unsaved(task))
        };
        let run = run_of(task, settings, seed, shape, watch)?;
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

    fn features(&self, observation: &[f64]) -> Option<StateFeatures> {
        features_of(&self.features, &E::Observation::of(observation)?)
    }

    fn greedy_episode(&self, tables: &[&[f64]], seed: u32, max_steps: u64) -> Option<Episode> {
        let mut rng = Pcg64::new(&SeedSequence::new(&[seed]));
        let mut state = self.env.reset(&mut rng);
        let mut episode = Episode::default();
        for _ in 0..max_steps {
            let observation = self.env.observe(&state);
            let features = features_of(&self.features, &observation)?;
            let action = greedy_action(tables, &features, self.num_actions())?;
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
