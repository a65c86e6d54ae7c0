//! The shortest known routes: a beam search over the exact dynamics, for tasks in which every step but the last has the
//! same cost.
//!
//! From an initial state the search tries all actions, step by step, and keeps the most promising states after each
//! step. The first step that ends the episode completes a route. The exact dynamics reproduce it, but it is not proven
//! to be shortest.

use std::mem::swap;

use super::super::PlanningError;
use super::{GridTask, GridValues};
use crate::StopFlag;
use crate::memory::{collect, reserve};

/// States within the same cell count as equal. Along each axis, the cell size is this fraction of the range.
const CELL: f64 = 1e-4;

/// The shortest sequence of actions found from an initial state to a terminal one; `None` if none is found within
/// `max_steps` steps. After each step, the `beam` states of the highest values are kept.
///
/// # Errors
/// `Stopped` after `stop` was set; `OutOfMemory`.
pub fn beam_search<T: GridTask<D>, const D: usize>(
    heuristic: &GridValues<T, D>,
    start: [f64; D],
    max_steps: u64,
    beam: usize,
    stop: &StopFlag<'_>,
) -> Result<Option<Vec<u8>>, PlanningError> {
    let task = heuristic.task();
    let (lows, sizes) = cell_sizes(task);
    let mut layer = vec![Node { state: start, value: 0.0, cell: [0; D], parent: (0, 0) }];
    let mut next_layer = Vec::new();
    // The parents of the nodes kept in each layer.
    let mut parents: Vec<Vec<Parent>> = Vec::new();
    let max_steps = if heuristic.is_above_lowest(start) { max_steps } else { 0 };
    for _ in 0..max_steps {
        if stop.is_set() {
            return Err(PlanningError::Stopped);
        }
        next_layer.clear();
        for (index, node) in layer.iter().enumerate() {
            for action in 0..T::ACTIONS {
                let next = task.transition(node.state, action);
                let parent = (index as u32, action as u8);
                if next.terminated {
                    return Ok(Some(backtrack(&parents, parent)));
                }
                let (state, value) = (next.state, heuristic.value(next.state));
                let cell = std::array::from_fn(|axis| ((state[axis] - lows[axis]) / sizes[axis]).floor() as i32);
                next_layer.push(Node { state, value, cell, parent });
            }
        }
        // The sorts are stable: of equal nodes, the first stays first.
        next_layer.sort_by(|a, b| a.cell.cmp(&b.cell).then(b.value.total_cmp(&a.value)));
        next_layer.dedup_by_key(|node| node.cell);
        next_layer.sort_by(|a, b| b.value.total_cmp(&a.value));
        next_layer.truncate(beam);
        swap(&mut layer, &mut next_layer);
        reserve(&mut parents, 1)?;
        parents.push(collect(layer.iter().map(|node| node.parent))?);
    }
    Ok(None)
}

/// The lower bound and the cell size of each axis.
fn cell_sizes<T: GridTask<D>, const D: usize>(task: &T) -> ([f64; D], [f64; D]) {
    let bounds = task.bounds();
    (bounds.map(|(low, _)| low), bounds.map(|(low, high)| (high - low) * CELL))
}

/// The index of the parent in the previous layer, and the action taken from it.
type Parent = (u32, u8);

/// A state in the beam.
#[derive(Clone, Copy)]
struct Node<const D: usize> {
    state: [f64; D],
    /// The value on the grid.
    value: f64,
    cell: [i32; D],
    parent: Parent,
}

/// The actions that lead from the start to a node of the last layer, followed by `last`.
fn backtrack(parents: &[Vec<Parent>], (mut index, last): Parent) -> Vec<u8> {
    let mut actions = vec![last];
    for layer in parents.iter().rev() {
        let (parent, action) = layer[index as usize];
        actions.push(action);
        index = parent;
    }
    actions.reverse();
    actions
}

#[cfg(test)]
mod tests {
    use super::super::{Rollout, replay, rollouts};
    use super::*;
    use crate::envs::classic_control::{Acrobot, MountainCar};

    static NO_STOP: StopFlag<'static> = StopFlag::new();
    const BEAM: usize = 16;

    fn values<T: GridTask<D>, const D: usize>(task: T, stride: usize) -> GridValues<T, D> {
        GridValues::new(task, 200, stride, &NO_STOP).expect("not stopped")
    }

    /// `count` initial states, at rest: the midpoints of equal parts of the range of positions.
    fn mountain_car_starts(count: u32) -> Vec<[f64; 2]> {
        (0..count).map(|index| [-0.6 + 0.2 * ((f64::from(index) + 0.5) / f64::from(count)), 0.0]).collect()
    }

