//! The shortest known routes of `MountainCar`: a beam search over the exact dynamics.
//!
//! From an initial state it tries all three actions, step by step, and keeps the most promising states after each step.
//! The first step that reaches the goal completes a route, which can be driven. The route is not proven to be shortest.

use crate::StopFlag;
use std::mem::swap;

use super::{CostToGo, PlanningError};
use crate::envs::Env;
use crate::envs::classic_control::{MOUNTAIN_CAR_RESET_BOUNDS, MountainCar, MountainCarState};
use crate::memory::{collect, reserve};

/// The default number of initial positions, which represent the uniform distribution.
pub const STARTS: u32 = 1000;
/// The default beam width. A width of 1,024 shortens routes by a hundredth of a step and takes a hundred times as long.
pub const BEAM: usize = 16;
/// States within the same cell count as equal. The cell is this fraction of the range of positions and velocities.
const CELL: f64 = 1e-4;

/// `count` initial positions: the midpoints of equal parts of their range.
pub fn starts(count: u32) -> Vec<f64> {
    let [low, high] = MOUNTAIN_CAR_RESET_BOUNDS.map(|(_, bound)| bound);
    (0..count).map(|index| low + (high - low) * ((f64::from(index) + 0.5) / f64::from(count))).collect()
}

/// The shortest sequence of actions found from an initial position, at rest, to the goal; `None` if none is found within
/// `max_steps` steps.
///
/// # Errors
/// `Stopped` after `stop` was set.
pub fn beam_search(
    heuristic: &CostToGo,
    position: f64,
    max_steps: u64,
    beam: usize,
    stop: &StopFlag<'_>,
) -> Result<Option<Vec<u8>>, PlanningError> {
    let car = heuristic.car();
    let start = MountainCarState { position, velocity: 0.0 };
    let mut layer = vec![Node { state: start, steps_to_go: 0.0, cell: (0, 0), parent: (0, 0) }];
    let mut next_layer = Vec::new();
    // The parents of the nodes kept in each layer.
    let mut parents: Vec<Vec<Parent>> = Vec::new();
    let max_steps = if heuristic.is_reachable(start) { max_steps } else { 0 };
    for _ in 0..max_steps {
        if stop.is_set() {
            return Err(PlanningError::Stopped);
        }
        next_layer.clear();
        for (index, node) in layer.iter().enumerate() {
            for action in 0..car.num_actions() {
                let next = car.transition(node.state, action);
                let parent = (index as u32, action as u8);
                if next.terminated {
                    return Ok(Some(backtrack(&parents, parent)));
                }
                let (state, steps_to_go) = (next.state, heuristic.steps(next.state));
                next_layer.push(Node { state, steps_to_go, cell: cell(car, state), parent });
            }
        }
        // The sorts are stable: of equal nodes the first stays first.
        next_layer.sort_by(|a, b| a.cell.cmp(&b.cell).then(a.steps_to_go.total_cmp(&b.steps_to_go)));
        next_layer.dedup_by_key(|node| node.cell);
        next_layer.sort_by(|a, b| a.steps_to_go.total_cmp(&b.steps_to_go));
        next_layer.truncate(beam);
        swap(&mut layer, &mut next_layer);
        reserve(&mut parents, 1)?;
        parents.push(collect(layer.iter().map(|node| node.parent))?);
    }
    Ok(None)
}

/// The number of steps to the goal of the greedy policy for the heuristic, which sees the float32 observation;
/// `max_steps` if it does not reach the goal.
///
/// # Errors
/// `Stopped` after `stop` was set.
pub fn greedy_rollout(
    heuristic: &CostToGo,
    position: f64,
    max_steps: u64,
    stop: &StopFlag<'_>,
) -> Result<u64, PlanningError> {
    let car = heuristic.car();
    let mut state = MountainCarState { position, velocity: 0.0 };
    let steps = if heuristic.is_reachable(state) { max_steps } else { 0 };
    for taken in 1..=steps {
        if stop.is_set() {
            return Err(PlanningError::Stopped);
        }
        let [position, velocity] = car.observe(&state).map(f64::from);
        let next = car.transition(state, heuristic.best_action(MountainCarState { position, velocity }));
        if next.terminated {
            return Ok(taken);
        }
        state = next.state;
    }
    Ok(max_steps)
}

