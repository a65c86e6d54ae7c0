//! `MountainCarContinuous-v0`: the mountain car with a continuous force, whose square is subtracted from the reward.

use crate::envs::{Env, Parameters, Step, parameters};
use crate::numeric::{Scalar, squared};
use crate::persist_struct;
use crate::random::Rng;

/// The bounds of the initial position, which is uniform.
const RESET_BOUNDS: [(&str, f64); 2] = [("low", -0.6), ("high", -0.4)];
/// The acceleration by gravity on the steepest slope, per step.
const GRAVITY: f64 = 0.0025;
const GOAL_REWARD: f64 = 100.0;

/// The parameters, with Gymnasium's names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuousMountainCar {
    /// The lower bound that the force is clipped to.
    pub min_action: f64,
    /// The upper bound that the force is clipped to.
    pub max_action: f64,
    /// The position of the left wall, which absorbs the car's speed.
    pub min_position: f64,
    /// The right end of the track.
    pub max_position: f64,
    /// The maximum speed in both directions.
    pub max_speed: f64,
    /// An episode ends at or beyond this position, with at least the goal velocity.
    pub goal_position: f64,
    /// The minimum velocity at the goal.
    pub goal_velocity: f64,
    /// The acceleration by a force of 1, per step.
    pub power: f64,
}

impl Default for ContinuousMountainCar {
    fn default() -> Self {
        Self {
            min_action: -1.0,
            max_action: 1.0,
            min_position: -1.2,
            max_position: 0.6,
            max_speed: 0.07,
            goal_position: 0.45,
            goal_velocity: 0.0,
            power: 0.0015,
        }
    }
}

impl Parameters for ContinuousMountainCar {
    parameters!(min_action, max_action, min_position, max_position, max_speed, goal_position, goal_velocity, power);
}

/// Position and velocity: float64 after a reset and float32 after a step, as in Gymnasium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuousMountainCarState {
    /// The position.
    pub position: Scalar,
    /// The velocity, in position units per step.
    pub velocity: Scalar,
}

persist_struct!(ContinuousMountainCarState { position, velocity });

impl From<[Scalar; 2]> for ContinuousMountainCarState {
    fn from([position, velocity]: [Scalar; 2]) -> Self {
        Self { position, velocity }
    }
}

impl From<ContinuousMountainCarState> for [f64; 2] {
    fn from(state: ContinuousMountainCarState) -> Self {
        [state.position.into(), state.velocity.into()]
    }
}

impl Env for ContinuousMountainCar {
    type State = ContinuousMountainCarState;
    /// The force. Its dtype matters: float32 and float64 forces lead to different numbers.
    type Action = Scalar;
    type Observation = [f32; 2];

    #[inline]
    fn num_actions(&self) -> usize {
        0
    }

    const RESET_BOUNDS: Option<[(&'static str, f64); 2]> = Some(RESET_BOUNDS);

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> Self::State {
        self.reset_within(RESET_BOUNDS.map(|(_, number)| number), rng)
    }

    #[inline]
    fn reset_within(&self, [low, high]: [f64; 2], rng: &mut impl Rng) -> Self::State {
        let position = Scalar::Double(rng.uniform(low, high));
        ContinuousMountainCarState { position, velocity: Scalar::Double(0.0) }
    }

    #[inline]
    fn step(&self, state: Self::State, action: Scalar, _rng: &mut impl Rng) -> Step<Self::State> {
        let ContinuousMountainCarState { mut position, mut velocity } = state;
        let [min_action, max_action] = [self.min_action, self.max_action].map(Scalar::Python);
        let [min_position, max_position] = [self.min_position, self.max_position].map(Scalar::Python);
        let [max_speed, min_speed] = [self.max_speed, -self.max_speed].map(Scalar::Python);

        let mut force = action;
        if force.less(min_action) {
            force = min_action;
        }
        if max_action.less(force) {
            force = max_action;
        }
        let slope = f64::from(Scalar::Python(3.0) * position).cos();
        velocity = velocity + (force * Scalar::Python(self.power) - Scalar::Python(GRAVITY * slope));
        if max_speed.less(velocity) {
            velocity = max_speed;
        }
        if velocity.less(min_speed) {
            velocity = min_speed;
        }
        position = position + velocity;
        if max_position.less(position) {
            position = max_position;
        }
        if position.less(min_position) {
            position = min_position;
        }
        if position.equal(min_position) && velocity.less(Scalar::Python(0.0)) {
            velocity = Scalar::Python(0.0);
        }

        let terminated = position.greater_equal(Scalar::Python(self.goal_position))
            && velocity.greater_equal(Scalar::Python(self.goal_velocity));
        let reward = if terminated { GOAL_REWARD } else { 0.0 };
        Step {
            state: ContinuousMountainCarState {
                position: Scalar::Single(position.into()),
                velocity: Scalar::Single(velocity.into()),
            },
            reward: reward - squared(action.into()) * 0.1,
            terminated,
        }
    }

    #[inline]
    fn observe(&self, state: &Self::State) -> [f32; 2] {
        [state.position.into(), state.velocity.into()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    fn step(position: f32, velocity: f32, force: f32) -> Step<ContinuousMountainCarState> {
        let state =
            ContinuousMountainCarState { position: Scalar::Single(position), velocity: Scalar::Single(velocity) };
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        ContinuousMountainCar::default().step(state, Scalar::Single(force), &mut rng)
    }

    #[test]
    fn the_left_wall_absorbs_speed() {
        assert_eq!(
            step(-1.19, -0.05, -1.0).state,
            ContinuousMountainCarState { position: Scalar::Single(-1.2), velocity: Scalar::Single(0.0) }
        );
    }

    #[test]
    fn the_cost_uses_the_force_before_clipping() {
        assert_eq!(step(-0.5, 0.0, 2.0).state, step(-0.5, 0.0, 1.0).state);
        assert_eq!(step(-0.5, 0.0, 2.0).reward, -0.4);
        assert_eq!(step(-0.5, 0.0, 0.0).reward, 0.0);
    }

    #[test]
    fn the_goal_has_a_reward_of_a_hundred() {
        let goal = step(0.449, 0.06, 1.0);
        assert!(goal.terminated);
        assert_eq!(goal.reward, 99.9);
    }
}