    /// Whether exactly the last action ends the episode.
    fn ends_with<T: GridTask<D>, const D: usize>(task: &T, start: [f64; D], actions: &[u8]) -> bool {
        let (mut state, last) = (start, actions.len() - 1);
        actions.iter().enumerate().all(|(taken, &action)| {
            let step = task.transition(state, action.into());
            state = step.state;
            step.terminated == (taken == last)
        })
    }

    /// The fewest steps to the goal, found by trying all sequences of up to `max_steps` actions.
    fn fewest_steps(car: &MountainCar, state: [f64; 2], max_steps: usize) -> Option<usize> {
        if max_steps == 0 {
            return None;
        }
        let steps = (0..3).map(|action| GridTask::transition(car, state, action));
        let rest =
            steps.map(|step| if step.terminated { Some(0) } else { fewest_steps(car, step.state, max_steps - 1) });
        rest.flatten().min().map(|rest| rest + 1)
    }

    #[test]
    fn every_route_reaches_the_goal_with_its_last_action() {
        let heuristic = values(MountainCar::default(), 1);
        let starts = mountain_car_starts(50);
        let greedy = rollouts(&heuristic, &starts, 200, &NO_STOP).expect("not stopped");
        let mut sum = 0;
        for (start, greedy) in starts.into_iter().zip(greedy) {
            let route = beam_search(&heuristic, start, 200, BEAM, &NO_STOP).expect("not stopped").expect("a route");
            assert!(ends_with(heuristic.task(), start, &route));
            let steps = route.len() as u64;
            assert_eq!(replay(heuristic.task(), start, &route), Rollout { total: -(steps as f64), steps });
            assert!(steps <= greedy.steps);
            sum += steps;
        }
        // At the time of writing, the sum was 4,883. Published agents need more steps.
        assert!(sum <= 50 * 98, "{sum}");
    }

    #[test]
    fn a_route_of_the_acrobot_ends_with_its_last_action() {
        let heuristic = values(Acrobot::default(), 4);
        let start = [0.05, -0.05, 0.02, 0.0];
        let route = beam_search(&heuristic, start, 200, 32, &NO_STOP).expect("not stopped").expect("a route");
        assert!(ends_with(heuristic.task(), start, &route));
        assert!(route.len() < 100, "{}", route.len());
        // The last step costs nothing.
        assert_eq!(replay(heuristic.task(), start, &route).total, 1.0 - route.len() as f64);
    }

    #[test]
    fn routes_are_shortest_where_all_sequences_can_be_tried() {
        let car = MountainCar { force: 0.01, goal_position: -0.2, ..MountainCar::default() };
        let heuristic = values(car, 1);
        for start in mountain_car_starts(7) {
            let route = beam_search(&heuristic, start, 200, BEAM, &NO_STOP).expect("not stopped").expect("a route");
            assert_eq!(Some(route.len()), fewest_steps(&car, start, route.len()), "from {start:?}");
        }
    }

    #[test]
    fn an_unreachable_goal_has_no_route() {
        let heuristic = values(MountainCar { goal_velocity: 1.0, ..MountainCar::default() }, 1);
        assert_eq!(beam_search(&heuristic, [-0.5, 0.0], 200, BEAM, &NO_STOP), Ok(None));
        assert_eq!(
            rollouts(&heuristic, &[[-0.5, 0.0]], 200, &NO_STOP),
            Ok(vec![Rollout { total: -200.0, steps: 200 }])
        );
    }

    #[test]
    fn the_time_limit_ends_the_search() {
        let heuristic = values(MountainCar::default(), 1);
        assert_eq!(beam_search(&heuristic, [-0.5, 0.0], 50, BEAM, &NO_STOP), Ok(None));
        assert_eq!(rollouts(&heuristic, &[[-0.5, 0.0]], 50, &NO_STOP), Ok(vec![Rollout { total: -50.0, steps: 50 }]));
    }

    #[test]
    fn the_stop_flag_stops_the_search() {
        let stop = StopFlag::new();
        stop.set();
        assert_eq!(GridValues::new(MountainCar::default(), 200, 1, &stop), Err(PlanningError::Stopped));
        let heuristic = values(MountainCar::default(), 1);
        assert_eq!(beam_search(&heuristic, [-0.5, 0.0], 200, BEAM, &stop), Err(PlanningError::Stopped));
        assert_eq!(rollouts(&heuristic, &[[-0.5, 0.0]], 200, &stop), Err(PlanningError::Stopped));
    }
}
