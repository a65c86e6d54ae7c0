//! The best known ways out of the valley: a beam search over the car's exact dynamics.
//!
//! From a start all three actions are tried, again and again, each on real states; of the states reached after so many
//! steps only the most promising are followed. The first step that reaches the goal makes a route that can be driven.
//! That no shorter one exists is not proved.

use std::mem::swap;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{CostToGo, PlanningError};
use crate::envs::Env;
use crate::envs::classic_control::{MOUNTAIN_CAR_RESET_BOUNDS, MountainCar, MountainCarState};

/// How many starts stand for the uniform distribution: each in the middle of an equal share of it.
pub const STARTS: u32 = 1000;
/// How many states are followed at a time; 1,024 save a hundredth of a step, in a hundred times the time.
pub const BEAM: usize = 16;
/// States as near as this to each other, in parts of the whole range, count as one.
const CELL: f64 = 1e-4;

/// The middles of equal shares of the starting positions.
pub fn starts(count: u32) -> Vec<f64> {
    let [low, high] = MOUNTAIN_CAR_RESET_BOUNDS.map(|(_, number)| number);
    (0..count).map(|index| low + (high - low) * ((f64::from(index) + 0.5) / f64::from(count))).collect()
}

/// The actions that lead from a standing start to the goal, the fewest that the beam finds; None where it finds no way
/// within the limit.
///
/// # Errors
/// `Stopped` after `stop` was set.
pub fn beam_search(
    heuristic: &CostToGo,
    position: f64,
    limit: u64,
    beam: usize,
    stop: &AtomicBool,
) -> Result<Option<Vec<u8>>, PlanningError> {
    let car = heuristic.car();
    let start = MountainCarState { position, velocity: 0.0 };
    let mut layer = vec![Node { state: start, left: 0.0, cell: (0, 0), way: (0, 0) }];
    let mut next = Vec::new();
    // Of each state that was followed, layer by layer.
    let mut ways: Vec<Vec<Parent>> = Vec::new();
    let steps = if heuristic.reachable(start) { limit } else { 0 };
    for _ in 0..steps {
        if stop.load(Ordering::Acquire) {
            return Err(PlanningError::Stopped);
        }
        next.clear();
        for (parent, reached) in layer.iter().enumerate() {
            for action in 0..car.num_actions() {
                let after = car.transition(reached.state, action);
                let way = (parent as u32, action as u8);
                if after.terminated {
                    return Ok(Some(backtrack(&ways, way)));
                }
                let (state, left) = (after.state, heuristic.steps(after.state));
                next.push(Node { state, left, cell: cell(car, state), way });
            }
        }
        // Stable sorts: of equals the first stays first.
        next.sort_by(|one, other| one.cell.cmp(&other.cell).then(one.left.total_cmp(&other.left)));
        next.dedup_by_key(|reached| reached.cell);
        next.sort_by(|one, other| one.left.total_cmp(&other.left));
        next.truncate(beam);
        swap(&mut layer, &mut next);
        ways.push(layer.iter().map(|reached| reached.way).collect());
    }
    Ok(None)
}

/// How many steps the car takes when at each it does what the heuristic says of the observation; the limit where it does
/// not arrive.
///
/// # Errors
/// `Stopped` after `stop` was set.
pub fn greedy_rollout(
    heuristic: &CostToGo,
    position: f64,
    limit: u64,
    stop: &AtomicBool,
) -> Result<u64, PlanningError> {
    let car = heuristic.car();
    let mut state = MountainCarState { position, velocity: 0.0 };
    let steps = if heuristic.reachable(state) { limit } else { 0 };
    for taken in 1..=steps {
        if stop.load(Ordering::Acquire) {
            return Err(PlanningError::Stopped);
        }
        let [position, velocity] = car.observe(&state).map(f64::from);
        let after = car.transition(state, heuristic.best_action(MountainCarState { position, velocity }));
        if after.terminated {
            return Ok(taken);
        }
        state = after.state;
    }
    Ok(limit)
}

/// The place of the state before in its layer, and the action.
type Parent = (u32, u8);

