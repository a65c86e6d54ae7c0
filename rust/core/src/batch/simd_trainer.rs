//! The runs that are trained in batches, and when they can be.

use super::BatchedRun;
use super::batch_loop::BatchLoop;
use crate::envs::{Env, SimdEnv};
use crate::features::{BatchFeatures, Features, OutOfBounds};
use crate::learners::{Agent, QLearning, TdLearner};
use crate::policies::EpsilonGreedy;
use crate::random::Pcg64;
use crate::schedules::StepSize;
use crate::tasks::NativeTask;
use crate::trainer::{Budget, Trainer};

/// With rewards of at most 1 per step, values below this bound cannot reach infinity, so a batch need not check for
/// divergence.
const FAR_FROM_OVERFLOW: f64 = 1e300;

/// ε-greedy Q-learning with `N` actions, on a grid, in an environment whose physics run in SIMD lanes.
pub type SimdTrainer<E, F, const N: usize, A> =
    Trainer<NativeTask<E, F>, TdLearner<QLearning, Agent<N, EpsilonGreedy, A>>, Pcg64>;

impl<E, F, A, const N: usize, const M: usize> BatchedRun for SimdTrainer<E, F, N, A>
where
    E: SimdEnv<M> + Env<Observation = [f32; M]>,
    F: BatchFeatures<M>,
    A: StepSize,
{
    fn advance_all<const K: usize>(runs: &mut [Self; K], budget: Budget) -> Result<(), (usize, OutOfBounds)> {
        if runs.iter().any(|run| run.episodes.returns.len() >= budget.episodes) {
            return Ok(());
        }
        let mut steps = budget.steps;
        if runs[0].task.env.is_exact() && runs.iter().all(|run| compatible(run, &runs[0])) {
            steps = pulp::Arch::new().dispatch(BatchLoop { runs, budget })?;
        }
        let mut lanes = runs.iter_mut().enumerate();
        lanes.try_for_each(|(lane, run)| run.advance(Budget { steps, ..budget }).map_err(|error| (lane, error)))
    }
}

/// Whether two runs share all that a batch reads once, and neither can overflow.
fn compatible<E, F, A, const N: usize>(one: &SimdTrainer<E, F, N, A>, other: &SimdTrainer<E, F, N, A>) -> bool
where
    E: Env<Action = usize> + PartialEq,
    F: Features<E::Observation> + PartialEq,
{
    let (task, agent) = (&one.task, &one.learner.agent);
    let other_agent = &other.learner.agent;
    task.env == other.task.env
        && task.features == other.task.features
        && task.max_episode_steps == other.task.max_episode_steps
        && agent.discount == other_agent.discount
        && agent.terminal_update == other_agent.terminal_update
        && agent.table.values().len() == other_agent.table.values().len()
        && agent.table.values().iter().all(|value| value.abs() < FAR_FROM_OVERFLOW)
}