/// The index of the parent in the layer before, and the action taken there.
type Parent = (u32, u8);

/// A state in the beam.
#[derive(Clone, Copy)]
struct Node {
    state: MountainCarState,
    /// The heuristic number of steps to the goal.
    steps_to_go: f64,
    cell: (i32, i32),
    parent: Parent,
}

/// The cell of a state.
fn cell(car: &MountainCar, state: MountainCarState) -> (i32, i32) {
    let position = (state.position - car.min_position) / ((car.max_position - car.min_position) * CELL);
    let velocity = state.velocity / (2.0 * car.max_speed * CELL);
    (position as i32, velocity.floor() as i32)
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
    use super::*;

    static NO_STOP: StopFlag<'static> = StopFlag::new();

    fn cost_to_go(car: MountainCar) -> CostToGo {
        CostToGo::new(car, 200, &NO_STOP).expect("not stopped")
    }

    /// The number of actions, if exactly the last one reaches the goal.
    fn steps_to_goal(car: &MountainCar, position: f64, actions: &[u8]) -> Option<usize> {
        let mut state = MountainCarState { position, velocity: 0.0 };
        for (taken, &action) in actions.iter().enumerate() {
            let step = car.transition(state, action.into());
            if step.terminated {
                return (taken + 1 == actions.len()).then_some(taken + 1);
            }
            state = step.state;
        }
        None
    }

    /// The fewest steps to the goal, by trying all sequences of up to `max_steps` actions.
    fn fewest_steps(car: &MountainCar, state: MountainCarState, max_steps: usize) -> Option<usize> {
        if max_steps == 0 {
            return None;
        }
        let steps = (0..car.num_actions()).map(|action| car.transition(state, action));
        let rest =
            steps.map(|step| if step.terminated { Some(0) } else { fewest_steps(car, step.state, max_steps - 1) });
        rest.flatten().min().map(|rest| rest + 1)
    }

    #[test]
    fn every_route_reaches_the_goal_with_its_last_action() {
        let car = MountainCar::default();
        let heuristic = cost_to_go(car);
        let mut sum = 0;
        for position in starts(50) {
            let route = beam_search(&heuristic, position, 200, BEAM, &NO_STOP).expect("not stopped").expect("a route");
            let steps = steps_to_goal(&car, position, &route).expect("the goal");
            assert!(steps as u64 <= greedy_rollout(&heuristic, position, 200, &NO_STOP).expect("not stopped"));
            sum += steps;
        }
        // The sum was 4,883 when this was written. Published agents need more steps.
        assert!(sum <= 50 * 98, "{sum}");
    }

    #[test]
    fn routes_are_shortest_where_all_sequences_can_be_tried() {
        let car = MountainCar { force: 0.01, goal_position: -0.2, ..MountainCar::default() };
        let heuristic = cost_to_go(car);
        for position in starts(7) {
            let route = beam_search(&heuristic, position, 200, BEAM, &NO_STOP).expect("not stopped").expect("a route");
            let state = MountainCarState { position, velocity: 0.0 };
            assert_eq!(Some(route.len()), fewest_steps(&car, state, route.len()), "from {position}");
        }
    }

    #[test]
    fn an_unreachable_goal_has_no_route() {
        let heuristic = cost_to_go(MountainCar { goal_velocity: 1.0, ..MountainCar::default() });
        assert_eq!(beam_search(&heuristic, -0.5, 200, BEAM, &NO_STOP), Ok(None));
        assert_eq!(greedy_rollout(&heuristic, -0.5, 200, &NO_STOP), Ok(200));
    }

    #[test]
    fn the_time_limit_ends_the_search() {
        let heuristic = cost_to_go(MountainCar::default());
        assert_eq!(beam_search(&heuristic, -0.5, 50, BEAM, &NO_STOP), Ok(None));
        assert_eq!(greedy_rollout(&heuristic, -0.5, 50, &NO_STOP), Ok(50));
    }

    #[test]
    fn the_stop_flag_stops_the_search() {
        let stop = StopFlag::new();
        stop.set();
        assert_eq!(CostToGo::new(MountainCar::default(), 200, &stop), Err(PlanningError::Stopped));
        let heuristic = cost_to_go(MountainCar::default());
        assert_eq!(beam_search(&heuristic, -0.5, 200, BEAM, &stop), Err(PlanningError::Stopped));
    }
}
