//! Episodes of the policy that is greedy for values on a grid, and of given actions.

use super::super::PlanningError;
use super::{GridTask, GridValues};
use crate::StopFlag;

/// An episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rollout {
    /// The undiscounted sum of its rewards.
    pub total: f64,
    /// Its number of steps.
    pub steps: u64,
}

/// From each state, an episode of at most `max_steps` steps of the greedy policy, which sees float32 observations.
///
/// # Errors
/// `Stopped` after `stop` was set.
pub fn rollouts<T: GridTask<D>, const D: usize>(
    values: &GridValues<T, D>,
    starts: &[[f64; D]],
    max_steps: u64,
    stop: &StopFlag<'_>,
) -> Result<Vec<Rollout>, PlanningError> {
    let task = values.task();
    let greedy = |state: [f64; D]| values.best_action(task.observed(state));
    let rollout = |&start: &[f64; D]| {
        if stop.is_set() { Err(PlanningError::Stopped) } else { Ok(play(task, start, max_steps, greedy)) }
    };
    starts.iter().map(rollout).collect()
}

/// The episode that follows these actions from a state.
pub fn replay<T: GridTask<D>, const D: usize>(task: &T, start: [f64; D], actions: &[u8]) -> Rollout {
    let mut actions = actions.iter();
    let max_steps = actions.len() as u64;
    play(task, start, max_steps, |_| actions.next().map_or(0, |&action| action.into()))
}

fn play<T: GridTask<D>, const D: usize>(
    task: &T,
    mut state: [f64; D],
    max_steps: u64,
    mut choose: impl FnMut([f64; D]) -> usize,
) -> Rollout {
    let mut rollout = Rollout { total: 0.0, steps: 0 };
    while rollout.steps < max_steps {
        let step = task.transition(state, choose(state));
        rollout = Rollout { total: rollout.total + step.reward, steps: rollout.steps + 1 };
        if step.terminated {
            break;
        }
        state = step.state;
    }
    rollout
}
