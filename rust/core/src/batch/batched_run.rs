//! The trait of runs that can be trained in batches.

use super::BatchRule;
use super::batch_loop::BatchLoop;
use crate::envs::{Env, SimdEnv};
use crate::errors::TrainingError;
use crate::features::{BatchFeatures, Features, OutOfBounds};
use crate::learners::{Agent, Learner, TdLearner, UpdateRule};
use crate::policies::EpsilonGreedy;
use crate::random::{Pcg64, Rng};
use crate::schedules::StepSize;
use crate::simd::SimdLevel;
use crate::tasks::{NativeTask, Task};
use crate::trainer::{Budget, Trainer};

/// With rewards of at most 1 per step, the values of single rows below this bound cannot reach infinity. Sums over
/// several rows can, so a batch checks the errors of those.
const FAR_FROM_OVERFLOW: f64 = 1e300;

/// An ε-greedy one-step learner with `N` actions. It can be trained in a batch if its update rule `U` is a
/// [`BatchRule`](super::BatchRule), its environment `E` steps in SIMD lanes and its features `F` are
/// [`BatchFeatures`](crate::features::BatchFeatures).
pub type SimdTrainer<E, F, const N: usize, A, U> =
    Trainer<NativeTask<E, F>, TdLearner<U, Agent<N, EpsilonGreedy, A>>, Pcg64>;

/// A run that can be trained together with others of its type.
pub trait BatchedRun: Sized {
    /// Advances every run by up to `budget.work` steps, until one of them has finished `budget.episodes` episodes.
    /// Afterwards each run is in the state that it would have reached in as many steps alone, and it can be continued
    /// alone or in any batch.
    ///
    /// Runs that differ in more than their seeds, tables and learning rates advance one after the other. So do those
    /// whose learning rates depend on visits, and all runs once one of them has diverged or reaches an observation
    /// without a row.
    ///
    /// # Errors
    /// As [`Trainer::advance`](crate::Trainer::advance), with the index of the first run that failed. The others can be
    /// continued.
    fn advance_all<const K: usize>(
        runs: &mut [Self; K],
        budget: Budget,
    ) -> Result<(), (usize, TrainingError<OutOfBounds>)>;
}

impl<E, F, A, U, const N: usize, const M: usize> BatchedRun for SimdTrainer<E, F, N, A, U>
where
    E: SimdEnv<M> + Env<Observation = [f32; M]>,
    F: BatchFeatures<M>,
    A: StepSize,
    U: BatchRule + UpdateRule<F::Active, Agent<N, EpsilonGreedy, A>>,
{
    fn advance_all<const K: usize>(
        runs: &mut [Self; K],
        budget: Budget,
    ) -> Result<(), (usize, TrainingError<OutOfBounds>)> {
        advance_all_at(SimdLevel::detect(), runs, budget)
    }
}

/// [`BatchedRun::advance_all`] at one SIMD level.
pub(super) fn advance_all_at<E, F, A, U, const N: usize, const M: usize, const K: usize>(
    level: SimdLevel,
    runs: &mut [SimdTrainer<E, F, N, A, U>; K],
    budget: Budget,
) -> Result<(), (usize, TrainingError<OutOfBounds>)>
where
    E: SimdEnv<M> + Env<Observation = [f32; M]>,
    F: BatchFeatures<M>,
    A: StepSize,
    U: BatchRule + UpdateRule<F::Active, Agent<N, EpsilonGreedy, A>>,
{
    if runs.iter().any(|run| run.episodes.returns.len() >= budget.episodes) {
        return check_divergence(runs);
    }
    for (lane, run) in runs.iter_mut().enumerate() {
        run.reserve(budget).map_err(|error| (lane, error.into()))?;
    }
    let mut work = budget.work;
    if runs[0].task.env.is_exact() && runs.iter().all(|run| compatible(run, &runs[0])) {
        let advanced = level.run(BatchLoop { runs, budget });
        work = advanced.map_err(|(lane, error)| (lane, TrainingError::Task(error)))?;
    }
    let mut lanes = runs.iter_mut().enumerate();
    lanes.try_for_each(|(lane, run)| run.advance_or_stop(Budget { work, ..budget }).map_err(|error| (lane, error)))?;
    check_divergence(runs)
}

/// The error of the first run that has diverged.
fn check_divergence<T: Task, L: Learner<T::Active>, R: Rng + Clone>(
    runs: &[Trainer<T, L, R>],
) -> Result<(), (usize, TrainingError<T::Error>)> {
    runs.iter().enumerate().try_for_each(|(lane, run)| run.check_divergence().map_err(|error| (lane, error)))
}

/// Whether two runs share everything that a batch reads only once, and the first has neither diverged nor come near an
/// overflow.
fn compatible<E, F, A, U, const N: usize>(one: &SimdTrainer<E, F, N, A, U>, other: &SimdTrainer<E, F, N, A, U>) -> bool
where
    E: Env<Action = usize> + PartialEq,
    F: Features<E::Observation> + PartialEq,
    A: StepSize,
{
    let (task, agent) = (&one.task, &one.learner.agent);
    let other_agent = &other.learner.agent;
    task.env == other.task.env
        && task.features == other.task.features
        && task.max_episode_steps == other.task.max_episode_steps
        && agent.discount == other_agent.discount
        && agent.terminal_update == other_agent.terminal_update
        && agent.learning_rate.uniform().is_some()
        && !agent.table.diverged()
        && agent.table.values().len() == other_agent.table.values().len()
        && agent.table.values().iter().all(|value| value.abs() < FAR_FROM_OVERFLOW)
}
