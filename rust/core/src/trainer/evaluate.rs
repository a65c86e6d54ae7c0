//! Evaluation: episodes of a fixed policy, without learning.

use std::error::Error;
use std::fmt;

use super::{EpisodeLog, Trainer};
use crate::envs::Env;
use crate::features::{Features, OutOfBounds};
use crate::learners::Learner;
use crate::policies::GreedyPolicy;
use crate::random::{Pcg64, Rng, SeedSequence};
use crate::tasks::{NativeTask, Next, Task};

/// Why an evaluation failed. `E` is the task's error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum EvaluationError<E> {
    /// The task failed.
    Task(E),
    /// The task has no time limit, and a greedy policy need not end an episode.
    NoTimeLimit,
    /// The policy has another number of actions or of rows than the task.
    Shape {
        /// The rows and actions of the task.
        expected: (usize, usize),
        /// The rows and actions of the policy.
        got: (usize, usize),
    },
}

impl<E: fmt::Display> fmt::Display for EvaluationError<E> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Task(error) => write!(formatter, "the task failed: {error}"),
            Self::NoTimeLimit => write!(
                formatter,
                "the task has no time limit, and a greedy policy need not end an episode: build the run with \
                 max_episode_steps, or call qtab_core::evaluate with max_steps"
            ),
            Self::Shape { expected, got } => write!(
                formatter,
                "the policy must have {} rows of {} actions, as the task has, got {} of {}",
                expected.0, expected.1, got.0, got.1
            ),
        }
    }
}

impl<E: Error + 'static> Error for EvaluationError<E> {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        if let Self::Task(error) = self { Some(error) } else { None }
    }
}

/// Plays episodes with a greedy policy, each until it ends or has taken `max_steps` steps (at least 1).
///
/// # Errors
/// The task's error, or `Shape` for the policy of another task.
pub fn evaluate<T: Task>(
    task: &mut T,
    policy: &GreedyPolicy,
    episodes: usize,
    max_steps: u64,
) -> Result<EpisodeLog, EvaluationError<T::Error>> {
    if let Some(expected) = task.shape().filter(|&shape| shape != policy.shape()) {
        return Err(EvaluationError::Shape { expected, got: policy.shape() });
    }
    let mut log = EpisodeLog::default();
    for _ in 0..episodes {
        let (episode_return, length, terminated) = episode(task, policy, max_steps).map_err(EvaluationError::Task)?;
        log.push(episode_return, length, terminated);
    }
    Ok(log)
}

/// The return and the length of an episode, and whether it ended in a terminal state.
fn episode<T: Task>(task: &mut T, policy: &GreedyPolicy, max_steps: u64) -> Result<(f64, i64, bool), T::Error> {
    let (mut state, mut active) = task.reset()?;
    let (mut episode_return, mut length) = (0.0, 0);
    loop {
        let action = match task.action_mask() {
            Some(mask) => policy.action_among(active, mask),
            None => policy.action(active),
        };
        let transition = task.step(&mut state, action)?;
        episode_return += transition.reward;
        length += 1;
        match transition.next {
            Next::Terminal => return Ok((episode_return, length, true)),
            Next::NonTerminal(next) if length.cast_unsigned() < max_steps => active = next,
            Next::NonTerminal(_) | Next::Truncated(_) => return Ok((episode_return, length, false)),
        }
    }
}

impl<E, F, L, R> Trainer<NativeTask<E, F>, L, R>
where
    E: Env<Action = usize>,
    F: Features<E::Observation>,
    L: Learner<F::Active>,
    R: Rng + Clone,
{
    /// Plays episodes with the greedy policy in the environment with this seed. Nothing is learned, and the
    /// run does not change.
    ///
    /// # Errors
    /// `NoTimeLimit` if the task has none, or an observation without a row.
    pub fn evaluate(&self, episodes: usize, seed: u64) -> Result<EpisodeLog, EvaluationError<OutOfBounds>> {
        let max_steps = self.task.max_episode_steps().ok_or(EvaluationError::NoTimeLimit)?;
        let rng = Pcg64::new(&SeedSequence::from(seed));
        let mut task = NativeTask::new(self.task.env(), self.task.features(), Some(max_steps), rng);
        evaluate(&mut task, &self.greedy_policy(), episodes, max_steps)
    }

    /// The greedy action for an observation. For many observations, [`greedy_policy`](Self::greedy_policy) is faster.
    ///
    /// # Errors
    /// An observation without a row.
    pub fn predict(&self, observation: &E::Observation) -> Result<usize, OutOfBounds> {
        Ok(self.greedy_policy().action(self.task.features().active_rows(observation)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::tabular::{Outcome, TabularMdp};
    use crate::features::Identity;

    /// A corridor of three states: action 1 moves right, and the last move ends the episode.
    fn corridor(max_episode_steps: Option<u64>) -> NativeTask<TabularMdp, Identity> {
        let to = |state: i64, terminated| vec![Outcome { probability: 1.0, state, reward: -1.0, terminated }];
        let pairs = [to(0, false), to(1, false), to(0, false), to(2, true), to(2, true), to(2, true)];
        let table = TabularMdp::new(2, &[1.0, 0.0, 0.0], &pairs).expect("a valid table");
        NativeTask::new(table, Identity(3), max_episode_steps, Pcg64::new(&SeedSequence::from(0)))
    }

    #[test]
    fn a_policy_is_played_until_the_end_or_the_limit() {
        let right = GreedyPolicy::new(&[&[0.0, 1.0, 0.0, 1.0, 0.0, 0.0]], 2, None);
        let log = evaluate(&mut corridor(None), &right, 2, 10).expect("all states have rows");
        assert_eq!((log.returns, log.lengths, log.terminated), (vec![-2.0; 2], vec![2; 2], vec![true; 2]));
        let left = GreedyPolicy::new(&[&[0.0; 6]], 2, None);
        for (limit, max_steps) in [(None, 5), (Some(5), 9)] {
            let log = evaluate(&mut corridor(limit), &left, 1, max_steps).expect("all states have rows");
            assert_eq!((log.lengths, log.terminated), (vec![5], vec![false]));
        }
    }

    #[test]
    fn the_policy_of_another_task_is_refused() {
        let other = GreedyPolicy::new(&[&[0.0; 6]], 3, None);
        let error = evaluate(&mut corridor(None), &other, 1, 1).expect_err("two rows of three actions");
        assert_eq!(error.to_string(), "the policy must have 3 rows of 2 actions, as the task has, got 2 of 3");
    }
}