/// A state that was reached.
#[derive(Clone, Copy)]
struct Node {
    state: MountainCarState,
    /// The heuristic's steps from here on.
    left: f64,
    cell: (i32, i32),
    way: Parent,
}

fn cell(car: &MountainCar, state: MountainCarState) -> (i32, i32) {
    let position = (state.position - car.min_position) / ((car.max_position - car.min_position) * CELL);
    let velocity = state.velocity / (2.0 * car.max_speed * CELL);
    (position as i32, velocity.floor() as i32)
}

/// The actions that led to a state of the last layer, and one more.
fn backtrack(ways: &[Vec<Parent>], (mut place, last): Parent) -> Vec<u8> {
    let mut actions = vec![last];
    for layer in ways.iter().rev() {
        let (parent, action) = layer[place as usize];
        actions.push(action);
        place = parent;
    }
    actions.reverse();
    actions
}

#[cfg(test)]
mod tests {
    use super::*;

    static GO: AtomicBool = AtomicBool::new(false);

    fn heuristic(car: MountainCar) -> CostToGo {
        CostToGo::new(car, 200, &GO).expect("it settles")
    }

    /// How many steps the actions take to the goal, if their last one reaches it.
    fn driven(car: &MountainCar, position: f64, actions: &[u8]) -> Option<usize> {
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

    /// The fewest steps by trying every sequence of actions.
    fn fewest(car: &MountainCar, state: MountainCarState, most: usize) -> Option<usize> {
        if most == 0 {
            return None;
        }
        let steps = (0..car.num_actions()).map(|action| car.transition(state, action));
        let rest = steps.map(|step| if step.terminated { Some(0) } else { fewest(car, step.state, most - 1) });
        rest.flatten().min().map(|rest| rest + 1)
    }

    #[test]
    fn every_route_reaches_the_goal_with_its_last_action() {
        let car = MountainCar::default();
        let heuristic = heuristic(car);
        let mut sum = 0;
        for position in starts(50) {
            let beam_search = beam_search(&heuristic, position, 200, BEAM, &GO).expect("no stop").expect("a way");
            let steps = driven(&car, position, &beam_search).expect("the goal");
            assert!(steps as u64 <= greedy_rollout(&heuristic, position, 200, &GO).expect("no stop"));
            sum += steps;
        }
        // Seen: 4,883. The book's agents, and any that is published, take more.
        assert!(sum <= 50 * 98, "{sum}");
    }

    #[test]
    fn where_every_sequence_can_be_tried_none_is_shorter() {
        let car = MountainCar { force: 0.01, goal_position: -0.2, ..MountainCar::default() };
        let heuristic = heuristic(car);
        for position in starts(7) {
            let beam_search = beam_search(&heuristic, position, 200, BEAM, &GO).expect("no stop").expect("a way");
            let state = MountainCarState { position, velocity: 0.0 };
            assert_eq!(Some(beam_search.len()), fewest(&car, state, beam_search.len()), "from {position}");
        }
    }

    #[test]
    fn an_unreachable_goal_has_no_route() {
        let heuristic = heuristic(MountainCar { goal_velocity: 1.0, ..MountainCar::default() });
        assert_eq!(beam_search(&heuristic, -0.5, 200, BEAM, &GO), Ok(None));
        assert_eq!(greedy_rollout(&heuristic, -0.5, 200, &GO), Ok(200));
    }

    #[test]
    fn a_limit_ends_the_search() {
        let heuristic = heuristic(MountainCar::default());
        assert_eq!(beam_search(&heuristic, -0.5, 50, BEAM, &GO), Ok(None));
        assert_eq!(greedy_rollout(&heuristic, -0.5, 50, &GO), Ok(50));
    }

    #[test]
    fn who_is_told_to_stop_stops() {
        let stop = AtomicBool::new(true);
        assert_eq!(CostToGo::new(MountainCar::default(), 200, &stop), Err(PlanningError::Stopped));
        let heuristic = heuristic(MountainCar::default());
        assert_eq!(beam_search(&heuristic, -0.5, 200, BEAM, &stop), Err(PlanningError::Stopped));
    }
}
